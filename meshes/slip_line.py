"""Finds the slip surface of moving ground, defined in the same way for finite elements and discs: the middle of the
sheared zone."""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

ARCH = 0.25  # of the height of a line, by which it lies above the chord between its ends on average
# A single node may move many times as fast as the ground that slides, at a toe that cracks for example. A line of fewer
# columns is looked for again with speeds limited, down to this share of the largest one.
FEW_COLUMNS, LEAST_LIMIT = 3, 0.03


def slip_line(x: np.ndarray, z: np.ndarray, moved: np.ndarray) -> np.ndarray:
    """Find the line between moving ground and ground at rest.

    A column counts as moving if its top moves by more than a threshold: the mean of two means, that of moving and that
    of resting columns (Ridler & Calvard 1978, IEEE Trans. Syst. Man Cybern. 8, 630). In each such column the line lies
    where the ground moves half as much as the upper half of the ground above does on average. This is within a thin
    shear band, and half-way across a thick one, also where the ground rotates as it slides, or single grains roll ahead
    on its surface. Of the moving columns the longest row without a gap counts. The median of three neighbours removes
    outliers of single columns. Where a few points move many times as fast as all other moving ground, their
    displacement is limited.

    Parameters
    ----------
    x (columns,) : places of the columns (m)
    z (columns, points) : heights of the points in each column, from below upwards (m)
    moved (columns, points) : displacement (m) or speed at these points, not negative; NaN outside the ground

    Returns
    -------
    Points (k, 2) in m, from left to right; empty if nothing moves, or if the line is no slip surface: below a crest
    that settles while the ground moves to both sides, the line rises from both of its ends.
    """
    line = _line(x, z, moved)
    if not 0 < len(line) < FEW_COLUMNS:
        return line
    limited, least = moved, LEAST_LIMIT * float(np.nanmax(moved))
    while (limit := _threshold(limited[np.isfinite(limited)])) > least and np.isfinite(limit):
        limited = np.minimum(moved, limit)
        if len(wider := _line(x, z, limited)) >= FEW_COLUMNS:
            return wider
    return line


def _line(x: np.ndarray, z: np.ndarray, moved: np.ndarray) -> np.ndarray:
    """Return the line of `slip_line` for displacements as they are."""
    limit = _threshold(moved[np.isfinite(moved)])
    depths = [_depth(heights, values, limit) for heights, values in zip(z, moved, strict=True)]
    is_cut = np.isfinite(depths)
    if not is_cut.any():
        return np.zeros((0, 2))
    edges = np.flatnonzero(np.diff(np.concatenate([[False], is_cut, [False]]).astype(int)))
    starts, ends = edges[0::2], edges[1::2]
    longest = int(np.argmax(ends - starts))
    row = slice(starts[longest], ends[longest])
    line = np.column_stack([x[row], running_median(np.array(depths)[row], 1)])
    above_chord = line[:, 1] - np.interp(line[:, 0], line[[0, -1], 0], line[[0, -1], 1])
    return line if above_chord.mean() <= ARCH * np.ptp(line[:, 1]) else np.zeros((0, 2))


def extent_in_words(line: np.ndarray) -> str:
    """Return where ground slips along a line, as a predicate.

    Parameters
    ----------
    line (k, 2) : points of the line (m), at least one; a line without length is a place

    Returns
    -------
    Words after a subject, such as "slips from x = 3.0 to 21.5 m, down to z = -4.2 m".
    """
    (start, low), (end, _) = line.min(axis=0), line.max(axis=0)
    if f"{start:.1f}" == f"{end:.1f}":
        return f"fails first in a few cells at x = {start:.1f} m, z = {low:.1f} m"
    return f"slips from x = {start:.1f} to {end:.1f} m, down to z = {low:.1f} m"


def running_median(values: np.ndarray, reach: int) -> np.ndarray:
    """Return the median of every value and its neighbours.

    Parameters
    ----------
    values (n,) : the values; those at the ends are repeated beyond the ends
    reach : number of neighbours to either side

    Returns
    -------
    Medians (n,).
    """
    return np.median(sliding_window_view(np.pad(values, reach, mode="edge"), 2 * reach + 1), axis=1)


def _threshold(moved: np.ndarray) -> float:
    """Return the displacement that separates moving from resting ground; infinite if all ground moves alike."""
    if not len(moved) or np.ptp(moved) <= 1e-12 * np.abs(moved).max():
        return np.inf
    limit, before = 0.5 * (moved.min() + moved.max()), np.nan
    while limit != before:
        before, limit = limit, 0.5 * (moved[moved >= limit].mean() + moved[moved < limit].mean())
    return float(limit)


def _depth(z: np.ndarray, moved: np.ndarray, limit: float) -> float:
    """Return the least height at which a column moves half as much, on average, as the upper half of the ground above
    this height, and below which it moves less; NaN if the top of the column is at rest.
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
    """Return, for every height of a column, the mean displacement of the upper half of the ground above it."""
    first = np.searchsorted(z, 0.5 * (z + z[-1]))
    return np.cumsum(moved[::-1])[::-1][first] / (len(z) - first)
