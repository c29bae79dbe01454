"""Computes the K0 stress that acts on free-field sides, for finite elements and for limit analysis.

The K0 stress grows with depth as in ground without horizontal strain: ν / (1 - ν) of the weight of the column above,
times a factor for each stratum. The factor makes the resultant in the stratum equal to the resultant by plane
elasticity under weight with the sides held horizontally. Where the ground slopes, the factor of the K0 stress is above
1 on one side of the section and below 1 on the other side. The stress is nearer to the plain K0 stress than to
Rankine's active and passive stresses.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meshes.section.earth_pressure import active_pressure, passive_pressure
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section
from meshes.section.sides import interfaces_at

UPWARDS = np.array([[0.0, 1.0]])


@dataclass(frozen=True, eq=False)
class SideStress:
    """Holds the horizontal stress on a side of the section, linear over the thickness of each of the k strata there.

    Attributes
    ----------
    strata (k,) : numbers of the strata, from the top down
    elevation (k, 2) : elevation of the top and the bottom of each stratum (m)
    stress (k, 2) : horizontal stress at the top and the bottom of each stratum, tension positive (Pa)
    """

    strata: np.ndarray
    elevation: np.ndarray
    stress: np.ndarray

    def stratum_at(self, elevation: np.ndarray) -> np.ndarray:
        """Return the numbers of the strata (n,) at elevations (n,) in m."""
        below = np.searchsorted(-self.elevation[:, 1], -np.asarray(elevation))
        return self.strata[np.minimum(below, len(self.strata) - 1)]

    def at(self, elevation: np.ndarray, stratum: np.ndarray) -> np.ndarray:
        """Return the horizontal stress (Pa) at elevations (m) within strata."""
        place = np.searchsorted(self.strata, stratum)
        top, bottom = self.elevation[place].T
        share = np.clip((top - elevation) / (top - bottom), 0.0, 1.0)
        return (1.0 - share) * self.stress[place, 0] + share * self.stress[place, 1]


def k0_stress(section: Section, side: str, resultants: Sequence[float] | np.ndarray) -> SideStress:
    """Return the K0 stress on a side of the section.

    The stress is clipped half-way between ν / (1 - ν) of the weight and the active or passive stress of Rankine, since
    loose ground at its limit would not stand any seismic force.

    Parameters
    ----------
    section : the ground
    side : "left" or "right"
    resultants (strata,) : horizontal effective forces in every stratum at this side by plane elasticity, tension
        positive (N/m)

    Returns
    -------
    The horizontal effective stress of the strata that reach this side, tension positive.
    """
    elevation = interfaces_at(section, side == "right")
    effective = _vertical_stress(section, side, elevation)
    places, interior_points = _stratum_ends(section, side, elevation)
    present_strata = np.flatnonzero(elevation[:-1] > elevation[1:])
    sides = []
    for k in present_strata:
        soil = section.strata[k]
        vertical = effective[k]
        ratio = soil.poissons_ratio / (1.0 - soil.poissons_ratio)
        plain = ratio * vertical
        force = 0.5 * plain.sum() * (elevation[k] - elevation[k + 1])
        factor = -resultants[k] / force if force > 0.0 else 1.0
        sin, cos = np.sin(soil.friction_angle), np.cos(soil.friction_angle)
        cohesion = section.cohesion_field.at(places[k], interior_points[k], np.array([k, k]))
        active = np.maximum(active_pressure(vertical, sin, cohesion * cos), 0.0)
        passive = passive_pressure(vertical, sin, cohesion * cos)
        # Half-way to either limit at most: loose ground at the limit at its surface would not stand any push.
        lowest, highest = (0.5 * (np.clip(plain, active, passive) + limit) for limit in (active, passive))
        sides.append(-np.clip(factor * plain, lowest, highest))
    return SideStress(
        present_strata,
        np.column_stack([elevation[present_strata], elevation[present_strata + 1]]),
        np.array(sides).reshape(-1, 2),
    )


def _vertical_stress(section: Section, side: str, elevation: np.ndarray) -> np.ndarray:
    """Return the vertical effective stress (strata, 2) in Pa at top and bottom of every stratum on a side, pressure
    positive.

    ``elevation`` (interfaces,) contains the elevations of the layers at this side. Loads on the ground count as if the
    ground continued level.
    """
    water = section.water_pressure
    strata = len(section.strata)
    stress = np.zeros((strata, 2))
    thickness = elevation[:-1] - elevation[1:]
    weight = GRAVITY * np.array([s.density_ordinary for s in section.strata]) * thickness
    stress[:, 1] = np.cumsum(weight)
    stress[1:, 0] = stress[:-1, 1]
    if water.present or section.surcharges:
        places, interior_points = (ends.reshape(-1, 2) for ends in _stratum_ends(section, side, elevation))
        ground = places[:1]
        on_ground = (
            water.on_ground(ground, interior_points[:1])
            - section.surface_loads.dead(ground, interior_points[:1], UPWARDS)[:, 1]
        )
        pores = water.at_rest(places, interior_points, np.repeat(np.arange(strata), 2))
        stress = np.maximum(stress + on_ground - pores.reshape(strata, 2), 0.0)
    return stress


def _stratum_ends(section: Section, side: str, elevation: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the points (strata, 2, 2) at top and bottom of every stratum on a side, and points just inside the section
    next to them (m)."""
    x, layers = section.layering.x, len(elevation) - 1
    x_of_side, x_inside = (x[0], x[:2].mean()) if side == "left" else (x[-1], x[-2:].mean())
    ends = np.repeat(elevation, 2)[1:-1]
    places, interior_points = (np.column_stack([np.full(2 * layers, x_side), ends]) for x_side in (x_of_side, x_inside))
    return places.reshape(layers, 2, 2), interior_points.reshape(layers, 2, 2)
