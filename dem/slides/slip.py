"""Where discs have failed: cracked pore springs by stratum, and the surface along which they slid.

Surfaces are (k, 2), x and z in the section's frame (m).
"""

from dataclasses import dataclass

import numpy as np

from dem.ground import Ground
from dem.model import DiscModel
from meshes.section.section import Section

WIDTH = 2.0  # of a column, in diameters
STANDS_OUT = 0.1  # of the largest jump, below which a column has not slipped


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
    """Elevation of the largest jump of downhill displacement from disc to disc in every column; where it stands out."""
    free = ~model.fixed
    x, z = ground.to_section(before.x[free], before.z[free])
    moved, _ = ground.turned(model.x[free] - before.x[free], model.z[free] - before.z[free])
    width = WIDTH * 2.0 * ground.radius
    column = ((x - x.min()) / width).astype(int)
    found = []
    for c in range(column.max() + 1):
        here = np.flatnonzero(column == c)
        level, jump = _largest_jump(z[here], moved[here], 1.8 * ground.radius)
        if np.isfinite(level):
            found.append((float(x[here].mean()), level, jump))
    if not found:
        return np.zeros((0, 2))
    table = np.array(found)
    return table[table[:, 2] > STANDS_OUT * table[:, 2].max(), :2]


def _largest_jump(z: np.ndarray, moved: np.ndarray, reach: float) -> tuple[float, float]:
    """Level (m) at which the mean displacement of the discs within `reach` above and below differs most, and by how
    much (m); not a number without discs on both sides."""
    order = np.argsort(z, kind="stable")
    z, moved = z[order], moved[order]
    total = np.append(0.0, np.cumsum(moved))
    levels = 0.5 * (z[1:] + z[:-1])
    middle = np.arange(1, len(z))
    low, high = np.searchsorted(z, levels - reach), np.searchsorted(z, levels + reach)
    both = (high > middle) & (middle > low)  # a void as high as the reach has discs on neither side
    levels, low, middle, high = levels[both], low[both], middle[both], high[both]
    jump = np.abs((total[high] - total[middle]) / (high - middle) - (total[middle] - total[low]) / (middle - low))
    if not len(jump):
        return float("nan"), 0.0
    k = int(np.argmax(jump))
    return float(levels[k]), float(jump[k])


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
