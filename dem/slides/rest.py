"""Decides when a slide ends (the surface no longer moves), and names the source of energy of a slide that continues.

Single discs that rattle in loosened ground always have some kinetic energy, so energy is not a useful criterion of
rest. The criterion is the displacement of the ground: of every third of the surface, and the largest slide of the
surface.
"""

from collections.abc import Sequence

import numpy as np

WINDOW = 5.0  # s
STILL_SHARE = 2e-3  # of the largest slide: what moves on by less in a window is no movement, far below the scatter
# Amplitude of an oscillation about the final position, over the largest movement at rest: firm ground has little
# damping.
SWING_RATIO = 3.0
RECENT_TIME = 10.0  # s
SMALL_ENERGY_SHARE = 0.01  # of the total energy exchanged, in a window


def at_rest(times: Sequence[float], moved: Sequence[Sequence[float]], still: float) -> bool:
    """Return whether the ground is at rest: no displacement increased by `still` (m) within the last window of time, or
    oscillated by more than a few times this length. An increase below `STILL_SHARE` of the largest displacement counts
    as rest, too.

    The increase is twice the difference of the means over the two halves of the window: for creeping ground it is equal
    to the displacement, for oscillating ground much smaller.

    times (n,): times of the records (s), rising; moved (n, k): displacements at each time (m): slides and settlements
    of the thirds, and the largest slide.
    """
    time, displacements = np.asarray(times, float), np.asarray(moved, float)
    if len(time) == 0 or time[-1] - time[0] < WINDOW - 1e-9:
        return False
    still = max(still, STILL_SHARE * float(np.abs(displacements[-1]).max()))
    since = time - time[-1] + WINDOW
    late, middle = since > -1e-9, 0.5 * WINDOW
    earlier, later = displacements[late & (since < middle + 1e-9)], displacements[since > middle - 1e-9]
    moved_on = 2.0 * np.abs(later.mean(axis=0) - earlier.mean(axis=0))
    return bool(moved_on.max() < still and np.ptp(displacements[late], axis=0).max() < SWING_RATIO * still)


def moved_lately(times: Sequence[float], moved: Sequence[float]) -> float:
    """Return the displacement within the last 10 s (m); times (n,): times of the records (s), moved (n,): displacement
    at each time (m)."""
    first = int(np.searchsorted(np.asarray(times, float), times[-1] - RECENT_TIME - 1e-9))
    return float(np.ptp(np.asarray(moved, float)[first:]))


def residual_motion_source(times: Sequence[float], weight: Sequence[float], shaking: Sequence[float]) -> str:
    """Return the source of the energy of the last window of time, in words.

    weight, shaking (n,): work of gravity and of the seismic force since the beginning (J per metre).
    """
    time = np.asarray(times, float)
    first = int(np.searchsorted(time, time[-1] - WINDOW - 1e-9))
    by_weight, by_shaking = (max(float(work[-1] - work[first]), 0.0) for work in (weight, shaking))
    total = by_weight + by_shaking
    if total <= SMALL_ENERGY_SHARE * float(np.ptp(weight) + np.ptp(shaking)):
        return "no energy is supplied any more: the slide slows down, or oscillates"
    share = by_weight / total
    message = f"in its last {WINDOW:g} s {100.0 * share:.0f} % of the energy came from weight, the rest from shaking"
    return f"{message}: the slide would continue without shaking" if share > 0.9 else message
