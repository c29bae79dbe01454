"""Finds the critical seismic coefficient of discs, as a bracket: the largest Kh at which they stand, and the smallest
at which they do not.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from dem.ground import Ground
from dem.model import DiscModel
from dem.search.equilibrium import KhRise, Trial, displacement, try_kh
from dem.settings import DemSettings, SearchVerdict

PROBE_KH = 0.02  # under which the elastic displacement is measured
FIRST_STEP = 0.08  # Kh of the first steps, or the nearest power of two times the width

OnTrial = Callable[[Trial, DiscModel], None]


@dataclass
class Search:
    """Holds the bracket of the critical Kh, with all trials.

    Attributes
    ----------
    kc_lower : the largest Kh at which the discs stood
    kc_upper : the smallest Kh at which the discs did not stand
    verdict : "bracketed", or why there is no bracket
    reason : reason of the verdict in words
    flexibility_m : elastic displacement over Kh (m)
    trials : all trials, in the order of computation
    curve (Kh, displacement in m) : Kh and displacement of the states of equilibrium
    """

    kc_lower: float = 0.0
    kc_upper: float | None = None
    verdict: SearchVerdict = "undecided"
    reason: str = ""
    flexibility_m: float = 0.0
    trials: list[Trial] = field(default_factory=list)
    curve: list[tuple[float, float]] = field(default_factory=list)

    @property
    def kc(self) -> float | None:
        """Return the mean of the bracket; None without a bracket."""
        return None if self.kc_upper is None or self.verdict != "bracketed" else 0.5 * (self.kc_lower + self.kc_upper)

    @property
    def seconds(self) -> float:
        """Return the model time of all trials (s)."""
        return round(sum(trial.seconds for trial in self.trials), 3)


def critical_kh(
    settled: DiscModel,
    ground: Ground,
    settings: DemSettings,
    *,
    resolution: float | None = None,
    threads: int = 1,
    on_trial: OnTrial | None = None,
) -> Search:
    """Find the critical seismic coefficient of discs at rest, as a bracket.

    Kh rises by steps from one state of equilibrium to the next. A step after which the discs do not stand is halved,
    down to the width of the bracket. A Kh that failed is tried again only from a state one width below it, so that both
    ends of the bracket are reached from the same state. An undecided trial counts as a failure.

    Parameters
    ----------
    settled : DiscModel
        Discs at rest under their weight; not changed.
    ground : Ground
        Packing of the discs, and its place in the section.
    settings : DemSettings
        Criteria of rest and of failure, and largest Kh of the search.
    resolution : float, optional
        Width of the bracket (-); by default that of the settings.
    threads : int
        Threads of the engine.
    on_trial : callable, optional
        Called with every trial and the discs at its end.

    Returns
    -------
    Search
        The bracket, its verdict and all trials. The verdict is "undecided" if the upper end of the bracket is an
        undecided trial.
    """

    search = Search()
    width = settings.resolution if resolution is None else resolution
    step = width * 2.0 ** round(np.log2(FIRST_STEP / width)) if width < FIRST_STEP else width
    stood = settled.copy()
    kh, failed = PROBE_KH, float("inf")
    while True:
        if kh > settings.kh_limit:
            search.verdict, search.reason = (
                "stands everywhere",
                f"the discs stand at the largest Kh of the search, {search.kc_lower:g}",
            )
            return search
        model = stood.copy()
        # an elastic displacement is not known before the probe has stood
        known = search.flexibility_m or float("inf")
        trial = try_kh(model, settled, ground, settings, KhRise(search.kc_lower, kh, known), threads)
        search.trials.append(trial)
        if on_trial is not None:
            on_trial(trial, model)
        if trial.verdict == "stands":
            stood, search.kc_lower = model, kh
            moved = displacement(model, settled, ground)
            search.curve.append((kh, moved))
            search.flexibility_m = search.flexibility_m or abs(moved) / kh
            if kh > failed * (1.0 - 1e-9):
                failed = float("inf")
        elif not search.flexibility_m:
            search.kc_upper = kh
            search.reason = f"the discs stand at rest, but not at Kh = {kh:g}, the smallest tried: {trial.reason}"
            return search
        elif step <= width * (1.0 + 1e-9):
            break
        else:
            failed = kh
        while step > width * (1.0 + 1e-9) and _next_kh(search.kc_lower, step) > failed * (1.0 - 1e-9):
            step *= 0.5
        kh = _next_kh(search.kc_lower, step)
    search.kc_upper, search.reason = kh, trial.reason
    search.verdict = "bracketed" if trial.verdict == "fails" else "undecided"
    return search


def _next_kh(kh: float, step: float) -> float:
    """Return the next Kh: one step above the last one, or the step itself if only the first small Kh was tried."""
    return kh + step if step <= kh else step
