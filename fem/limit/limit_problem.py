"""A problem of limit analysis on triangles: a strength, a load that stays and one that a multiplier acts on.

Everything is dimensionless: lengths over ``units.length``, stresses over ``units.stress``; the multiplier is the same
in both worlds. Stress is positive in tension; components [xx, yy, xy], y upwards.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from meshes.bisection import split_at_middle
from meshes.triangles import TriMesh

# Traction (k, 2) in Pa at points (k, 2) in m of a boundary, next to strata (k,); linear along every edge of the mesh.
Traction = Callable[[np.ndarray, np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Side:
    """What holds on a boundary: components of the velocity that are ``held`` ("", "x", "y" or "xy"), where nothing is
    demanded of the traction, and in the others the traction that stays and the one the multiplier acts on."""

    held: str = ""
    fixed: Traction | None = None
    live: Traction | None = None


@dataclass(frozen=True, eq=False)
class Ground:
    """Strata in SI units: ``cohesion`` (Pa) and ``friction`` (rad), each (strata,); the body force that stays and the
    one the multiplier acts on, each (strata, 2) in N/m³; and what holds on every boundary by its name."""

    cohesion: np.ndarray
    friction: np.ndarray
    fixed_force: np.ndarray
    live_force: np.ndarray
    sides: Mapping[str, Side]


@dataclass(frozen=True)
class Units:
    """What the dimensionless problem is measured in: a length (m) and a stress (Pa), from an origin (m)."""

    length: float
    stress: float
    origin: tuple[float, float]


@dataclass(frozen=True, eq=False)
class Outline:
    """The edges of the boundary: number and ends (k, 2), the cell inside, which components are held (k, 2), and the
    tractions at both ends (k, 2 ends, 2), the one that stays and the live one."""

    edges: np.ndarray
    ends: np.ndarray
    cells: np.ndarray
    held: np.ndarray
    fixed: np.ndarray
    live: np.ndarray


@dataclass(frozen=True, eq=False)
class LimitProblem:
    """A dimensionless problem; m cells. ``cohesion`` and ``friction`` (m,), forces (m, 2)."""

    mesh: TriMesh
    units: Units
    cohesion: np.ndarray
    friction: np.ndarray
    fixed_force: np.ndarray
    live_force: np.ndarray
    outline: Outline

    @property
    def points(self) -> np.ndarray:
        """The points (n, 2) in m."""
        return self.mesh.points * self.units.length + np.array(self.units.origin)

    @property
    def mesh_in_metres(self) -> TriMesh:
        """The mesh with its points in m."""
        return TriMesh(self.points, self.mesh.cells, self.mesh.stratum, self.mesh.boundaries)


def units_of(mesh: TriMesh, ground: Ground) -> Units:
    """Height of the mesh, and the largest stress that loads or, without any, the weakest strength can make in it."""
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    length = float(high[1] - low[1])
    weight = float(np.hypot(*ground.fixed_force.T).max()) * length
    pressed = float(np.abs(_outline(mesh, ground).fixed).max())
    stress = max(weight, pressed) or float(ground.cohesion.max())
    return Units(length, stress, (float(low[0]), float(low[1])))


def limit_problem(mesh: TriMesh, ground: Ground, units: Units) -> LimitProblem:
    """The dimensionless problem on a mesh whose strata are those of the ground.

    Cells in which nothing could move are divided first. Raises ValueError if an edge of the outline
    belongs to no boundary.
    """
    outline = _outline(mesh, ground)
    divided = split_at_middle(mesh, stuck_cells(mesh, ground.friction[mesh.stratum], outline))
    if divided is not mesh:
        mesh, outline = divided, _outline(divided, ground)
    scaled = mesh.moved(np.array(units.origin), units.length)
    per_volume = units.length / units.stress
    return LimitProblem(
        mesh=scaled,
        units=units,
        cohesion=ground.cohesion[mesh.stratum] / units.stress,
        friction=ground.friction[mesh.stratum],
        fixed_force=ground.fixed_force[mesh.stratum] * per_volume,
        live_force=ground.live_force[mesh.stratum] * per_volume,
        outline=replace(outline, fixed=outline.fixed / units.stress, live=outline.live / units.stress),
    )


def stuck_cells(mesh: TriMesh, friction: np.ndarray, outline: Outline) -> np.ndarray:
    """Cells (m,) in a corner of which nothing could move as the flow rule asks, or the stress would have no choice.

    They have two edges on the outline; or a held one, at whose end ground with φ > 0 meets ground with φ = 0: that one
    can only shear along the held edge, the other one cannot do so without dilating.
    """
    held = np.zeros(len(mesh.edges), dtype=bool)
    held[outline.edges] = outline.held.all(axis=1)
    on_outline = (mesh.edge_cells[:, 1] < 0)[mesh.cell_edges].sum(axis=1)
    clay = np.append(friction == 0.0, False)[mesh.edge_cells]
    changes = clay[:, 0] != clay[:, 1]
    changes[mesh.edge_cells[:, 1] < 0] = False
    of_cell = held[mesh.cell_edges]
    dilates = (friction > 0.0) & of_cell.any(axis=1) & changes[mesh.cell_edges].any(axis=1)
    return dilates | (on_outline >= 2)


def _outline(mesh: TriMesh, ground: Ground) -> Outline:
    parts = []
    for name, side in ground.sides.items():
        ends = mesh.boundaries[name]
        edges = mesh.edge_numbers(ends)
        cells = mesh.edge_cells[edges, 0]
        held = np.tile([axis in side.held for axis in "xy"], (len(ends), 1))
        fixed, live = (_at_ends(traction, mesh, ends, cells) for traction in (side.fixed, side.live))
        parts.append((edges, ends, cells, held, fixed, live))
    outline = Outline(*(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))
    outer = np.flatnonzero(mesh.edge_cells[:, 1] < 0)
    if not np.array_equal(np.sort(outline.edges), outer):
        raise ValueError("the boundaries of the mesh do not cover its outline once")
    return outline


def _at_ends(traction: Traction | None, mesh: TriMesh, ends: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """A traction at both ends of edges, (k, 2, 2)."""
    values = np.zeros((len(ends), 2, 2))
    if traction is not None:
        for end in (0, 1):
            values[:, end] = traction(mesh.points[ends[:, end]], mesh.stratum[cells])
    return values
