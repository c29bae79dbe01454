"""Searches the factor of safety in one direction by bounds of the critical Kh of weakened ground."""

import math
from dataclasses import replace
from functools import partial

import numpy as np

from fem.limit.adaptive_bounds import (
    NARROW_ANGLE,
    proven_lower_bound,
    proven_upper_bound,
    refined,
    refinement_indicator,
    singular_points,
)
from fem.limit.bounds import body_of
from fem.limit.bracket import COST_EXPONENT, FAILED_MESHES, GROWTH, LEAST_GROWTH, MOST_GROWTH, BoundSide
from fem.limit.factor_trial import BoundsTrial, FactorWork, Gauge, TrialStart, gap_of_factors, inside, root_of
from fem.limit.limit_problem import LimitProblem, limit_problem, units_of, with_all_loads_live
from fem.limit.lower_bound import LowerBound
from fem.limit.upper_bound import UpperBound
from fem.settings import BoundsSettings, FemSettings
from fem.solvers.blas_threads import one_more_thread
from fem.solvers.cone_program import NEAR, Solution, Warm
from meshes.bisection import fan_out
from meshes.section.section import Section
from meshes.triangles import TriMesh

# The largest and smallest factor looked for, and by how much it changes at most from trial to trial.
SMALLEST, LARGEST, STEP = 0.02, 20.0, 1.6
# Trials on one mesh, and how close (of the factor) a trial is to where the secant puts the bound: a little to the safe
# side of it, so that it proves. The solver leaves 6e-5 of Kh open, which is 0.0003 of the factor where Kh falls by 0.2
# for each logarithm of it.
TRIALS, MARGIN = 10, 0.0005
# The same for proofs on triangles that are not the last ones: there one trial proves where the small margin took two or
# three, and finer triangles have a closer bound.
ROUGH_MARGIN = 0.005
# Trials, at most, that prove a bound on one mesh.
PROOFS = 4
# A factor is good enough to refine at when the middle of the bounds is this close, or this close over what they leave
# open: 0.5 is where the lower bound is.
CLOSE, OPEN = 0.015, 0.6
# On finer triangles the lower bound rises by about this share of what the bounds leave open: there the first trial is.
RISE = 0.05
# A bound is proven on triangles that are not the last ones where what is proven is so far (of the factor) from it.
FALLBACK = 0.05
# A Kh, or a logarithm of a share of loads, this far from what is to be borne says nothing on the factor.
FAR = 1.0

# The gap falls more slowly than the number of triangles rises: it is aimed at so much beyond it, since triangles that
# miss it by little are made again. If so many times more triangles reach it, and are allowed, they are made at once,
# without those between: six of eight sections took 6 to 30 % less work than with three times and an aim of 1.3, and two
# that used up their work came as close or closer.
AIM, FURTHEST_GROWTH = 1.15, 4.5
# Work that finer triangles take, over that of both bounds at one factor: these, and proofs begun from them.
WORK_OF_A_MESH = 1.5


class FactorSearch:
    """Searches bounds of the factor of safety at ``kh``, with the seismic force to one side."""

    def __init__(
        self,
        section: Section,
        mesh: TriMesh,
        fem: FemSettings,
        settings: BoundsSettings,
        sign: int,
        start: TrialStart,
        work: FactorWork,
    ) -> None:
        """Prepare the search in ``section`` on ``mesh``, with settings ``fem`` of the elements and ``settings`` of the
        bounds.

        ``sign`` is 1 for the direction of the seismic force in ``fem``, -1 for the opposite direction; ``start``
        contains Kh and the first factor; ``work`` is the computing work allowed.
        """
        body = body_of(section, mesh, fem, excess_pressure=start.kh != 0.0, smooth_sides=start.smooth_sides)
        self.body = replace(body, live_force=sign * body.live_force)
        self.units = units_of(mesh, self.body)
        self.mesh, self.settings, self.work = mesh, settings, work
        self.target, self.factor = sign * start.kh, start.factor
        self.enough, self.slips = start.enough, start.slips
        self.meshes, self.mesh_of_lower = [mesh], mesh
        self.lower, self.upper = 0.0, math.inf
        self.trials: list[BoundsTrial] = []
        self.slope: float | None = None
        self.gauge: Gauge = "kh"
        self.both_ways = False  # whether the lower bound is one for either direction of the push
        self.places: dict[BoundSide, tuple[float, Warm | None]] = {}
        self.failures: dict[BoundSide, int] = {"lower": 0, "upper": 0}  # of the solver, one after the other
        self.unborne_from = math.inf  # from this factor on no stress on this mesh balances the loads
        self.seen: tuple[LimitProblem, LowerBound, UpperBound] | None = None  # the last trial of both bounds

    def find(self) -> None:
        """Bracket the factor of safety on ever finer triangles."""
        while True:
            self.settle()
            beyond = self.lower >= LARGEST or self.upper <= SMALLEST
            last = self.mesh_is_full or self.solver_fails or not self.has_work_for_finer
            if not (beyond or self.is_enough or self.solver_fails):
                self.prove_both(last or self.open_here <= self.settings.gap - 2.0 * MARGIN)
            if self.good or last or beyond or self.is_enough:
                return
            self.refine()

    def confirms(self, other: "FactorSearch") -> bool:
        """Return whether the lower bound of the ``other`` direction is proven for this one on the finest triangles.

        To prove that the other direction governs mostly requires far fewer triangles than its bounds. If the proof
        fails, the factor of this direction is searched for, on triangles refined for its mechanism.
        """
        if other.both_ways:
            self.lower = other.lower
        if self.lower < other.lower:
            self.measure(other.lower, upper=False)
        if self.lower < other.lower and self.mesh is not other.mesh:
            self.mesh, self.unborne_from = other.mesh, math.inf
            self.measure(other.lower, upper=False)
        while self.lower < other.lower:
            self.measure(other.lower)
            if self.upper <= other.lower or self.mesh_is_full or self.solver_fails or not self.has_work_for_finer:
                break
            self.refine()
        return 0.0 < other.lower <= self.lower

    @property
    def gap(self) -> float:
        """Return the upper less lower factor over their mean, inf if one is missing."""
        return gap_of_factors(self.lower, self.upper)

    @property
    def is_enough(self) -> bool:
        """Return whether one of the bounds is already sufficient (see ``TrialStart``)."""
        return self.lower >= self.enough or self.upper < self.slips

    @property
    def open_here(self) -> float:
        """Return the relative gap of the factor on these triangles, estimated by secants through all trials; inf if
        unknown.
        """
        ends = self.root("lower"), self.root("upper")
        return math.log(ends[1] / ends[0]) if all(math.isfinite(end) for end in ends) else math.inf

    @property
    def good(self) -> bool:
        return self.gap <= self.settings.gap

    @property
    def mesh_is_full(self) -> bool:
        return self.settings.max_cells < 1.2 * len(self.mesh.cells)

    @property
    def solver_fails(self) -> bool:
        """Return whether the solver ended early at the same bound in several trials in a row, as it would again."""
        return max(self.failures.values()) >= FAILED_MESHES

    @property
    def has_work_for_finer(self) -> bool:
        return self.work.allows(WORK_OF_A_MESH * GROWTH**COST_EXPONENT * self.work_of_both)

    @property
    def work_of_both(self) -> float:
        """Return the computing work of both bounds at one factor on the present triangles."""
        return max(trial.work for trial in self.here)

    def problem(self, factor: float) -> LimitProblem:
        varying = self.body.varying
        weak = replace(
            self.body,
            cohesion=self.body.cohesion / factor,
            varying=None if varying is None else lambda mesh, above: varying(mesh, above) / factor,
            friction=np.arctan(np.tan(self.body.friction) / factor),
            tension=None if self.body.tension is None else self.body.tension / factor,
        )
        problem = limit_problem(self.mesh, weak, self.units)
        return problem if self.gauge == "kh" else with_all_loads_live(problem, self.target)

    def over(self, bound: float) -> float:
        """Return the excess of a bound: of Kh over the given Kh, or the logarithm of the share of loads resisted."""
        if self.gauge == "kh":
            return bound - self.target
        return math.log(bound) if bound > 0.0 else -math.inf

    def measure(self, factor: float, lower: bool = True, upper: bool = True) -> BoundsTrial:
        """Find bounds for ground of reduced strength, and narrow the bracket of the factor of safety."""
        lower = lower and factor < self.unborne_from
        before = self.work.spent
        problem = self.problem(factor)
        low = high = stress = mechanism = None
        left = self.work.left / (2.0 if lower and upper else 1.0)
        with one_more_thread(lower and upper) as executor:
            above = partial(proven_upper_bound, problem, left, self.place("upper", factor))
            future = executor.submit(above) if upper else None
            if lower:
                low, _, stress = proven_lower_bound(problem, left, self.place("lower", factor))
                self.count("lower", factor, low.solution, stress is None)
            if future is not None:
                high, _, mechanism = future.result()
                self.count("upper", factor, high.solution, mechanism is None)
        unmoved = high is not None and high.solution.none == "no mechanism"
        trial = BoundsTrial(
            factor,
            len(problem.mesh.cells),
            self.gauge,
            stress.multiplier if stress else None,
            mechanism.multiplier if mechanism else math.inf if unmoved and self.gauge == "loads" else None,
            low is not None and low.solution.none == "no stress",
            self.work.spent - before,
        )
        if low is not None and high is not None:
            self.seen = (problem, low, high)
        elif trial.unborne and low is not None and self.seen and len(self.seen[1].stress) == len(low.stress):
            self.seen = (self.seen[0], low, self.seen[2])  # what keeps stress from balancing the loads wants triangles
        if trial.lower is not None and self.over(trial.lower) >= 0.0:
            self.both_ways = self.gauge == "loads" if factor > self.lower else self.both_ways
            self.mesh_of_lower = self.mesh if factor > self.lower else self.mesh_of_lower
            self.lower = max(self.lower, factor)
        if trial.upper is not None and self.over(trial.upper) <= 0.0:
            self.upper = min(self.upper, factor)
        self.trials.append(trial)
        return trial

    def count(self, side: BoundSide, factor: float, solution: Solution, unproven: bool) -> None:
        """Count a trial: add its computing work, store its solution as the next starting point, and count consecutive
        trials in which the solver found neither a bound nor a proof that there is none. ``side`` names the bound;
        ``factor`` is the factor of safety tried; ``solution`` is the answer of the solver; ``unproven`` means that the
        answer decided nothing.
        """
        self.work.spent += solution.work
        self.work.ran_out = self.work.ran_out or solution.out_of_work
        self.places[side] = factor, solution.warm
        self.failures[side] = self.failures[side] + 1 if unproven and not (solution.none or solution.out_of_work) else 0

    def place(self, side: BoundSide, factor: float) -> Warm | None:
        """Return the solution of the last trial as starting point of the solver, if its factor is close enough."""
        last, place = self.places.get(side, (factor, None))
        return place if abs(math.log(factor / last)) < NEAR else None

    def settle(self) -> None:
        """Try factors of safety on this mesh until their bracket is within the required gap."""
        last = self.regauged(self.measure(self.factor))
        safe, unsafe = 0.0, math.inf
        for _ in range(TRIALS):
            middle = self.middle(last)
            step = 1.0 / STEP if middle < -FAR else self.step(middle)
            if self.is_enough or self.solver_fails or not self.work.allows(last.work):
                return
            if self.slope is not None and abs(math.log(step)) < max(CLOSE, OPEN * self.gap_of(last)):
                break
            safe, unsafe = (last.factor, unsafe) if middle >= 0.0 else (safe, last.factor)
            self.factor = float(np.clip(inside(last.factor * step, safe, unsafe), SMALLEST, LARGEST))
            if self.factor == last.factor:  # at an end of what is looked for
                break
            trial = self.regauged(self.measure(self.factor))
            self.learn(last, trial)
            last = trial

    def regauged(self, trial: BoundsTrial) -> BoundsTrial:
        """Return a trial with bounds of Kh or, if they decide nothing, with bounds of the share of all loads. Bounds of
        Kh decide nothing if no mechanism fails below the given Kh and yet no stress field balances the weight, as below
        a footing.
        """
        fails_late = trial.upper is not None and self.over(trial.upper) > 0.0
        if self.gauge == "loads" or not (trial.unborne and fails_late):
            return trial
        self.gauge, seen = "loads", self.seen
        loaded = self.measure(trial.factor)
        if loaded.lower is None:
            self.gauge, self.seen = "kh", seen
            self.unborne_from = trial.factor
            return trial
        self.slope = None
        return loaded

    def middle(self, trial: BoundsTrial) -> float:
        """Return the mean excess of both bounds over the required value, or the excess of the only bound; -inf without
        any."""
        values = [self.over(bound) for bound in (trial.lower, trial.upper) if bound is not None]
        return sum(values) / len(values) if values else -math.inf

    def gap_of(self, trial: BoundsTrial) -> float:
        """Return the relative gap between the factors of safety that the lower and the upper bound of a trial give."""
        if trial.lower is None or trial.upper is None or self.slope is None:
            return 0.0
        return (self.over(trial.lower) - self.over(trial.upper)) / self.slope

    def learn(self, before: BoundsTrial, now: BoundsTrial) -> None:
        """Update the derivative of the excess with respect to the logarithm of the factor, from the trials so far."""
        if before.cells != now.cells or before.factor == now.factor or before.gauge != now.gauge:
            return
        for side in ("upper", "lower"):
            ends = [getattr(trial, side) for trial in (before, now)]
            first, second = (-math.inf if end is None else self.over(end) for end in ends)
            if max(abs(first), abs(second)) < FAR:
                slope = (second - first) / math.log(now.factor / before.factor)
                if slope < 0.0:
                    self.slope = slope
                    return

    def step(self, over: float) -> float:
        """Return the ratio of the next factor to the present factor, if a bound at the present factor exceeds the
        required value by ``over``."""
        if self.slope is None:
            log_step = (2.0 if self.gauge == "kh" else 1.0) * over
            log_step = math.copysign(max(abs(log_step), 0.05), log_step)
        else:
            log_step = -over / self.slope
        return math.exp(float(np.clip(log_step, -math.log(STEP), math.log(STEP))))

    def prove_both(self, finally_: bool) -> None:
        """Prove the upper bound, which takes less work, then the lower bound.

        On the last triangles (``finally_``) the required gap has to be reached. Earlier triangles prove bounds only if
        little is proven yet, since the solver may fail on finer triangles, or if the upper bound decides.
        """
        sides: tuple[tuple[BoundSide, float], ...] = (("upper", 1.0), ("lower", -1.0))
        for side, sense in sides:
            root, proven = self.root(side), getattr(self, side)
            known = 0.0 < proven < math.inf and math.isfinite(root)
            decides = side == "upper" and root * math.exp(MARGIN) < self.slips
            if finally_ or decides or not known or abs(math.log(root / proven)) > FALLBACK:
                self.prove(side, sense, finally_)

    def prove(self, side: BoundSide, sense: float, finally_: bool = True) -> None:
        """Prove a bound by trials a little to the safe side of the estimated factor until no better bound is proven.
        The lower bound takes most of the work, so that its trials end as soon as the gap is small enough. Without an
        estimate, the interval of the factor is bisected. Where no stress has balanced the loads yet, the factor is
        reduced, but only once on triangles that are not the last ones (``finally_``).
        """
        last, work = self.trials[-1].factor, 0.5 * min(trial.work for trial in self.here)  # of one bound, at least
        decides = not self.slips <= self.root(side) * math.exp(sense * MARGIN) < self.enough
        margin = MARGIN if finally_ or decides else ROUGH_MARGIN
        for times in range(1, PROOFS + 1):
            proven = getattr(self, side)
            at = self.root(side) * math.exp(sense * times * margin)
            unborne = min((trial.factor for trial in self.here if side == "lower" and trial.unborne), default=math.inf)
            if math.isnan(at) and proven == 0.0:
                if times > 1 and not finally_:
                    return
                at = min(last, unborne) * STEP ** (-0.5 * times)
            elif math.isnan(at) or self.trials[-1].factor == unborne:
                at = math.sqrt(min(last, unborne) * proven)
            elif not sense * (at - proven * math.exp(-sense * margin)) < 0.0:
                return
            if (self.good and side == "lower") or not SMALLEST < at < LARGEST or not self.work.allows(work):
                return
            self.measure(at, side == "lower", side == "upper")

    @property
    def here(self) -> list[BoundsTrial]:
        """Return the trials on the present triangles."""
        last = self.trials[-1]
        return [trial for trial in self.trials if (trial.cells, trial.gauge) == (last.cells, last.gauge)]

    def root(self, side: BoundSide) -> float:
        """Return the factor at which a bound meets the required value, by a secant; NaN if unknown."""
        return root_of(self.points(side), self.slope, math.log(STEP))

    def points(self, side: BoundSide) -> list[tuple[float, float]]:
        """Return ln F and the excess of the bound (see ``over``) of every trial on the present triangles."""
        bounds = [(trial.factor, getattr(trial, side)) for trial in self.here]
        points = [(math.log(factor), self.over(bound)) for factor, bound in bounds if bound is not None]
        return sorted(point for point in points if abs(point[1]) < FAR)

    def refine(self) -> None:
        """Refine the triangles where the bounds of the last trial differ, by enough cells to close the gap if one step
        can do that. The margins of the bounds are unchanged.
        """
        assert self.seen is not None  # both bounds were tried on these triangles
        problem, low, high = self.seen
        indicator = refinement_indicator(problem, low, high)
        mesh, parent = fan_out(problem.mesh_in_metres, singular_points(problem, low), NARROW_ANGLE)
        margins = 2.0 * MARGIN
        needed = AIM * min(self.gap, self.open_here) / max(self.settings.gap - margins, margins)
        allowed = self.settings.max_cells / len(problem.mesh.cells)
        at_once = FURTHEST_GROWTH if needed <= allowed else MOST_GROWTH
        affordable = (self.work.left / (WORK_OF_A_MESH * self.work_of_both)) ** (1.0 / COST_EXPONENT)
        allowed = min(allowed, max(affordable, GROWTH))
        growth = min(max(needed, LEAST_GROWTH) if needed <= at_once else GROWTH, allowed)
        lower = self.root("lower")
        if math.isfinite(lower):
            rise = RISE * self.open_here if math.isfinite(self.open_here) else 0.0
            self.factor = float(np.clip(lower * math.exp(rise), SMALLEST, LARGEST))
        self.unborne_from = math.inf
        self.mesh = refined(mesh, indicator[parent] / np.bincount(parent)[parent], growth * len(indicator))
        self.meshes.append(self.mesh)
