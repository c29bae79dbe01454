"""Maps strength and stiffness of random patches of soil discs as functions of the two dimensionless numbers that govern
them.

The discs have the law "soil" and random packings of porosity `patch.POROSITY`. If contacts are stiff for their stress
(kappa = kn / p above 200), the strength at a confining pressure p depends on two numbers, and by a few per cent on
kappa: the friction mu of the contacts, and the cohesion number C / (2 r p) with the mean radius r and the cohesion C of
a contact (N per metre). The tensile strength of a contact is a = `springs.ATTRACTION` times C; this attraction acts
like an additional pressure a C / (2 r), which counts in kappa. Strength is half the deviator stress at 8 to 15 % of
axial compression, since the continuum is perfectly plastic without a peak. The peak is taken from the mean curve of all
patches, since the curve of a single patch is jerky, and its peak is higher.

There are two strength maps. Discs of soil with friction rotate, with rolling resistance (`springs.ROLLING`), so that
rigid rotation of the ground needs no work. Discs without rotation have about the same biaxial strength and peak, but
columns of them collapse to only two thirds of the run-out of sand. Discs of clay, whose contacts have tensile strength,
do not rotate: with rotation they roll under tension, and a vertical face that is stable by limit analysis collapses.

Discs without contact friction still have a friction angle of some 8 degrees by their geometry. Clay has no friction
angle: its contacts have a negative friction in addition to their cohesion, so that their strength falls as the normal
force rises.

The maps are computed by `python -m docs.strength_map`, and stored next to this file.
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
STIFFNESS_POWERS = 0.22, 0.16
# Soft cohesive discs are stronger, by (SOFT_KAPPA / kappa) to this power: 1.03 times at 154, 1.05 at 95, 1.15 at
# 54 and 1.33 at 29, measured with mu = -0.2 and C/(2 r p) of 0.8 to 6.4.
SOFT_KAPPA, SOFT_POWER = 15.5, 1.6
# Those without cohesion are weaker, since discs pressed into each other dilate less: strength goes with kappa to this
# power up to `DENSEST_KAPPA`. Of discs that turn it is 0.99, 1.05, 1.11, 1.17 of the pressure at kappa 200, 400, 1600,
# 6000 (mu = 0.35, 16 to 32 seeds each), and 1.64, 1.61, 1.63, 1.87 with mu = 0.6 (12 to 16 seeds, 0.04 to 0.14 of
# scatter of the mean). A cohesion number of 0.4 leaves a seventh of it (mu = 0.3, discs that do not turn), as the
# weight EVEN_COHESION / (number + EVEN_COHESION).
DILATION_POWER, DENSEST_KAPPA = 0.05, 6000.0
EVEN_COHESION = 0.1  # cohesion number below which the map is even: the axis is the logarithm of what lies beyond


@dataclass(frozen=True)
class ContactStrength:
    """Holds constants of contacts, and the strength of discs with these contacts by the map.

    Attributes
    ----------
    friction : friction coefficient mu
    cohesion : C over the mean diameter (Pa)
    expected_strength (n,) : strength at the required pressures by the strength map (Pa)
    """

    friction: float
    cohesion: float
    expected_strength: np.ndarray


@dataclass(frozen=True)
class StrengthMap:
    """Gives strength and stiffness of patches as functions of friction and cohesion number.

    Attributes
    ----------
    friction (m,) : friction coefficients mu of the contacts, in rising order
    cohesion (k,) : cohesion numbers C / (2 r p) of the contacts, in rising order
    post_peak, peak (m, k) : half the deviator stress over the confining pressure, after the peak and at the peak; mean
        over the seeds
    scatter (m, k) : standard deviation of `post_peak` from seed to seed
    modulus (m, k) : E over kn, with E of a soil of the same stiffness in plane strain; see `normal_stiffness`
    """

    friction: np.ndarray
    cohesion: np.ndarray
    post_peak: np.ndarray
    peak: np.ndarray
    scatter: np.ndarray
    modulus: np.ndarray

    def strongest(self, cohesive: bool) -> float:
        """Return the largest ratio in the map of half the deviator stress to the pressure, with or without cohesion of
        contacts.
        """
        return float(self.post_peak.max() if cohesive else self._sand[1].max())

    def normal_stiffness(self, youngs_modulus: float, pressure: float, friction: float, cohesion: float) -> float:
        """Return the contact stiffness kn (N/m) with which patches have this Young's modulus (Pa) at this pressure
        (Pa); cohesion: C over the diameter (Pa), whose attraction adds to the pressure. youngs_modulus: Young's modulus
        (Pa); friction: friction of the contacts (-).
        """
        power = STIFFNESS_POWERS[cohesion > 0.0]
        modulus = float(self._at(self.modulus, friction, np.array([cohesion / pressure]))[0])
        stiff = youngs_modulus / modulus / (KAPPA * (pressure + ATTRACTION * cohesion)) ** power
        return float(stiff ** (1.0 / (1.0 - power)))

    def modulus_over_kn(self, friction: float, cohesion_number: float, kappa: float) -> float:
        """Return Young's modulus in plane strain over kn of patches with these dimensionless numbers."""
        modulus = float(self._at(self.modulus, friction, np.array([cohesion_number]))[0])
        return modulus * (KAPPA / kappa) ** STIFFNESS_POWERS[cohesion_number > 0.0]

    def gained_by_softness(self, stiffness: float, pressure: np.ndarray, cohesion: float) -> np.ndarray:
        """Return the ratio of the strength of discs with the spring constant kn (N/m) at given pressures (Pa) to the
        strength of the map, which is for stiff discs; cohesion: C over the diameter (Pa). The ratio is interpolated
        between its values without cohesion and with large cohesion.
        """
        kappa = stiffness / (pressure + ATTRACTION * cohesion)
        dry = EVEN_COHESION / (EVEN_COHESION + cohesion / pressure)
        dilating = (np.minimum(kappa, DENSEST_KAPPA) / KAPPA) ** DILATION_POWER
        return np.asarray(dry * dilating + (1.0 - dry) * (1.0 + (SOFT_KAPPA / kappa) ** SOFT_POWER))

    def _at(self, table: np.ndarray, friction: float, number: np.ndarray) -> np.ndarray:
        """Return a table (m, k), interpolated at one friction and some cohesion numbers."""
        coordinates = np.column_stack([np.broadcast_to(friction, number.shape), np.log(number + EVEN_COHESION)])
        between = RegularGridInterpolator(
            (self.friction, np.log(self.cohesion + EVEN_COHESION)), np.log(table), bounds_error=False, fill_value=None
        )
        return np.asarray(np.exp(between(coordinates)))

    def strength(self, friction: float, cohesion: float, pressure: np.ndarray) -> np.ndarray:
        """Return half the deviator stress after the peak (Pa) at confining pressures (Pa); cohesion: C over the
        diameter (Pa).
        """
        pressure = np.asarray(pressure, float)
        return self._at(self.post_peak, friction, cohesion / pressure) * pressure

    @property
    def _sand(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the friction mu (from 0 on) of contacts without cohesion, and for each mu half the deviator stress of
        patches over the pressure.
        """
        has_any = self.friction >= 0.0
        return self.friction[has_any], self.post_peak[has_any, 0]

    def fit(self, required: np.ndarray, pressure: np.ndarray, cohesive: bool = True) -> ContactStrength:
        """Fit the friction and cohesion of contacts, so that the ratios of the strengths by the map to the required
        strengths (Pa) are closest to 1 at all pressures.

        cohesive: False for contacts without cohesion.
        """
        if not cohesive:
            ratio = float(np.exp(np.mean(np.log(required / pressure))))
            friction, after = self._sand
            mu = float(np.interp(np.log(ratio), np.log(after), friction))
            return ContactStrength(mu, 0.0, self.strength(mu, 0.0, pressure))
        highest = float(self.cohesion[-1] * np.max(pressure))

        def miss(values: np.ndarray) -> np.ndarray:
            return np.asarray(np.log(self.strength(values[0], values[1], pressure) / required))

        bounds = [self.friction[0], 0.0], [self.friction[-1], highest]
        scale = max(1e-3 * highest, min(float(required.mean()), 0.9 * highest))
        best = min(
            (
                least_squares(miss, [min(mu, float(self.friction[-1])), c], bounds=bounds, x_scale=[0.1, scale])
                for mu, c in ((-0.1, scale), (0.05, scale), (0.3, 1e-3 * scale), (0.3, scale))
            ),
            key=lambda solution: solution.cost,
        )
        # the solver approaches bounds without reaching them
        mu, c = (
            0.0 if abs(value) < 1e-3 * size else float(value) for value, size in zip(best.x, (1.0, scale), strict=True)
        )
        return ContactStrength(mu, c, self.strength(mu, c, pressure))


@lru_cache(maxsize=2)
def strength_map(turns: bool = True) -> StrengthMap:
    """Return the strength map that comes with this package: of discs that rotate (``turns``), for soil with friction,
    or of discs that do not rotate, for clay."""
    with (files("dem.laboratory") / MAP).open(encoding="utf-8") as source:
        every = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(source)]
    rows = [row for row in every if row["turns"] == turns]
    friction, cohesion = (np.array(sorted({row[key] for row in rows})) for key in ("friction", "cohesion_number"))
    by_place = {(row["friction"], row["cohesion_number"]): row for row in rows}

    def table(key: str) -> np.ndarray:
        return np.array([[by_place[mu, c][key] for c in cohesion] for mu in friction])

    return StrengthMap(friction, cohesion, table("after"), table("peak"), table("scatter"), table("modulus"))
