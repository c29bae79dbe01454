"""Lower bound: a stress field that is linear in every triangle, in equilibrium and nowhere beyond the yield surface.

Every triangle has three corner stresses of its own (Sloan 1988); the stress may jump from triangle to triangle, the
traction across an edge may not. Mohr-Coulomb holds at the corners as a cone (Makrodimopoulos & Martin 2006; Lyamin &
Sloan 2002 for its smooth forms) and therefore, being convex, everywhere in between.
"""

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.linalg import qr

from fem.limit import cone_program
from fem.limit.limit_problem import LimitProblem

# Distance kept from the yield surface, so that rounding does not lead beyond it, over the unit of stress, in a cell of
# unit size; in others it goes with their size.
STRESS_MARGIN = 3e-5

# Smallest eigenvalue of the Gram matrix of one point's equations, over the largest, at which they are independent.
DEPENDENT = 1e-12

# Matrix A, right-hand sides b0 (dead) and b1 (live), and the point of every equation.
Equations = tuple[sparse.csr_matrix, np.ndarray, np.ndarray, np.ndarray]


@dataclass(frozen=True, eq=False)
class LowerBound:
    """The stress field with the largest load multiplier, dimensionless.

    Attributes
    ----------
    multiplier : float
        The load multiplier that it carries.
    stress : ndarray (m, 3 corners, [xx, yy, xy])
        The stress at the corners of every cell.
    yield_work : ndarray (m, 3)
        Work of the stress at every corner on the dual strain rates, the multipliers of the equilibrium equations. It is
        large where the yield surface keeps the load multiplier down.
    solution : cone_program.Solution
        What the solver left.
    """

    multiplier: float
    stress: np.ndarray
    yield_work: np.ndarray
    solution: cone_program.Solution


def lower_bound(problem: LimitProblem, margin: float = STRESS_MARGIN) -> LowerBound:
    """The stress field with the largest load multiplier, its equations met to rounding after the solver.

    Whether its multiplier is a strict bound is for ``fem.limit.bound_checks`` to say.
    """
    balance, dead, live, points = equations(problem)
    free = np.repeat(~stress_free_corners(problem).ravel(), 3)
    cohesion, friction = np.repeat(problem.cohesion, 3)[free[::3]], np.repeat(problem.friction, 3)[free[::3]]
    kept = margin * np.repeat(np.sqrt(problem.mesh.areas), 3)[free[::3]]
    strain = balance.T.tocsr()[free]
    matters = independent_equations(strain.T.tocsr(), points)
    ones = np.ones(len(cohesion))
    program = cone_program.ConeProgram(
        strain[:, matters], cohesion, friction, ones, dead[matters], live[matters], stress_margin=kept
    )
    solution = cone_program.solve(program)
    found = solution.stress.ravel()
    found = found + cone_program.smallest_correction(strain.T, dead + solution.multiplier * live - strain.T @ found)
    stress = np.zeros(9 * len(problem.mesh.cells))
    stress[free] = found
    yield_work = np.abs(stress * (balance[matters].T @ solution.rates)).reshape(-1, 3, 3).sum(axis=2)
    return LowerBound(solution.multiplier, stress.reshape(-1, 3, 3), yield_work, solution)


def equations(problem: LimitProblem) -> tuple[sparse.csr_matrix, np.ndarray, np.ndarray, np.ndarray]:
    """A, b0, b1 of A σ = b0 + λ b1: equilibrium of the cells, then tractions of the edges, times a length each.

    The last array has the point at which an equation of tractions holds, -1 for one of equilibrium.
    """
    rows = [_balance(problem), _continuity(problem), _boundary(problem)]
    matrices, dead, live, points = zip(*rows, strict=True)
    return sparse.vstack(matrices).tocsr(), np.concatenate(dead), np.concatenate(live), np.concatenate(points)


def independent_equations(matrix: sparse.csr_matrix, points: np.ndarray) -> np.ndarray:
    """Numbers of a set of linearly independent equations, judged point by point from the tractions there.

    Equations depend on others where edges go on straight through a point, and at corners without stress. The dual
    velocities of dependent equations are not unique and could grow without end, and with them the solver's tolerance.
    """
    at_point = np.flatnonzero(points >= 0)
    at_point = at_point[np.argsort(points[at_point], kind="stable")]
    tractions = matrix[at_point]
    gram = (tractions @ tractions.T).tocsr()  # equations of different points have no stress in common
    start = np.flatnonzero(np.diff(points[at_point], prepend=-1))
    size = np.diff(start, append=len(at_point))
    kept = [np.flatnonzero(points < 0)]
    for count in np.unique(size):
        first = start[size == count]
        rows = first[:, None] + np.arange(count)
        flat = np.asarray(gram[np.repeat(rows, count, axis=1).ravel(), np.tile(rows, (1, count)).ravel()])
        blocks = flat.reshape(len(first), count, count)
        values = np.linalg.eigvalsh(blocks)
        whole = values[:, 0] > DEPENDENT * values[:, -1]
        kept.append(at_point[rows[whole]].ravel())
        for row, block in zip(rows[~whole], blocks[~whole], strict=True):
            _, triangle, order = qr(block, pivoting=True)
            steps = np.abs(np.diag(triangle))
            kept.append(at_point[row[order[: np.count_nonzero(steps > DEPENDENT * max(steps[0], 1e-300))]]])
    return np.sort(np.concatenate(kept))


def _balance(problem: LimitProblem) -> Equations:
    """div σ + force = 0 in every cell, times the root of its area."""
    mesh = problem.mesh
    size = np.sqrt(mesh.areas)
    values = mesh.gradients * size[:, None, None]
    cells = len(mesh.cells)
    row = np.repeat(2 * np.arange(cells), 3)
    column = (9 * np.arange(cells)[:, None] + [0, 3, 6]).ravel()
    x, y = values[..., 0].ravel(), values[..., 1].ravel()
    entries = np.concatenate([x, y, y, x])
    rows = np.concatenate([row, row, row + 1, row + 1])
    columns = np.concatenate([column, column + 2, column + 1, column + 2])
    matrix = sparse.csr_matrix((entries, (rows, columns)), shape=(2 * cells, 9 * cells))
    scale = -size[:, None]
    nowhere = np.full(2 * cells, -1)
    return matrix, (scale * problem.dead_force).ravel(), (scale * problem.live_force).ravel(), nowhere


def _continuity(problem: LimitProblem) -> Equations:
    """The same traction on both sides of the inner edges, at both ends, times half their length."""
    mesh = problem.mesh
    inner = np.flatnonzero(mesh.edge_cells[:, 1] >= 0)
    ends = mesh.edges[inner]
    one, other = mesh.edge_cells[inner].T
    normal = _normals(problem, one, ends)
    zero = np.zeros(4 * len(inner))
    matrix = _tractions(problem, one, ends, normal) - _tractions(problem, other, ends, normal)
    return matrix, zero, zero, np.repeat(ends.ravel(), 2)


def _boundary(problem: LimitProblem) -> Equations:
    """The given traction at both ends of the edges of the outline, where it is not held, times half their length."""
    outline = problem.outline
    normal = _normals(problem, outline.cells, outline.ends)
    wanted = np.repeat(~outline.held[:, None, :], 2, axis=1).ravel()
    matrix = _tractions(problem, outline.cells, outline.ends, normal)[wanted]
    half = np.hypot(*normal.T)[:, None, None]
    points = np.repeat(outline.ends.ravel(), 2)[wanted]
    return matrix, (half * outline.dead).ravel()[wanted], (half * outline.live).ravel()[wanted], points


def _normals(problem: LimitProblem, cells: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Outward normals (k, 2) of edges of cells, as long as half of the edge."""
    points = problem.mesh.points
    along = points[ends[:, 1]] - points[ends[:, 0]]
    normal = 0.5 * np.column_stack([along[:, 1], -along[:, 0]])
    inwards = points[problem.mesh.cells[cells]].mean(axis=1) - points[ends[:, 0]]
    return np.where(np.sum(normal * inwards, axis=1)[:, None] > 0.0, -normal, normal)


def _tractions(problem: LimitProblem, cells: np.ndarray, ends: np.ndarray, normal: np.ndarray) -> sparse.csr_matrix:
    """From the stresses to the tractions of cells on edges, rows edge by edge: both ends, x and y."""
    corner = np.argmax(problem.mesh.cells[cells][:, None, :] == ends[:, :, None], axis=2)
    first = 9 * cells[:, None] + 3 * corner
    rows = 4 * np.arange(len(cells))[:, None] + [0, 2]
    x, y = (np.repeat(normal[:, axis, None], 2, axis=1) for axis in (0, 1))
    entries = np.stack([x, y, y, x])
    columns = np.stack([first, first + 2, first + 1, first + 2])
    shape = (4 * len(cells), 9 * len(problem.mesh.cells))
    return sparse.csr_matrix(
        (entries.ravel(), (np.stack([rows, rows, rows + 1, rows + 1]).ravel(), columns.ravel())), shape=shape
    )


def stress_free_corners(problem: LimitProblem) -> np.ndarray:
    """Corners (m, 3) at which there can be no stress: of ground without cohesion at its free, unloaded surface.

    There the traction is zero, so that one principal stress is; the other one would have to be tension. From such a
    corner it spreads to the neighbours at the same point, whose traction on the common edge is zero as well.
    """
    mesh, outline = problem.mesh, problem.outline
    loose = problem.cohesion == 0.0
    bare = ~outline.held.any(axis=1) & ~outline.dead.any(axis=(1, 2)) & ~outline.live.any(axis=(1, 2))
    bare &= loose[outline.cells]
    free = np.zeros(mesh.cells.shape, dtype=bool)
    for end in (0, 1):
        cells = outline.cells[bare]
        free[cells, np.argmax(mesh.cells[cells] == outline.ends[bare, end][:, None], axis=1)] = True
    inner = mesh.edge_cells[mesh.edge_cells[:, 1] >= 0]
    ends = mesh.edges[mesh.edge_cells[:, 1] >= 0]
    while True:
        before = np.count_nonzero(free)
        for here, there in ((0, 1), (1, 0)):
            for end in (0, 1):
                at = [np.argmax(mesh.cells[inner[:, k]] == ends[:, end][:, None], axis=1) for k in (here, there)]
                spreads = free[inner[:, here], at[0]] & loose[inner[:, there]]
                free[inner[spreads, there], at[1][spreads]] = True
        if np.count_nonzero(free) == before:
            return free
