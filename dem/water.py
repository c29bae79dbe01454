"""Computes forces of water and surcharges on discs, by the same fields as in finite elements and bounds. The force on a
disc is the force on its share of the soil at its initial place. Forces on the ground surface, and between strata with
different pore pressures, act on the nearest discs. The force on a disc is constant as it moves, except for buoyancy:
the water table does not move, and the buoyancy of soil discs that cross it follows from their part below it
(`buoyancy`).
"""

from collections.abc import Callable

import numpy as np
from scipy.spatial import cKDTree

from dem.state import DiscState
from meshes.pore_loads import Pressure, at_ends, corner_pressure, edge_jumps, outward_normals
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section
from meshes.triangles import TriMesh, triangulate

# Step (mean radii) of the finite difference that finds the slope of the pore pressure, which is linear.
STEP = 1e-3
# Edges of the triangles, in mean radii.
EDGE = 2.0

Places = tuple[np.ndarray, np.ndarray]  # x and z (n,) of all discs in the section (m)
# Traction (k, 2) in Pa on the skeleton at the middles (k, 2) of edges of the ground, whose outward normals are (k, 2).
WaterTraction = Callable[[np.ndarray, np.ndarray], np.ndarray]
# Pressure (k,) in Pa of the water at points (k, 2) of the ground, with points near them.
Outside = Callable[[np.ndarray, np.ndarray], np.ndarray]


def still_water(section: Section, places: Places, discs: DiscState) -> np.ndarray:
    """Return the acceleration (n, 2) in m/s2 of discs by static pore pressure and by loads on the ground."""
    acceleration = np.zeros((len(discs), 2))
    water, size = section.water_pressure, EDGE * float(discs.radius.mean())
    if water.present:
        acceleration += _of_pores(section, places, discs, water.at_rest, water.on_ground)
    if section.surcharges:
        mesh = triangulate(section, size)
        acceleration += _at_nearest(
            discs, places, *_on_ground(mesh, lambda at, out: section.surface_loads.dead(at, at, out))
        )
    return acceleration


def buoyancy(section: Section, places: Places, discs: DiscState) -> np.ndarray | None:
    """Return the acceleration (n, 2) in m/s2 of discs by buoyancy below the water table, averaged over each disc.

    The buoyancy of a disc is proportional to its part below the table, so that ground that sinks becomes buoyant, and
    ground that rises above the table has its full weight.

    Parameters
    ----------
    section : section with the water
    places : present positions of the discs (m); the water table does not move
    discs : radii (m) and layers of the discs, and mask of the fixed ones

    Returns
    -------
    The accelerations (n, 2), zero for discs of strata without a water level. None for a section without still water
    below a table: for seepage and for a pore pressure ratio, the pressure at new positions is not known.
    """
    water = section.water_pressure
    levels = zip(water.levels, section.strata, strict=True)
    floats = [level is not None and stratum.pore_pressure_ratio is None for level, stratum in levels]
    if water.flow is not None or not any(floats):
        return None
    free = np.flatnonzero(~discs.fixed & np.append(floats, False)[discs.layer])
    at, layer, radius = np.column_stack(places)[free], discs.layer[free].astype(int), discs.radius[free]
    density = np.array([s.density_seismic for s in section.strata])[layer]
    acceleration = np.zeros((len(discs), 2))
    for axis in (0, 1):
        away = radius[:, np.newaxis] * np.eye(2)[axis]
        rise = water.at_rest(at + away, at, layer) - water.at_rest(at - away, at, layer)
        acceleration[free, axis] = -rise / (2.0 * radius) / density
    return acceleration


def excess(section: Section, places: Places, discs: DiscState) -> np.ndarray | None:
    """Return the acceleration (n, 2) in m/s2 of discs by excess pore pressure by shaking; None without any."""
    if not section.water_pressure.rises_by_shaking:
        return None
    return _of_pores(section, places, discs, section.water_pressure.excess, None)


def added_mass(section: Section, places: Places, discs: DiscState) -> np.ndarray | None:
    """Return the acceleration (n, 2) of discs by the inertia of surcharges and free water, over the horizontal
    acceleration.

    None without surcharges and free water.
    """
    surface = section.surface_loads
    if not surface.present:
        return None
    mesh = triangulate(section, EDGE * float(discs.radius.mean()))
    at, force = _on_ground(mesh, lambda middle, out: surface.seismic(1, middle, middle, out))
    return _at_nearest(discs, places, at, force / GRAVITY)


def _of_pores(
    section: Section, places: Places, discs: DiscState, pressure: Pressure, outside: Outside | None
) -> np.ndarray:
    """Return the acceleration (n, 2) by a pore pressure: by its gradient, its jumps, and its excess over free water."""
    free = np.flatnonzero(~discs.fixed)
    at, layer = np.column_stack(places)[free], discs.layer[free].astype(int)
    step = STEP * float(discs.radius.mean())
    density = np.array([s.density_seismic for s in section.strata])[layer]
    acceleration = np.zeros((len(discs), 2))
    for axis in (0, 1):
        away = step * np.eye(2)[axis]
        rise = pressure(at + away, at, layer) - pressure(at - away, at, layer)
        acceleration[free, axis] = -rise / (2.0 * step) / density
    mesh = triangulate(section, EDGE * float(discs.radius.mean()))
    corners = corner_pressure(mesh, pressure)
    ends = mesh.boundaries["surface"]
    inside = at_ends(mesh, corners, mesh.edge_cells[mesh.edge_numbers(ends), 0], ends).mean(axis=1)

    def pressed(middle: np.ndarray, out: np.ndarray) -> np.ndarray:
        water = 0.0 if outside is None else 0.5 * sum(outside(mesh.points[ends[:, k]], middle) for k in (0, 1))
        return (inside - water)[:, None] * out

    jumps = edge_jumps(mesh, corners)
    between = _length(mesh, jumps.ends) * jumps.traction.mean(axis=1)
    acceleration += _at_nearest(discs, places, *_on_ground(mesh, pressed))
    return acceleration + _at_nearest(discs, places, mesh.points[jumps.ends].mean(axis=1), between)


def _on_ground(mesh: TriMesh, traction: WaterTraction) -> tuple[np.ndarray, np.ndarray]:
    """Return middles (k, 2) in m of the edges of the ground surface, and forces (k, 2) in N/m of a traction on these
    edges."""
    ends = mesh.boundaries["surface"]
    normal = outward_normals(mesh, mesh.edge_cells[mesh.edge_numbers(ends), 0], ends)
    middle = mesh.points[ends].mean(axis=1)
    return middle, _length(mesh, ends) * traction(middle, normal)


def _at_nearest(discs: DiscState, places: Places, at: np.ndarray, force: np.ndarray) -> np.ndarray:
    """Return the acceleration (n, 2) in m/s2 of discs by forces (k, 2) in N/m, each on the disc that is nearest to its
    place (k, 2) in m.
    """
    free = np.flatnonzero(~discs.fixed)
    nearest = free[cKDTree(np.column_stack(places)[free]).query(at)[1]]
    acceleration = np.zeros((len(discs), 2))
    np.add.at(acceleration, nearest, force / discs.mass[nearest, None])
    return acceleration


def _length(mesh: TriMesh, ends: np.ndarray) -> np.ndarray:
    return np.hypot(*(mesh.points[ends[:, 1]] - mesh.points[ends[:, 0]]).T)[:, None]
