"""Smooths the surface of the ground as far as discs or cells resolve it."""

import numpy as np


def smoothed(line: np.ndarray, size: float) -> np.ndarray:
    """Return the surface that discs of a diameter ``size`` (m) resolve, without spikes by single additional or missing
    discs.

    Parameters
    ----------
    line (n, 2) : tops of the discs of the surface: x and elevation (m)
    size : diameter of the discs (m): the surface is a running median over three diameters, then a mean over two

    Returns
    -------
    Points (m, 2) half a diameter apart.
    """
    line = line[np.argsort(line[:, 0], kind="stable")]
    if len(line) < 2 or not size > 0.0 or np.ptp(line[:, 0]) < 4.0 * size:
        return line
    x = np.arange(line[0, 0], line[-1, 0] + 0.25 * size, 0.5 * size)
    z = np.interp(x, *line.T)
    for width, average in ((7, np.median), (5, np.mean)):
        padded = np.pad(z, width // 2, mode="reflect")
        z = average(np.lib.stride_tricks.sliding_window_view(padded, width), axis=1)
    return np.column_stack([x, z])
