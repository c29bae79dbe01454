"""Lines with the points that they need: Douglas & Peucker (1973), with distances measured upwards."""

from itertools import pairwise

import numpy as np


def needed(points: np.ndarray, tolerance: float) -> np.ndarray:
    """Which points of a line keep it within a tolerance.

    Parameters
    ----------
    points : ndarray (n, 2)
        Points (m), of which x never falls.
    tolerance : float
        How far (m, upwards) the line may go from where it was; points of a vertical step stay.

    Returns
    -------
    ndarray (n,) of bool
        The ends are always kept.
    """
    keep = np.zeros(len(points), dtype=bool)
    keep[[0, -1]] = True
    steps = np.flatnonzero(np.diff(points[:, 0]) == 0.0)
    keep[steps] = keep[steps + 1] = True
    ends = np.flatnonzero(keep)
    waiting = [(int(a), int(b)) for a, b in pairwise(ends)]
    while waiting:
        first, last = waiting.pop()
        if last - first < 2:
            continue
        (x0, z0), (x1, z1) = points[first], points[last]
        inner = points[first + 1 : last]
        off = np.abs(inner[:, 1] - (z0 + (z1 - z0) * (inner[:, 0] - x0) / (x1 - x0)))
        worst = int(np.argmax(off))
        if off[worst] > tolerance:
            middle = first + 1 + worst
            keep[middle] = True
            waiting += [(first, middle), (middle, last)]
    return keep
