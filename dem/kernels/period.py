"""Computes distances in periodic ground, of which one period is computed (kernel).

Positions are never mapped back into the period; the distance of two discs is the distance to the nearest periodic
image.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from dem.kernels.device_function import device_function


class Period(NamedTuple):
    """Holds length and rise after which periodic ground repeats itself.

    Attributes
    ----------
    length : length of the period along x (m)
    rise : rise (m) over one period, negative where the ground falls to the right
    """

    length: float
    rise: float


# So long that the nearest image is always the thing itself, to the last bit; not so long that a way over it is a
# denormal number, with which processors are slow.
NO_PERIOD = Period(1e100, 0.0)


@device_function(forceinline=True)
def image(dx: float, dz: float, period: Period) -> tuple[float, float]:
    """Return the vector (m) to the image that is nearest along x."""
    n = math.floor(dx * (1.0 / period.length) + 0.5)
    return dx - n * period.length, dz - n * period.rise


@njit(cache=True, nogil=True, error_model="numpy")
def folded(x: np.ndarray, z: np.ndarray, period: Period) -> tuple[np.ndarray, np.ndarray]:
    """Return the images of all positions in the period that begins with the leftmost position.

    Parameters
    ----------
    x, z (n,) : positions (m)
    period : length along x and rise along z of a period (m)

    Returns
    -------
    x and z (n,) of the images (m); the positions themselves if the ground is not periodic.
    """
    if period.length == NO_PERIOD.length:
        return x, z
    inside, height = x.copy(), z.copy()
    left = x.min()
    for i in range(len(x)):
        n = math.floor((x[i] - left) / period.length)
        inside[i] -= n * period.length
        height[i] -= n * period.rise
    return inside, height
