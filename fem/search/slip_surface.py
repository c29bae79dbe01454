"""Finds the slip surface of a state: the line in the middle of the sheared ground, if the ground moves in a mechanism.

Two mechanisms that need almost the same Kh may lie far apart. Two slip surfaces are therefore compared not only by
their distance, but also by the critical Kh of ground that can fail only above one of them.
"""

import numpy as np
from scipy.spatial import Delaunay

from fem.continuum.fields import FieldState, is_mechanism
from fem.limit_load.conic_limit_load import conic_limit_load
from fem.limit_load.limit_load import critical_limit_load
from fem.settings import FemSettings
from meshes.quad_mesh import QuadMesh
from meshes.section.section import Section
from meshes.slip_line import slip_line

# Ground at the surface moves if its speed is at least this share of the largest speed there.
MOVING_SHARE = 0.1
# Points in each column: a shear band is seldom thinner than a fiftieth of the height of the ground.
POINTS_IN_COLUMN = 100
# A slip surface of fewer columns is found once more in columns that reach this many columns past its ends.
FEW_COLUMNS, CLOSE_REACH = 5, 3.0


def slip_surface(mesh: QuadMesh, state: FieldState, columns: int = 100) -> np.ndarray:
    """Return the slip surface of a state, between moving ground and ground at rest (`slip_line`).

    Parameters
    ----------
    mesh : the mesh of the state
    state : a state, whose displacements (or velocities) are compared
    columns : number of columns in which the line is looked for

    Returns
    -------
    Points (k, 2) in m from left to right; none without a mechanism.
    """
    if not is_mechanism(state):
        return np.zeros((0, 2))
    ends = float(mesh.points[:, 0].min()), float(mesh.points[:, 0].max())
    line = _slip_line(mesh, state, ends, columns)
    if 0 < len(line) < FEW_COLUMNS:  # a small failure, looked at closely
        reach = CLOSE_REACH * (ends[1] - ends[0]) / columns
        near = max(line[0, 0] - reach, ends[0]), min(line[-1, 0] + reach, ends[1])
        closer = _slip_line(mesh, state, near, columns)
        return closer if len(closer) > len(line) else line
    return line


def _slip_line(mesh: QuadMesh, state: FieldState, ends: tuple[float, float], columns: int) -> np.ndarray:
    """Return the slip line (k, 2) in m in columns between two ends (m)."""
    edges = np.linspace(*ends, columns + 1)
    x = 0.5 * (edges[1:] + edges[:-1])
    base, ground = (_line(mesh, name, x)[:, None] for name in ("base", "surface"))
    z = base + (ground - base) * (np.arange(POINTS_IN_COLUMN) + 0.5) / POINTS_IN_COLUMN
    at = np.column_stack([np.repeat(x, POINTS_IN_COLUMN), z.ravel()])
    return slip_line(x, z, _interpolated(mesh.points, np.hypot(*state.displacement.T), at).reshape(z.shape))


def _interpolated(points: np.ndarray, values: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return ``values`` (n,) at ``points`` (n, 2) in m, interpolated linearly in the Delaunay triangles of the points,
    at other points (k, 2) in m; NaN outside of all triangles.

    The interpolator of SciPy does the same; its package takes 0.2 s to load.
    """
    triangles = Delaunay(points)
    place = triangles.find_simplex(at)
    transform = triangles.transform[place]
    share = np.einsum("kij,kj->ki", transform[:, :2], at - transform[:, 2])
    shares = np.column_stack([share, 1.0 - share.sum(axis=1)])
    return np.where(place >= 0, (shares * values[triangles.simplices[place]]).sum(axis=1), np.nan)


def moving_ground(mesh: QuadMesh, state: FieldState) -> tuple[float, float]:
    """Return both ends of the ground surface that moves in a mechanism.

    Below a crest that settles while the ground spreads to both sides there is no slip surface, and this extent serves
    in its place.

    Parameters
    ----------
    mesh : the mesh of the state
    state : the mechanism; ground moves if its speed is at least a tenth of the largest speed at the surface

    Returns
    -------
    x of the left and of the right end (m).
    """
    nodes = np.unique(mesh.boundaries["surface"])
    nodes = nodes[np.argsort(mesh.points[nodes, 0], kind="stable")]
    speed = np.hypot(*state.displacement[nodes].T)
    x = mesh.points[nodes[speed >= MOVING_SHARE * speed.max()], 0]
    return float(x[0]), float(x[-1])


def _line(mesh: QuadMesh, boundary: str, x: np.ndarray) -> np.ndarray:
    nodes = mesh.points[np.unique(mesh.boundaries[boundary])]
    return np.interp(x, *nodes[np.argsort(nodes[:, 0], kind="stable")].T)


def critical_above(section: Section, mesh: QuadMesh, settings: FemSettings, line: np.ndarray) -> tuple[float, float]:
    """Return the critical Kh of a mesh, and that of the same ground if it can fail only above a line.

    Parameters
    ----------
    section : the ground
    mesh : a mesh of the section
    settings : settings of the finite elements
    line (k, 2) : points [x, elevation] in m from left to right; nodes on and below it are fixed. Beyond its ends the
        line continues at the depth of these ends below the ground.

    Returns
    -------
    The critical Kh without and with the restriction (-); the latter is infinite if no mechanism is possible.

    Raises
    ------
    InputError, UnstableError, NoAnswerError
        As in ``critical_limit_load``.
    """
    ground = critical_limit_load(section, mesh, settings).ground
    assert ground.limit is not None
    problem, below = ground.problem, _ground_below(section, line, ground.problem.grid.node_points)
    problem.fix_components(~problem.free | np.repeat(below, 2))
    above = conic_limit_load(problem, mesh, ground.constant, ground.load)
    return ground.limit.multiplier, above.multiplier


def _ground_below(section: Section, line: np.ndarray, points: np.ndarray) -> np.ndarray:
    x, z = points.T
    ground_at_line, ground = (np.interp(at, *section.ground.T) for at in (line[:, 0], x))
    return ground - z >= np.interp(x, line[:, 0], ground_at_line - line[:, 1]) * (1.0 - 1e-9)
