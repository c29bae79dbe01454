"""Computes both bounds on a sequence of meshes, each refined where the bounds on the mesh before differ."""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import TypeVar

import numpy as np

from fem.limit.band_metric import band_metric
from fem.limit.bound_checks import (
    StressCheck,
    VelocityCheck,
    check_stress,
    check_velocity,
    corner_rates,
    dissipation,
    work,
)
from fem.limit.bracket import BoundSide, Bracket, Limits, Mechanism, MeshBounds, StressField
from fem.limit.limit_problem import LimitProblem, RigidPlasticBody, limit_problem, units_of, with_all_loads_live
from fem.limit.lower_bound import LowerBound, lower_bound
from fem.limit.upper_bound import UpperBound, upper_bound
from fem.solvers.blas_threads import one_more_thread
from fem.solvers.cone_program import NoSolution, Solution, Warm
from meshes.bisection import bisect, fan_out
from meshes.triangles import TriMesh

# The cells to bisect are those with the largest indicators that add up to half of the sum of all (the bulk criterion of
# Dörfler 1996).
BULK_SHARE = 0.5
# The indicator of a cell is its share of the gap plus this much times its share of the yield work of the lower bound.
YIELD_WORK_WEIGHT = 0.5
# A point is singular if it has at least this share of the yield work, and this many times the mean of all points. Cells
# at a singular point are halved until their angle is below NARROW_ANGLE (rad). The share is 1 at the edge of a footing.
# At the toe of a slope it is below 0.2 and decreases; narrow cells there would not improve the upper bound.
SINGULAR_SHARE, SINGULAR_RATIO, NARROW_ANGLE = 0.03, 20.0, 0.1
# Indicator of one half of a bisected cell over that of the whole cell: less than 0.5, as the gap falls faster than the
# area.
HALF_CELL_INDICATOR = 0.3
# Friction angle (rad) from which ground in a right angle between fixed sides cannot strain.
LARGEST_LOCKED_FRICTION = np.pi / 4.0
# Smallest and largest share of the computing work for the lower bound; the search ends if less work is left for one of
# the two bounds.
LOWER_BOUND_WORK = (0.35, 0.65)
# Largest number of attempts at a bound, and the increase of the margin per attempt, over the shortfall of the last
# attempt.
ATTEMPTS, MARGIN_OVER_SHORTFALL = 3, 5.0


class BoundSearch:
    """Finds lower and upper bounds of the load multiplier of a body on a sequence of ever finer meshes.

    Attributes
    ----------
    bracket : Bracket
        Best bounds so far, and the reason why the search has ended (none while the search continues).
    """

    def __init__(self, mesh: TriMesh, body: RigidPlasticBody, limits: Limits) -> None:
        self.bracket = Bracket(None, None, [], mesh)
        self._body, self._limits, self._units = body, limits, units_of(mesh, body)
        self._seen: tuple[LimitProblem, LowerBound, UpperBound] | None = None

    @property
    def work(self) -> float:
        """Return the computing work so far, in seconds on the reference machine of ``cone_program``."""
        return sum(mesh.work for mesh in self.bracket.meshes)

    def advance(self, others: float = 0.0) -> None:
        """Find bounds on the next mesh; ``others`` is the computing work of other searches, which counts towards the
        same limit of work."""
        best, mesh = self.bracket, self.bracket.mesh
        if self._seen is not None:
            mesh = finer_mesh(*self._seen, self._limits.growth(best, len(self._seen[0].mesh.cells)))
        problem = limit_problem(mesh, self._body, self._units)
        remaining_work = max(self._limits.seconds - self.work - others, 0.0)
        share = share_of_lower_bound(*self._seen[1:]) if self._seen is not None else 0.5
        with one_more_thread() as executor:
            before = self._seen[2] if self._seen is not None else None
            above = executor.submit(partial(proven_upper_bound, problem, (1.0 - share) * remaining_work, before=before))
            low, low_notes, stress = proven_lower_bound(problem, share * remaining_work)
            high, high_notes, mechanism = above.result()
        spent = low.solution.work + high.solution.work
        if mechanism is None and low.solution.none == "no stress":
            mechanism, more_work = failing_by_weight(problem, max(remaining_work - spent, 0.0))
            spent += more_work
        missing: tuple[tuple[BoundSide, bool], ...] = (
            ("lower", stress is None and not (low.solution.none or low.solution.out_of_work)),
            ("upper", mechanism is None and not (high.solution.none or high.solution.out_of_work)),
        )
        solutions: tuple[tuple[BoundSide, Solution], ...] = (("lower", low.solution), ("upper", high.solution))
        mesh_bounds = MeshBounds(
            len(problem.mesh.cells),
            stress.multiplier if stress else None,
            mechanism.multiplier if mechanism else None,
            (*low_notes, *high_notes),
            spent,
            tuple(side for side, failed in missing if failed),
            tuple(side for side, solution in solutions if solution.fallback),
            mesh,
        )
        if (mechanism and mechanism.multiplier < best.lower) or (stress and stress.multiplier > best.upper):
            # Under seepage the pore pressure is linear in each triangle: finer triangles are other ground, and count.
            best = replace(best, stress=None, mechanism=None)
        best = Bracket(
            stress if stress and stress.multiplier > best.lower else best.stress,
            mechanism if mechanism and mechanism.multiplier < best.upper else best.mechanism,
            [*best.meshes, mesh_bounds],
            mesh,
        )
        self._seen = problem, low, high
        end_reason = self._limits.reached(best, len(problem.mesh.cells), others)
        worst = problem.points[problem.mesh.cells[np.argmax(refinement_indicator(*self._seen))]].mean(axis=0)
        self.bracket = replace(
            best,
            end_reason=end_reason,
            open_at=(float(worst[0]), float(worst[1])) if end_reason not in (None, "gap") else None,
        )


def share_of_lower_bound(low: LowerBound, high: UpperBound) -> float:
    """Return the share of the computing work on the next mesh that the lower bound may take: the same share as on the
    last mesh."""
    return float(np.clip(low.solution.work / max(low.solution.work + high.solution.work, 1e-300), *LOWER_BOUND_WORK))


def proven_lower_bound(
    problem: LimitProblem, most_work: float = math.inf, start: Warm | None = None
) -> tuple[LowerBound, list[str], StressField | None]:
    """Find a strict lower bound. Returns the stress field of the solver, the reason if there is no bound, and, if the
    field passes the check, the field with its bound.

    After ``most_work`` (seconds on the reference machine of ``cone_program``) the solver returns its last iterate.
    ``start`` is the iterate at which it begins.
    """
    place = start

    def attempt(more_margin: np.ndarray | float, work: float) -> tuple[LowerBound, StressCheck]:
        nonlocal place
        bound = lower_bound(problem, more_margin, work, place)
        place = bound.solution.warm
        return bound, check_stress(problem, bound.stress, bound.multiplier)

    bound, check, notes = _first_checked("lower bound", attempt, most_work)
    return bound, notes, StressField(problem, bound.multiplier, bound.stress, check) if check else None


def proven_upper_bound(
    problem: LimitProblem, most_work: float = math.inf, start: Warm | None = None, before: UpperBound | None = None
) -> tuple[UpperBound, list[str], Mechanism | None]:
    """Find a strict upper bound of the load in a ``problem``. Returns the mechanism of the solver, the reason if there
    is no bound, and, if the mechanism passes the check, the mechanism with its bound.

    After ``most_work`` (seconds on the reference machine of ``cone_program``) the solver returns its last iterate.
    ``start`` is the iterate at which it begins.

    Ground of φ > 45° in a corner between held sides cannot strain, and the solver may find no mechanism there: this
    ground is then held as a rigid body, at once if it was held for the bound ``before``, on another mesh or for ground
    of another strength.
    """

    place = start

    def attempt(
        more_margin: np.ndarray | float, work: float, rigid: np.ndarray | None = None
    ) -> tuple[UpperBound, VelocityCheck]:
        nonlocal place
        bound = upper_bound(problem, more_margin, rigid, work, place)
        place = bound.solution.warm
        return bound, check_velocity(problem, bound.velocity)

    locked_cells = problem.friction > LARGEST_LOCKED_FRICTION
    partly_steep = bool(locked_cells.any() and not locked_cells.all())
    work_before, notes, check = 0.0, list[str](), None
    if not (partly_steep and before is not None and before.steep_is_rigid):
        bound, check, notes = _first_checked("upper bound", attempt, most_work, 1 if partly_steep else ATTEMPTS)
        work_before = bound.solution.work
    if check is None and partly_steep:
        attempt_with_rigid = partial(attempt, rigid=locked_cells)
        bound, check, more_notes = _first_checked(
            "upper bound, steep ground held", attempt_with_rigid, most_work - work_before
        )
        work = work_before + bound.solution.work
        bound = replace(bound, solution=replace(bound.solution, work=work), steep_is_rigid=True)
        notes += more_notes
    return bound, notes, Mechanism(problem, check.multiplier, bound.velocity, check) if check else None


F = TypeVar("F", LowerBound, UpperBound)
C = TypeVar("C", StressCheck, VelocityCheck)


def failing_by_weight(problem: LimitProblem, most_work: float) -> tuple[Mechanism | None, float]:
    """Return a mechanism that fails under the dead load alone and moves in the direction of the live load, with its
    upper bound of the multiplier, below 0, and the computing work; None if there is no such mechanism.

    Where the weight fails the ground, as below an embankment, the multiplier has no least upper bound, and the solver
    finds none. The share of the dead load that the ground resists has one.

    ``problem``: problem of the multiplier; ``most_work``: as in `proven_upper_bound`.
    """
    bound, _, mechanism = proven_upper_bound(with_all_loads_live(problem, 0.0), most_work)
    if mechanism is None or mechanism.multiplier >= 1.0:
        return None, bound.solution.work
    _, live = work(problem, bound.velocity)
    if live <= 0.0:
        return None, bound.solution.work
    check = check_velocity(problem, bound.velocity)
    return Mechanism(problem, check.multiplier, bound.velocity, check), bound.solution.work


def _first_checked(
    name: str,
    attempt: Callable[[np.ndarray | float, float], tuple[F, C]],
    most_work: float,
    attempts: int = ATTEMPTS,
) -> tuple[F, C | None, list[str]]:
    """Return the first of a few attempts that passes its check, and the check; None instead of the check if no attempt
    passes.

    The solver fulfils equations and margins only approximately, and the correction of the equations may lead beyond the
    yield surface or violate the flow rule. Therefore the next attempt has a margin to the yield surface at every
    corner, which is a few times the violation by the last attempt. There is no next attempt if the solver ended early:
    the violation then comes from unfinished iterations, and a margin of the same size would leave no admissible stress.
    """
    notes: list[str] = []
    bound, check = attempt(0.0, most_work)
    work, more_margin = bound.solution.work, np.zeros(bound.shortfall.shape)
    if bound.solution.none:
        return bound, None, [f"{name}: {NO_BOUND_REASONS[bound.solution.none]}"]
    for _ in range(attempts - 1):
        if check.holds or not check.needs_margin or not bound.shortfall.any() or bound.solution.end_status:
            break  # more margin would not help
        if work >= most_work:
            break
        more_margin += MARGIN_OVER_SHORTFALL * bound.shortfall
        wider, check_of_wider = attempt(more_margin, most_work - work)
        work += wider.solution.work
        if wider.solution.none:
            break
        bound, check = wider, check_of_wider
    if bound.solution.end_status:
        reason = "the allowed work is used up" if bound.solution.out_of_work else bound.solution.end_status
        notes.append(f"{name}: the solver ended early ({reason})")
    bound = replace(bound, solution=replace(bound.solution, work=work))  # that of all attempts
    if check.holds:
        return bound, check, notes
    return bound, None, [*notes, f"the {name} does not hold: {check}"]


NO_BOUND_REASONS: Mapping[NoSolution, str] = {
    "no stress": "no stress field on this mesh is in equilibrium with the dead load",
    "no mechanism": "the live load does no work in any mechanism on this mesh",
}


def gap_shares(problem: LimitProblem, low: LowerBound, high: UpperBound) -> np.ndarray:
    """Return the contribution of every cell (m,) to the gap between the bounds: the dissipation of the mechanism less
    the work of the lower bound's stress on the strain rate of the mechanism.

    Apart from rounding no contribution is negative, and their sum is the upper less the lower bound (Ciria, Peraire &
    Bonet 2008).
    """
    if high.solution.none:
        return problem.mesh.areas
    rates = corner_rates(problem, high.velocity)
    shares = dissipation(problem, rates)
    if not low.solution.none:
        mass = (np.ones((3, 3)) + np.eye(3)) / 12.0  # of linear fields over a triangle
        shares = shares - problem.mesh.areas * np.einsum("mki,kl,mli->m", low.stress, mass, rates)
    return np.maximum(shares, 0.0)


def refinement_indicator(problem: LimitProblem, low: LowerBound, high: UpperBound) -> np.ndarray:
    """Return the refinement indicator (m,) of every cell: the share of the cell in the gap between the bounds plus its
    share in the yield work of the lower bound.

    Yield work may be far from the mechanism of the upper bound: a stress field that is too coarse at one corner can
    reduce the lower bound, or leave no lower bound.
    """
    shares = gap_shares(problem, low, high)
    shares = shares / max(shares.sum(), 1e-300)
    if (total := low.yield_work.sum()) > 0.0:
        shares = shares + YIELD_WORK_WEIGHT * low.yield_work.sum(axis=1) / total
    return np.nan_to_num(shares)  # a solver that ended early may leave no numbers


def singular_points(problem: LimitProblem, low: LowerBound) -> np.ndarray:
    """Find the singular points (n,), as a mask: the principal directions rotate more around them than the cells can
    follow.

    The edge of a footing is a singular point: the few cells around it reduce the lower bound, however small they are.
    """
    points = problem.mesh.cells.ravel()
    work = np.bincount(points, weights=low.yield_work.ravel(), minlength=len(problem.mesh.points))
    singular = work > max(SINGULAR_SHARE * work.sum(), SINGULAR_RATIO * work.mean())
    return singular


def finer_mesh(problem: LimitProblem, low: LowerBound, high: UpperBound, growth: float) -> TriMesh:
    """Return the mesh of a problem with about ``growth`` times as many cells, refined where the bounds ``low`` and
    ``high`` differ, into triangles that are long along the shear bands."""
    indicator = refinement_indicator(problem, low, high)
    mesh, parent = fan_out(problem.mesh_in_metres, singular_points(problem, low), NARROW_ANGLE)
    metric = band_metric(problem, high)[parent]
    return refined(mesh, indicator[parent] / np.bincount(parent)[parent], growth * len(indicator), metric)


def refined(mesh: TriMesh, indicator: np.ndarray, wanted: float, metric: np.ndarray) -> TriMesh:
    """Return the mesh with about ``wanted`` cells, bisected where the ``indicator`` (m,) is largest, at the edges that
    are longest by the ``metric`` (m, 2, 2)."""
    while len(mesh.cells) < 0.95 * wanted:
        order = np.argsort(-indicator, kind="stable")
        count_by_share = int(np.searchsorted(np.cumsum(indicator[order]), BULK_SHARE * indicator.sum())) + 1
        largest_count = max(1, int((wanted - len(mesh.cells)) / 1.5))
        mesh, parent = bisect(mesh, order[: min(count_by_share, largest_count)], metric)
        metric = metric[parent]
        halves = np.bincount(parent)[parent]
        indicator = indicator[parent] * np.where(halves > 1, 2.0 * HALF_CELL_INDICATOR / halves, 1.0)
    return mesh
