"""Lists the edges of cells, each once, for cells with any number of corners."""

import numpy as np


def edges_of(cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the edges (e, 2), the lower point number of each first, and the numbers of the edges of every cell,
    (cells, corners).

    ``cells`` (cells, corners) are point numbers in the order round the cell; its edge k leads from corner k onwards.
    """
    ends = np.stack([cells, np.roll(cells, -1, axis=1)], axis=-1)
    edges, number = np.unique(np.sort(ends.reshape(-1, 2), axis=1), axis=0, return_inverse=True)
    return edges, number.reshape(cells.shape)


def without_cells(cells: np.ndarray, boundary: np.ndarray) -> np.ndarray:
    """Return edges (k, 2) that are outer edges of the cells but not of the ``boundary`` (n, 2), or vice versa."""
    edges, of_cell = edges_of(cells)
    outer = edges[np.bincount(of_cell.ravel()) == 1]
    either, times = np.unique(np.concatenate([outer, np.sort(boundary, axis=1)]), axis=0, return_counts=True)
    return np.asarray(either[times == 1])
