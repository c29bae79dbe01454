"""Strict lower and upper bound of the factor of safety of a section at a given Kh, by limit analysis.

The factor divides c and tan φ of all strata (Zienkiewicz, Humpheson & Lewis 1975); the flow rule is associated. For a
trial factor F, limit analysis bounds the Kh that the ground so weakened carries. Where a stress carries more than the
Kh given, and another one more than that Kh the other way, the two carry every Kh between them, for yield surfaces are
convex: F is a lower bound. Where a mechanism fails at less than the Kh given, either way, F is an upper bound. The
bounds of Kh fall as F rises, smoothly, so that F is found by a few secants on coarse triangles, then on finer ones.
"""

import math
import time
from dataclasses import dataclass, replace

import numpy as np

from fem.errors import UnstableError
from fem.limit.adaptive_bounds import (
    GROWTH,
    NARROW_ANGLE,
    proven_lower_bound,
    proven_upper_bound,
    refined,
    refinement_indicator,
    singular_points,
)
from fem.limit.bounds import body_of, first_mesh
from fem.limit.limit_problem import LimitProblem, limit_problem, units_of
from fem.settings import BoundsSettings, FemSettings
from meshes.bisection import fan_out
from meshes.section.section import Section
from meshes.triangles import TriMesh

# The largest and smallest factor looked for, and by how much it changes at most from trial to trial.
SMALLEST, LARGEST, STEP = 0.02, 20.0, 1.6
# Trials on one mesh, and how close (of the factor) a trial is to where the secant puts the bound: a little to the safe
# side of it, so that it proves.
TRIALS, MARGIN = 10, 0.002
# A coarse factor is good enough to refine at when it is this close.
CLOSE = 0.01


@dataclass(frozen=True)
class Trial:
    """Bounds of the Kh of ground weakened by ``factor``, proven on ``cells`` triangles; None where nothing was."""

    factor: float
    cells: int
    lower: float | None
    upper: float | None
    seconds: float


@dataclass(frozen=True)
class Start:
    """The Kh given, the factor to begin with, whether Davis's substitute is looked at, and whether sides are held."""

    kh: float
    factor: float
    davis: bool
    held: bool


@dataclass(frozen=True)
class SafetyBounds:
    """Factors of safety: ``lower`` is carried, ``upper`` fails; 0 and inf where none was proven."""

    kh: float
    lower: float
    upper: float
    cells: int
    trials: list[Trial]

    @property
    def gap(self) -> float:
        """Upper less lower bound over their mean, inf where one is missing."""
        if self.lower <= 0.0 or not math.isfinite(self.upper):
            return math.inf
        return (self.upper - self.lower) / (0.5 * (self.upper + self.lower))


def safety_bounds(
    section: Section,
    fem: FemSettings,
    settings: BoundsSettings,
    kh: float = 0.0,
    guess: float = 1.0,
    davis: bool = False,
    held: bool = False,
) -> SafetyBounds:
    """Lower and upper bound of the factor of safety at ``kh``, of the section or of its substitute of Davis.

    ``held`` sides move up and down alone, as in strength reduction without shaking, where others bear the K0 stress.
    ``guess`` is where to begin, and only costs time. Both directions of the push are looked at. Raises InputError as
    ``kh_bounds`` does, UnstableError if no factor from 0.02 to 20 is between safe and unsafe, BadMeshError if there are
    no triangles.
    """
    start = Start(kh, guess, davis, held)
    searches = [_Search(section, first_mesh(section, settings.max_cells), fem, settings, 1, start)]
    searches[0].find()
    searches.append(_Search(section, searches[0].mesh, fem, settings, -1, start))
    if not searches[1].confirms(searches[0]):
        start = replace(start, factor=searches[0].lower or guess)
        searches.append(_Search(section, first_mesh(section, settings.max_cells), fem, settings, -1, start))
        searches[2].find()
    lower, upper = min(searches[0].lower, searches[-1].lower), min(search.upper for search in searches)
    if lower <= 0.0 and not math.isfinite(upper):
        raise UnstableError("no factor of safety from 0.02 to 20 could be bounded; check strengths and densities")
    trials = [trial for search in searches for trial in search.trials]
    return SafetyBounds(kh, lower, upper, max(trial.cells for trial in trials), trials)


class _Search:
    """The factor at which a push to one side (``sign`` 1: that of ``fem``) bears just ``sign`` x ``kh``."""

    def __init__(
        self, section: Section, mesh: TriMesh, fem: FemSettings, settings: BoundsSettings, sign: int, start: Start
    ) -> None:
        body = body_of(section, mesh, fem, start.davis, start.kh != 0.0, start.held)
        self.body = replace(body, live_force=sign * body.live_force)
        self.units = units_of(mesh, self.body)
        self.mesh, self.settings = mesh, settings
        self.target, self.factor = sign * start.kh, start.factor
        self.lower, self.upper = 0.0, math.inf
        self.trials: list[Trial] = []
        self.slope: float | None = None

    def find(self) -> None:
        """Narrow the factor down on ever finer triangles."""
        while True:
            self.settle()
            if self.good or self.mesh_is_full:
                return
            self.refine()

    def confirms(self, other: "_Search") -> bool:
        """Whether this push, too, is proven to bear what the other one bears.

        Where it is not, its own factor is looked for on triangles of its own: these are fine where the other fails.
        """
        if other.lower > 0.0:
            self.measure(other.lower)
        return 0.0 < other.lower <= self.lower

    @property
    def good(self) -> bool:
        middle = 0.5 * (self.lower + self.upper)
        return math.isfinite(self.upper) and self.upper - self.lower <= self.settings.gap * middle

    @property
    def mesh_is_full(self) -> bool:
        return self.settings.max_cells < 1.2 * len(self.mesh.cells)

    def problem(self, factor: float) -> LimitProblem:
        weak = replace(
            self.body,
            cohesion=self.body.cohesion / factor,
            growth=None if self.body.growth is None else self.body.growth / factor,
            friction=np.arctan(np.tan(self.body.friction) / factor),
        )
        return limit_problem(self.mesh, weak, self.units)

    def measure(self, factor: float, lower: bool = True, upper: bool = True) -> Trial:
        """Bounds of the Kh of ground weakened by a factor; what they prove is kept."""
        started = time.perf_counter()
        problem = self.problem(factor)
        low = high = stress = mechanism = None
        if lower:
            low, _, stress = proven_lower_bound(problem)
        if upper:
            high, _, mechanism = proven_upper_bound(problem)
        trial = Trial(
            factor,
            len(problem.mesh.cells),
            stress.multiplier if stress else None,
            mechanism.multiplier if mechanism else None,
            time.perf_counter() - started,
        )
        if low is not None and high is not None:
            self.seen = (problem, low, high)
        if trial.lower is not None and trial.lower >= self.target:
            self.lower = max(self.lower, factor)
        if trial.upper is not None and trial.upper <= self.target:
            self.upper = min(self.upper, factor)
        self.trials.append(trial)
        return trial

    def settle(self) -> None:
        """Trials on this mesh until the factor is close, then one that proves each bound."""
        weakest = LARGEST
        last = self.measure(self.factor)
        for _ in range(TRIALS):
            middle = _middle(last)
            if middle is None:
                weakest = min(weakest, last.factor)  # the ground is too weak to carry anything
                step = 1.0 / STEP
            else:
                step = min(self.step(middle), math.sqrt(weakest / last.factor))
                if self.slope is not None and abs(step - 1.0) < CLOSE:
                    break
            self.factor = float(np.clip(last.factor * step, SMALLEST, LARGEST))
            trial = self.measure(self.factor)
            self.learn(last, trial)
            last = trial
        for side, sense in (("lower", -1.0), ("upper", 1.0)):
            self.prove(last, side, sense)

    def learn(self, before: Trial, now: Trial) -> None:
        """How much the Kh falls where the logarithm of the factor rises."""
        if before.cells != now.cells or before.factor == now.factor:
            return
        for side in ("upper", "lower"):
            first, second = getattr(before, side), getattr(now, side)
            if first is not None and second is not None:
                slope = (second - first) / math.log(now.factor / before.factor)
                if slope < 0.0:
                    self.slope = slope
                    return

    def step(self, off: float) -> float:
        """The ratio of the next factor to this one, at which a Kh of ``off`` was found."""
        if self.slope is None:
            ahead = 2.0 * (off - self.target)
            ahead = math.copysign(max(abs(ahead), 0.05), ahead)
        else:
            ahead = (self.target - off) / self.slope
        return float(np.clip(math.exp(ahead), 1.0 / STEP, STEP))

    def prove(self, last: Trial, side: str, sense: float) -> None:
        """One trial, or two, where a bound of Kh should come to the Kh given, if that betters what is proven."""
        trial = last
        for more in (1.0, 3.0):
            found = getattr(trial, side)
            if found is None or self.slope is None:
                return
            at = trial.factor * self.step(found) * math.exp(sense * more * MARGIN)
            if at <= self.lower if sense < 0.0 else at >= self.upper:
                return
            trial = self.measure(at, side == "lower", side == "upper")
            if at in (self.lower, self.upper):
                return

    def refine(self) -> None:
        """Finer triangles where the bounds of the last trial are apart."""
        problem, low, high = self.seen
        indicator = refinement_indicator(problem, low, high)
        mesh, parent = fan_out(problem.mesh_in_metres, singular_points(problem, low), NARROW_ANGLE)
        room = self.settings.max_cells / len(problem.mesh.cells)
        self.mesh = refined(mesh, indicator[parent] / np.bincount(parent)[parent], min(GROWTH, room) * len(indicator))


def _middle(trial: Trial) -> float | None:
    """The middle of the bounds of Kh, or the one there is."""
    found = [bound for bound in (trial.lower, trial.upper) if bound is not None]
    return sum(found) / len(found) if found else None
