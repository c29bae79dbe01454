"""Both bounds on a sequence of meshes, each refined where the one before leaves a gap between the bounds."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeVar

import numpy as np

from fem.limit.bound_checks import StressCheck, VelocityCheck, check_stress, check_velocity, corner_rates, dissipation
from fem.limit.limit_problem import LimitProblem, RigidPlasticBody, limit_problem, units_of
from fem.limit.lower_bound import LowerBound, lower_bound
from fem.limit.upper_bound import UpperBound, upper_bound
from fem.meanwhile import Meanwhile
from meshes.bisection import bisect, fan_out
from meshes.triangles import TriMesh

# A mesh has twice as many cells as the one before. The cells to bisect are those with the largest indicators that add
# up to half of the sum of all (the bulk criterion of Dörfler 1996).
GROWTH, BULK_SHARE = 2.0, 0.5
# One step more may take this factor if it should close the gap, for which it aims so much beyond it.
MOST_GROWTH, AIM_BEYOND = 3.0, 1.15
# A mesh is worth its work if it has this many times as many cells as the one before.
LEAST_GROWTH = 1.2
# Work is counted in seconds of a reference machine, so that its clock and its load decide nothing: an iteration of
# either solver on this many cells takes so long, and goes with this power of the cells.
COST_CELLS, COST_SECONDS, COST_EXPONENT = 1000, 0.021, 1.1
# The search has stalled if so many meshes in a row left this share of the gap.
STALLED_MESHES, STALLED_SHARE = 2, 0.9
# The indicator of a cell is its share of the gap plus this much times its share of the yield work of the lower bound.
YIELD_WORK_WEIGHT = 0.5
# A point is singular if it has this share of all yield work, and this many times the mean of all points; the cells
# that meet there are halved until their angle is below the last (rad). The share is 1 at the edge of a footing; at the
# toe of a slope it is below 0.2 and falls, and narrow cells there would be lost to the upper bound.
SINGULAR_SHARE, SINGULAR_TIMES, NARROW_ANGLE = 0.03, 20.0, 0.1
# The indicator of either half of a bisected cell, over that of the whole: the gap falls faster than the area.
HALF_SHARE = 0.3
# Friction angle (rad) from which ground in a right angle between held sides cannot strain.
STEEP = np.pi / 4.0
# Attempts at a bound, and how much more margin the next one has, over what the last one fell short of its own.
ATTEMPTS, SHORTFALLS = 3, 5.0


@dataclass(frozen=True, eq=False)
class StressField:
    """A stress field that was checked to be statically admissible, dimensionless.

    Attributes
    ----------
    problem : LimitProblem
        The problem it belongs to.
    multiplier : float
        The load multiplier that it carries: a strict lower bound.
    stress : ndarray (m, 3 corners, [xx, yy, xy])
        The stress at the corners of every cell.
    check : StressCheck
        How well it meets its conditions.
    """

    problem: LimitProblem
    multiplier: float
    stress: np.ndarray
    check: StressCheck


@dataclass(frozen=True, eq=False)
class Mechanism:
    """Velocities that were checked to be kinematically admissible, dimensionless.

    Attributes
    ----------
    problem : LimitProblem
        The problem they belong to.
    multiplier : float
        The load multiplier at which they dissipate what the loads do: a strict upper bound.
    velocity : ndarray (m, 6 nodes, 2)
        Velocities of every cell at its corners, then at the middles of its edges.
    check : VelocityCheck
        How well they meet their conditions.
    """

    problem: LimitProblem
    multiplier: float
    velocity: np.ndarray
    check: VelocityCheck

    @property
    def dissipation(self) -> np.ndarray:
        """Plastic dissipation (m,) of every cell."""
        return dissipation(self.problem, corner_rates(self.problem, self.velocity))


@dataclass(frozen=True)
class MeshBounds:
    """The bounds on one mesh.

    Attributes
    ----------
    cells : int
        Number of its triangles.
    lower, upper : float or None
        The strict bounds of the load multiplier, None where there is none.
    notes : tuple of str
        What went wrong.
    work : float
        Its work in seconds of the reference machine, counted and not measured (``work_of``).
    """

    cells: int
    lower: float | None
    upper: float | None
    notes: tuple[str, ...]
    work: float


@dataclass(frozen=True, eq=False)
class Bracket:
    """The best lower and upper bound over all meshes so far.

    Attributes
    ----------
    stress : StressField or None
        The stress field of the largest lower bound, None without one.
    mechanism : Mechanism or None
        The mechanism of the smallest upper bound, None without one.
    meshes : list of MeshBounds
        The bounds on every mesh, in their order.
    mesh : TriMesh
        The last mesh, in m.
    ended : str
        Why there is no finer mesh: "gap" (closed as far as was asked), "enough" (the upper bound is), "triangles" or
        "time" (no more allowed), "stalled" (finer meshes no longer close it).
    open_at : tuple of float or None
        Where the gap is widest, (x, y) in m, if the search ended before it was closed.
    """

    stress: StressField | None
    mechanism: Mechanism | None
    meshes: list[MeshBounds]
    mesh: TriMesh
    ended: str = ""
    open_at: tuple[float, float] | None = None

    @property
    def lower(self) -> float:
        """The lower bound, -inf without one."""
        return self.stress.multiplier if self.stress else -np.inf

    @property
    def upper(self) -> float:
        """The upper bound, inf without one."""
        return self.mechanism.multiplier if self.mechanism else np.inf

    @property
    def gap(self) -> float:
        """Upper less lower bound over the mean of their sizes; inf where one is missing."""
        if not (self.stress and self.mechanism):
            return np.inf
        return (self.upper - self.lower) / max(0.5 * (abs(self.upper) + abs(self.lower)), 1e-12)


# Called with the bracket after every mesh.
Observer = Callable[[Bracket], None]


@dataclass(frozen=True)
class Limits:
    """When to stop.

    Attributes
    ----------
    gap : float
        Relative gap between the bounds that is small enough.
    max_cells : int
        Triangles of the last mesh, at most.
    seconds : float
        Work for all meshes, in seconds of the reference machine. Another one is begun if it is likely to end by then.
        The clock is not asked: the same input takes the same meshes, however loaded the machine is.
    enough : float
        An upper bound below this one is as good as any.
    """

    gap: float
    max_cells: int
    seconds: float = np.inf
    enough: float = -np.inf

    def growth(self, found: Bracket, cells: int) -> float:
        """How many times as many cells the next mesh has: as many as should close the gap, if one step can do that.

        The gap goes with one over the number of cells, or a little faster.
        """
        needed = AIM_BEYOND * found.gap / self.gap
        return min(needed if needed <= MOST_GROWTH else GROWTH, self.max_cells / cells)

    def reached(self, found: Bracket, cells: int) -> str:
        """Which of them ends the search, as ``Bracket.ended`` has it; empty if none does."""
        if found.gap <= self.gap:
            return "gap"
        if found.upper < self.enough:
            return "enough"
        if cells * LEAST_GROWTH > self.max_cells:
            return "triangles"
        spent = sum(mesh.work for mesh in found.meshes)
        if spent + GROWTH**COST_EXPONENT * found.meshes[-1].work > self.seconds:
            return "time"
        return "stalled" if _stalled(found.meshes) else ""


def work_of(cells: int, iterations: int) -> float:
    """Seconds in which the reference machine makes so many iterations of a solver on a mesh of so many ``cells``."""
    return COST_SECONDS * iterations * (cells / COST_CELLS) ** COST_EXPONENT


def _stalled(meshes: list[MeshBounds]) -> bool:
    """Whether the last two refinements did next to nothing for the gap, or could not prove a bound."""
    if len(meshes) < 3 + STALLED_MESHES:
        return False
    best = []
    for count in (len(meshes) - STALLED_MESHES, len(meshes)):
        lower = max((m.lower for m in meshes[:count] if m.lower is not None), default=-np.inf)
        upper = min((m.upper for m in meshes[:count] if m.upper is not None), default=np.inf)
        best.append(upper - lower)
    before, now = best
    return bool(now > STALLED_SHARE * before or np.isinf(now))


def bracket(
    mesh: TriMesh,
    body: RigidPlasticBody,
    limits: Limits,
    observer: Observer | None = None,
) -> Bracket:
    """Lower and upper bound of the load multiplier on a sequence of ever finer meshes, until a limit is reached."""
    units = units_of(mesh, body)
    best = Bracket(None, None, [], mesh)
    while True:
        problem = limit_problem(mesh, body, units)
        with Meanwhile() as meanwhile:
            above = meanwhile.begin(partial(proven_upper_bound, problem))
            low, low_notes, stress = proven_lower_bound(problem)
            high, high_notes, mechanism = above.result()
        this = MeshBounds(
            len(problem.mesh.cells),
            stress.multiplier if stress else None,
            mechanism.multiplier if mechanism else None,
            (*low_notes, *high_notes),
            work_of(len(problem.mesh.cells), max(low.solution.iterations, high.solution.iterations)),
        )
        best = Bracket(
            stress if stress and stress.multiplier > best.lower else best.stress,
            mechanism if mechanism and mechanism.multiplier < best.upper else best.mechanism,
            [*best.meshes, this],
            mesh,
        )
        if observer:
            observer(best)
        ended = limits.reached(best, len(problem.mesh.cells))
        if ended == "gap":
            return replace(best, ended=ended)
        indicator = refinement_indicator(problem, low, high)
        if ended:
            worst = problem.points[problem.mesh.cells[np.argmax(indicator)]].mean(axis=0)
            return replace(best, ended=ended, open_at=(float(worst[0]), float(worst[1])))
        growth = limits.growth(best, len(problem.mesh.cells))
        mesh, parent = fan_out(problem.mesh_in_metres, singular_points(problem, low), NARROW_ANGLE)
        mesh = refined(mesh, indicator[parent] / np.bincount(parent)[parent], growth * len(indicator))


def proven_lower_bound(problem: LimitProblem) -> tuple[LowerBound, list[str], StressField | None]:
    """The stress field that was found, what went wrong, and the same as a strict bound if it passes its check."""

    def attempt(more_margin: np.ndarray | float, again: bool) -> tuple[LowerBound, StressCheck]:
        found = lower_bound(problem, more_margin, again)
        return found, check_stress(problem, found.stress, found.multiplier)

    # More margin from the cone does not help where a cut-off is passed, from which no margin can be kept.
    attempts = 1 if np.isfinite(problem.tension).any() else ATTEMPTS
    found, check, notes = _first_that_holds("lower bound", attempt, attempts)
    return found, notes, StressField(problem, found.multiplier, found.stress, check) if check else None


def proven_upper_bound(problem: LimitProblem) -> tuple[UpperBound, list[str], Mechanism | None]:
    """The mechanism that was found, what went wrong, and the same as a strict bound if it passes its check.

    Ground of φ > 45° cannot strain where it lies in a corner of held sides, far into the section the more the steeper φ
    is, and may leave the solver nothing to find. Such ground is held then.
    """

    def attempt(
        more_margin: np.ndarray | float, again: bool, rigid: np.ndarray | None = None
    ) -> tuple[UpperBound, VelocityCheck]:
        found = upper_bound(problem, more_margin, again, rigid)
        return found, check_velocity(problem, found.velocity)

    steep = problem.friction > STEEP
    some = bool(steep.any() and not steep.all())
    found, check, notes = _first_that_holds("upper bound", attempt, 1 if some else ATTEMPTS)
    if check is None and some and found.solution.none != "no stress":
        before = found.solution.iterations
        found, check, more_notes = _first_that_holds("upper bound, steep ground held", partial(attempt, rigid=steep))
        found = replace(found, solution=replace(found.solution, iterations=before + found.solution.iterations))
        notes += more_notes
    return found, notes, Mechanism(problem, check.multiplier, found.velocity, check) if check else None


F = TypeVar("F", LowerBound, UpperBound)
C = TypeVar("C", StressCheck, VelocityCheck)


def _first_that_holds(
    name: str, attempt: Callable[[np.ndarray | float, bool], tuple[F, C]], attempts: int = ATTEMPTS
) -> tuple[F, C | None, list[str]]:
    """The first of a few attempts whose check holds, None for the check if none does.

    The solver meets equations and margins nearly, and what corrects the equations may lead beyond the yield surface or
    against the flow rule. The next attempt keeps away from these, corner by corner, by some times what the last one
    fell short of its margin, and is made with more regularisation where the solver broke down.
    """
    notes: list[str] = []
    iterations = 0
    more_margin: np.ndarray | float = 0.0
    for _ in range(attempts):
        found, check = attempt(more_margin, bool(notes))
        iterations += found.solution.iterations
        found = replace(found, solution=replace(found.solution, iterations=iterations))  # the work of all attempts
        if found.solution.none:
            return found, None, [f"{name}: {NONE_FOUND[found.solution.none]}"]
        if found.solution.ended:
            notes.append(f"{name}: the solver ended early ({found.solution.ended})")
        if check.holds:
            return found, check, notes
        more_margin = more_margin + SHORTFALLS * np.nan_to_num(found.shortfall)
    return found, None, [*notes, f"{name} refused: {check}"]


NONE_FOUND = {
    "no stress": "no stress field on this mesh is in equilibrium with the dead load",
    "no mechanism": "in no mechanism on this mesh does the live load do work",
}


def gap_shares(problem: LimitProblem, low: LowerBound, high: UpperBound) -> np.ndarray:
    """What every cell (m,) adds to the gap: its dissipation less the work of the lower bound's stress on its strain.

    None is negative, but for rounding, and they add up to upper less lower bound (Ciria, Peraire & Bonet 2008).
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
    """Indicator (m,) of every cell for refinement: its share of the gap, and of the yield work of the lower bound.

    The latter need not be near the mechanism of the upper bound: too coarse a stress field at one corner can keep the
    lower bound down, or leave none.
    """
    shares = gap_shares(problem, low, high)
    shares = shares / max(shares.sum(), 1e-300)
    if (total := low.yield_work.sum()) > 0.0:
        shares = shares + YIELD_WORK_WEIGHT * low.yield_work.sum(axis=1) / total
    return np.nan_to_num(shares)  # a solver that ended early may leave no numbers


def singular_points(problem: LimitProblem, low: LowerBound) -> np.ndarray:
    """Points (n,), as a mask, at which the stress would turn faster than the cells that meet there can follow.

    The edge of a footing is one: its few cells keep the lower bound down, however small they are.
    """
    points = problem.mesh.cells.ravel()
    work = np.bincount(points, weights=low.yield_work.ravel(), minlength=len(problem.mesh.points))
    singular = work > max(SINGULAR_SHARE * work.sum(), SINGULAR_TIMES * work.mean())
    return singular


def refined(mesh: TriMesh, indicator: np.ndarray, wanted: float) -> TriMesh:
    """The mesh with about ``wanted`` cells, bisected where the ``indicator`` (m,) is largest."""
    while len(mesh.cells) < 0.95 * wanted:
        order = np.argsort(-indicator, kind="stable")
        enough = int(np.searchsorted(np.cumsum(indicator[order]), BULK_SHARE * indicator.sum())) + 1
        most = max(1, int((wanted - len(mesh.cells)) / 1.5))
        mesh, parent = bisect(mesh, order[: min(enough, most)])
        halves = np.bincount(parent)[parent]
        indicator = indicator[parent] * np.where(halves > 1, 2.0 * HALF_SHARE / halves, 1.0)
    return mesh
