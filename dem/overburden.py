"""Computes the effective overburden of discs: the weight less buoyancy of the ground vertically above each disc."""

import numpy as np

from dem.model import DiscModel
from dem.state import nearest_image

SPREADING_WIDTH = 2.0  # mean diameters to either side over which weight is spread


def effective_overburden(model: DiscModel) -> np.ndarray:
    """Return the vertical effective stress at the centres of all discs.

    The stress is the weight of all higher discs and of half the disc itself, with the forces of water and of loads on
    the ground; the weight of each disc is distributed over `SPREADING_WIDTH` mean diameters to either side. Fixed discs
    have no weight.

    Parameters
    ----------
    model : discs with gravity and the accelerations by water and loads

    Returns
    -------
    Stress (n,) in Pa, positive in compression; 0 where the forces of water exceed the weight.
    """
    free = np.flatnonzero(~model.fixed)
    down = -model.mass * model.pull[1]
    width = SPREADING_WIDTH * 2.0 * float(model.radius[free].mean())
    left, right = float((model.x - model.radius)[free].min()), float((model.x + model.radius)[free].max())
    length = right - left if model.period is None else model.period[0]
    columns = max(3, int(length / width))
    across = length / columns

    def column_of(x: np.ndarray) -> np.ndarray:
        column = np.floor((x - left) / across).astype(int)
        return np.clip(column, 0, columns - 1) if model.period is None else column % columns

    there, here = column_of(model.x[free]), column_of(model.x)
    out = np.zeros(len(model))
    for k in range(columns):
        around = [k - 1, k, k + 1]
        if model.period is not None:
            around = [c % columns for c in around]
        above, below = free[np.isin(there, around)], np.flatnonzero(here == k)
        dx, dz = (at[above] - at[below][:, np.newaxis] for at in (model.x, model.z))
        dx, dz = nearest_image(dx, dz, model.repeats)
        share = np.maximum(1.0 - np.abs(dx) / across, 0.0) / across
        higher = np.clip(0.5 + 0.5 * dz / model.radius[above], 0.0, 1.0)
        out[below] = (share * higher) @ down[above]
    if model.period is None:
        out /= _share_within(model.x, left, right, across)
    return np.maximum(out, 0.0)


def _share_within(x: np.ndarray, left: float, right: float, width: float) -> np.ndarray:
    """Return the share of a triangular distribution (half width `width`, peak at x) that lies between two sides
    (n,)."""

    def beyond(distance: np.ndarray) -> np.ndarray:
        return 0.5 * np.clip(1.0 - np.maximum(distance, 0.0) / width, 0.0, 1.0) ** 2

    return 1.0 - beyond(x - left) - beyond(right - x)
