"""The slip surface of moving ground, defined alike for finite elements and discs: the middle of the sheared zone."""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

ARCH = 0.25  # of the height of a line, by which it lies above the chord between its ends on average


def slip_line(x: np.ndarray, z: np.ndarray, moved: np.ndarray) -> np.ndarray:
    """Find the line between moving ground and ground at rest, (k, 2) in m. The line is empty if nothing moves, or if it
    is no slip surface: below a crest that settles while the ground moves to both sides, the line rises from both of its
    ends.

    x (m,) are columns, z (m, n) points in each of them from below upwards, in m, and ``moved`` (m, n) how far or how
    fast the ground there moves, not a number if there is none. A column counts as moving if its top moves by more than
    the mean of two means, that of moving and that of resting columns (Ridler & Calvard 1978, IEEE Trans. Syst. Man
    Cybern. 8, 630); the line is where it moves half as much as the upper half of what lies above does on average:
    within a thin band of shear, half of the way across a thick one, also where the ground turns as it slides, or grains
    roll ahead on its surface. Of the columns that count it is the longest row without a gap; the median of three
    neighbours leaves out what one column alone has.
    """
    limit = _threshold(moved[np.isfinite(moved)])
    depths = [_depth(heights, values, limit) for heights, values in zip(z, moved, strict=True)]
    is_cut = np.isfinite(depths)
    if not is_cut.any():
        return np.zeros((0, 2))
    edges = np.flatnonzero(np.diff(np.concatenate([[False], is_cut, [False]]).astype(int)))
    starts, ends = edges[0::2], edges[1::2]
    longest = int(np.argmax(ends - starts))
    row = slice(starts[longest], ends[longest])
    neighbours = sliding_window_view(np.pad(np.array(depths)[row], 1, mode="edge"), 3)
    line = np.column_stack([x[row], np.median(neighbours, axis=1)])
    above_chord = line[:, 1] - np.interp(line[:, 0], line[[0, -1], 0], line[[0, -1], 1])
    return line if above_chord.mean() <= ARCH * np.ptp(line[:, 1]) else np.zeros((0, 2))


def _threshold(moved: np.ndarray) -> float:
    """Return the displacement that separates moving from resting ground; infinite if all ground moves alike."""
    if not len(moved) or np.ptp(moved) <= 1e-12 * np.abs(moved).max():
        return np.inf
    limit, before = 0.5 * (moved.min() + moved.max()), np.nan
    while limit != before:
        before, limit = limit, 0.5 * (moved[moved >= limit].mean() + moved[moved < limit].mean())
    return float(limit)


def _depth(z: np.ndarray, moved: np.ndarray, limit: float) -> float:
    """Return the least height at which a column moves half as much as the upper half of what lies above, below which it
    moves less; not a number if its top is at rest.
    """
    ground = np.isfinite(moved)
    z, moved = z[ground], moved[ground]
    if not len(z) or moved[-1] < limit:
        return np.nan
    beyond = moved - 0.5 * _upper_halves(z, moved)
    below = np.flatnonzero((beyond[:-1] < 0.0) & (beyond[1:] >= 0.0))
    if not len(below):
        return float(z[0])
    k = below[0]
    return float(z[k] - beyond[k] / (beyond[k + 1] - beyond[k]) * (z[k + 1] - z[k]))


def _upper_halves(z: np.ndarray, moved: np.ndarray) -> np.ndarray:
    """For every height the mean of what moves in the upper half of what lies above."""
    first = np.searchsorted(z, 0.5 * (z + z[-1]))
    return np.cumsum(moved[::-1])[::-1][first] / (len(z) - first)
