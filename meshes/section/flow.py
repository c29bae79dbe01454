"""Computes the seepage of a section: heads and permeabilities on the grid, and the resulting lines of water."""

from collections.abc import Callable, Iterable, Sequence

import numpy as np

from meshes.errors import InputError
from meshes.section.flow_grid import FlowGrid, Wall, flow_grid
from meshes.section.layering import Layering
from meshes.section.polyline import level_at
from meshes.section.seepage import Seepage, steady_seepage
from meshes.section.stratum import Stratum
from meshes.section.water_pressure import WaterPressure

# So many triangles would have the area of the section if they were squares halved.
SQUARES = 4500
# Where ground is more permeable along x, triangles are longer by the root of the ratio, up to this.
MOST_STRETCHED = 4.0


def seepage_of(
    name: str,
    strata: Sequence[Stratum],
    layers_with: Callable[[Iterable[float]], Layering],
    still: WaterPressure,
    walls: Sequence[Wall] = (),
) -> Seepage:
    """Compute the steady seepage of a section between the free water on the ground and at the sides.

    Parameters
    ----------
    name : name of the section, for messages
    strata : the strata of the file; each has a permeability
    layers_with : function that returns the layers of these strata with breakpoints at additional x (m)
    still : static water everywhere; its water table determines the heads
    walls : walls that no water crosses

    Raises
    ------
    InputError : if the water table lies above neither the ground nor a side, so that there is no head
    SeepageError : if the iteration of the phreatic line does not converge
    """
    table = still.table_before
    assert table is not None  # Water sees to it
    plain = layers_with([])
    shores = _shores(plain, table)
    layers = layers_with([*shores, *(wall.x for wall in walls)])
    size = float(np.sqrt(layers.areas().sum() / SQUARES))
    steps = layers.x[1:-1][np.abs(layers.right[:-1, 0] - layers.left[1:, 0]) > layers.tolerance]
    levels = np.unique(np.interp([layers.x[0], *shores, *steps, layers.x[-1]], *table.T))
    k = np.array([(s.permeability or 0.0, s.permeability_vertical or s.permeability or 0.0) for s in strata], float)
    stretch = float(np.sqrt(np.clip(k[:, 0] / k[:, 1], 1.0, MOST_STRETCHED**2).max()))
    grid = flow_grid(layers, size, walls, levels.tolist(), stretch)
    heads = _known_heads(grid, still, table, layers.tolerance)
    if not np.isfinite(heads).any():
        raise InputError(
            name,
            ["water, flow: the table is below the base at both sides, and there is no free water; expected water at "
             "one side at least, from which it flows"],
        )  # fmt: skip
    return steady_seepage(grid, k, _without_islands(grid, heads), table, layers.tolerance)


def _shores(layers: Layering, table: np.ndarray) -> list[float]:
    """Return the x at which the water table crosses the ground (m)."""
    x = np.union1d(layers.x, table[(table[:, 0] > layers.x[0]) & (table[:, 0] < layers.x[-1]), 0])
    middle = 0.5 * (x[1:] + x[:-1])
    first, last = (level_at(table, end, middle) - layers.interface(0, end, near=middle) for end in (x[:-1], x[1:]))
    i = np.flatnonzero(first * last < 0.0)
    return [float(at) for at in x[i] + (x[i + 1] - x[i]) * first[i] / (first[i] - last[i])]


def _known_heads(grid: FlowGrid, still: WaterPressure, table: np.ndarray, tolerance: float) -> np.ndarray:
    """Return the heads (n,) of the points below free water and, at the sides, below the water table; NaN at other
    points."""
    heads = np.full(len(grid.points), np.nan)
    places = np.unique(np.concatenate([grid.ground, *grid.sides]))
    points, middle = grid.points[places], grid.points[grid.cells].mean(axis=1)
    cells = np.bincount(grid.cells.ravel(), minlength=len(heads))
    inside = np.bincount(grid.cells.ravel(), np.repeat(middle[:, 0], 3), minlength=len(heads))[places] / cells[places]
    near = np.column_stack([inside, points[:, 1]])
    under = level_at(table, points[:, 0], inside) >= points[:, 1] - 1e-3 * tolerance
    pressure = still.hydrostatic(table, points, near) / still.unit_weight
    heads[places[under]] = (points[:, 1] + pressure)[under]
    return heads


def _without_islands(grid: FlowGrid, heads: np.ndarray) -> np.ndarray:
    """Return the prescribed heads. Ground that no water reaches is dry: its lowest point gets a head equal to its
    elevation."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    size = len(grid.points)
    ends = np.concatenate([grid.cells[:, pair] for pair in ([0, 1], [1, 2])])
    _, part = connected_components(coo_array((np.ones(len(ends)), ends.T), shape=(size, size)), directed=False)
    heads = heads.copy()
    for number in np.setdiff1d(part, part[np.isfinite(heads)]):
        members = np.flatnonzero(part == number)
        lowest = members[np.argmin(grid.points[members, 1])]
        heads[lowest] = grid.points[lowest, 1]
    return heads
