"""End of a slide: the surface no longer moves; and the source of the energy of one that continues.

Single discs that rattle in loosened ground keep some kinetic energy for ever, so energy says little about rest. What a
person looks at is the ground: every third of the surface, and its largest slide.
"""

from collections.abc import Sequence

import numpy as np

WINDOW = 5.0  # s
SWING = 3.0  # times what counts as still, about where the ground has come to lie: little damps the swing of firm ground
LATELY = 10.0  # s
LITTLE = 0.01  # of the energy turned over, in a window


def at_rest(times: Sequence[float], moved: Sequence[Sequence[float]], still: float) -> bool:
    """Whether nothing moved on by `still` (m) within the last window, nor swung by more than a few times that.

    What moved on is twice the way between the mean places in the two halves of the window: ground that creeps moves on
    as far as it moves, and ground that swings by much less.

    times (n,): of the looks (s), rising; moved (n, k): what is watched at each look (m): slides and settlements of the
    thirds, and the largest slide.
    """
    time, where = np.asarray(times, float), np.asarray(moved, float)
    if len(time) == 0 or time[-1] - time[0] < WINDOW - 1e-9:
        return False
    since = time - time[-1] + WINDOW
    late, middle = since > -1e-9, 0.5 * WINDOW
    earlier, later = where[late & (since < middle + 1e-9)], where[since > middle - 1e-9]
    moved_on = 2.0 * np.abs(later.mean(axis=0) - earlier.mean(axis=0))
    return bool(moved_on.max() < still and np.ptp(where[late], axis=0).max() < SWING * still)


def moved_lately(times: Sequence[float], moved: Sequence[float]) -> float:
    """How much something moved within the last 10 s (m); times (n,) of the looks (s), moved (n,) at each (m)."""
    first = int(np.searchsorted(np.asarray(times, float), times[-1] - LATELY - 1e-9))
    return float(np.ptp(np.asarray(moved, float)[first:]))


def residual_motion_source(times: Sequence[float], weight: Sequence[float], shaking: Sequence[float]) -> str:
    """Where the energy of the last window came from, in words.

    weight, shaking (n,): work that gravity and the seismic force have done since the beginning (J per metre).
    """
    time = np.asarray(times, float)
    first = int(np.searchsorted(time, time[-1] - WINDOW - 1e-9))
    by_weight, by_shaking = (max(float(work[-1] - work[first]), 0.0) for work in (weight, shaking))
    total = by_weight + by_shaking
    if total <= LITTLE * float(np.ptp(weight) + np.ptp(shaking)):
        return "nothing drives it any more: it slows down, or swings"
    share = by_weight / total
    message = (
        f"in its last {WINDOW:g} s {100.0 * share:.0f} % of the energy came from its weight, the rest from shaking"
    )
    return f"{message}: it would go on without" if share > 0.9 else message
