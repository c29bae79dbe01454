"""Computes vertical stresses in a section before the earthquake, at a point (x, depth)."""

from dataclasses import dataclass

import numpy as np

from meshes.section.layering import middles
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section
from meshes.section.water import FRESH

COLUMNS = 200  # along the section
AT_WATER = 1e-6  # m: distance of a point from the water table at which the point lies on it


@dataclass(frozen=True)
class Overburden:
    """Holds the vertical stresses at a point.

    Attributes
    ----------
    stratum : index of the stratum
    total : vertical stress (Pa) of the mass that shakes above the point, ground and surcharges, without water on the
        ground
    effective : vertical effective stress (Pa)
    loads : increments of total and effective stress by surcharges (Pa): by the share of a surcharge that shakes, and by
        the share under which the ground has consolidated
    below_water : whether the point lies at or below the water table, or the piezometric level of its stratum: soil at
        the table is saturated, and relations of triggering are evaluated there (Idriss & Boulanger 2008, appendix A)
    """

    stratum: int
    total: float
    effective: float
    below_water: bool
    loads: tuple[float, float] = (0.0, 0.0)


def overburden(section: Section, x: float, depth: float) -> Overburden:
    """Compute vertical stresses at a point before the earthquake.

    The total stress is the weight of the strata above with all water in their pores. The effective stress is this
    weight and the weight of water on the ground, less the pore pressure.

    The total stress is counted from the ground down, under water from the mudline: water has no shear stiffness, so
    free water adds nothing to the shear stress that shaking brings, a_max σv r_d/g (Seed & Idriss 1971), and a cone is
    zeroed at the mudline. The pore pressure is that of the stratum, after a drawdown if there is one, or hydrostatic
    below a water table that is only drawn.

    Surcharges spread with depth as on an elastic half-plane (`Surcharge.below`): the total stress has the share of
    their mass that shakes, the effective stress the share under which the ground has consolidated.

    If a stratum has two densities, the seismic density contains all of its mass. Strata are divided where water stands
    in them, with a density on either side.

    Parameters
    ----------
    section : the section
    x : place in the section (m)
    depth : depth of the point below the ground (m), within the section: see `outside`

    Returns
    -------
    The stresses (Pa), positive in compression.
    """
    levels = section.layering.interfaces(np.array([x]))[0]
    elevation = float(levels[0]) - depth
    water = water_level(section, x)
    unit_weight = FRESH * GRAVITY if section.water is None else float(section.water.unit_weight)
    thickness = np.clip(levels[:-1], elevation, None) - np.clip(levels[1:], elevation, None)
    total = GRAVITY * float(thickness @ [stratum.density_seismic for stratum in section.strata])
    pressure = free_water = 0.0
    if water is not None:
        free_water = unit_weight * max(0.0, water - float(levels[0]))
        pressure = unit_weight * max(0.0, water - elevation)
    stratum = int(section.stratum_at(np.array([x]), np.array([elevation]))[0])
    level = water_level(section, x, stratum)
    at_water = level is not None and abs(level - elevation) <= AT_WATER
    below_water = level is not None and level > elevation
    if section.water_pressure.still:  # levels and ratios of the strata and a drawdown are in it
        place, field = np.array([[x, elevation]]), section.water_pressure
        pressure = float(field.at_rest(place, place, np.array([stratum]))[0])
        free_water = float(field.ponded(field.table_after, place, place)[0])
        below_water = below_water and pressure > 0.0
    added, drained = loads = _loads(section, x, elevation)
    effective = total + free_water - pressure + drained
    return Overburden(stratum, total + added, effective, below_water or at_water, loads)


def _loads(section: Section, x: float, elevation: float) -> tuple[float, float]:
    """Return the increments of total and effective stress (Pa) at a point by surcharges, see `Overburden.loads`."""
    total = drained = 0.0
    for load in section.surcharges:
        stands_on = float(np.interp(min(max(x, load.start), load.end), *section.ground.T))
        stress = load.below(x, stands_on - elevation)
        total, drained = total + load.seismic_share * stress, drained + load.consolidated * stress
    return total, drained


def water_level(section: Section, x: float, stratum: int | None = None) -> float | None:
    """Return the elevation of the water at a place, after a drawdown if there is one.

    Parameters
    ----------
    section : the section
    x : place (m)
    stratum : number of a stratum, whose own piezometric level counts if it has one, or the level below which its pores
        are full: before the drawdown if the stratum does not drain; None for the water table

    Returns
    -------
    Elevation (m); None without water.
    """
    points = computed_water_points(section, stratum)
    return None if points is None else float(np.interp(x, points[:, 0], points[:, 1]))


def computed_water_points(section: Section, stratum: int | None = None) -> np.ndarray | None:
    """Return the water table of the state that is computed, which is the lower one after a drawdown.

    Parameters
    ----------
    section : the ground
    stratum : number of the stratum whose water level is meant; None for the water table, which free water follows

    Returns
    -------
    Elevations (n, 2) in m; None without water.
    """
    if stratum is not None and section.strata[stratum].confined:
        return section.water_pressure.levels[stratum]
    lowered = section.water_points_after_drawdown()
    follows = stratum is None or section.strata[stratum].drains
    return lowered if lowered is not None and follows else section.water_points()


def outside(section: Section, x: float, depth: float) -> str:
    """Return why a point is not in the section.

    Parameters
    ----------
    section : the section
    x : place (m)
    depth : depth of the point below the ground (m)

    Returns
    -------
    The reason in words; empty if the point is inside.
    """
    left, right = section.given_extent
    if not left <= x <= right:
        return f"x = {x:g} m is off the section, which reaches from {left:g} to {right:g} m"
    levels = section.layering.interfaces(np.array([x]))[0]
    deepest = float(levels[0] - levels[-1])
    return f"depth = {depth:g} m is below the base, {deepest:.2f} m down at x = {x:g} m" if depth >= deepest else ""


def reaches_water(section: Section, stratum: int) -> bool:
    """Return whether any part of a stratum lies below water.

    Parameters
    ----------
    section : the section
    stratum : number of the stratum

    Returns
    -------
    True if a part lies below the water table, or below the piezometric level of the stratum.
    """
    x = middles(*section.given_extent, COLUMNS)
    levels = section.layering.interfaces(x)
    points = computed_water_points(section, stratum)
    if points is None:
        return False
    present = levels[:, stratum] > levels[:, stratum + 1]
    return bool(np.any(present & (levels[:, stratum + 1] < np.interp(x, *points.T) - 1e-9)))
