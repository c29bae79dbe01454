"""Where discs have failed: cracked pore springs by stratum, and the surface along which they slid.

Surfaces are (k, 2), x and z in the section's frame (m).
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from dem.ground import Ground
from dem.model import DiscModel
from meshes.section.section import Section

WIDTH = 4.0  # from one column to the next, in mean radii
REACH = 4.0  # mean radii within which discs make a strain: a band of shear is eight to ten of them wide
FEWEST = 8  # discs that a strain wants
FAINT = 0.2  # of the largest strain, above which ground belongs to the slip surface
STEEPEST = 1.5  # rise over run of a slip surface


@dataclass(frozen=True)
class Agreement:
    """Two slip surfaces compared where both are.

    Attributes
    ----------
    mean_distance_m : float
        Mean vertical distance (m).
    same_stratum_share : float
        Share of the columns in which both lie in the same stratum.
    columns : int
        How many were compared.
    """

    mean_distance_m: float
    same_stratum_share: float
    columns: int


def cracked_shares(model: DiscModel) -> dict[str, float]:
    """Share of the pore springs of each layer that are cracked; one between two layers counts in both."""
    set_, cracked = model.pore_length != 0.0, model.pore_length < 0.0
    first, second = model.layer[model.pair_i], model.layer[model.pair_j]
    shares = {}
    for k, layer in enumerate(model.springs.layers):
        here = set_ & ((first == k) | (second == k))
        shares[layer.name] = float(cracked[here].mean()) if here.any() else 0.0
    return shares


def slip_surface(model: DiscModel, before: DiscModel, ground: Ground) -> np.ndarray:
    """The ridge of shear strain along x: of all lines nowhere steeper than `STEEPEST` the one with the largest sum of
    log(strain / faintest strain), found by dynamic programming, as in the continuum. Empty where nothing moved.
    """
    x, levels, strain = shear_strain(model, before, ground)
    largest = float(np.nanmax(strain, initial=0.0))
    if largest <= 0.0:
        return np.zeros((0, 2))
    worth = np.where(np.isfinite(strain), np.log(np.maximum(strain, 1e-12) / (FAINT * largest)), -np.inf)
    far = max(1, int(STEEPEST * (x[1] - x[0]) / (levels[1] - levels[0]))) if len(x) > 1 else 1
    number = np.arange(len(levels))
    near = np.abs(number[:, None] - number[None, :]) <= far
    sums, back = np.empty_like(worth), np.full(worth.shape, -1)
    sums[0] = worth[0]
    for k in range(1, len(x)):
        reached = np.where(near, sums[k - 1][None, :], -np.inf)
        best = reached.max(axis=1)
        sums[k] = worth[k] + np.maximum(best, 0.0)
        back[k] = np.where(best > 0.0, reached.argmax(axis=1), -1)
    column, level = (int(n) for n in np.unravel_index(int(np.argmax(sums)), sums.shape))
    line: list[tuple[float, float]] = []
    while level >= 0:
        line.append((float(x[column]), float(levels[level])))
        column, level = column - 1, int(back[column, level])
    return np.array(line[::-1])


def shear_strain(model: DiscModel, before: DiscModel, ground: Ground) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Largest shear strain since `before` on columns x (m,) and levels (k,): (m, k), not a number where no ground is.

    Of the displacement that fits the discs within `REACH` best and is linear there; held discs count as ground at rest.
    """
    x, z = ground.to_section(before.x, before.z)
    moved = np.column_stack(ground.turned(model.x - before.x, model.z - before.z))
    free = ~model.fixed
    tree, ends = cKDTree(np.column_stack([x, z])), (x[free], z[free])
    columns = np.arange(ends[0].min(), ends[0].max(), WIDTH * ground.radius)
    levels = np.arange(ends[1].min(), ends[1].max() + ground.radius, ground.radius)
    nearest = cKDTree(np.column_stack(ends))
    strain = np.full((len(columns), len(levels)), np.nan)
    for i, column in enumerate(columns):
        points = np.column_stack([np.full(len(levels), column), levels])
        inside = nearest.query(points)[0] <= 1.5 * ground.radius
        for j in np.flatnonzero(inside):
            near = np.array(tree.query_ball_point(points[j], REACH * ground.radius))
            if len(near) >= FEWEST:
                strain[i, j] = _shear(x[near] - column, z[near] - levels[j], moved[near])
    return columns, levels, strain


def _shear(x: np.ndarray, z: np.ndarray, moved: np.ndarray) -> float:
    fit = np.linalg.lstsq(np.column_stack([np.ones(len(x)), x, z]), moved, rcond=None)[0]
    return float(np.hypot(fit[1, 0] - fit[2, 1], fit[2, 0] + fit[1, 1]))


def compare(section: Section, first: np.ndarray, second: np.ndarray) -> Agreement | None:
    """How two slip surfaces agree, at the columns of the first that lie within the second's reach; None if none do."""
    if len(first) == 0 or len(second) < 2:
        return None
    inside = (first[:, 0] >= second[:, 0].min()) & (first[:, 0] <= second[:, 0].max())
    if not inside.any():
        return None
    x, z = first[inside].T
    other = np.interp(x, second[:, 0], second[:, 1])
    same = section.stratum_at(x, z) == section.stratum_at(x, other)
    return Agreement(float(np.abs(z - other).mean()), float(same.mean()), int(inside.sum()))


def cracked_count(model: DiscModel) -> int:
    """Pore springs that are cracked."""
    return int((model.pore_length < 0.0).sum())
