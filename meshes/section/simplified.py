"""Simplifies lines to the points that they need: Douglas & Peucker (1973), with vertical distances."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np


def needed(points: np.ndarray, tolerance: float) -> np.ndarray:
    """Find the points of a line that keep it within a tolerance.

    Parameters
    ----------
    points (n, 2) : points (m); x never decreases
    tolerance : largest vertical distance (m) between the original and the simplified line; points of a vertical step
        stay

    Returns
    -------
    Mask (n,) of the points to keep; the ends are always kept.
    """
    keep = np.zeros(len(points), dtype=bool)
    keep[[0, -1]] = True
    steps = np.flatnonzero(np.diff(points[:, 0]) == 0.0)
    keep[steps] = keep[steps + 1] = True

    def off(first: int, last: int) -> np.ndarray:
        (x0, z0), (x1, z1) = points[first], points[last]
        between = points[first + 1 : last]
        return np.abs(between[:, 1] - (z0 + (z1 - z0) * (between[:, 0] - x0) / (x1 - x0)))

    return with_farthest(keep, off, tolerance)


def with_farthest(fixed: np.ndarray, off: Callable[[int, int], np.ndarray], tolerance: float) -> np.ndarray:
    """Return a mask of places (n,): the ``fixed`` places and, between two of them, repeatedly the place farthest
    ``off`` the chord, until no place is farther off than the tolerance.
    """
    keep = fixed.copy()
    ends = np.flatnonzero(keep)
    waiting = [(int(a), int(b)) for a, b in pairwise(ends)]
    while waiting:
        first, last = waiting.pop()
        if last - first < 2:
            continue
        far = off(first, last)
        worst = int(np.argmax(far))
        if far[worst] > tolerance:
            middle = first + 1 + worst
            keep[middle] = True
            waiting += [(first, middle), (middle, last)]
    return keep
