"""Computes the nodal forces of pore water, free water and surcharges.

The pore pressure u is taken at the quadrature points, where it does work on the volumetric strain, so that the skeleton
gets the forces of σ' = σ + u (tension positive) whether u jumps from stratum to stratum or not. Free water loads the
ground surface with its pressure. Where the pressure of free water equals u, both forces together give buoyancy. (If u
were bilinear between the corners of cells that the water table crosses, there would be pore pressure above the water
table, and sand without cohesion would be lifted.)
"""

from collections.abc import Callable

import numpy as np

from fem.continuum.discretisation import DEGREES
from fem.continuum.plane_strain import PlaneStrain
from fem.solvers import dolfinx_api as api
from meshes.quad_mesh import QuadMesh
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section

# Pressure (n,) in Pa at points (n, 2) in m, with points near them and their strata.
Pressure = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]
# Traction (n, 2) in Pa at points (n, 2) of the ground, with points near them and outward normals.
Traction = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]

# Gauss points along an edge, more than a linear traction on quadratic shape functions requires.
POINTS_ON_EDGE = 3


def hydrostatic_load(problem: PlaneStrain, mesh: QuadMesh, section: Section) -> np.ndarray | float:
    """Return the nodal forces of static pore pressure, free water and surcharges.

    Parameters
    ----------
    problem : the elements of the mesh
    mesh : a mesh of the section
    section : the ground with its water and surcharges

    Returns
    -------
    Forces (dofs,) in N/m on the skeleton, positive to the right and upwards; 0.0 without load.
    """
    load: np.ndarray | float = 0.0
    water, surface = section.water_pressure, section.surface_loads
    if water.present:
        load = load + pore_force(problem, mesh, water.at_rest) + _free_water_forces(problem, mesh, section)
    if surface.surcharges:
        load = load + ground_force(problem, mesh, surface.dead)
    return load


def excess_pressure_load(problem: PlaneStrain, mesh: QuadMesh, section: Section) -> np.ndarray | None:
    """Return the nodal forces of the excess pore pressure by shaking.

    Parameters
    ----------
    problem, mesh, section : as in `hydrostatic_load`

    Returns
    -------
    Forces (dofs,) in N/m; None without excess pore pressure, or if the pore pressure at rest contains it.
    """
    if not section.water_pressure.rises_by_shaking or section.water_pressure.after_shaking:
        return None
    return pore_force(problem, mesh, section.water_pressure.excess)


def seismic_surface_load(problem: PlaneStrain, mesh: QuadMesh, section: Section, sign: int) -> np.ndarray | float:
    """Return the nodal forces (dofs,) in N/m of Kh = 1 on surcharges and free water; 0.0 without any.

    ``problem`` are the elements of ``mesh``, which is a mesh of ``section``; ``sign`` is 1 if the force acts to the
    right, -1 to the left.
    """
    surface = section.surface_loads
    if not surface.present:
        return 0.0
    return ground_force(problem, mesh, lambda *place: surface.seismic(sign, *place))


def seismic_load(problem: PlaneStrain, mesh: QuadMesh, section: Section, sign: int) -> np.ndarray:
    """Return the nodal forces of Kh = 1 on the soil, on surcharges and on free water.

    Parameters
    ----------
    problem, mesh, section : as in `hydrostatic_load`
    sign : 1 if the force acts to the right, -1 to the left

    Returns
    -------
    Forces (dofs,) in N/m: the seismic density times the acceleration of gravity on the soil.
    """
    soil = problem.body_force([s.density_seismic for s in problem.strata], (sign * GRAVITY, 0.0))
    return soil + seismic_surface_load(problem, mesh, section, sign)


def pore_force(problem: PlaneStrain, mesh: QuadMesh, pressure: Pressure) -> np.ndarray:
    """Return the nodal forces (dofs,) in N/m of a pore pressure, by the principle of virtual work: the force does the
    work of the pore pressure u on the volumetric strain."""
    grid = problem.grid
    corners = mesh.points[grid.corners]
    points = np.einsum("qa,cai->cqi", grid.corner_shapes, corners)
    cell_centres = np.repeat(corners.mean(axis=1), grid.points_per_cell, axis=0)
    stratum = np.repeat(grid.stratum, grid.points_per_cell)
    pressures = pressure(points.reshape(-1, 2), cell_centres, stratum).reshape(grid.weights.shape)
    local = np.zeros(len(grid.global_dofs))
    np.add.at(local, grid.dofs, np.einsum("cq,cq,cqd->cd", grid.weights, pressures, grid.divergence))
    return problem.exchange.sum_to_owned(local)


def _free_water_forces(problem: PlaneStrain, mesh: QuadMesh, section: Section) -> np.ndarray:
    """Return the nodal forces (dofs,) in N/m of the pressure of free water on the ground."""

    def traction(ends: np.ndarray, near: np.ndarray, normal: np.ndarray) -> np.ndarray:
        return -section.water_pressure.on_ground(ends, near)[:, None] * normal

    return ground_force(problem, mesh, traction)


def pressed_sides(problem: PlaneStrain, mesh: QuadMesh, section: Section) -> np.ndarray | float:
    """Return the nodal forces of the static pore pressure on both sides, as of periodic sides.

    Parameters
    ----------
    problem, mesh, section : as in `hydrostatic_load`

    Returns
    -------
    Forces (dofs,) in N/m, -u n with the outward normal n; 0.0 without water.
    """
    water = section.water_pressure
    if not water.present:
        return 0.0

    def traction(points: np.ndarray, near: np.ndarray, normal: np.ndarray) -> np.ndarray:
        return -water.at_rest(points, near, section.stratum_at(*near.T))[:, None] * normal

    return ground_force(problem, mesh, traction, "left") + ground_force(problem, mesh, traction, "right")


def ground_force(problem: PlaneStrain, mesh: QuadMesh, traction: Traction, boundary: str = "surface") -> np.ndarray:
    """Return the nodal forces of a traction on a boundary of a mesh.

    Parameters
    ----------
    problem : the elements of the mesh
    mesh : the mesh with its boundaries
    traction : function of points (n, 2) on the boundary, points (n, 2) near them (the middles of their edges) and
        outward unit normals (n, 2), which returns the traction (n, 2) in Pa
    boundary : name of the boundary, such as "surface" or "left"

    Returns
    -------
    Forces (dofs,) in N/m.
    """
    grid, degree = problem.grid, DEGREES[problem.grid.element]
    s, weight = np.polynomial.legendre.leggauss(POINTS_ON_EDGE)
    s, weight = 0.5 * (s + 1.0), 0.5 * weight
    shapes = np.column_stack([1.0 - s, s])
    if degree == 2:
        shapes = np.column_stack([(1.0 - s) * (1.0 - 2.0 * s), s * (2.0 * s - 1.0), 4.0 * s * (1.0 - s)])
    key = np.array([len(mesh.points), 1])
    boundary_edges = np.sort(mesh.boundaries[boundary], axis=1).astype(np.int64) @ key
    local = np.zeros(len(grid.global_dofs))
    for number, (a, b) in enumerate(api.REFERENCE_EDGES):
        ends = grid.corners[:, [a, b]].astype(np.int64)
        cells = np.flatnonzero(np.isin(np.sort(ends, axis=1) @ key, boundary_edges))
        first, last = (mesh.points[ends[cells, end]] for end in (0, 1))
        middle, edge_vectors = 0.5 * (first + last), last - first
        length = np.hypot(*edge_vectors.T)
        normal = np.column_stack([edge_vectors[:, 1], -edge_vectors[:, 0]]) / length[:, None]
        inwards = mesh.points[grid.corners[cells]].mean(axis=1) - middle
        normal *= -np.sign(np.sum(normal * inwards, axis=1))[:, None]
        tractions = [traction(first + share * edge_vectors, middle, normal) for share in s]
        force = np.einsum("q,qn,qki,k->kni", weight, shapes, np.array(tractions), length)
        nodes = [a, b] if degree == 1 else [a, b, 4 + number]
        for axis in (0, 1):
            np.add.at(local, grid.dofs[cells][:, [2 * node + axis for node in nodes]], force[:, :, axis])
    return problem.exchange.sum_to_owned(local)
