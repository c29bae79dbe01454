"""Searches the factor of safety in one direction by bounds of the critical Kh of weakened ground."""

import math

import numpy as np

from fem.limit.adaptive_bounds import finer_mesh
from fem.limit.bracket import CELL_RATIO, COST_EXPONENT, FAILED_MESHES, LEAST_CELL_RATIO, MOST_CELL_RATIO, BoundSide
from fem.limit.factor_trial import within_interval
from fem.limit.weakened_ground import LARGEST_EXCESS, LARGEST_FACTOR_RATIO, WeakenedGround

# Interval in which factors are searched.
SMALLEST_FACTOR, LARGEST_FACTOR = 0.02, 20.0
# Largest number of trials on one mesh.
MOST_TRIALS = 10
# Distance, as a share of the factor, of a proof from the estimated factor of a bound, to the safe side. The solver
# leaves 6e-5 of Kh open, which is 0.0003 of the factor where Kh falls by 0.2 for each unit of its logarithm.
PROOF_MARGIN = 0.0005
# The same on meshes that are refined again: with this margin one trial proves where the smaller one requires two or
# three, and finer triangles have a closer bound.
ROUGH_PROOF_MARGIN = 0.005
# Share of the distance of extrapolation that is added to the margin of a proof.
EXTRAPOLATION_SHARE = 0.05
# Share of the allowed gap that both bounds leave open, by which a proof is further to the safe side: nearer to its
# estimate it fails more often, and where both have succeeded the gap is closer than it has to be.
SLACK_SHARE = 0.1
# Share of the allowed gap between a proven upper and the estimated lower bound within which the upper bound suffices.
ENOUGH_SHARE_OF_GAP = 0.5
# Largest number of proofs of one bound on one mesh.
MOST_PROOFS = 4
# Distance (in ln F) of a trial from the estimated factor with which its mesh is refined: the largest of this number, of
# this share of the gap between the bounds of the trial (a share of 0.5 is at the lower bound), and of this share of the
# allowed gap.
CLOSE_STEP, CLOSE_SHARE_OF_GAP, CLOSE_SHARE_OF_ALLOWED_GAP = 0.015, 0.6, 0.3
# Share of the gap by which the lower bound rises at least on the next mesh: it rose by 0.24 to 0.3 of the gap on five
# sections. The first trial there then proves the lower bound, and is close enough to both bounds.
LOWER_BOUND_RISE = 0.15
# Share of the gap that the lower bound closes on finer triangles: 0.28 to 0.44 on five sections. And the share of the
# allowed gap that lies between the factors at which both bounds are tried on triangles that are expected to close it.
SHARE_OF_LOWER_BOUND, WITHIN_GAP = 0.36, 0.98
# Usual decrease of the critical Kh with the logarithm of the factor: 0.16 to 0.5 on six sections.
USUAL_DECREASE_OF_KH = 0.3
# Gap (in ln F) between a proven and an estimated bound with which the bound is proven on a mesh that is refined again.
FALLBACK_GAP = 0.05

# Ratio of the gap for which the next mesh is made to the required gap. The gap falls more slowly than the number of
# triangles rises, and triangles that miss it by little are made again.
GAP_RATIO_AIMED_AT = 1.15
# Largest ratio of the numbers of triangles of two meshes, if the second mesh is expected to close the gap and is
# allowed: six of eight sections took 6 to 30 % less work than with a ratio of 3 and a gap ratio of 1.3, and two that
# used up their work came as close or closer.
FURTHEST_CELL_RATIO = 4.5
# Smallest and largest power of the number of triangles with which the gap is expected to fall. Where the gap is at a
# few points, as at the toe of a bank of sand below a crust, twice as many triangles had a sixth of the gap.
GAP_EXPONENTS = 1.0, 2.0
# Distance (in ln F) from the estimated upper bound at which both bounds are tried, and how far below it.
STEP_TO_BOTH_BOUNDS, STEP_BELOW_UPPER_BOUND = 0.1, 0.04
# Excess of Kh of the first upper bound up to which the next trial is of both bounds without a slope.
NEAR_EXCESS = 0.003
# Ratio of the work of a trial of both bounds and of their proofs to that of one trial. With less work left there are
# only proofs.
WORK_RATIO_OF_PROOFS = 2.5
# Ratio of the work on the next mesh, with the proofs begun from it, to that of both bounds at one factor on a mesh of
# as many triangles.
WORK_RATIO_OF_MESH = 1.5
# Share of the work left that the next mesh may take without proofs on the present mesh, and that one trial of both
# bounds may take on triangles that are expected to close the gap.
WORK_SHARE_OF_UNPROVEN_MESH, WORK_SHARE_OF_EXPECTED_BOUNDS = 0.5, 0.65


class FactorSearch(WeakenedGround):
    """Searches bounds of the factor of safety at ``kh``, with the seismic force to one side."""

    def find(self) -> None:
        """Bracket the factor of safety on ever finer triangles."""
        while True:
            self.settle()
            beyond = self.lower >= LARGEST_FACTOR or self.upper <= SMALLEST_FACTOR
            last = self.mesh_is_full or self.solver_fails or not self.has_work_for_finer
            if not (beyond or self.is_enough or self.solver_fails):
                finest = last or self.open_here <= self.settings.gap - 2.0 * PROOF_MARGIN
                self.prove_both(finest or not self.may_refine_unproven)
            if self.gap_is_closed or last or beyond or self.is_enough:
                return
            self.refine()

    def confirms(self, other: "FactorSearch") -> bool:
        """Return whether the lower bound of the ``other`` direction is proven for this one on the finest triangles.

        In most cases this proof, that the other direction governs, requires far fewer triangles than bounds of this
        direction do. If the proof fails, the factor of this direction is searched for, on triangles refined for its
        mechanism.
        """
        if other.holds_in_both_directions:
            self.lower = other.lower
        if self.lower < other.lower:
            self.measure(other.lower, upper=False)
        if self.lower < other.lower and self.mesh is not other.mesh:
            self.mesh, self.no_equilibrium_from = other.mesh, math.inf
            self.measure(other.lower, upper=False)
        while self.lower < other.lower:
            self.measure(other.lower)
            if self.upper <= other.lower or self.mesh_is_full or self.solver_fails or not self.has_work_for_finer:
                break
            self.refine()
        return 0.0 < other.lower <= self.lower

    @property
    def is_enough(self) -> bool:
        """Return whether one of the bounds is already sufficient (see ``TrialStart``)."""
        return self.lower >= self.lower_suffices or self.upper < self.upper_suffices

    @property
    def open_here(self) -> float:
        """Return the relative gap of the factor on these triangles, estimated by secants through all trials; inf if
        unknown.
        """
        ends = self.root("lower"), self.root("upper")
        return math.log(ends[1] / ends[0]) if all(math.isfinite(end) for end in ends) else math.inf

    @property
    def gap_is_closed(self) -> bool:
        return self.gap <= self.settings.gap

    @property
    def mesh_is_full(self) -> bool:
        return self.settings.max_cells < 1.2 * len(self.mesh.cells)

    @property
    def solver_fails(self) -> bool:
        """Return whether the solver ended early at the same bound in several trials in a row, so that further trials
        would fail, too."""
        return max(self.failures.values()) >= FAILED_MESHES

    @property
    def has_work_for_finer(self) -> bool:
        return self.work.allows(self.work_of_a_mesh(min(self.growth(), CELL_RATIO)))

    @property
    def may_refine_unproven(self) -> bool:
        """Return whether enough work is left to make finer triangles without proofs on the present ones. Triangles that
        are expected to close the gap by one trial require less."""
        growth = self.growth()
        if growth >= self.needed_growth and self.expected_on_next_mesh is not None:
            return growth**COST_EXPONENT * self.work_of_both <= WORK_SHARE_OF_EXPECTED_BOUNDS * self.work.left
        return self.work_of_a_mesh(growth) <= WORK_SHARE_OF_UNPROVEN_MESH * self.work.left

    @property
    def work_of_both(self) -> float:
        """Return the computing work of both bounds at one factor on the present triangles."""
        both = [trial.work for trial in self.trials_on_mesh if not (trial.lower is None or trial.upper is None)]
        return max(both) if both else 2.0 * max(trial.work for trial in self.trials_on_mesh)

    def approach(self) -> None:
        """Bring the first factor close to the factor at which the ground fails, by upper bounds alone. Upper bounds
        take less work than lower bounds, and exist on coarse triangles on which lower bounds do not."""
        safe, unsafe, last = 0.0, math.inf, self.known_at_full_strength
        if last is not None and last.upper is not None:
            # Light ground, such as that below a footing, has a Kh of hundreds, whose exponential overflows.
            most = math.log(LARGEST_FACTOR_RATIO)
            step = math.exp(min(max(self.excess(last.upper) / USUAL_DECREASE_OF_KH, -most), most))
            self.factor = self.looked_for(step)
            safe, unsafe = (1.0, math.inf) if step >= 1.0 else (0.0, 1.0)
        for _ in range(MOST_TRIALS):
            trial = self.measure(self.factor, lower=False)
            if trial.upper is None or self.is_enough or not self.work.allows(2.0 * trial.work):
                return
            if last is not None:
                self.update_slope(last, trial)
            excess, last = self.excess(trial.upper), trial
            if self.slope is None and abs(excess) < NEAR_EXCESS:
                self.factor = self.looked_for(trial.factor * math.exp(-STEP_BELOW_UPPER_BOUND))
                return
            step = LARGEST_FACTOR_RATIO**-2.0 if excess < -LARGEST_EXCESS else self.step(excess)
            if self.slope is not None and abs(math.log(step)) < STEP_TO_BOTH_BOUNDS:
                self.factor = self.looked_for(trial.factor * step * math.exp(-STEP_BELOW_UPPER_BOUND))
                return
            safe, unsafe = (trial.factor, unsafe) if excess >= 0.0 else (safe, trial.factor)
            self.factor = self.looked_for(within_interval(trial.factor * step, safe, unsafe))
            if self.factor == trial.factor:
                return

    def settle(self) -> None:
        """Try factors of safety on this mesh until their bracket is within the required gap."""
        if self.slope is None:
            self.approach()
        if self.expected_bounds is not None:
            expected_lower, expected_upper = self.expected_bounds
            self.measure(expected_lower, upper_factor=expected_upper)
            return
        before = self.trials[-1] if self.trials else None
        last = self.with_deciding_multiplier(self.measure(self.factor))
        if self.slope is None and before is not None:
            self.update_slope(before, last)
        safe, unsafe = 0.0, math.inf
        for _ in range(MOST_TRIALS):
            middle = self.mean_excess(last)
            step = 1.0 / LARGEST_FACTOR_RATIO if middle < -LARGEST_EXCESS else self.step(middle)
            if self.is_enough or self.solver_fails or not self.work.allows(last.work):
                return
            distance = (
                CLOSE_STEP,
                CLOSE_SHARE_OF_GAP * self.gap_of_trial(last),
                CLOSE_SHARE_OF_ALLOWED_GAP * self.settings.gap,
            )
            close = abs(math.log(step)) < max(distance)
            if self.slope is not None and (close or self.work.left < WORK_RATIO_OF_PROOFS * last.work):
                break
            safe, unsafe = (last.factor, unsafe) if middle >= 0.0 else (safe, last.factor)
            self.factor = self.looked_for(within_interval(last.factor * step, safe, unsafe))
            if self.factor == last.factor:  # at an end of what is looked for
                break
            trial = self.with_deciding_multiplier(self.measure(self.factor))
            self.update_slope(last, trial)
            last = trial

    def step(self, excess: float) -> float:
        """Return the ratio of the next factor to the present factor, if a bound at the present factor exceeds the
        required value by ``excess``."""
        if self.slope is None:
            log_step = (2.0 if self.multiplier_kind == "kh" else 1.0) * excess
            log_step = math.copysign(max(abs(log_step), 0.05), log_step)
        else:
            log_step = -excess / self.slope
        return math.exp(float(np.clip(log_step, -math.log(LARGEST_FACTOR_RATIO), math.log(LARGEST_FACTOR_RATIO))))

    def prove_both(self, on_last_mesh: bool) -> None:
        """Prove the upper bound, which takes less work, then the lower bound.

        On the last triangles (``on_last_mesh``) the required gap has to be reached. Earlier triangles prove bounds only
        if little is proven yet, since the solver may fail on finer triangles, or if the upper bound decides.
        """
        sides: tuple[tuple[BoundSide, float], ...] = (("upper", 1.0), ("lower", -1.0))
        for side, sense in sides:
            root, proven = self.root(side), getattr(self, side)
            known = 0.0 < proven < math.inf and math.isfinite(root)
            decides = side == "upper" and root * math.exp(PROOF_MARGIN) < self.upper_suffices
            if side == "upper" and known and not decides and self.upper_is_close_enough:
                continue
            if on_last_mesh or decides or not known or abs(math.log(root / proven)) > FALLBACK_GAP:
                self.prove(side, sense, on_last_mesh)

    @property
    def upper_is_close_enough(self) -> bool:
        """Return whether a proof of the estimated lower bound leaves at most half of the allowed gap."""
        lower = self.root("lower")
        return math.isfinite(lower) and math.log(self.upper / lower) <= ENOUGH_SHARE_OF_GAP * self.settings.gap

    def prove(self, side: BoundSide, sense: float, on_last_mesh: bool = True) -> None:
        """Prove a bound by trials a little to the safe side of the estimated factor until no better bound is proven.
        The lower bound takes most of the work, so that its trials end as soon as the gap is small enough. Without an
        estimate, the interval of the factor is bisected. Where no stress has balanced the loads yet, the factor is
        reduced, but only once unless the triangles are the last of the search (``on_last_mesh``). On earlier triangles
        one bound is proven.
        """
        last, before = self.trials[-1].factor, getattr(self, side)
        work = 0.5 * min(trial.work for trial in self.trials_on_mesh)  # of one bound, at least
        decides = not self.upper_suffices <= self.root(side) * math.exp(sense * PROOF_MARGIN) < self.lower_suffices
        margin = PROOF_MARGIN if on_last_mesh or decides else ROUGH_PROOF_MARGIN
        if not decides and math.isfinite(self.open_here):
            margin = max(margin, SLACK_SHARE * (self.settings.gap - self.open_here))
        for times in range(1, MOST_PROOFS + 1):
            proven = getattr(self, side)
            if not on_last_mesh and proven != before:
                return
            at = self.root(side) * math.exp(sense * (times * margin + EXTRAPOLATION_SHARE * self.extrapolated(side)))
            unbalanced = [trial.factor for trial in self.trials_on_mesh if side == "lower" and trial.no_equilibrium]
            least_unbalanced = min(unbalanced, default=math.inf)
            if math.isnan(at) and proven == 0.0:
                if times > 1 and not on_last_mesh:
                    return
                at = min(last, least_unbalanced) * LARGEST_FACTOR_RATIO ** (-0.5 * times)
            elif math.isnan(at) or self.trials[-1].factor == least_unbalanced:
                at = math.sqrt(min(last, least_unbalanced) * proven)
            elif not sense * (at - proven * math.exp(-sense * margin)) < 0.0:
                return
            if (
                (self.gap_is_closed and side == "lower")
                or not SMALLEST_FACTOR < at < LARGEST_FACTOR
                or not self.work.allows(work)
            ):
                return
            self.measure(at, side == "lower", side == "upper")

    def growth(self) -> float:
        """Return how many times more triangles the next mesh has: enough to close the gap, if one step can do that. The
        margins of the bounds are unchanged.
        """
        needed = self.needed_growth
        allowed = self.settings.max_cells / len(self.mesh.cells)
        furthest = FURTHEST_CELL_RATIO if needed <= allowed else MOST_CELL_RATIO
        affordable = (self.work.left / self.work_of_a_mesh(1.0)) ** (1.0 / COST_EXPONENT)
        allowed = min(allowed, max(affordable, CELL_RATIO))
        return min(max(needed, LEAST_CELL_RATIO) if needed <= furthest else CELL_RATIO, allowed)

    @property
    def needed_growth(self) -> float:
        """Return how many times more triangles are expected to close the gap, less the margins of its proofs."""
        margins = 2.0 * PROOF_MARGIN
        gap = max(min(self.gap, self.open_here), 0.0)  # secants may cross: the lower bound seems to be the larger one
        needed = GAP_RATIO_AIMED_AT * gap / max(self.settings.gap - margins, margins)
        return float(needed ** (1.0 / self.gap_exponent))

    @property
    def gap_exponent(self) -> float:
        """Return the power of the number of triangles with which the gap fell from the last mesh to this one."""
        smallest, largest = GAP_EXPONENTS
        if self.open_before is None or not math.isfinite(self.open_here):
            return smallest
        cells, gap = self.open_before
        ratio = math.log(len(self.mesh.cells) / cells)
        return min(max(math.log(gap / max(self.open_here, 1e-6)) / max(ratio, 1e-6), smallest), largest)

    def work_of_a_mesh(self, growth: float) -> float:
        """Return the expected computing work on a mesh of ``growth`` times as many triangles."""
        return WORK_RATIO_OF_MESH * growth**COST_EXPONENT * self.work_of_both

    def refine(self) -> None:
        """Refine the triangles where the bounds of the last trial differ."""
        assert self.last_of_both is not None  # both bounds were tried on these triangles
        growth = self.growth()
        mesh = finer_mesh(*self.last_of_both, growth)
        self.slope = self.local_slope() or self.slope
        self.expected_bounds = self.expected_on_next_mesh if growth >= self.needed_growth else None
        lower = self.root("lower")
        self.open_before = (len(self.mesh.cells), self.open_here) if 0.0 < self.open_here < math.inf else None
        if math.isfinite(lower):
            rise = LOWER_BOUND_RISE * self.open_here if math.isfinite(self.open_here) else 0.0
            self.factor = self.looked_for(lower * math.exp(rise))
        self.no_equilibrium_from = math.inf
        self.mesh = mesh
        self.meshes.append(mesh)

    @property
    def expected_on_next_mesh(self) -> tuple[float, float] | None:
        """Return the factors of the lower and of the upper bound, as far apart as allowed, that a mesh which closes the
        gap is expected to prove; None where the bounds on this mesh are unknown, or one of them decides alone."""
        lower, gap = self.root("lower"), self.settings.gap
        decides = self.lower_suffices < math.inf or self.upper_suffices > 0.0
        if decides or self.slope is None or not (math.isfinite(lower) and math.isfinite(self.open_here)):
            return None
        gap_expected = max(gap - 2.0 * PROOF_MARGIN, 2.0 * PROOF_MARGIN) / GAP_RATIO_AIMED_AT
        rise = SHARE_OF_LOWER_BOUND * max(self.open_here - gap_expected, 0.0)
        at = self.looked_for(lower * math.exp(rise - 0.5 * max(gap - gap_expected, 0.0)))
        return at, at * math.exp(WITHIN_GAP * gap)

    def looked_for(self, factor: float) -> float:
        """Return the factor, limited to the interval in which factors are searched, and to the lower bound that
        suffices: a trial above it would decide nothing."""
        return min(max(factor, SMALLEST_FACTOR), LARGEST_FACTOR, self.lower_suffices)
