"""Bounds the critical Kh of ground whose strength is divided by trial factors, and keeps the trials."""

import math
from dataclasses import replace
from functools import partial

import numpy as np

from fem.continuum.loads import direction_of
from fem.limit.adaptive_bounds import proven_lower_bound, proven_upper_bound, share_of_lower_bound
from fem.limit.bracket import BoundSide
from fem.limit.factor_trial import (
    BoundsTrial,
    FactorWork,
    LoadMultiplier,
    TrialStart,
    gap_of_factors,
    known_at_full_strength,
    root_of,
)
from fem.limit.limit_problem import LimitProblem, limit_problem, units_of, with_all_loads_live
from fem.limit.lower_bound import LowerBound
from fem.limit.section_body import body_of
from fem.limit.upper_bound import UpperBound
from fem.settings import BoundsSettings, FemSettings
from fem.solvers.blas_threads import one_more_thread
from fem.solvers.cone_program import NEAR, Solution, Warm
from meshes.section.section import Section
from meshes.triangles import TriMesh

# Largest ratio of the factors of two trials in succession.
LARGEST_FACTOR_RATIO = 1.6
# Largest excess of Kh, or of the logarithm of a share of loads, from which a factor is estimated.
LARGEST_EXCESS = 1.0
# Excess of a lower bound of Kh up to which, and of the upper bound from which, the lower bound may be independent of
# the factor. It is, if the logarithm of the share of loads that the ground resists is at least the last number.
FLAT_LOWER_EXCESS, FLAT_UPPER_EXCESS, FLAT_LOAD_EXCESS = 1e-4, 0.01, 0.005
# Smallest step (in ln F) between trials from which a slope follows: the solver leaves 6e-5 of Kh open.
LEAST_STEP_OF_SLOPE = 0.02
SIDES: tuple[BoundSide, BoundSide] = ("upper", "lower")
# Largest ratio of the bounds of the share of loads with which this share decides. Friction resists a share without
# limit: of a dam of sand on coarse triangles the bounds were 0.1 and 15 where the dam stood with 0.95 of that factor.
LARGEST_LOAD_RATIO = 4.0


class WeakenedGround:
    """Holds ground on triangles, and the bounds of its critical Kh at every factor by which its strength was divided,
    with the seismic force to one side.
    """

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
        """Prepare trials of ``section`` on ``mesh``, with settings ``fem`` of the elements and ``settings`` of the
        bounds.

        ``sign`` is 1 for the direction of the seismic force in ``fem``, -1 for the opposite direction; ``start``
        contains Kh and the first factor; ``work`` is the computing work allowed.
        """
        body = body_of(section, mesh, fem, excess_pressure=start.kh != 0.0, smooth_sides=start.smooth_sides)
        self.body = replace(body, live_force=sign * body.live_force)
        self.units = units_of(mesh, self.body)
        self.mesh, self.settings, self.work = mesh, settings, work
        self.target, self.factor = sign * start.kh, start.factor
        self.lower_suffices, self.upper_suffices = start.lower_suffices, start.upper_suffices
        self.meshes, self.mesh_of_lower = [mesh], mesh
        self.lower, self.upper = 0.0, math.inf
        self.trials: list[BoundsTrial] = []
        self.slope: float | None = None
        self.multiplier_kind: LoadMultiplier = "kh"
        self.holds_in_both_directions = False  # whether the lower bound is one for both directions of the seismic force
        self.starting_points: dict[BoundSide, tuple[float, Warm | None]] = {}
        self.failures: dict[BoundSide, int] = {"lower": 0, "upper": 0}  # of the solver, one after the other
        self.no_equilibrium_from = math.inf  # from this factor on no stress on this mesh balances the loads
        self.last_of_both: tuple[LimitProblem, LowerBound, UpperBound] | None = None  # the last trial of both bounds
        self.last_upper: UpperBound | None = None
        self.known_at_full_strength = known_at_full_strength(start, mesh, direction_of(fem, opposite=sign < 0))
        self.expected_bounds: tuple[float, float] | None = None  # factors that may prove both bounds on this mesh
        self.open_before: tuple[int, float] | None = None  # number of cells and relative gap of the mesh before

    @property
    def gap(self) -> float:
        """Return the upper less lower factor over their mean, inf if a factor is missing."""
        return gap_of_factors(self.lower, self.upper)

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
        return problem if self.multiplier_kind == "kh" else with_all_loads_live(problem, self.target)

    def excess(self, bound: float) -> float:
        """Return the excess of a bound: of Kh over the given Kh, or the logarithm of the share of loads resisted."""
        if self.multiplier_kind == "kh":
            return bound - self.target
        return math.log(bound) if bound > 0.0 else -math.inf

    def measure(
        self, factor: float, lower: bool = True, upper: bool = True, upper_factor: float | None = None
    ) -> BoundsTrial:
        """Find bounds for ground of reduced strength, and narrow the bracket of the factor of safety.

        With an ``upper_factor`` the upper bound is that of ground weakened by this factor; the trial of the lower bound
        is returned.
        """
        lower = lower and factor < self.no_equilibrium_from
        before = self.work.spent
        problem = self.problem(factor)
        above_problem = problem if upper_factor is None else self.problem(upper_factor)
        low = high = stress = mechanism = None
        share = share_of_lower_bound(*self.last_of_both[1:]) if self.last_of_both else 0.5
        of_lower, of_upper = (share, 1.0 - share) if lower and upper else (1.0, 1.0)
        left = self.work.left
        with one_more_thread(lower and upper) as executor:
            above = partial(
                proven_upper_bound,
                above_problem,
                of_upper * left,
                self.starting_point("upper", upper_factor or factor),
                self.last_upper,
            )
            future = executor.submit(above) if upper else None
            if lower:
                low, _, stress = proven_lower_bound(problem, of_lower * left, self.starting_point("lower", factor))
                self.count("lower", factor, low.solution, stress is None)
            if future is not None:
                high, _, mechanism = future.result()
                self.last_upper = high
                self.count("upper", upper_factor or factor, high.solution, mechanism is None)
        unmoved = high is not None and high.solution.none == "no mechanism"
        trial = BoundsTrial(
            factor,
            len(problem.mesh.cells),
            self.multiplier_kind,
            stress.multiplier if stress else None,
            mechanism.multiplier if mechanism else math.inf if unmoved and self.multiplier_kind == "loads" else None,
            low is not None and low.solution.none == "no stress",
            self.work.spent - before,
        )
        if upper_factor is None or low is None or high is None:
            self.keep(problem, trial, low, high)
            return trial
        work_above = high.solution.work
        of_lower_bound = replace(trial, upper=None, work=trial.work - work_above)
        self.keep(problem, of_lower_bound, low, None)
        self.keep(above_problem, replace(trial, factor=upper_factor, lower=None, work=work_above), None, high)
        self.last_of_both = (problem, low, high)  # the factors are close, and the triangles are refined by both
        return of_lower_bound

    def keep(
        self, problem: LimitProblem, trial: BoundsTrial, stress: LowerBound | None, velocity: UpperBound | None
    ) -> None:
        """Keep a ``trial``, narrow the bracket of the factor of safety by it, and keep what the triangles are refined
        by: the ``problem`` with the ``stress`` field and the ``velocity`` field of the last trial of both bounds.
        """
        if stress is not None and velocity is not None:
            self.last_of_both = (problem, stress, velocity)
        elif trial.no_equilibrium and stress is not None and self.last_of_both:
            before, last_stress, last_velocity = self.last_of_both
            if len(last_stress.stress) == len(stress.stress):  # triangles are needed where no stress balances the loads
                self.last_of_both = (before, stress, last_velocity)
        factor = trial.factor
        if trial.lower is not None and self.excess(trial.lower) >= 0.0 and factor > self.lower:
            self.lower, self.mesh_of_lower = factor, self.mesh
            self.holds_in_both_directions = self.multiplier_kind == "loads"
        if trial.upper is not None and self.excess(trial.upper) <= 0.0:
            self.upper = min(self.upper, factor)
        self.trials.append(trial)

    def count(self, side: BoundSide, factor: float, solution: Solution, unproven: bool) -> None:
        """Count a trial: add its computing work, store its solution as the next starting point, and count consecutive
        trials in which the solver found neither a bound nor a proof that there is none. ``side`` names the bound;
        ``factor`` is the factor of safety tried; ``solution`` is the answer of the solver; ``unproven`` means that the
        answer decided nothing.
        """
        self.work.spent += solution.work
        self.work.ran_out = self.work.ran_out or solution.out_of_work
        self.starting_points[side] = factor, solution.warm
        self.failures[side] = self.failures[side] + 1 if unproven and not (solution.none or solution.out_of_work) else 0

    def starting_point(self, side: BoundSide, factor: float) -> Warm | None:
        """Return the solution of the last trial as starting point of the solver, if its factor is close enough.

        A mechanism is no starting point for a mechanism of other strength: its strain rates lie at the limit of the
        flow rule, which turns with φ. From there the solver took 35 to 51 iterations, or broke down, instead of 20 to
        26 from its own start. The order of elimination alone is therefore used again.
        """
        last, point = self.starting_points.get(side, (factor, None))
        if point is None or abs(math.log(factor / last)) >= NEAR:
            return None
        return replace(point, place=None) if side == "upper" else point

    def with_deciding_multiplier(self, trial: BoundsTrial) -> BoundsTrial:
        """Return a trial with bounds of Kh or, if they decide nothing, with bounds of the share of all loads. Bounds of
        Kh decide nothing if no mechanism fails below the given Kh and yet no stress field balances the weight, as below
        a footing, or if the lower bound is the given Kh at any factor, as where thin slices of cracked ground topple
        from an upright face. The share of all loads is bounded once more only while no factor is proven: it does not
        decide either where its own lower bound was missing.
        """
        # The solver may fail where no bound of Kh exists: a mechanism that does not move in its direction fails at any.
        fails_late = trial.no_equilibrium if trial.upper is None else self.excess(trial.upper) > 0.0
        if self.multiplier_kind == "loads" or not fails_late or not (trial.no_equilibrium or self.is_flat(trial)):
            return trial
        if trial.no_equilibrium and self.has_no_share_of_loads and self.lower > 0.0:
            self.no_equilibrium_from = trial.factor
            return trial
        self.multiplier_kind, seen = "loads", self.last_of_both
        loaded = self.measure(trial.factor)
        is_flat = loaded.lower is not None and self.excess(loaded.lower) < FLAT_LOAD_EXCESS
        if not self.decides(loaded) or (not trial.no_equilibrium and is_flat):
            self.multiplier_kind, self.last_of_both = "kh", seen
            if trial.no_equilibrium:
                self.no_equilibrium_from = trial.factor
            return trial
        self.slope, self.failures = None, {"lower": 0, "upper": 0}
        return loaded

    @property
    def has_no_share_of_loads(self) -> bool:
        """Return whether the bounds of the share of all loads decided nothing in an earlier trial."""
        return any(trial.multiplier_kind == "loads" and not self.decides(trial) for trial in self.trials)

    @staticmethod
    def decides(loaded: BoundsTrial) -> bool:
        """Return whether the bounds of the share of all loads are close enough to decide."""
        if loaded.lower is None or loaded.upper is None:
            return False
        return loaded.lower > 0.0 and loaded.upper <= LARGEST_LOAD_RATIO * loaded.lower

    def is_flat(self, trial: BoundsTrial) -> bool:
        """Return whether the lower bound of Kh is the given Kh, although the upper bound lies far above it."""
        if trial.lower is None or trial.upper is None:
            return False
        return abs(self.excess(trial.lower)) < FLAT_LOWER_EXCESS and self.excess(trial.upper) > FLAT_UPPER_EXCESS

    def mean_excess(self, trial: BoundsTrial) -> float:
        """Return the mean excess of both bounds over the required value, or the excess of the only bound; -inf without
        any."""
        values = [self.excess(bound) for bound in (trial.lower, trial.upper) if bound is not None]
        return sum(values) / len(values) if values else -math.inf

    def gap_of_trial(self, trial: BoundsTrial) -> float:
        """Return the relative gap between the factors of safety that the lower and the upper bound of a trial give."""
        if trial.lower is None or trial.upper is None or self.slope is None:
            return 0.0
        return (self.excess(trial.lower) - self.excess(trial.upper)) / self.slope

    def update_slope(self, before: BoundsTrial, now: BoundsTrial) -> None:
        """Update the derivative of the excess with respect to the logarithm of the factor, from the trials so far."""
        if before.cells != now.cells or before.factor == now.factor or before.multiplier_kind != now.multiplier_kind:
            return
        for side in SIDES:
            ends = [getattr(trial, side) for trial in (before, now)]
            first, second = (-math.inf if end is None else self.excess(end) for end in ends)
            if max(abs(first), abs(second)) < LARGEST_EXCESS:
                slope = (second - first) / math.log(now.factor / before.factor)
                if slope < 0.0:
                    self.slope = slope
                    return

    def local_slope(self) -> float | None:
        """Return the derivative of the excess with respect to the logarithm of the factor by two trials on the present
        triangles, the one closest to the required value among them; None without two trials far enough apart."""
        for side in SIDES:
            first, *others = sorted(self.points(side), key=lambda point: abs(point[1])) or [(0.0, 0.0)]
            for other in others:
                if abs(other[0] - first[0]) >= LEAST_STEP_OF_SLOPE:
                    slope = (other[1] - first[1]) / (other[0] - first[0])
                    return slope if slope < 0.0 else None
        return None

    @property
    def trials_on_mesh(self) -> list[BoundsTrial]:
        """Return the trials on the present triangles."""
        last = self.trials[-1]
        return [
            trial for trial in self.trials if (trial.cells, trial.multiplier_kind) == (last.cells, last.multiplier_kind)
        ]

    def root(self, side: BoundSide) -> float:
        """Return the factor at which a bound meets the required value, by a secant; NaN if unknown."""
        return root_of(self.points(side), self.slope, math.log(LARGEST_FACTOR_RATIO))

    def extrapolated(self, side: BoundSide) -> float:
        """Return how far (in ln F) the factor at which a bound meets the required value lies beyond all trials. The
        result is 0 if this factor is unknown or lies between trials."""
        at = math.log(self.root(side))
        trials = [log_factor for log_factor, _ in self.points(side)]
        return max(at - max(trials), min(trials) - at, 0.0) if trials and math.isfinite(at) else 0.0

    def points(self, side: BoundSide) -> list[tuple[float, float]]:
        """Return ln F and the excess of the bound (see ``excess``) of every trial on the present triangles."""
        bounds = [(trial.factor, getattr(trial, side)) for trial in self.trials_on_mesh]
        points = [(math.log(factor), self.excess(bound)) for factor, bound in bounds if bound is not None]
        return sorted(point for point in points if abs(point[1]) < LARGEST_EXCESS)
