"""Kernel: discs that carry what shakes with the ground and is no soil, surcharges and free water (`Layout.swing`)."""

import numpy as np
from numba import njit

from dem.kernels.layout import INVMASS, PULL_X, PULL_Z, VX, VZ, Layout


@njit(cache=True, nogil=True, error_model="numpy")
def swing_slice(p: int, layout: Layout, level: float) -> None:
    """Lets such discs of slice p feel it, at this acceleration of the frame across gravity (m/s2)."""
    for k in range(layout.swing_start[p], layout.swing_start[p + 1]):
        at = np.uint64(layout.swing_disc[k])
        layout.discs[at + PULL_X] = layout.swing[k, 0] + layout.swing[k, 2] * level
        layout.discs[at + PULL_Z] = layout.swing[k, 1] + layout.swing[k, 3] * level


@njit(cache=True, nogil=True, error_model="numpy")
def momentum_of_swings(p: int, layout: Layout) -> float:
    """Its power (J/s) on slice p over the acceleration of the frame across gravity (m/s2)."""
    momentum = 0.0
    for k in range(layout.swing_start[p], layout.swing_start[p + 1]):
        at = np.uint64(layout.swing_disc[k])
        speed = layout.swing[k, 2] * layout.discs[at + VX] + layout.swing[k, 3] * layout.discs[at + VZ]
        momentum += speed / layout.discs[at + INVMASS]
    return momentum
