"""Defines the problem of limit analysis on triangles: a rigid-plastic body under a dead load and a live load.

The load multiplier λ acts on the live load alone: the body carries dead + λ live, and λ is to be bounded. Everything in
a ``LimitProblem`` is dimensionless: lengths over ``units.length``, stresses over ``units.stress``; λ is as in SI
units. Stress is positive in tension; its components are [xx, yy, xy], y upwards.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from meshes.bisection import split_at_middle
from meshes.pore_loads import SAME_PRESSURE, EdgeJumps, Pressure, at_ends, corner_pressure, edge_jumps, outward_normals
from meshes.triangles import TriMesh


@dataclass(frozen=True, eq=False)
class Places:
    """Holds the ends of edges of the outline: k points, each of which belongs to one cell.

    Attributes
    ----------
    points (k, 2) : the points in m
    middles (k, 2) : middle of the edge to which each point belongs, in m
    stratum (k,) : the strata of the cells
    normal (k, 2) : outward unit normals of the edges
    """

    points: np.ndarray
    middles: np.ndarray
    stratum: np.ndarray
    normal: np.ndarray


# Traction over the unit of stress up to which it counts as zero.
TRACTION_ROUNDING = 1e-12
# Traction (k, 2) in Pa on a boundary, and pressure (k,) in Pa outside; linear along every edge of the mesh.
EdgeTraction = Callable[[Places], np.ndarray]
Outside = Callable[[Places], np.ndarray]
# Cohesion (m, 3) in Pa at the corners of the cells of a mesh: the linear one between them is nowhere above the true
# one, or nowhere below it where that is asked for.
CornerCohesion = Callable[[TriMesh, bool], np.ndarray]


@dataclass(frozen=True)
class Side:
    """Holds the boundary condition on one side of the body.

    Attributes
    ----------
    fixed : components of the velocity that are zero: "", "x", "y" or "xy". In the fixed components the traction is an
        unknown reaction.
    dead : traction in the other components that does not depend on the multiplier; None for zero
    live : traction in the other components that is multiplied by the load multiplier; None for zero
    pressure : pressure of the water outside, which acts in addition to the dead traction; None for zero
    periodic : whether the side is joined to the opposite side: velocities on the two are equal, effective tractions
        opposite
    """

    fixed: str = ""
    dead: EdgeTraction | None = None
    live: EdgeTraction | None = None
    pressure: Outside | None = None
    periodic: bool = False


@dataclass(frozen=True, eq=False)
class RigidPlasticBody:
    """Holds strengths and body forces of the strata, in SI units, and the boundary conditions.

    Attributes
    ----------
    cohesion (strata,) : cohesion c in Pa where it is constant
    friction (strata,) : friction angle φ in rad; the flow rule is associated, ψ = φ
    dead_force (strata, 2) : body force in N/m³ that does not depend on the multiplier
    live_force (strata, 2) : body force in N/m³ that is multiplied by the load multiplier
    sides : the boundary condition on every boundary of the mesh, by its name
    pore_pressure : pore pressure u; None for zero. Strength and the stress of the problem are those of the effective
        stress σ' = σ + u, tension positive.
    varying : cohesion at the corners of cells where it varies, in place of ``cohesion``; None if it is constant
    tension (strata,) : tension cut-off: the largest major principal stress, in Pa; inf for strata, and None for
        sections, without cut-off
    """

    cohesion: np.ndarray
    friction: np.ndarray
    dead_force: np.ndarray
    live_force: np.ndarray
    sides: Mapping[str, Side]
    pore_pressure: Pressure | None = None
    varying: CornerCohesion | None = None
    tension: np.ndarray | None = None


@dataclass(frozen=True)
class Units:
    """Holds units in which the problem is dimensionless.

    Attributes
    ----------
    length : unit of length in m
    stress : unit of stress in Pa
    origin : origin of the dimensionless coordinates, (x, y) in m
    """

    length: float
    stress: float
    origin: tuple[float, float]


@dataclass(frozen=True, eq=False)
class Outline:
    """Holds the k edges of the boundary, with their boundary conditions, dimensionless.

    Attributes
    ----------
    edges (k,) : numbers of the boundary edges in the mesh
    ends (k, 2) : numbers of the end points of each edge
    cells (k,) : number of the cell inside each edge
    fixed (k, 2) : which components of the velocity are zero, so that their traction is unknown
    periodic (k,) : edges without prescribed traction, since they are joined to edges of the opposite side
    dead (k, 2 ends, 2) : traction at both ends that does not depend on the multiplier
    live (k, 2 ends, 2) : traction at both ends that is multiplied by the load multiplier
    """

    edges: np.ndarray
    ends: np.ndarray
    cells: np.ndarray
    fixed: np.ndarray
    periodic: np.ndarray
    dead: np.ndarray
    live: np.ndarray

    @property
    def reacts(self) -> np.ndarray:
        """Find the components (k, 2) of the traction, as a mask, that are not prescribed."""
        return self.fixed | self.periodic[:, None]

    @property
    def loaded(self) -> np.ndarray:
        """Find the ends of edges (k, 2), as a mask, with a prescribed traction other than zero or an unknown one."""
        return (self.reacts[:, None, :] | (self.dead != 0.0) | (self.live != 0.0)).any(axis=2)


@dataclass(frozen=True, eq=False)
class LimitProblem:
    """Holds a rigid-plastic body on a mesh of m triangles, dimensionless.

    Attributes
    ----------
    mesh : the triangles, lengths over ``units.length``
    units : units of length and stress
    cohesion (m, 3) : cohesion at the corners of every cell over the unit of stress; linear in between, nowhere above
        the true one
    cohesion_above (m, 3) : cohesion at the corners of every cell over the unit of stress, nowhere below the true
        cohesion; for upper bounds
    friction (m,) : friction angle of every cell in rad
    tension (m,) : largest major principal stress of every cell over the unit of stress, inf without a tension cut-off
    dead_force (m, 2) : body force on the skeleton that does not depend on the multiplier, over unit of stress / unit of
        length
    live_force (m, 2) : body force that is multiplied by the load multiplier, over unit of stress / unit of length
    outline : the edges of the boundary
    jumps : the edges between different pore pressures
    """

    mesh: TriMesh
    units: Units
    cohesion: np.ndarray
    cohesion_above: np.ndarray
    friction: np.ndarray
    tension: np.ndarray
    dead_force: np.ndarray
    live_force: np.ndarray
    outline: Outline
    jumps: EdgeJumps

    @property
    def spread_cohesion(self) -> np.ndarray:
        """Return corner cohesions c_i (m, 3) with which the sum over the corner dissipations D_i is an upper limit of
        the dissipation of a cell: ∫ c D dA <= Σ c_i D_i A/3.

        D is convex where the strain rate is linear, D <= Σ D_i L_i, and c = Σ c_j L_j with the area coordinates L, so
        that ∫ c D dA <= Σ_ij c_j D_i ∫ L_i L_j dA, which is A/6 for i = j and A/12 otherwise. With a tension cut-off D
        is not proportional to c, and all corners get the largest c of the cell.
        """
        cohesion = self.cohesion_above
        spread = 0.25 * (cohesion + cohesion.sum(axis=1, keepdims=True))
        return np.where(np.isfinite(self.tension)[:, None], cohesion.max(axis=1, keepdims=True), spread)

    @property
    def points(self) -> np.ndarray:
        """Return the points (n, 2) in m."""
        return self.mesh.points * self.units.length + np.array(self.units.origin)

    @property
    def mesh_in_metres(self) -> TriMesh:
        """Return the mesh with its points in m."""
        mesh = self.mesh
        return TriMesh(self.points, mesh.cells, mesh.stratum, mesh.boundaries, mesh.repeats)


def units_of(mesh: TriMesh, body: RigidPlasticBody) -> Units:
    """Return the units of length and stress. The unit of length is the height of the mesh. The unit of stress is the
    largest dead stress (γH or traction), or the cohesion if there is no dead stress."""
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    length = float(high[1] - low[1])
    weight = float(np.hypot(*_on_skeleton(mesh, body).T).max()) * length
    pressed = float(np.abs(_outline(mesh, body).dead).max())
    stress = max(weight, pressed) or float(corner_cohesion(mesh, body).max())
    return Units(length, stress, (float(low[0]), float(low[1])))


def corner_cohesion(mesh: TriMesh, body: RigidPlasticBody, above: bool = True) -> np.ndarray:
    """Return the cohesion (m, 3) in Pa at the corners of every cell. The linear interpolation of the returned cohesion
    is nowhere below the true cohesion if ``above``, else nowhere above it.
    """
    if body.varying is not None:
        return body.varying(mesh, above)
    return np.repeat(body.cohesion[mesh.stratum][:, None], 3, axis=1)


def limit_problem(mesh: TriMesh, body: RigidPlasticBody, units: Units) -> LimitProblem:
    """Return the dimensionless problem on a mesh whose strata are those of the body.

    Cells in a corner of the outline (``corner_cells``) are divided first. Raises ValueError if an
    edge of the outline belongs to no boundary.
    """
    outline = _outline(mesh, body)
    divided = split_at_middle(mesh, corner_cells(mesh))
    if divided is not mesh:
        mesh, outline = divided, _outline(divided, body)
    scaled = mesh.moved(np.array(units.origin), units.length)
    per_volume = units.length / units.stress
    jumps = edge_jumps(mesh, corner_pressure(mesh, body.pore_pressure))
    return LimitProblem(
        mesh=scaled,
        units=units,
        cohesion=corner_cohesion(mesh, body, above=False) / units.stress,
        cohesion_above=corner_cohesion(mesh, body) / units.stress,
        friction=body.friction[mesh.stratum],
        tension=_tension(mesh, body) / units.stress,
        dead_force=_on_skeleton(mesh, body) * per_volume,
        live_force=body.live_force[mesh.stratum] * per_volume,
        outline=replace(
            outline,
            dead=_beyond_rounding(outline.dead / units.stress),
            live=_beyond_rounding(outline.live / units.stress),
        ),
        jumps=jumps._replace(traction=_beyond_rounding(jumps.traction / units.stress)),
    )


def _beyond_rounding(traction: np.ndarray) -> np.ndarray:
    """Return dimensionless tractions, exactly zero where they are rounding errors, such as the pressure of water that
    ends at this point: whether a traction is zero decides which corners have no stress.
    """
    return np.where(np.abs(traction) <= TRACTION_ROUNDING, 0.0, traction)


def _tension(mesh: TriMesh, body: RigidPlasticBody) -> np.ndarray:
    """Return the tension cut-off (m,) of every cell in Pa; inf if the cut-off lies beyond the apex of the cone and
    never acts."""
    if body.tension is None:
        return np.full(len(mesh.cells), np.inf)
    tension, friction = body.tension[mesh.stratum], body.friction[mesh.stratum]
    finite = np.where(np.isfinite(tension), tension, 0.0)
    acts = np.isfinite(tension) & (finite * np.tan(friction) < corner_cohesion(mesh, body).max(axis=1))
    return np.where(acts, tension, np.inf)


def with_all_loads_live(problem: LimitProblem, multiplier: float) -> LimitProblem:
    """Return the problem whose multiplier acts on all loads; where it is above 1 the ground resists ``multiplier``
    times the live load.

    Forces by jumps of the pore pressure are among these loads. Without load there is an admissible stress, so that by
    convexity the ground resists every share of the loads up to the largest one.
    """
    outline, jumps = problem.outline, problem.jumps
    return replace(
        problem,
        dead_force=np.zeros_like(problem.dead_force),
        live_force=problem.dead_force + multiplier * problem.live_force,
        outline=replace(outline, dead=np.zeros_like(outline.dead), live=outline.dead + multiplier * outline.live),
        jumps=jumps._replace(traction=np.zeros_like(jumps.traction), live=jumps.traction + multiplier * jumps.live),
    )


def bare_corners(problem: LimitProblem) -> np.ndarray:
    """Find the corners (m, 3), as a mask, on an edge of the outline that has no traction at all."""
    outline = problem.outline
    loaded = outline.loaded
    bare = np.zeros(problem.mesh.cells.shape, dtype=bool)
    for end in (0, 1):
        cells = outline.cells[~loaded[:, end]]
        bare[cells, np.argmax(problem.mesh.cells[cells] == outline.ends[~loaded[:, end], end, None], axis=1)] = True
    return bare


def _on_skeleton(mesh: TriMesh, body: RigidPlasticBody) -> np.ndarray:
    """Return the body force (m, 2) in N/m³ on the skeleton: the dead force less the gradient of the pore pressure."""
    force = body.dead_force[mesh.stratum]
    if body.pore_pressure is None:
        return force
    return force - np.einsum("mk,mki->mi", corner_pressure(mesh, body.pore_pressure), mesh.gradients)


def corner_cells(mesh: TriMesh) -> np.ndarray:
    """Find the cells (m,), as a mask, with two edges on the outline, whose stress or velocity follows from the boundary
    conditions.
    """
    return (mesh.edge_cells[:, 1] < 0)[mesh.cell_edges].sum(axis=1) >= 2


def _outline(mesh: TriMesh, body: RigidPlasticBody) -> Outline:
    parts = []
    pressure = corner_pressure(mesh, body.pore_pressure)
    for name, side in body.sides.items():
        ends = mesh.boundaries[name]
        edges = mesh.edge_numbers(ends)
        cells = mesh.edge_cells[edges, 0]
        fixed = np.tile([axis in side.fixed for axis in "xy"], (len(ends), 1))
        periodic = np.full(len(ends), side.periodic)
        places = edge_ends(mesh, ends, cells)
        dead, live = (_traction(traction, places) for traction in (side.dead, side.live))
        if body.pore_pressure is not None and not side.periodic:
            inside = at_ends(mesh, pressure, cells, ends)
            outside = np.zeros(inside.shape) if side.pressure is None else side.pressure(places).reshape(-1, 2)
            left = np.where(np.abs(inside - outside) > SAME_PRESSURE * pressure.max(initial=0.0), inside - outside, 0.0)
            dead = dead + left[:, :, None] * places.normal.reshape(-1, 2, 2)
        parts.append((edges, ends, cells, fixed, periodic, dead, live))
    outline = Outline(*(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))
    outer = np.flatnonzero(mesh.edge_cells[:, 1] < 0)
    if not np.array_equal(np.sort(outline.edges), outer):
        raise ValueError("the boundaries of the mesh do not cover its outline exactly once")
    return outline


def edge_ends(mesh: TriMesh, ends: np.ndarray, cells: np.ndarray) -> Places:
    """Return both ends of edges (k, 2) of the outline, one edge after the other."""
    points = mesh.points[ends]
    return Places(
        points.reshape(-1, 2),
        np.repeat(points.mean(axis=1), 2, axis=0),
        np.repeat(mesh.stratum[cells], 2),
        np.repeat(outward_normals(mesh, cells, ends), 2, axis=0),
    )


def _traction(traction: EdgeTraction | None, places: Places) -> np.ndarray:
    """Return a traction at both ends of edges, (k, 2, 2)."""
    return np.zeros((len(places.points) // 2, 2, 2)) if traction is None else traction(places).reshape(-1, 2, 2)
