"""Finds an upper bound: a mechanism of continuous, quadratic velocities that obey the associated flow rule everywhere.

In a triangle with straight sides and six nodes the strain rate is linear. The flow rule is convex: it holds in the
whole triangle if it holds at the corners, and the dissipation is at most a third of the area times the sum of its
values at the corners. The smallest load multiplier is therefore a strict upper bound (Makrodimopoulos & Martin 2007).
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from fem.limit.independent_equations import independent_combinations
from fem.limit.limit_problem import LimitProblem
from fem.limit.point_freedom import unstrained_points
from fem.solvers import cone_program
from fem.solvers.least_norm import smallest_correction
from fem.solvers.program_accuracy import FEASIBILITY, accuracy_of_bounds
from meshes.triangles import TriMesh

# Volumetric strain rate beyond that of the flow rule, so that rounding does not break it: in units of velocity over
# length, and as much again as a share of the shear rate.
STRAIN_MARGIN = 1e-5
# Nodal forces are multiplied by the number of cells over this number before the program is solved. Without this factor,
# the nodal forces of fine meshes in cohesionless sand were below the tolerance of the solver, and bounds stalled 4 %
# apart on 21,000 triangles. On coarse meshes forces ten times as large double the iterations.
UNSCALED_CELLS = 1000.0
# Largest number of corrections of velocities at corners that violate the flow rule. About twenty are needed for two
# hundred corners; each costs a hundredth of a solution of the program.
MOST_REPAIRS = 30
# Residual of the solver's velocities that is accepted if its iterations no longer reduce it. The volume conditions of
# clay are nearly dependent where edges pass almost straight through a point, and a residual of 2e-8 remained in layers
# of clay whose strength follows the stress; the velocities are corrected to rounding afterwards.
ACCURACY = accuracy_of_bounds(stalled_residual=1e-7)
# Ratio of singular values of the volume equations at a point up to which they depend on each other. The equations that
# are left out then hold to this share of the strain rates.
DEPENDENT_VOLUMES = 1e-10
# Velocity, where the live load does work of 1, above which the mechanism is one of the dead load alone. The bound is
# then far below any Kh.
LARGEST_VELOCITY = 1e5


@dataclass(frozen=True, eq=False)
class UpperBound:
    """Holds the mechanism with the smallest load multiplier, dimensionless.

    Attributes
    ----------
    multiplier : dissipation less the work of the dead load where the work of the live load is 1, by the solver
    velocity (m, 6 nodes, 2) : velocities of every cell at its corners, then at the middles of its edges
    shortfall (m, 3) : required less actual distance of every corner to the limit of the flow rule, as a velocity:
        volumetric rate less sin φ times the shear rate, times the root of a third of the area
    solution : the solution of the cone program
    steep_is_rigid : whether ground of φ > 45° was held as a rigid body, since the solver found no mechanism otherwise
    """

    multiplier: float
    velocity: np.ndarray
    shortfall: np.ndarray
    solution: cone_program.Solution
    steep_is_rigid: bool = False


def upper_bound(
    problem: LimitProblem,
    more_margin: np.ndarray | float = 0.0,
    rigid: np.ndarray | None = None,
    most_work: float = math.inf,
    start: cone_program.Warm | None = None,
) -> UpperBound:
    """Find the mechanism with the smallest load multiplier, corrected after the solver so that it fulfils the equations
    to rounding.

    ``more_margin`` (m, 3), as ``UpperBound.shortfall``, is a distance to the limit of the flow rule beyond the usual
    margin. Cells of ``rigid`` (m,), a mask, do not move: the result is still an upper bound, though a larger one.

    After ``most_work`` (seconds on the reference machine of ``cone_program``) the solver returns its last iterate.
    ``start`` is the iterate at which it begins.

    ``fem.limit.bound_checks`` checks whether its multiplier is a strict bound.
    ``problem``: triangles, strength and loads.
    """
    nodes, moves, dead, live = nodes_and_loads(problem)
    if rigid is not None:
        moves.reshape(-1, 2)[nodes[rigid]] = False
    velocities = 2 * problem.mesh.own_node[:, None] + [0, 1]
    np.logical_and.at(moves, velocities.ravel(), moves.copy())
    basis = free_velocities(problem, moves)
    areas = np.repeat(problem.mesh.areas / 3.0, 3)
    size = np.sqrt(areas)  # strains times lengths: the solver's tolerance is one of velocities
    strain = (sparse.diags(np.repeat(size, 3)) @ strain_rates(problem.mesh, nodes) @ basis).tocsr()
    strain.eliminate_zeros()
    # Corners of unstrained points, and of rigid cells, have no strain rate.
    strains = np.repeat(np.diff(strain.indptr).reshape(-1, 3).any(axis=1), 3)
    corners = strains[::3]
    extra_margin = np.broadcast_to(more_margin, (len(problem.mesh.cells), 3)).ravel()[corners]
    program = cone_program.ConeProgram(
        strain[strains],
        problem.spread_cohesion.ravel()[corners],
        np.repeat(problem.friction, 3)[corners],
        size[corners],
        basis.T @ dead,
        basis.T @ live,
        strain_margin=STRAIN_MARGIN * size[corners] + extra_margin,
        strain_share=STRAIN_MARGIN,
        tension=np.repeat(problem.tension, 3)[corners],
    )
    magnified = max(1.0, len(problem.mesh.cells) / UNSCALED_CELLS)
    solution = cone_program.solve(program, ACCURACY, magnified, most_work, start)
    if solution.none == "no stress":  # its proof are rates at which the dead load alone fails
        solution = replace(
            solution, rates=LARGEST_VELOCITY / np.abs(solution.rates).max() * solution.rates, none="", end_status=""
        )
    dilates = program.friction > 0.0
    dilates[program.torn] = True
    points = problem.mesh.own_node[problem.mesh.cells.ravel()[corners]]
    rates = _corrected(program, solution.rates, dilates, points)
    slack, _ = _flow_slack(program, rates)
    shortfalls = np.maximum(program.strain_margin - slack, 0.0)
    shortfalls[slack < 0.0] += FEASIBILITY * np.abs(rates).max()  # the margin of a sliver may be less
    shortfall = np.zeros(len(areas))
    shortfall[corners] = np.where(dilates, shortfalls, 0.0)
    velocity = (basis @ rates).reshape(-1, 2)[nodes]
    return UpperBound(solution.multiplier, velocity, shortfall.reshape(-1, 3), solution)


def free_velocities(problem: LimitProblem, moves: np.ndarray) -> sparse.csr_matrix:
    """Return the matrix from the free velocities to all velocities (2 n,); ``moves`` (2 n,) marks the components that
    are not fixed.

    At a point whose strain rate must vanish, the velocity v along an edge has no slope:
    4 v(middle) = 3 v(point) + v(end). Periodic sides have equal velocities.
    """
    mesh = problem.mesh
    left, right = mesh.matched
    unstrained = unstrained_points(problem)
    unstrained[left] = unstrained[right] = unstrained[left] | unstrained[right]
    edges = np.flatnonzero(unstrained[mesh.edges].any(axis=1))
    ends = mesh.edges[edges]
    point = np.where(unstrained[ends[:, 0]], ends[:, 0], ends[:, 1])
    middle, own_nodes, matched_nodes = (
        2 * node[:, None] + [0, 1] for node in (len(mesh.points) + edges, point, ends.sum(1) - point)
    )
    free = moves.astype(float)
    free[middle] = 0.0
    rows, columns = np.concatenate([middle.ravel()] * 2), np.concatenate([own_nodes.ravel(), matched_nodes.ravel()])
    shares = np.repeat([0.75, 0.25], middle.size) * moves[rows] * moves[columns]
    full = sparse.diags(free) + sparse.csr_matrix((shares, (rows, columns)), shape=(len(moves), len(moves)))
    if mesh.repeats:
        own_components = (2 * mesh.own_node[:, None] + [0, 1]).ravel()
        alike = sparse.csr_matrix(
            (np.ones(len(own_components)), (np.arange(len(own_components)), own_components)), shape=full.shape
        )
        full = alike @ full @ alike
    full = sparse.csc_matrix(full)
    full.eliminate_zeros()
    return full[:, np.diff(full.indptr) > 0].tocsr()


def _corrected(
    program: cone_program.ConeProgram, rates: np.ndarray, dilates: np.ndarray, points: np.ndarray
) -> np.ndarray:
    """Return velocities without volume change where φ = 0 and no tension cut-off acts, scaled so that the live load
    does unit work.

    ``dilates`` (k,) marks the corners that dilate; ``points`` (k,) are the points where the corners lie. Where the
    correction violates the flow rule at such a corner, the velocities are corrected again with the linearised flow
    rule, until the volumetric rate exceeds that of the flow rule by half the margin of the program, ``strain_margin``.
    """
    clay = np.flatnonzero(~dilates)
    volume = (program.strain[3 * clay] + program.strain[3 * clay + 1]).tocsr()
    volume = independent_combinations(volume, points[clay], DEPENDENT_VOLUMES) @ volume
    equal = sparse.vstack([sparse.csr_matrix(program.live), volume]).tocsr()
    load_row = np.pad([1.0], (0, volume.shape[0]))
    rates = rates + smallest_correction(equal, load_row - equal @ rates)
    goal = 0.5 * np.broadcast_to(program.strain_margin, len(dilates))
    corrected = np.zeros(len(dilates), dtype=bool)
    for _ in range(MOST_REPAIRS):
        slack, slope = _flow_slack(program, rates)
        violating = dilates & (slack < 0.5 * goal)
        if not violating.any():
            break
        corrected |= violating
        change = sparse.vstack([equal, slope[corrected]]).tocsr()
        residual = np.concatenate([load_row - equal @ rates, (goal - slack)[corrected]])
        rates = rates + smallest_correction(change, residual)
    return rates / (program.live @ rates)


def _flow_slack(program: cone_program.ConeProgram, rates: np.ndarray) -> tuple[np.ndarray, sparse.csr_matrix]:
    """Return the volumetric rate less sin φ times the shear rate at every corner (k,), and its derivative with respect
    to the rates (k, n)."""
    xx, yy, xy = (program.strain @ rates).reshape(-1, 3).T
    sin, shear = np.sin(program.friction), np.hypot(xx - yy, xy)
    across, along = (np.divide(part, shear, out=np.zeros(len(sin)), where=shear > 0.0) for part in (xx - yy, xy))
    slopes = np.column_stack([1.0 - sin * across, 1.0 + sin * across, -sin * along])
    pick = sparse.csr_matrix((slopes.ravel(), np.arange(slopes.size), np.arange(0, slopes.size + 1, 3)))
    return xx + yy - sin * shear, (pick @ program.strain).tocsr()


def nodes_and_loads(problem: LimitProblem) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return the nodes (m, 6) of the cells, a mask of the free velocity components (2 n,), and the work of the dead and
    of the live load on a unit velocity of each component (2 n,)."""
    mesh, outline = problem.mesh, problem.outline
    nodes = mesh.six_nodes
    count = len(mesh.points) + len(mesh.edges)
    moves = np.ones((count, 2), dtype=bool)
    along = np.column_stack([outline.ends, len(mesh.points) + outline.edges])
    for axis in (0, 1):
        moves[along[outline.fixed[:, axis]], axis] = False
    dead, live = np.zeros((count, 2)), np.zeros((count, 2))
    third = mesh.areas[:, None, None] / 3.0  # quadratic shapes: the middles carry all of it
    for work, force, traction in (
        (dead, problem.dead_force, outline.dead),
        (live, problem.live_force, outline.live),
    ):
        np.add.at(work, nodes[:, 3:], third * force[:, None, :])
        add_edge_loads(work, mesh, along, traction)
    jumps = problem.jumps
    at_jumps = np.column_stack([jumps.ends, len(mesh.points) + jumps.edges])
    add_edge_loads(dead, mesh, at_jumps, jumps.traction)
    add_edge_loads(live, mesh, at_jumps, jumps.live)
    return nodes, moves.ravel(), dead.ravel(), live.ravel()


def add_edge_loads(loads: np.ndarray, mesh: TriMesh, nodes: np.ndarray, traction: np.ndarray) -> None:
    """Add tractions (k, 2 ends, 2) in Pa, linear along edges, to nodal ``loads`` (n, 2) in N/m.

    ``mesh``: triangles; ``nodes`` (k, 3): ends and middle of each edge; ``traction``: traction at both ends.
    """
    length = np.hypot(*(mesh.points[nodes[:, 1]] - mesh.points[nodes[:, 0]]).T)[:, None]
    first, last = traction[:, 0], traction[:, 1]
    for node, share in zip(nodes.T, (first / 6.0, last / 6.0, (first + last) / 3.0), strict=True):
        np.add.at(loads, node, length * share)  # Simpson's rule, exact for linear times quadratic


def strain_rates(mesh: TriMesh, nodes: np.ndarray) -> sparse.csr_matrix:
    """Return the matrix from the velocities (2 n,) to the strain rates at the corners (9 m,), [xx, yy, engineering xy]
    corner by corner.

    At corner k the gradient of the shape function is (4 δ_ik - 1) ∇L_i for corner i, and 4 ∇L_j for the middle of the
    edge kj.
    """
    cells = len(nodes)
    gradient = mesh.gradients
    slope = np.zeros((cells, 3, 6, 2))
    for k in range(3):
        for i in range(3):
            slope[:, k, i] = (3.0 if i == k else -1.0) * gradient[:, i]
        slope[:, k, 3 + k] = 4.0 * gradient[:, (k + 1) % 3]
        slope[:, k, 3 + (k + 2) % 3] = 4.0 * gradient[:, (k + 2) % 3]
    first = 9 * np.arange(cells)[:, None, None] + 3 * np.arange(3)[:, None]
    first = np.broadcast_to(first, (cells, 3, 6))
    node = np.broadcast_to(2 * nodes[:, None, :], (cells, 3, 6))
    x, y = slope[..., 0], slope[..., 1]
    rows = np.stack([first, first + 1, first + 2, first + 2])
    columns = np.stack([node, node + 1, node, node + 1])
    values = np.stack([x, y, y, x])
    keep = values != 0.0
    shape = (9 * cells, 2 * (int(nodes.max()) + 1))
    return sparse.csr_matrix((values[keep], (rows[keep], columns[keep])), shape=shape)
