"""Finds points whose conditions force zero stress, or zero strain rate.

Several cells meet at a point, and each has its own stress and strain rate there. Conditions at the point link them to
each other and to the boundary; some of these conditions leave only zero stress or zero strain rate. Rounding would turn
the zero into a small violation of the yield surface or the flow rule, and an interior-point solver would find no
interior. Points with zero stress or zero strain rate are therefore found beforehand, and zero is prescribed at them.
"""

from collections.abc import Iterator

import clarabel
import numpy as np
from scipy import sparse

from fem.limit.limit_problem import LimitProblem
from meshes.quality import corner_angles

# Singular value of the equations of one point, scaled to unit length, below which the equations are dependent.
DEPENDENT_SINGULAR_VALUE = 1e-12
# Largest eigenvalue of the yield function on the free stresses of a point, over the largest eigenvalue on all stresses,
# up to which no free stress is inside the cone.
OUTSIDE_EIGENVALUE = 1e-9
# Rows that map a stress [xx, yy, xy] to σxx - σyy and σxy, which are zero where the pressure is equal in all
# directions.
SHEAR_ROWS = np.array([[1.0, -1.0, 0.0], [0.0, 0.0, 1.0]])
# Cohesion over the unit of stress up to which it counts as zero.
COHESION_ROUNDING = 1e-12
# Angle (rad) between two bare faces above which the point between them is a crest.
CREST_ANGLE = 1e-6
# Largest excess of the volumetric strain rate over sin φ times the shear rate, for velocity gradients of 1, below which
# a point counts as unable to strain. With 0.02, a point of 0.018 on the side of S-13 was fixed, the corners around it
# had no margin, and no mechanism was found.
UNSTRAINED_RATE = 0.01


def cells_at_points(problem: LimitProblem, points: np.ndarray) -> Iterator[tuple[int, np.ndarray, np.ndarray]]:
    """For every point, yield the cells that meet there, and the number of the point among the corners of each cell."""
    cells = problem.mesh.cells
    wanted = np.zeros(len(problem.mesh.points), dtype=bool)
    wanted[points] = True
    at = np.flatnonzero(wanted[cells.ravel()])
    at = at[np.argsort(cells.ravel()[at], kind="stable")]
    for group in np.split(at, np.flatnonzero(np.diff(cells.ravel()[at])) + 1):
        if len(group):
            yield int(cells.ravel()[group[0]]), group // 3, group % 3


def stress_free_corners(problem: LimitProblem) -> np.ndarray:
    """Find the corners (m, 3), as a mask, at which the stress must be zero: corners near a bare surface, in cells
    without cohesion or at crests without tension.

    Tractions are continuous across the edges that meet at a point, and zero on a bare edge. Where both conditions leave
    a cell no stress inside its cone |radius of Mohr's circle| <= sin φ |mean stress|, its stress is zero. Where the
    cone has no interior, as for clay whose strength is zero there, the stress is zero wherever an isotropic pressure is
    excluded.
    """
    outline, mesh = problem.outline, problem.mesh
    round_corners = pressed_all_round(problem)
    loose = (problem.cohesion == 0.0).all(axis=1) | round_corners.any(axis=1)
    known = ~outline.reacts[:, None, :] & (outline.dead == 0.0) & (outline.live == 0.0)  # (k, 2 ends, 2)
    touches = np.zeros(len(mesh.points), dtype=bool)
    touches[outline.ends[known.any(axis=2)]] = True
    at_loose = np.zeros(len(mesh.points), dtype=bool)
    at_loose[mesh.cells[loose]] = True
    place = np.full(len(mesh.edges), -1)
    place[outline.edges] = np.arange(len(outline.edges))
    jumps = np.zeros((len(mesh.edges), 2), dtype=bool)  # ends of edges across which tractions jump by a known amount
    jumps[problem.jumps.edges] = ((problem.jumps.traction != 0.0) | (problem.jumps.live != 0.0)).any(axis=2)
    free = np.zeros(mesh.cells.shape, dtype=bool)
    for point, cells, corners in cells_at_points(problem, np.flatnonzero(touches & at_loose)):
        round_there = round_corners[cells, corners]
        equations = _traction_equations(problem, point, cells, (place, jumps, known))
        equations = np.vstack([equations, np.kron(np.eye(len(cells))[round_there], SHEAR_ROWS)])
        may_be_zero = round_there | (problem.cohesion[cells] == 0.0).all(axis=1)
        zero = np.zeros(len(cells), dtype=bool)
        while True:
            fixed = np.kron(np.eye(len(cells))[zero], np.eye(3))
            left = _null_space(np.vstack([equations, fixed])).reshape(len(cells), 3, -1)
            outside = [_outside_cone(part, phi) for part, phi in zip(left, problem.friction[cells], strict=True)]
            pressed = [float(np.abs(part).max(initial=0.0)) > OUTSIDE_EIGENVALUE for part in left]
            more = may_be_zero & ~zero & np.where(round_there, ~np.array(pressed), outside)
            if not more.any():
                break
            zero |= more
        free[cells[zero], corners[zero]] = True
    return free | _crests(problem)


def pressed_all_round(problem: LimitProblem) -> np.ndarray:
    """Return corners (m, 3), as a mask, of ground without cohesion and friction there, such as clay whose strength is
    proportional to σ'v where σ'v is zero: only an isotropic pressure is admissible.
    """
    return (problem.cohesion <= COHESION_ROUNDING) & (problem.friction[:, None] == 0.0)


def _crests(problem: LimitProblem) -> np.ndarray:
    """Find the corners (m, 3), as a mask, of cells without tensile strength at points where bare surfaces meet at less
    than 180°.

    A compression at such a convex point would push the point out, since neither face carries traction.
    """
    outline, mesh = problem.outline, problem.mesh
    bare = np.bincount(outline.ends[~outline.loaded], minlength=len(mesh.points)) == 2
    angles = np.radians(corner_angles(mesh.points, mesh.cells))
    inside = np.bincount(mesh.cells.ravel(), weights=angles.ravel(), minlength=len(mesh.points))
    crest = bare & (inside < np.pi - CREST_ANGLE)
    return crest[mesh.cells] & (problem.tension == 0.0)[:, None]


def _traction_equations(
    problem: LimitProblem, point: int, cells: np.ndarray, conditions: tuple[np.ndarray, np.ndarray, np.ndarray]
) -> np.ndarray:
    """Return the equations of the tractions at a point for the stresses of its cells: continuity across inner edges
    unless tractions jump at this end of the edge, and zero traction where it is prescribed.

    ``conditions``: the number of every edge on the outline, or -1; whether tractions jump at either end of every edge;
    the components of the tractions at the ends of the outline that are zero.
    """
    mesh, outline = problem.mesh, problem.outline
    place, jumps, known = conditions
    rows = []
    for edge in np.unique(mesh.cell_edges[cells]):
        ends = mesh.edges[edge]
        if point not in ends or jumps[edge, int(ends[1] == point)]:
            continue
        along = mesh.points[ends[1]] - mesh.points[ends[0]]
        x, y = np.array([along[1], -along[0]]) / np.hypot(*along)
        traction = np.array([[x, 0.0, y], [0.0, y, x]])
        row = np.zeros((2, len(cells), 3))
        for cell, sign in zip(mesh.edge_cells[edge], (1.0, -1.0), strict=True):
            if cell >= 0:
                row[:, np.flatnonzero(cells == cell)[0]] = sign * traction
        k = place[edge]
        if k >= 0:
            row = row[known[k, int(outline.ends[k, 1] == point)]]
        rows.append(row.reshape(-1, 3 * len(cells)))
    return np.vstack(rows)


def _null_space(matrix: np.ndarray) -> np.ndarray:
    _, values, vectors = np.linalg.svd(matrix)
    return vectors[np.count_nonzero(values > DEPENDENT_SINGULAR_VALUE) :].T


def _outside_cone(stresses: np.ndarray, friction: float) -> bool:
    """Return whether no combination of stresses (3, d) lies inside the cone of ground without cohesion."""
    mean, half = 0.5 * (stresses[0] + stresses[1]), 0.5 * (stresses[0] - stresses[1])
    inside = np.sin(friction) ** 2 * np.outer(mean, mean) - np.outer(half, half) - np.outer(stresses[2], stresses[2])
    return stresses.shape[1] == 0 or float(np.linalg.eigvalsh(inside)[-1]) <= OUTSIDE_EIGENVALUE


def unstrained_points(problem: LimitProblem) -> np.ndarray:
    """Find the points (n,), as a mask, on fixed boundaries at which the flow rule lets no cell strain.

    No cell can strain at corners between two held edges, where φ is larger than half of the angle between them, nor at
    points of a straight held edge where ground that cannot dilate begins. At a corner between two edges the velocity
    gradient of a cell follows from the derivatives of the velocity along its edges, which are zero on held edges.
    """
    mesh, outline = problem.mesh, problem.outline
    fixed = np.zeros((len(mesh.edges), 2), dtype=bool)
    fixed[outline.edges] = outline.fixed
    on_fixed = np.zeros(len(mesh.points), dtype=bool)
    on_fixed[outline.ends[outline.fixed.any(axis=1)]] = True
    unstrained = np.zeros(len(mesh.points), dtype=bool)
    for point, cells, corners in cells_at_points(problem, np.flatnonzero(on_fixed)):
        friction = problem.friction[cells]
        if not friction.any():
            continue
        corner_edges = np.column_stack([corners, (corners + 2) % 3])
        edges = np.take_along_axis(mesh.cell_edges[cells], corner_edges, axis=1)
        bounds = edges[fixed[edges].any(axis=2)]
        if not (friction.all() and _parallel(problem, bounds)):
            unstrained[point] = _largest_slack(problem, point, cells, edges, fixed) < UNSTRAINED_RATE
    return unstrained


def _parallel(problem: LimitProblem, edges: np.ndarray) -> bool:
    """Return whether all of the edges lie on one straight line."""
    ends = problem.mesh.points[problem.mesh.edges[edges]]
    along = ends[:, 1] - ends[:, 0]
    along /= np.hypot(*along.T)[:, None]
    return bool(np.abs(along[0, 0] * along[:, 1] - along[0, 1] * along[:, 0]).max() <= 1e-9)


def _largest_slack(problem: LimitProblem, point: int, cells: np.ndarray, edges: np.ndarray, fixed: np.ndarray) -> float:
    """Return the largest s such that volumetric rate - sin φ shear rate >= s in all cells at a point (0 = volume where
    φ = 0). The unknowns are velocity derivatives of at most 1 along the ``edges`` (k, 2) of these cells that meet at
    the point."""
    mesh, friction = problem.mesh, problem.friction[cells]
    different, place = np.unique(edges, return_inverse=True)
    place = place.reshape(edges.shape)
    ends = mesh.edges[edges]
    along = mesh.points[ends.sum(axis=2) - point] - mesh.points[point]
    inverse = np.linalg.inv(np.swapaxes(along / np.linalg.norm(along, axis=2)[..., None], 1, 2))
    rates = np.zeros((len(cells), 3, len(different), 2))  # [xx, yy, xy] of every cell
    for j in range(len(cells)):
        for side in (0, 1):
            dx, dy = inverse[j, side]
            rates[j, :, place[j, side]] += [[dx, 0.0], [0.0, dy], [dy, dx]]
    return _most_dilation(rates[..., ~fixed[different]], np.sin(friction))


def _most_dilation(rates: np.ndarray, sin: np.ndarray) -> float:
    """Return the largest s such that volumetric rate - sin φ shear rate >= s in all k cells; unknowns are at most 1.

    ``rates`` (k, [xx, yy, xy], n): strain rates by the n unknowns; ``sin`` (k,): sin φ of the cells, whose volume is
    constant where it is 0.
    """
    clay, sand = rates[sin == 0.0], rates[sin > 0.0]
    sin, size = sin[sin > 0.0, None], rates.shape[-1]
    cone = np.stack([sand[:, 0] + sand[:, 1], sin * (sand[:, 0] - sand[:, 1]), sin * sand[:, 2]], axis=1)
    slack = np.tile([[1.0], [0.0], [0.0]], (len(sand), 1))
    equal = np.column_stack([clay[:, 0] + clay[:, 1], np.zeros(len(clay))])
    box = np.vstack([np.eye(size + 1), -np.eye(size + 1)])
    matrix = sparse.csc_matrix(np.vstack([equal, box, np.column_stack([-cone.reshape(-1, size), slack])]))
    offset = np.concatenate([np.zeros(len(clay)), np.ones(len(box)), np.zeros(3 * len(sand))])
    cones = [clarabel.ZeroConeT(len(clay)), clarabel.NonnegativeConeT(len(box))]
    cones += [clarabel.SecondOrderConeT(3)] * len(sand)
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    nothing = sparse.csc_matrix((size + 1, size + 1))
    cost = np.append(np.zeros(size), -1.0)
    return float(clarabel.DefaultSolver(nothing, cost, matrix, offset, cones, settings).solve().x[-1])
