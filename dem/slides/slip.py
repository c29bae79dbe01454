"""Describes the failure of discs: cracked pore springs by stratum, and the slip surface.

Surfaces are (k, 2), x and z in the section's frame (m).
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from dem.ground import Ground
from dem.model import DiscModel
from meshes.section.section import Section
from meshes.slip_line import slip_line

COLUMN_WIDTH = 4.0  # from one column to the next, in mean radii
NEIGHBOUR_RADIUS = 3.0  # mean radii within which discs move as one: a band of shear is eight to ten of them wide


@dataclass(frozen=True)
class Agreement:
    """Compares two slip surfaces in the columns where both exist.

    Attributes
    ----------
    mean_distance_m : mean vertical distance (m)
    mean_height_m : mean height of the first surface above the second (m)
    same_stratum_share : share of the columns in which both surfaces lie in the same stratum
    columns : number of compared columns
    """

    mean_distance_m: float
    mean_height_m: float
    same_stratum_share: float
    columns: int


def cracked_shares(model: DiscModel) -> dict[str, float]:
    """Return the share of cracked pore springs in each layer.

    Parameters
    ----------
    model : the discs

    Returns
    -------
    Share by name of the layer, 0 without pore springs; a spring between two layers counts in both.
    """
    set_, cracked = model.pore_length != 0.0, model.pore_length < 0.0
    first, second = model.layer[model.pair_i], model.layer[model.pair_j]
    shares = {}
    for k, layer in enumerate(model.springs.layers):
        set_in_layer = set_ & ((first == k) | (second == k))
        shares[layer.name] = float(cracked[set_in_layer].mean()) if set_in_layer.any() else 0.0
    return shares


def slip_surface(model: DiscModel, before: DiscModel, ground: Ground) -> np.ndarray:
    """Return the slip surface between discs that moved and discs at rest, see `slip_line`.

    The displacement at a point is the mean displacement of the discs within `NEIGHBOUR_RADIUS`, fixed discs included.

    Parameters
    ----------
    model : discs after the movement
    before : the same discs before the movement
    ground : packing of the discs, and its place in the section

    Returns
    -------
    x and z (k, 2) in the frame of the section before the movement (m), from left to right; empty if no disc moved.
    """
    x, z = ground.to_section(before.x, before.z)
    moved = np.column_stack(ground.to_section_axes(model.x - before.x, model.z - before.z))
    free = ~model.fixed
    columns = np.arange(x[free].min(), x[free].max(), COLUMN_WIDTH * ground.radius)
    levels = np.arange(z[free].min(), z[free].max() + ground.radius, ground.radius)
    points = np.stack(np.meshgrid(columns, levels, indexing="ij"), axis=-1)
    inside = cKDTree(np.column_stack([x, z])[free]).query(points)[0] <= 1.5 * ground.radius
    speed = np.full(inside.shape, np.nan)
    near = cKDTree(np.column_stack([x, z])).query_ball_point(points[inside], NEIGHBOUR_RADIUS * ground.radius)
    speed[inside] = [np.hypot(*moved[discs].mean(axis=0)) for discs in near]
    return slip_line(columns, points[..., 1], speed)


def compare(section: Section, first: np.ndarray, second: np.ndarray) -> Agreement | None:
    """Compare two slip surfaces, at the columns of the first surface that lie within the extent of the second.

    Parameters
    ----------
    section : ground with the strata
    first, second (k, 2) : x and z of the two surfaces (m), from left to right

    Returns
    -------
    Distances, and share of the columns in the same stratum; None if there are no such columns.
    """
    if len(first) == 0 or len(second) < 2:
        return None
    inside = (first[:, 0] >= second[:, 0].min()) & (first[:, 0] <= second[:, 0].max())
    if not inside.any():
        return None
    x, z = first[inside].T
    other = np.interp(x, second[:, 0], second[:, 1])
    same = section.stratum_at(x, z) == section.stratum_at(x, other)
    return Agreement(float(np.abs(z - other).mean()), float((z - other).mean()), float(same.mean()), int(inside.sum()))
