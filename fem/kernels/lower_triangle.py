"""Adds many small symmetric matrices to the lower triangle of a sparse matrix (kernels)."""

import numpy as np
from numba import njit


@njit(cache=True, nogil=True, error_model="numpy")
def find_places(
    starts: np.ndarray, columns: np.ndarray, pointers: np.ndarray, indices: np.ndarray, first: np.ndarray,
    places: np.ndarray,
) -> None:  # fmt: skip
    """Find the places of the entries of small matrices, row by row of their lower triangles, among the entries of a
    sorted csc matrix.

    Matrix k has the unknowns ``columns`` from ``starts[k]`` on, and its ``places`` begin at ``first[k]``; ``pointers``
    and ``indices`` are those of the csc matrix.
    """
    for k in range(len(starts) - 1):
        place = first[k]
        for i in range(starts[k], starts[k + 1]):
            for j in range(starts[k], i + 1):
                low, high, row = pointers[columns[j]], pointers[columns[j] + 1], columns[i]
                while low < high:
                    middle = (low + high) // 2
                    if indices[middle] < row:
                        low = middle + 1
                    else:
                        high = middle
                places[place] = low
                place += 1


@njit(cache=True, nogil=True)
def add_matrices(matrices: np.ndarray, order: np.ndarray, places: np.ndarray, entries: np.ndarray) -> None:
    """Add symmetric ``matrices`` (k, at least n, n) to the ``entries`` at their ``places``; ``order`` (k, n) sorts the
    rows of each matrix by rising unknowns."""
    place = 0
    for k in range(len(order)):
        for i in order[k]:
            for j in order[k]:
                entries[places[place]] += matrices[k, i, j]
                place += 1
                if i == j:
                    break
