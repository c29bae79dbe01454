"""Lowers the residual strength just above the lower edge of a liquefied layer, so that the layer slips at this edge.

Discs shear in a band some diameters wide, which lies above the edge where the ground below is strong. The shear stress
by Kh and by the slope is proportional to the overburden, so that a band above the edge resists more than slip on the
edge itself would. Within the width of the band discs therefore have at
most

    s(z) = s_e p(z) / p_e,

with the overburden p (Pa), and s_e and p_e at the edge: all of the band yields at the Kh at which a rigid block slips
on the edge. A strength in proportion to the overburden stays as it is. Material points have the same rule for the
ground below the edge (`fem.mpm.weak_edges`).
"""

import numpy as np

from dem.model import DiscModel

BAND = 3.0  # mean diameters above the edge
# Of its strength that ground keeps: thin ground in front of a toe does not only slip on its edge, but is compressed.
LEAST_SHARE = 0.8
AROUND = 1.0  # mean diameters to either side, in which the lowest disc of a layer marks its edge
NEXT_LAYER = 1.5  # mean diameters below the edge, in which other liquefied ground makes it no edge


def edge_shares(
    model: DiscModel, liquefies: np.ndarray, strength: np.ndarray, increase: np.ndarray, pressure: np.ndarray,
    area: np.ndarray,
) -> np.ndarray:  # fmt: skip
    """Return the share of their strength that discs keep near the lower edges of liquefied layers.

    Parameters
    ----------
    model : DiscModel
        The discs at rest.
    liquefies : ndarray (n,) of bool
        Discs that liquefy.
    strength : ndarray (n,)
        Residual strength (Pa).
    increase : ndarray (n,)
        Increase of the residual strength with the overburden (-).
    pressure : ndarray (n,)
        Effective overburden (Pa), with the loads on the ground.
    area : ndarray (n,)
        Area of the discs with their voids (m²).

    Returns
    -------
    Shares (n,), from `LEAST_SHARE` to 1; 1 away from edges.
    """
    share = np.ones(len(model))
    discs = np.flatnonzero(liquefies & (strength > 0.0) & (pressure > 0.0))
    if not len(discs):
        return share
    diameter = 2.0 * float(model.radius[~model.fixed].mean())
    height = model.z[discs] - _edges(model, discs, diameter)
    near = height < BAND * diameter
    discs, height = discs[near], height[near]
    below = height * np.maximum(-model.mass * model.pull[1] / area, 0.0)[discs]  # overburden from the disc to the edge
    slips = (strength[discs] + increase[discs] * below) * pressure[discs] / (pressure[discs] + below)
    share[discs] = np.clip(slips / strength[discs], LEAST_SHARE, 1.0)
    return share


def _edges(model: DiscModel, discs: np.ndarray, diameter: float) -> np.ndarray:
    """Return the elevation (m) of the lower edge of the layer of each of the ``discs``; minus infinity above other
    liquefied ground."""
    order = discs[np.argsort(model.x[discs], kind="stable")]
    x, bottom, layer = model.x[order], (model.z - model.radius)[order], model.layer[order]
    first = np.searchsorted(x, x - AROUND * diameter)
    last = np.searchsorted(x, x + AROUND * diameter, side="right")
    edge = np.empty(len(order))
    for k, (low, high) in enumerate(zip(first, last, strict=True)):
        same = layer[low:high] == layer[k]
        edge[k] = bottom[low:high][same].min()
        others = bottom[low:high][~same]
        if ((others < edge[k]) & (others > edge[k] - NEXT_LAYER * diameter)).any():
            edge[k] = -np.inf
    by_disc = np.empty(len(model))
    by_disc[order] = edge
    return by_disc[discs]
