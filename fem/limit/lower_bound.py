"""Finds a lower bound: a stress field that is linear in every triangle, in equilibrium, and nowhere beyond the yield
surface.

Every triangle has three corner stresses (Sloan 1988); the stress may jump from triangle to triangle, the traction on
their common edge may not. Mohr-Coulomb holds at the corners as a cone (Makrodimopoulos & Martin 2006; Lyamin & Sloan
2002 for its smooth forms) and therefore, being convex, everywhere in between.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from fem.limit.bound_checks import yield_slack
from fem.limit.independent_equations import independent_combinations
from fem.limit.limit_problem import LimitProblem, bare_corners
from fem.limit.point_freedom import SHEAR_ROWS, pressed_all_round, stress_free_corners
from fem.solvers import cone_program
from fem.solvers.least_norm import smallest_correction
from fem.solvers.program_accuracy import REGULARISATIONS_OF_STRESS, accuracy_of_bounds

# Margin of the stress from the yield surface over the unit of stress, which covers rounding, in a cell of unit size.
# The margin is proportional to the size of the cell, and at least the second number.
STRESS_MARGIN, SMALLEST_MARGIN = 3e-5, 1e-6
LARGEST_MARGIN = 0.1  # of the strength of clay
ACCURACY = accuracy_of_bounds(REGULARISATIONS_OF_STRESS)

# Matrix A, right-hand sides b0 (dead) and b1 (live), and the point of every equation.
Equations = tuple[sparse.csr_matrix, np.ndarray, np.ndarray, np.ndarray]


@dataclass(frozen=True, eq=False)
class LowerBound:
    """Holds the stress field with the largest load multiplier, dimensionless.

    Attributes
    ----------
    multiplier : the load multiplier with which the stress is in equilibrium
    stress (m, 3 corners, [xx, yy, xy]) : the stress at the corners of every cell
    yield_work (m, 3) : work of the stress at every corner on the dual strain rates, the multipliers of the equilibrium
        equations. The work is large where the yield surface limits the load multiplier. If one corner of a cell can
        have no stress, the work of the cell is assigned to this corner. Where no stress balances the dead load,
        ``yield_work`` is the magnitude of the strain rates at which the dead load fails.
    shortfall (m, 3) : required less actual distance of the stress at every corner to the yield surface
    solution : the solution of the cone program
    """

    multiplier: float
    stress: np.ndarray
    yield_work: np.ndarray
    shortfall: np.ndarray
    solution: cone_program.Solution


def lower_bound(
    problem: LimitProblem,
    more_margin: np.ndarray | float = 0.0,
    most_work: float = math.inf,
    start: cone_program.Warm | None = None,
) -> LowerBound:
    """Find the stress field with the largest load multiplier, corrected after the solver so that it fulfils the
    equilibrium equations to rounding.

    ``more_margin`` (m, 3), as ``LowerBound.shortfall``, is a distance to the yield surface beyond the usual margin.
    After ``most_work`` (seconds on the reference machine of ``cone_program``) the solver returns its last iterate.
    ``start`` is the iterate at which it begins.

    ``fem.limit.bound_checks`` checks whether its multiplier is a strict bound.
    ``problem``: triangles, strength and loads.
    """
    balance, dead, live, points = equations(problem)
    free = np.repeat(~stress_free_corners(problem).ravel(), 3)
    all_round = pressed_all_round(problem).ravel()[free[::3]]
    cohesion, friction = problem.cohesion.ravel()[free[::3]], np.repeat(problem.friction, 3)[free[::3]]
    cohesion = np.where(all_round, 1.0, cohesion)  # so that the cone has an inside; equations keep it to its axis
    size = np.repeat(np.sqrt(problem.mesh.areas), 3)[free[::3]]
    extra_margin = np.broadcast_to(more_margin, (len(problem.mesh.cells), 3)).ravel()[free[::3]]
    margin = np.maximum(STRESS_MARGIN * size, SMALLEST_MARGIN) + extra_margin
    margin = np.where(
        friction == 0.0, np.minimum(margin, LARGEST_MARGIN * cohesion), margin
    )  # beside clay without strength
    balance = balance[:, free].tocsr()
    corner_points = problem.mesh.own_node[problem.mesh.cells.ravel()[free[::3]]]
    points = points_of_equations(balance, points, corner_points)
    equal_pressure_points = np.flatnonzero(all_round)
    balance = sparse.vstack(
        [balance, sparse.kron(sparse.identity(len(cohesion), format="csr")[equal_pressure_points], SHEAR_ROWS)]
    ).tocsr()
    dead, live = (np.append(values, np.zeros(2 * len(equal_pressure_points))) for values in (dead, live))
    balance, dead, live = independent_equations(
        balance, dead, live, np.append(points, np.repeat(corner_points[equal_pressure_points], 2))
    )
    ones = np.ones(len(cohesion))
    program = cone_program.ConeProgram(
        balance.T.tocsr(),
        cohesion,
        friction,
        ones,
        dead,
        live,
        stress_margin=margin,
        tension=np.repeat(problem.tension, 3)[free[::3]],
        bare=bare_corners(problem).ravel()[free[::3]],
    )
    solution = cone_program.solve(program, ACCURACY, most_work=most_work, start=start)
    stresses = solution.stress.ravel()
    stresses = stresses + smallest_correction(balance, dead + solution.multiplier * live - balance @ stresses)
    stresses = _all_round(stresses.reshape(-1, 3), all_round).ravel()
    stress = np.zeros(9 * len(problem.mesh.cells))
    stress[free] = stresses
    stress = stress.reshape(-1, 3, 3)
    work = _yield_work(solution, balance, stresses, free)
    shortfall = np.zeros(work.shape)
    slack = np.where(
        all_round, margin, yield_slack(problem, stress).ravel()[free[::3]]
    )  # there is no margin on an axis
    shortfall.ravel()[free[::3]] = np.maximum(margin - slack, 0.0)
    return LowerBound(solution.multiplier, stress, work, shortfall, solution)


def _yield_work(
    solution: cone_program.Solution, balance: sparse.csr_matrix, stresses: np.ndarray, free: np.ndarray
) -> np.ndarray:
    """Return ``LowerBound.yield_work`` from the ``stresses`` of the components that are ``free``."""
    work = np.zeros(len(free))
    work[free] = np.abs(balance.T @ solution.rates)
    if solution.none != "no stress":  # else these rates are a mechanism of the dead load, whatever the stress
        work[free] *= np.abs(stresses)
    work = work.reshape(-1, 3, 3).sum(axis=2)
    stressless = ~free[::3].reshape(-1, 3)
    turns = stressless.sum(axis=1) == 1  # the stress turns round a corner that has none itself
    work[turns] = np.where(stressless[turns], work[turns].sum(axis=1, keepdims=True), 0.0)
    return work


def _all_round(stresses: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Return stresses (n, 3) that are exactly isotropic at the masked ``corners``, where the solver leaves rounding
    errors."""
    pressure = 0.5 * (stresses[:, 0] + stresses[:, 1])
    return np.where(corners[:, None], np.column_stack([pressure, pressure, np.zeros(len(pressure))]), stresses)


def equations(problem: LimitProblem) -> tuple[sparse.csr_matrix, np.ndarray, np.ndarray, np.ndarray]:
    """Return the equilibrium equations A σ = b0 + λ b1 of the cells, then the tractions of the edges, each times a
    length.

    The last array contains the number of the point of each equation of tractions, and -1 for equations of equilibrium.
    """
    rows = [_balance(problem), _continuity(problem), _boundary(problem), _repetition(problem)]
    matrices, dead, live, points = zip(*rows, strict=True)
    point = np.append(problem.mesh.own_node, -1)[np.concatenate(points)]
    return sparse.vstack(matrices).tocsr(), np.concatenate(dead), np.concatenate(live), point


def points_of_equations(matrix: sparse.csr_matrix, points: np.ndarray, corner_points: np.ndarray) -> np.ndarray:
    """Return the number of the point to which each equation belongs, -1 for none. The equilibrium equations of a cell
    with a stress at only one corner belong to this corner.

    A cell has only one corner stress if its two other corners lie at a bare surface of ground without cohesion. The
    equilibrium equations of several cells with only one corner stress around a point, as in the tip of a wedge of sand,
    depend on the tractions there. ``matrix`` multiplies the stresses at the corners, which lie at the points
    ``corner_points`` (k,); ``points`` holds the point of each equation of tractions, -1 for the other equations.
    """
    rows = np.flatnonzero((points < 0) & (np.diff(matrix.indptr) > 0))
    corners = matrix[rows].indices // 3
    start = np.append(0, np.cumsum(np.diff(matrix.indptr)[rows]))[:-1]
    least, most = np.minimum.reduceat(corners, start), np.maximum.reduceat(corners, start)
    points = points.copy()
    points[rows[least == most]] = corner_points[least[least == most]]
    return points


def independent_equations(
    matrix: sparse.csr_matrix, dead: np.ndarray, live: np.ndarray, points: np.ndarray
) -> tuple[sparse.csr_matrix, np.ndarray, np.ndarray]:
    """Return a, b0, b1 of linearly independent equations with the same solutions.

    The dual velocities of dependent equations are not unique and could grow without limit, and with them the tolerance
    of the solver. ``matrix``: A; ``dead``, ``live``: b0 and b1; ``points``: point of every equation by
    ``points_of_equations``.
    """
    change = independent_combinations(matrix, points)
    return (change @ matrix).tocsr(), change @ dead, change @ live


def _balance(problem: LimitProblem) -> Equations:
    """Return the equations div σ + force = 0 in every cell, times the root of its area."""
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
    """Return the equations of tractions at both ends of inner edges: they are equal on both sides except for the
    ``EdgeJumps``. Each equation is multiplied by half the length of the edge.
    """
    mesh = problem.mesh
    interior = np.flatnonzero(mesh.edge_cells[:, 1] >= 0)
    ends = mesh.edges[interior]
    left, right = mesh.edge_cells[interior].T
    normal = _normals(problem, left, ends)
    dead, live = np.zeros((2, len(interior), 2, 2))
    at = np.searchsorted(interior, problem.jumps.edges)
    half = np.hypot(*normal[at].T)[:, None, None]
    dead[at], live[at] = half * problem.jumps.traction, half * problem.jumps.live
    matrix = _tractions(problem, left, ends, normal) - _tractions(problem, right, ends, normal)
    return matrix, dead.ravel(), live.ravel(), np.repeat(ends.ravel(), 2)


def _boundary(problem: LimitProblem) -> Equations:
    """Return the equations of the prescribed traction at both ends of the edges of the outline, in components that are
    not fixed. Each equation is multiplied by half the length of the edge.
    """
    outline = problem.outline
    normal = _normals(problem, outline.cells, outline.ends)
    wanted = np.repeat(~outline.reacts[:, None, :], 2, axis=1).ravel()
    matrix = _tractions(problem, outline.cells, outline.ends, normal)[wanted]
    half = np.hypot(*normal.T)[:, None, None]
    points = np.repeat(outline.ends.ravel(), 2)[wanted]
    return matrix, (half * outline.dead).ravel()[wanted], (half * outline.live).ravel()[wanted], points


def _repetition(problem: LimitProblem) -> Equations:
    """Return the equations of tractions on periodic sides: they are opposite at both ends of edges that are joined.
    Each equation is multiplied by half the length of the edge."""
    mesh = problem.mesh
    parts = []
    for ends in mesh.matched:
        cells = mesh.edge_cells[mesh.edge_numbers(ends), 0]
        parts.append(_tractions(problem, cells, ends, _normals(problem, cells, ends)))
    zero = np.zeros(parts[0].shape[0])
    return parts[0] + parts[1], zero, zero, np.repeat(mesh.matched[0].ravel(), 2)


def _normals(problem: LimitProblem, cells: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Return the outward normals (k, 2) of edges of cells; the length of each normal is half the length of its edge."""
    points = problem.mesh.points
    along = points[ends[:, 1]] - points[ends[:, 0]]
    normal = 0.5 * np.column_stack([along[:, 1], -along[:, 0]])
    inwards = points[problem.mesh.cells[cells]].mean(axis=1) - points[ends[:, 0]]
    return np.where(np.sum(normal * inwards, axis=1)[:, None] > 0.0, -normal, normal)


def _tractions(problem: LimitProblem, cells: np.ndarray, ends: np.ndarray, normal: np.ndarray) -> sparse.csr_matrix:
    """Return the matrix from the stresses of cells to the tractions on edges. The rows of the matrix are ordered edge
    by edge: both ends, x and y."""
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
