"""Both bounds on meshes that are refined where the gap between them is."""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fem.limit.bound_checks import StressCheck, VelocityCheck, check_stress, check_velocity, corner_rates, dissipation
from fem.limit.limit_problem import Ground, LimitProblem, limit_problem, units_of
from fem.limit.lower_bound import STRESS_MARGIN, LowerBound, lower_bound
from fem.limit.upper_bound import STRAIN_MARGIN, UpperBound, upper_bound
from meshes.bisection import bisect, fan_out
from meshes.triangles import TriMesh

# From mesh to mesh: how many times as many cells, and which share of the gap the cells to divide make up.
GROWTH, SHARE = 2.0, 0.5
# Weight of where the lower bound is stuck beside the parts of the gap.
STUCK_SHARE = 0.5
# Share of one point in all that holds the lower bound down, and how many times the mean of all points this is, at which
# the cells round it are halved from there; and the angle (rad) at which they are narrow enough. The share is 1 at the
# edge of a footing; at the toe of a slope it is below 0.2 and falls, and narrow cells would be lost to the upper bound.
STUCK_POINT, STUCK_TIMES, NARROW = 0.03, 20.0, 0.1
# What a bisection leaves of a cell's part of the gap in each half, as far as choosing the next cells goes.
LEFT_IN_HALF = 0.3
# How much more margin a second attempt gets where rounding led out of the yield surface or the flow rule.
MORE_MARGIN = 10.0


@dataclass(frozen=True, eq=False)
class Stress:
    """A stress field (m, 3 corners, [xx, yy, xy]), dimensionless, that was found to hold its multiplier."""

    problem: LimitProblem
    multiplier: float
    stress: np.ndarray
    check: StressCheck


@dataclass(frozen=True, eq=False)
class Mechanism:
    """Velocities (m, 6 nodes, 2), dimensionless, that were found to bound the multiplier."""

    problem: LimitProblem
    multiplier: float
    velocity: np.ndarray
    check: VelocityCheck

    @property
    def dissipation(self) -> np.ndarray:
        """Dissipation (m,) of every cell."""
        return dissipation(self.problem, corner_rates(self.problem, self.velocity))


@dataclass(frozen=True)
class Round:
    """One mesh: its cells, the bounds on it (None where there is none), what is to be said of them, and seconds."""

    cells: int
    lower: float | None
    upper: float | None
    notes: tuple[str, ...]
    seconds: float


@dataclass(frozen=True, eq=False)
class Bracket:
    """The best of both bounds over all meshes, None where there is none."""

    stress: Stress | None
    mechanism: Mechanism | None
    rounds: list[Round]
    mesh: TriMesh

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


Progress = Callable[[Bracket], None]


def bracket(
    mesh: TriMesh,
    ground: Ground,
    gap: float,
    max_cells: int,
    progress: Progress | None = None,
    useless: float = -np.inf,
) -> Bracket:
    """Lower and upper bound of the multiplier on ever finer meshes, until the gap or the number of cells is reached or
    the multiplier is known to be below ``useless``."""
    units = units_of(mesh, ground)
    best = Bracket(None, None, [], mesh)
    while True:
        started = time.perf_counter()
        problem = limit_problem(mesh, ground, units)
        low, low_notes, stress = proven_lower_bound(problem)
        high, high_notes, mechanism = proven_upper_bound(problem)
        this = Round(
            len(problem.mesh.cells),
            stress.multiplier if stress else None,
            mechanism.multiplier if mechanism else None,
            (*low_notes, *high_notes),
            time.perf_counter() - started,
        )
        best = Bracket(
            stress if stress and stress.multiplier > best.lower else best.stress,
            mechanism if mechanism and mechanism.multiplier < best.upper else best.mechanism,
            [*best.rounds, this],
            mesh,
        )
        if progress:
            progress(best)
        room = max_cells / len(problem.mesh.cells)
        if best.gap <= gap or best.upper < useless or room < 1.2:
            return best
        parts = worth_dividing(problem, low, high)
        mesh, parent = fan_out(problem.mesh_in_metres, stuck_points(problem, low), NARROW)
        mesh = refined(mesh, parts[parent] / np.bincount(parent)[parent], min(GROWTH, room) * len(parts))


def proven_lower_bound(problem: LimitProblem) -> tuple[LowerBound, list[str], Stress | None]:
    """What the solver found, what is to be said of it, and the stress if it proves its multiplier a lower bound.

    A stress past the yield surface is looked for anew with more margin, and refused if that does not do.
    """
    notes: list[str] = []
    for margin in (STRESS_MARGIN, MORE_MARGIN * STRESS_MARGIN):
        found = lower_bound(problem, margin)
        if found.solution.none:
            return found, ["lower bound: no stress of this mesh carries the load that stays"], None
        check = check_stress(problem, found.stress, found.multiplier)
        if found.solution.ended:
            notes.append(f"lower bound: the solver ended early ({found.solution.ended})")
        if check.holds:
            return found, notes, Stress(problem, found.multiplier, found.stress, check)
    notes.append(f"lower bound refused: {check}")
    return found, notes, None


def proven_upper_bound(problem: LimitProblem) -> tuple[UpperBound, list[str], Mechanism | None]:
    """What the solver found, what is to be said of it, and the mechanism if it proves an upper bound."""
    notes: list[str] = []
    for margin in (STRAIN_MARGIN, MORE_MARGIN * STRAIN_MARGIN):
        found = upper_bound(problem, margin)
        if found.solution.none:
            return found, ["upper bound: no mechanism of this mesh lets the load do work"], None
        check = check_velocity(problem, found.velocity)
        if found.solution.ended:
            notes.append(f"upper bound: the solver ended early ({found.solution.ended})")
        if check.holds:
            return found, notes, Mechanism(problem, check.multiplier, found.velocity, check)
    notes.append(f"upper bound refused: {check}")
    return found, notes, None


def gap_parts(problem: LimitProblem, low: LowerBound, high: UpperBound) -> np.ndarray:
    """What every cell (m,) adds to the gap: its dissipation less the work of the lower bound's stress on its strain.

    None is negative, but for rounding, and they add up to upper less lower bound (Ciria, Peraire & Bonet 2008).
    """
    if high.solution.none:
        return problem.mesh.areas
    rates = corner_rates(problem, high.velocity)
    parts = dissipation(problem, rates)
    if not low.solution.none:
        mass = (np.ones((3, 3)) + np.eye(3)) / 12.0  # of linear fields over a triangle
        parts = parts - problem.mesh.areas * np.einsum("mki,kl,mli->m", low.stress, mass, rates)
    return np.maximum(parts, 0.0)


def worth_dividing(problem: LimitProblem, low: LowerBound, high: UpperBound) -> np.ndarray:
    """Share of every cell (m,) in what keeps the bounds apart: its part of the gap, and where the lower bound is stuck.

    The latter need not be near the mechanism of the upper bound: too few stresses at one corner can hold it down.
    """
    parts = gap_parts(problem, low, high)
    parts = parts / max(parts.sum(), 1e-300)
    if not low.solution.none and (total := low.price.sum()) > 0.0:
        parts = parts + STUCK_SHARE * low.price.sum(axis=1) / total
    return np.nan_to_num(parts)  # a solver that ended early may leave no numbers


def stuck_points(problem: LimitProblem, low: LowerBound) -> np.ndarray:
    """Points (n,) at which too few cells meet, so that they hold the lower bound down, as at a footing's edge."""
    price = np.bincount(problem.mesh.cells.ravel(), weights=low.price.ravel(), minlength=len(problem.mesh.points))
    blocks = price > max(STUCK_POINT * price.sum(), STUCK_TIMES * price.mean())
    return blocks & (not low.solution.none)


def refined(mesh: TriMesh, parts: np.ndarray, wanted: float) -> TriMesh:
    """The mesh with about ``wanted`` cells, divided where the ``parts`` (m,) are largest."""
    while len(mesh.cells) < 0.95 * wanted:
        order = np.argsort(-parts, kind="stable")
        enough = int(np.searchsorted(np.cumsum(parts[order]), SHARE * parts.sum())) + 1
        most = max(1, int((wanted - len(mesh.cells)) / 1.5))
        mesh, parent = bisect(mesh, order[: min(enough, most)])
        halves = np.bincount(parent)[parent]
        parts = parts[parent] * np.where(halves > 1, 2.0 * LEFT_IN_HALF / halves, 1.0)
    return mesh
