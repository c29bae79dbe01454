"""Strength and stiffness of random patches of soil discs, over the two groups that govern them.

Discs of law "soil" in random packings of porosity `patch.POROSITY`. Stiff for their stress (kappa = kn / p above 200),
their strength at a confining pressure p depends on two numbers, and by a few per cent on kappa: the friction mu
of their contacts, and the cohesion number C / (2 r p) with the mean radius r and the cohesion C of a contact (N per
metre), which bears `springs.ATTRACTION` times as much pull. What pulls at contacts presses them together as a pressure
a C / (2 r) would, and counts in kappa. Strength is half the deviator that is left at 8 to 15 % of axial compression, as
the continuum is perfectly plastic, and knows no peak. The peak is that of the mean curve of all patches, since the peak
of a single patch includes its largest jerk.

There are two maps. Discs of soil with friction turn, and roll over each other no more than the spring of rolling gives
way (`springs.ROLLING`): ground that turns as a whole costs nothing. Discs that could not turn had a biaxial strength
alike, and no less of a peak, but columns of them ran two thirds as far as sand does. Discs of clay, whose contacts
pull, do not turn: those that do roll where they are pulled at, and a face falls off that stands by limit analysis.

Discs without friction at their contacts still have some 8 degrees by their geometry. A clay has none: its contacts have
a friction below zero beside their cohesion, so that they hold less where they are pressed harder.

The maps are computed once, by `python -m dem.laboratory.make_map`, and kept beside this file.
"""

import csv
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files

import numpy as np
from scipy.interpolate import RegularGridInterpolator
from scipy.optimize import least_squares

from dem.springs import ATTRACTION

MAP = "strength_map.csv"
KAPPA = 400.0  # kn over the pressure and the pull of contacts, at which the map was made
# E / kn goes with kappa to minus this power, without and with cohesion of contacts: stiffer discs have fewer contacts.
LOOSENS = 0.22, 0.16
# Soft cohesive discs are stronger, by (SOFT / kappa) to this power: 1.03 times at 154, 1.05 at 95, 1.15 at 54 and 1.33
# at 29, measured with mu = -0.2 and C/(2 r p) of 0.8 to 6.4.
SOFT, SOFTER = 15.5, 1.6
# Those without cohesion are weaker, since discs pressed into each other dilate less: strength goes with kappa to this
# power up to `DENSEST`. Of discs that turn it is 0.99, 1.05, 1.11, 1.17 of the pressure at kappa 200, 400, 1600, 6000
# (mu = 0.35, 16 to 32 seeds each), and 1.64, 1.61, 1.63, 1.87 with mu = 0.6 (12 to 16 seeds, 0.04 to 0.14 of scatter of
# the mean). A cohesion number of 0.4 leaves a seventh of it (mu = 0.3, discs that do not turn), as the weight of EARLY
# over it and EARLY does.
DILATES, DENSEST = 0.05, 6000.0
EARLY = 0.1  # cohesion number below which the map is even: the axis is the logarithm of what lies beyond


@dataclass(frozen=True)
class ContactStrength:
    """Constants of contacts, and the strength that the map expects of discs with them.

    Attributes
    ----------
    friction : float
        mu.
    cohesion : float
        C over the mean diameter (Pa).
    expected : (n,)
        Strength at the pressures that were asked for, by the map (Pa).
    """

    friction: float
    cohesion: float
    expected: np.ndarray


@dataclass(frozen=True)
class StrengthMap:
    """Strength and stiffness of patches over friction and cohesion number.

    Attributes
    ----------
    friction : (m,)
        mu of the contacts, negative ones first.
    cohesion : (k,)
        Cohesion numbers C / (2 r p).
    after, peak : (m, k)
        Half the deviator over the confining pressure, after the peak and there; mean over the seeds.
    scatter : (m, k)
        Standard deviation of `after` from seed to seed.
    modulus : (m, k)
        E of the soil as stiff in plane strain over kn; see `normal_stiffness`.
    """

    friction: np.ndarray
    cohesion: np.ndarray
    after: np.ndarray
    peak: np.ndarray
    scatter: np.ndarray
    modulus: np.ndarray

    def strongest(self, cohesive: bool) -> float:
        """The largest half deviator over the pressure in the map, with or without cohesion of contacts."""
        return float(self.after.max() if cohesive else self._sand[1].max())

    def normal_stiffness(self, youngs_modulus: float, pressure: float, friction: float, cohesion: float) -> float:
        """kn (N/m) with which patches have this Young's modulus (Pa) at this pressure (Pa); cohesion: C over the
        diameter (Pa), whose pull presses contacts together as well.
        youngs_modulus: (Pa); friction: of the contacts (-).
        """
        power = LOOSENS[cohesion > 0.0]
        modulus = float(self._at(self.modulus, friction, np.array([cohesion / pressure]))[0])
        stiff = youngs_modulus / modulus / (KAPPA * (pressure + ATTRACTION * cohesion)) ** power
        return float(stiff ** (1.0 / (1.0 - power)))

    def modulus_over_kn(self, friction: float, cohesion_number: float, kappa: float) -> float:
        """Young's modulus in plane strain over kn of patches of these dimensionless numbers."""
        modulus = float(self._at(self.modulus, friction, np.array([cohesion_number]))[0])
        return modulus * (KAPPA / kappa) ** LOOSENS[cohesion_number > 0.0]

    def gained_by_softness(self, stiffness: float, pressure: np.ndarray, cohesion: float) -> np.ndarray:
        """Strength of discs of this kn (N/m) at these pressures (Pa) over that of the map; cohesion: C over the
        diameter (Pa). It is interpolated between that without cohesion and that with much.
        """
        kappa = stiffness / (pressure + ATTRACTION * cohesion)
        dry = EARLY / (EARLY + cohesion / pressure)
        dilating = (np.minimum(kappa, DENSEST) / KAPPA) ** DILATES
        return np.asarray(dry * dilating + (1.0 - dry) * (1.0 + (SOFT / kappa) ** SOFTER))

    def _at(self, table: np.ndarray, friction: float, number: np.ndarray) -> np.ndarray:
        """A table (m, k) between its points, at one friction and some cohesion numbers."""
        where = np.column_stack([np.broadcast_to(friction, number.shape), np.log(number + EARLY)])
        between = RegularGridInterpolator(
            (self.friction, np.log(self.cohesion + EARLY)), np.log(table), bounds_error=False, fill_value=None
        )
        return np.asarray(np.exp(between(where)))

    def strength(self, friction: float, cohesion: float, pressure: np.ndarray) -> np.ndarray:
        """Half the deviator after the peak (Pa) at confining pressures (Pa); cohesion: C over the diameter (Pa)."""
        pressure = np.asarray(pressure, float)
        return self._at(self.after, friction, cohesion / pressure) * pressure

    @property
    def _sand(self) -> tuple[np.ndarray, np.ndarray]:
        """mu of contacts without cohesion, from 0 on, and half the deviator over the pressure that they have."""
        has_any = self.friction >= 0.0
        return self.friction[has_any], self.after[has_any, 0]

    def fit(self, wanted: np.ndarray, pressure: np.ndarray, cohesive: bool = True) -> ContactStrength:
        """Friction and cohesion whose strengths come closest to those wanted (Pa), as ratios, at all the pressures.

        cohesive: False for contacts that shall have no cohesion.
        """
        if not cohesive:
            ratio = float(np.exp(np.mean(np.log(wanted / pressure))))
            friction, after = self._sand
            mu = float(np.interp(np.log(ratio), np.log(after), friction))
            return ContactStrength(mu, 0.0, self.strength(mu, 0.0, pressure))
        highest = float(self.cohesion[-1] * np.max(pressure))

        def miss(values: np.ndarray) -> np.ndarray:
            return np.asarray(np.log(self.strength(values[0], values[1], pressure) / wanted))

        bounds = [self.friction[0], 0.0], [self.friction[-1], highest]
        scale = max(1e-3 * highest, min(float(wanted.mean()), 0.9 * highest))
        best = min(
            (
                least_squares(miss, [min(mu, float(self.friction[-1])), c], bounds=bounds, x_scale=[0.1, scale])
                for mu, c in ((-0.1, scale), (0.05, scale), (0.3, 1e-3 * scale), (0.3, scale))
            ),
            key=lambda solution: solution.cost,
        )
        # a bound that the solver only comes near to is meant to be reached
        mu, c = (
            0.0 if abs(value) < 1e-3 * size else float(value) for value, size in zip(best.x, (1.0, scale), strict=True)
        )
        return ContactStrength(mu, c, self.strength(mu, c, pressure))


@lru_cache(maxsize=2)
def strength_map(turns: bool = True) -> StrengthMap:
    """The map of the package: of rotating discs for soil with friction, or of discs that do not rotate for clay."""
    with (files("dem.laboratory") / MAP).open(encoding="utf-8") as source:
        every = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(source)]
    rows = [row for row in every if row["turns"] == turns]
    friction, cohesion = (np.array(sorted({row[key] for row in rows})) for key in ("friction", "cohesion_number"))
    by_place = {(row["friction"], row["cohesion_number"]): row for row in rows}

    def table(key: str) -> np.ndarray:
        return np.array([[by_place[mu, c][key] for c in cohesion] for mu in friction])

    return StrengthMap(friction, cohesion, table("after"), table("peak"), table("scatter"), table("modulus"))
