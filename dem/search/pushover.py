"""The critical Kh of soil discs from one push: their displacement is prescribed, and the Kh that it takes is measured.

So the curve goes on where a Kh that is prescribed would run away, as the path of the continuum does, and both mean the
same: Kh over the mean displacement in the direction of the push, weighted with mass (m). Discs are held against the
continuum at the same displacement, since neither has a limit of its own in a box: loose ground goes on to harden as
it is pressed together. Their critical Kh is the largest that they bear, on average over a fifth of the way, up to
`DemSettings.growth` times the displacement at which the continuum yields. Grains want that much more strain than an
elastic-plastic body of the same E to have the same strength: patches of them have nine tenths of it at 1 to 3 % of
compression, where an elastic body would have it at 0.3 to 1 %.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from dem.engine.engine import Engine, largest_step
from dem.errors import DemError
from dem.ground import Ground
from dem.model import DiscModel
from dem.search.critical import OnTrial, Search
from dem.search.equilibrium import STEP, Trial, displacement, kinetic_ratio, period, unbalanced_ratio
from dem.settings import DemSettings
from dem.side_by_side import StoppedError

MACHINE = 65.0  # stiffness of the spring that pushes, in critical Kh over the reach: some five times that of the ground
SLOWEST, QUICKEST = 0.012, 0.04  # reaches in a period of the ground; half of both changes kc by 1 %
PULSES = 64  # of a period, between two looks at the displacement
BLOCK = 0.05  # of the reach, over which a point of the curve is a mean
WINDOW = 4  # blocks over which Kh is averaged for the critical one
BEYOND = 1.1  # of the reach, where the push ends: the last window has the reach in its middle


class Continuum(NamedTuple):
    """What discs are held against.

    Attributes
    ----------
    kc : float
        The critical Kh of the continuum with their sides.
    yielding : float
        Its mean displacement in the direction of the push once it has come to that (m).
    """

    kc: float
    yielding: float


@dataclass
class Curve:
    """What was measured on the way.

    Attributes
    ----------
    displacement, kh : list of float
        Mean displacement (m) and seismic coefficient, point by point.
    trials : list of Trial
        The same with what tells how far from rest the discs were.
    """

    displacement: list[float] = field(default_factory=list)
    kh: list[float] = field(default_factory=list)
    trials: list[Trial] = field(default_factory=list)

    def critical(self) -> tuple[float, float, int]:
        """The critical Kh, half the width of its bracket, and the number of the point at which it was reached.

        The width is the standard error of the mean over the window: loose ground gives way by jerks.
        """
        kh = np.array(self.kh)
        size = min(WINDOW, len(kh))
        windows = np.lib.stride_tricks.sliding_window_view(kh, size)
        best = int(np.argmax(windows.mean(axis=1)))
        return float(windows[best].mean()), float(windows[best].std() / np.sqrt(size)), best + size - 1


def push_over(
    settled: DiscModel,
    ground: Ground,
    settings: DemSettings,
    continuum: Continuum,
    *,
    threads: int = 1,
    on_trial: OnTrial | None = None,
    stopped: Callable[[], bool] = lambda: False,
) -> Search:
    """The critical Kh of settled discs, which stay as they are, and the curve that leads to it.

    on_trial hears of every point of the
    curve. stopped: asked at every look; raises StoppedError once it says so. Undecided where a DemError stopped the
    discs before the end.
    """
    if min(continuum) <= 0.0:
        raise ValueError(f"{continuum}: expected a critical Kh and a displacement above 0")
    search = Search()
    reach = settings.growth * continuum.yielding
    curve = Curve()
    try:
        _push(settled.copy(), settled, ground, reach, MACHINE * continuum.kc / reach, threads, curve, on_trial, stopped)
    except DemError as error:
        search.reason = f"after {max(curve.displacement, default=0.0):.3g} m: {type(error).__name__}: {error}"
    else:
        search.verdict, search.reason = (
            "bracketed",
            f"the largest Kh borne up to {reach:.3g} m, {settings.growth:g} times the continuum's",
        )
    if curve.kh:
        kc, half, last = curve.critical()
        search.lower, search.upper = kc - half, kc + half
        search.flexibility = continuum.yielding / kc if kc > 0.0 else 0.0
        search.trials = curve.trials
        search.curve = list(zip(curve.kh[: last + 1], curve.displacement[: last + 1], strict=True))
        if kc <= 0.0:
            search.verdict, search.upper = "fails under its own weight", 0.0
    return search


def _push(
    model: DiscModel,
    before: DiscModel,
    ground: Ground,
    reach: float,
    stiffness: float,
    threads: int,
    curve: Curve,
    on_trial: OnTrial | None,
    stopped: Callable[[], bool],
) -> None:
    """Moves one end of a spring on and takes the discs along, until they have moved a little beyond the reach.

    Between two looks Kh is what the spring then carries, its stiffness (Kh per m) times its shortening.
    """
    cycle, start = period(model, ground), model.time
    pulse = cycle / PULSES
    moved, end = 0.0, 0.0
    since: list[tuple[float, float]] = []
    while moved < BEYOND * reach:
        if stopped():
            raise StoppedError
        end += reach * float(np.clip(0.15 * moved / reach, SLOWEST, QUICKEST)) / PULSES
        kh = stiffness * (end - moved)
        model.acceleration = ground.shaking(kh, kh, model.time, model.time + pulse)
        Engine(dt=STEP * largest_step(model).seconds, ledger=False, threads=threads).run(model, pulse)
        moved = displacement(model, before, ground)
        since.append((moved, kh))
        if moved >= BLOCK * reach * (len(curve.kh) + 1):
            _note(curve, model, np.array(since), model.time - start)
            since = []
            if on_trial is not None:
                on_trial(curve.trials[-1], model)


def _note(curve: Curve, model: DiscModel, since: np.ndarray, seconds: float) -> None:
    """One more point of the curve: the mean of what was measured since the last."""
    moved, kh = (float(value) for value in since.mean(axis=0))
    more = kh > max(curve.kh, default=0.0)
    reason = "more than they have borne so far" if more else "they have borne more on the way"
    curve.displacement.append(moved)
    curve.kh.append(kh)
    ratios = unbalanced_ratio(model), kinetic_ratio(model)
    curve.trials.append(Trial(kh, "stands" if more else "fails", reason, *ratios, moved, np.inf, seconds))
