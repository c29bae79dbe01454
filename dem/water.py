"""What water does to discs: the slope of the pore pressure on each, and on those at the ground what presses there.

The force of a disc is that of its share of the soil, where it lies when the discs are made; it goes with the disc from
then on, and so do the forces at the ground, and between strata with different pore pressures, which the nearest discs
take. Pore pressure that shaking adds is left out: of discs, strata liquefy.
"""

import numpy as np
from scipy.spatial import cKDTree

from dem.state import DiscState
from meshes.pore_loads import at_ends, corner_pressure, edge_jumps, outward_normals
from meshes.section.section import Section
from meshes.triangles import TriMesh, triangulate

# Step (mean radii) of the finite difference that finds the slope of the pore pressure, which is linear.
STEP = 1e-3
# Edges of the triangles, in mean radii.
EDGE = 2.0


def drift(section: Section, x: np.ndarray, z: np.ndarray, discs: DiscState) -> tuple[np.ndarray, np.ndarray]:
    """Acceleration (m/s2) of discs at x and z (m) of a section by its water and by what presses on its ground."""
    found = np.zeros((len(x), 2))
    water = section.water_pressure
    free = np.flatnonzero(~discs.fixed)
    if water.present:
        places, layer = np.column_stack([x, z])[free], discs.layer[free].astype(int)
        step = STEP * float(discs.radius.mean())
        density = np.array([s.density_seismic for s in section.strata])[layer]
        for axis in (0, 1):
            away = step * np.eye(2)[axis]
            rise = water.at_rest(places + away, places, layer) - water.at_rest(places - away, places, layer)
            found[free, axis] = -rise / (2.0 * step) / density
    if water.present or section.surcharges:
        tree = cKDTree(np.column_stack([x, z])[free])
        at, force = _edge_forces(section, EDGE * float(discs.radius.mean()))
        nearest = free[tree.query(at)[1]]
        np.add.at(found, nearest, force / discs.mass[nearest, None])
    return found[:, 0], found[:, 1]


def _edge_forces(section: Section, size: float) -> tuple[np.ndarray, np.ndarray]:
    """Where (k, 2) in m the skeleton is pressed at the ground and between strata, and by what force (k, 2) in N/m."""
    mesh, water = triangulate(section, size), section.water_pressure
    pressure = corner_pressure(mesh, water.at_rest)
    jumps = edge_jumps(mesh, pressure)
    ends = mesh.boundaries["surface"]
    cells = mesh.edge_cells[mesh.edge_numbers(ends), 0]
    normal, middle = outward_normals(mesh, cells, ends), mesh.points[ends].mean(axis=1)
    inside = at_ends(mesh, pressure, cells, ends).mean(axis=1)
    outside = 0.5 * sum(water.on_ground(mesh.points[ends[:, end]], middle) for end in (0, 1))
    pressed = (inside - outside)[:, None] * normal + section.surface_loads.dead(middle, middle, normal)
    return (
        np.vstack([middle, mesh.points[jumps.ends].mean(axis=1)]),
        np.vstack([_length(mesh, ends) * pressed, _length(mesh, jumps.ends) * jumps.traction.mean(axis=1)]),
    )


def _length(mesh: TriMesh, ends: np.ndarray) -> np.ndarray:
    return np.hypot(*(mesh.points[ends[:, 1]] - mesh.points[ends[:, 0]]).T)[:, None]
