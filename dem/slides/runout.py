"""Measures the run-out of discs: profile of the deposit, quantiles of the mass, and mass that has left the connected
ground.

All distances are in the frame of the discs, in m. The deposit is the connected ground: discs that touch, or nearly,
without those that flew or rolled away.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from dem.liquefied_ground import is_liquefying
from dem.model import DiscModel

# Mean radii: gap between the rims of connected discs, about the free space of a disc between its neighbours.
GAP_OF_NEIGHBOURS = 0.25
GAP_OF_BONDED = 1.0  # the same for liquefied discs and undrained clay, whose bonds reach two diameters
REPORTED_MASS = 0.01  # share of the mass outside the connected ground above which it is reported
FULL_ROW = 0.5  # of a row of discs: columns with less are beyond the front


@dataclass(frozen=True)
class RunOut:
    """Holds the extent of a deposit of discs.

    Attributes
    ----------
    front : float
        Farthest point of the discs of the connected deposit along x (m).
    x98 : float
        Horizontal position to the left of which 98 % of the mass lies (m).
    height : float
        Height of the top of the connected deposit above its lowest point (m).
    loose : float
        Share of the mass that has left the connected ground.
    """

    front: float
    x98: float
    height: float
    loose: float


def connected_ground(model: DiscModel) -> np.ndarray:
    """Find the connected free discs, as a mask (n,): the part of the largest mass whose discs touch, or nearly touch.

    Parameters
    ----------
    model
        The discs; discs nearly touch if their gap is below a quarter of their mean radius, or below that radius if
        bonds hold both.

    Returns
    -------
    (n,) bool
        The mask, False for fixed discs.
    """
    free = np.flatnonzero(~model.fixed)
    places, r = np.column_stack([model.x, model.z])[free], model.radius[free]
    bonded, mean = is_liquefying(model)[free], float(r.mean())
    i, j = cKDTree(places).query_pairs(2.0 * float(r.max()) + GAP_OF_BONDED * mean, output_type="ndarray").T
    nearly = np.where(bonded[i] & bonded[j], GAP_OF_BONDED, GAP_OF_NEIGHBOURS) * mean
    near = np.hypot(*(places[j] - places[i]).T) < r[i] + r[j] + nearly
    links = coo_matrix((np.ones(int(near.sum())), (i[near], j[near])), shape=(len(free), len(free)))
    _, part = connected_components(links, directed=False)
    largest = int(np.bincount(part, model.mass[free]).argmax())
    chosen = np.zeros(len(model), bool)
    chosen[free[part == largest]] = True
    return chosen


def loose_share(model: DiscModel) -> float:
    """Return the share of the mass of the free discs that has left the connected ground.

    Parameters
    ----------
    model : DiscModel
        Discs, see `connected_ground`.

    Returns
    -------
    float
        Share of the mass, from 0 to 1.
    """
    free = ~model.fixed
    return float(1.0 - model.mass[connected_ground(model)].sum() / model.mass[free].sum())


def on_loose_mass(share: float) -> list[str]:
    """Return a sentence on the share of the mass that has left the connected ground; empty if the share is small."""
    if share <= REPORTED_MASS:
        return []
    return [f"{100.0 * share:.0f} % of the mass has left the connected ground: single discs flew or rolled away"]


def mass_quantile(model: DiscModel, share: float) -> float:
    """Return the position x (m) to the left of which this share of the mass of the free discs lies.

    Parameters
    ----------
    model
        Discs.
    share
        Share of the mass, from 0 to 1.

    Returns
    -------
    float
        Position in the frame of the discs (m).

    Raises
    ------
    ValueError
        If the share is not between 0 and 1.
    """
    if not 0.0 <= share <= 1.0:
        raise ValueError(f"a share of the mass is between 0 and 1, not {share}")
    free = ~model.fixed
    order = np.argsort(model.x[free], kind="stable")
    below = np.cumsum(model.mass[free][order]) / model.mass[free].sum()
    return float(model.x[free][order][min(int(np.searchsorted(below, share)), len(order) - 1)])


def deposit_profile(model: DiscModel, width: float | None = None) -> np.ndarray:
    """Return the surface of the connected deposit, column by column.

    Parameters
    ----------
    model
        Discs.
    width
        Width of a column (m); four mean radii of the free discs if None.

    Returns
    -------
    (k, 2)
        Middle of each column and highest point of its discs (m), from the left to the last column that contains at
        least half a row of discs; empty columns in between are left out.
    """
    chosen = connected_ground(model)
    x, z, r = model.x[chosen], model.z[chosen], model.radius[chosen]
    step = 4.0 * float(r.mean()) if width is None else width
    column = ((x - x.min()) / step).astype(int)
    top = np.full(column.max() + 1, -np.inf)
    np.maximum.at(top, column, z + r)
    area = np.bincount(column, np.pi * r**2, len(top))
    last = int(np.flatnonzero(area > FULL_ROW * step * 2.0 * float(r.mean()) * np.pi / 4.0).max(initial=0))
    middle = x.min() + (np.arange(len(top)) + 0.5) * step
    covered = np.isfinite(top[: last + 1])
    return np.column_stack([middle[: last + 1][covered], top[: last + 1][covered]])


def run_out(model: DiscModel) -> RunOut:
    """Measure the extent along x of the discs in their present positions.

    Parameters
    ----------
    model
        Discs.

    Returns
    -------
    RunOut
        Extent of the deposit; a column of width d has the run-out `front` - d.
    """
    chosen = connected_ground(model)
    x, z, r = model.x[chosen], model.z[chosen], model.radius[chosen]
    return RunOut(
        float((x + r).max()), mass_quantile(model, 0.98), float((z + r).max() - (z - r).min()), loose_share(model)
    )
