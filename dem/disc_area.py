"""Computes the area of discs with their voids (m2), which is their volume per metre out of plane."""

import numpy as np
from scipy.spatial import Delaunay

from dem.model import DiscModel

LONGEST_SIDE = 4.0  # mean radii: distance of neighbours at most; triangles with longer sides lie outside the ground


def area_per_disc(model: DiscModel, start: DiscModel) -> np.ndarray:
    """Return the area of the ground of each stratum with its voids, over the area of its discs at the start.

    The area of the ground is that of Delaunay triangles of the centres, each divided among its corners by their angles.
    Triangles with a side of `LONGEST_SIDE` mean radii or more lie outside the ground.

    Parameters
    ----------
    model : present positions and layers of the discs
    start : the same discs at the start, whose radii give the area of the discs

    Returns
    -------
    Ratio (strata,), such as 2 sqrt(3)/pi where equal discs just touch; NaN for a stratum without triangles.
    """
    points = np.column_stack([model.x, model.z])
    corners = Delaunay(points).simplices
    edges = np.roll(points[corners], -1, axis=1) - points[corners]
    lengths = np.hypot(edges[..., 0], edges[..., 1])
    close = (lengths < LONGEST_SIDE * float(start.radius.mean())).all(axis=1)
    corners, edges, lengths = corners[close], edges[close], lengths[close]
    behind = -np.roll(edges, 1, axis=1)
    cosine = (edges * behind).sum(axis=-1) / (lengths * np.roll(lengths, 1, axis=1))
    angle = np.arccos(np.clip(cosine, -1.0, 1.0))
    area = 0.5 * np.abs(edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0])
    layer, count = model.layer[corners], len(model.springs.layers)
    soil = layer >= 0
    ground = np.bincount(layer[soil], (area[:, np.newaxis] * angle / np.pi)[soil], count)
    discs = np.bincount(layer[soil], (0.5 * angle * start.radius[corners] ** 2)[soil], count)
    return np.divide(ground, discs, out=np.full(count, np.nan), where=discs > 0.0)


def area_with_voids(model: DiscModel) -> np.ndarray:
    """Return the area of every disc with its voids, in proportion to the area of the disc.

    Parameters
    ----------
    model : the discs at their present positions

    Returns
    -------
    Area (n,) in m2: area of the disc times the ratio of its stratum by `area_per_disc`. Fixed discs of the boundary,
    and strata without triangles, have the mean ratio of the strata.
    """
    ratio = area_per_disc(model, model)
    mean = np.nanmean(ratio)
    of_layers = np.append(np.where(np.isfinite(ratio), ratio, mean), mean)  # the last entry is the boundary
    return np.asarray(of_layers[model.layer] * np.pi * model.radius**2)
