"""Computes the motion of the ground beyond a free-field side of a slide: an endless slope with the strata of the side.

Ground that continues beyond a side slides, too, where its own slope and Kh make it slide. A side that waited for it
would hold the ground in the section back. The free field is a column of the strata at the side that shears on the
lowest stratum that liquefies, under Kh and under its weight on the slope of the surface next to the side (coupled
analysis of sliding, Rathje & Bray 1999, Earthquake Eng. Struct. Dyn. 28, 1303-1332). Below the water that stands on the
ground the weight is the buoyant one. Strengths are c + σ'_v tan φ, and the residual strength after liquefaction; ground
with a strain potential has its two straight lines (`meshes.section.strain_potential`). Ground that stands before the
shaking has at least the strength for it. Velocities are positive to the right.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from meshes.section import shear_column as column
from meshes.section.earth_pressure import passive_pressure
from meshes.section.liquefies import RemainingStrength
from meshes.section.section import Section
from meshes.section.sides import interfaces_at, lowest_liquefied
from meshes.section.strain_potential import REGAINING_STRAIN, soft_range

LAYERS = 30  # of the column
TIME_STEP, RECORD_INTERVAL = 5e-4, 0.04  # s
STABLE_SHARE = 0.4  # of the time in which a shear wave crosses a layer: largest time step
DAMPING_RATIO = 0.1  # of ground that does not slip, at the natural period of the column
LARGEST_ELASTIC_STRAIN = 0.02  # at which liquefied ground without a strain potential reaches its strength
LEAST_STRENGTH = 1.0  # Pa
CREEP_TIME = 5.0  # s: viscosity over stiffness of ground short of its strain potential, as in discs and points


@dataclass(frozen=True, eq=False)
class FreeField:
    """Holds the column of ground beyond a side.

    Attributes
    ----------
    section : the ground
    right : whether the side is the right one
    starts : time at which each stratum begins to liquefy (s since the beginning of the slide), by its number
    remains : strength that strata retain after liquefaction, by their numbers; others keep their strength
    onset : time in which a stratum liquefies (s)
    stiffness : factor on the shear modulus of liquefied ground
    by_stiffness : how ground with a strain potential becomes soft, see `meshes.section.shear_column`: by its stiffness,
        as material points, or by its strain potential, as discs
    """

    section: Section
    right: bool
    starts: Mapping[int, float]
    remains: Mapping[int, RemainingStrength]
    onset: float
    stiffness: float = 1.0
    by_stiffness: bool = False

    @cached_property
    def foot(self) -> float:
        """Return the elevation of the base of the column (m). Raises ValueError if no stratum liquefies at the side."""
        foot = lowest_liquefied(self.section, self.right, self.starts)
        if foot is None:
            raise ValueError("no stratum liquefies at this side")
        return foot

    @cached_property
    def slope(self) -> float:
        """Return the angle (rad) by which the surface beside the side falls to the right, over a distance of the height
        of the column."""
        x, z = self.section.ground.T
        left, right = self.section.extent
        side = right if self.right else left
        top = float(z[-1] if self.right else z[0])
        reach = min(top - self.foot, right - left)
        inside = side - reach if self.right else side + reach
        return float(np.arctan2(top - np.interp(inside, x, z), inside - side))

    @cached_property
    def levels(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the elevations (n + 1,) of the boundaries of the layers of the column from the base up (m), and the
        stratum (n,) of each layer."""
        bounds, tolerance = interfaces_at(self.section, self.right), self.section.layering.tolerance
        step = (bounds[0] - self.foot) / LAYERS
        levels, strata = [np.array([self.foot])], list[int]()
        for k in range(len(bounds) - 2, -1, -1):
            low, high = max(bounds[k + 1], self.foot), bounds[k]
            if high - low > tolerance:
                count = max(1, round((high - low) / step))
                levels.append(np.linspace(low, high, count + 1)[1:])
                strata += [k] * count
        return np.concatenate(levels), np.array(strata, int)

    def velocities(self, shaking: Callable[[np.ndarray], np.ndarray], end: float) -> "FreeFieldMotion":
        """Return the motion of the column.

        Parameters
        ----------
        shaking : horizontal acceleration of the ground (m/s²) at times (n,) in s, positive to the right
        end : time to which the motion is computed (s since the beginning of the slide)

        Returns
        -------
        Velocities of the ground from the base of the column to the surface.
        """
        levels, strata = self.levels
        time = TIME_STEP * np.arange(int(np.ceil(end / TIME_STEP)))
        thickness = np.diff(levels)
        density = np.array([soil.density_seismic for soil in self.section.strata])[strata]
        begin = np.array([self.starts.get(k, np.inf) for k in strata.tolist()])
        speeds = column.shear_column(
            _at_tops(density * thickness), thickness, self._pull(), self._laws(density, thickness), begin, self.onset,
            TIME_STEP, np.asarray(shaking(time), float), round(RECORD_INTERVAL / TIME_STEP),
            self.by_stiffness,
        )  # fmt: skip
        at_rest = np.zeros((1, len(strata)))
        speeds = np.vstack([at_rest, speeds])
        times = RECORD_INTERVAL * np.arange(len(speeds))
        return FreeFieldMotion(levels, times, np.column_stack([np.zeros(len(speeds)), speeds]))

    def passive_pressure(self, z: np.ndarray) -> np.ndarray:
        """Return the effective passive pressure of the ground beyond the side after liquefaction.

        Parameters
        ----------
        z (n,) : elevations above the base of the column (m)

        Returns
        -------
        Pressure (n,) in Pa; of liquefied ground σ'_v + 2 s_r, with its residual strength s_r.
        """
        levels, strata = self.levels
        numbers = strata[np.clip(np.searchsorted(levels, z) - 1, 0, len(strata) - 1)]
        points = self._points(np.clip(z, levels[0], levels[-1]))
        stress = self.section.surface_loads.vertical_effective(points, numbers)
        soils = self.section.cohesion_field.means()
        sine = np.array([np.sin(soils[k].friction_angle) for k in numbers])
        cohesion = np.array([soils[k].cohesion for k in numbers]) * np.sqrt(1.0 - sine**2)
        for k in self.remains:
            inside = numbers == k
            sine[inside], cohesion[inside] = 0.0, self._residual_strength(k, stress[inside], soils[k].cohesion)
        return passive_pressure(stress, sine, cohesion)

    def _residual_strength(self, stratum: int, stress: np.ndarray, cohesion: float) -> np.ndarray:
        """Return the strength (n,) of a liquefied stratum in Pa; stress (n,): vertical effective stress (Pa); cohesion:
        that before liquefaction (Pa)."""
        remains, soil = self.remains[stratum], self.section.strata[stratum]
        by_stress = remains.residual + remains.friction * np.tan(soil.friction_angle)
        strength = by_stress * stress + remains.strength + remains.cohesion * cohesion
        return np.maximum(strength, LEAST_STRENGTH)

    def _points(self, z: np.ndarray) -> np.ndarray:
        left, right = self.section.extent
        tiny = 1e-9 * (right - left)
        return np.column_stack([np.full(len(z), right - tiny if self.right else left + tiny), z])

    def _pull(self) -> np.ndarray:
        """Return the force by weight (n,) on each mass of the column (N/m²)."""
        levels, strata = self.levels
        water, points = self.section.water_pressure, self._points(levels[:-1])
        weight = water.overburden(points, points)
        if water.on_ground(top := self._points(levels[-1:]), top)[0] > 0.0:
            weight = water.vertical_effective(points, points, strata)
        of_layers = weight - np.append(weight[1:], 0.0)
        return _at_tops(of_layers) * np.sin(self.slope) * np.cos(self.slope)

    def _laws(self, density: np.ndarray, thickness: np.ndarray) -> np.ndarray:
        """Return the laws of shear (2, n, 6) of the layers before and after liquefaction."""
        levels, numbers = self.levels
        section = self.section
        stress = section.surface_loads.vertical_effective(self._points(0.5 * (levels[1:] + levels[:-1])), numbers)
        soils = section.cohesion_field.means()
        tangent, cohesion, modulus = np.array([
            (np.tan(soil.friction_angle), soil.cohesion, soil.youngs_modulus / (2.0 * (1.0 + soil.poissons_ratio)))
            for soil in soils
        ])[numbers].T  # fmt: skip
        modulus = np.minimum(modulus, density * (STABLE_SHARE * thickness / TIME_STEP) ** 2)
        at_rest = np.abs(np.cumsum(self._pull()[::-1])[::-1])
        before = np.maximum(np.maximum(cohesion + stress * tangent, at_rest), LEAST_STRENGTH)
        crossing = np.sum(thickness / np.sqrt(modulus / density))
        viscosity = DAMPING_RATIO * modulus * 4.0 * crossing / np.pi
        viscosity = np.minimum(viscosity, 0.25 * density * thickness**2 / TIME_STEP)
        laws = np.zeros((2, len(numbers), 6))
        laws[:, :, column.STRENGTH], laws[:, :, column.REGAINING] = before, before / modulus
        laws[:, :, column.VISCOSITY] = laws[:, :, column.SOFT_VISCOSITY] = viscosity
        for k in self.remains:
            self._liquefy(laws[1], k, numbers == k, stress, soils[k].cohesion, modulus)
        return laws

    def _liquefy(
        self,
        laws: np.ndarray,
        stratum: int,
        inside: np.ndarray,
        stress: np.ndarray,
        cohesion: float,
        modulus: np.ndarray,
    ) -> None:
        """Set the laws (n, 6) of the layers ``inside`` a stratum to those after liquefaction."""
        remains = self.remains[stratum]
        strength = self._residual_strength(stratum, stress[inside], cohesion)
        elastic = np.minimum(strength / (modulus[inside] * self.stiffness), LARGEST_ELASTIC_STRAIN)
        laws[inside, column.STRENGTH], laws[inside, column.REGAINING] = strength, elastic
        laws[inside, column.VISCOSITY] *= self.stiffness
        if remains.strain_potential > 0.0:
            soft = soft_range(remains.strain_potential, stress[inside], strength)
            laws[inside, column.POTENTIAL], laws[inside, column.KNEE] = soft.strain, soft.stress
            laws[inside, column.REGAINING] = REGAINING_STRAIN
            laws[inside, column.SOFT_VISCOSITY] = CREEP_TIME * soft.stress / soft.strain


@dataclass(frozen=True, eq=False)
class FreeFieldMotion:
    """Holds the velocity of the ground beyond a side in time.

    Attributes
    ----------
    levels (n + 1,) : elevations, from the base of the column up (m)
    times (k,) : times (s since the beginning of the slide)
    speeds (k, n + 1) : velocity at each elevation, positive to the right (m/s)
    """

    levels: np.ndarray
    times: np.ndarray
    speeds: np.ndarray

    def mean(self, z: np.ndarray) -> np.ndarray:
        """Return the mean velocity (k,) over elevations z (m), in m/s."""
        weights = np.mean([np.interp(z, self.levels, unit) for unit in np.eye(len(self.levels))], axis=1)
        return np.asarray(self.speeds @ weights)


def _at_tops(of_layers: np.ndarray) -> np.ndarray:
    """Return quantities of layers from the lowest up, divided in half between top and bottom of each, at the tops. The
    whole lowest layer counts at its top, so that ground that slips at the foot has all its mass."""
    at_tops = 0.5 * (of_layers + np.append(of_layers[1:], 0.0))
    at_tops[0] += 0.5 * of_layers[0]
    return np.asarray(at_tops)
