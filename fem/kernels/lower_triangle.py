"""Adds many small symmetric matrices to the lower triangle of a sparse matrix (kernels)."""

import numpy as np
from numba import njit


@njit(cache=True, nogil=True, error_model="numpy")
def find_places(
    starts: np.ndarray, columns: np.ndarray, pointers: np.ndarray, indices: np.ndarray, first: np.ndarray,
    places: np.ndarray,
) -> None:  # fmt: skip
    """Find the places of the entries of small symmetric matrices among the entries of a sorted csc matrix.

    Parameters
    ----------
    starts (k + 1,) : small matrix i has the unknowns ``columns[starts[i] : starts[i + 1]]``
    columns (unknowns of all matrices,) : numbers of the unknowns, rising in each matrix
    pointers, indices : ``indptr`` and ``indices`` of the lower triangle in csc format
    first (k + 1,) : the places of matrix i begin at ``first[i]``
    places (pairs,) : set to the places, row by row of the lower triangle of each small matrix
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
    """Add small symmetric matrices to the entries of a lower triangle.

    Parameters
    ----------
    matrices (k, m, m) : small matrices; the first n <= m rows and columns of each are added
    order (k, n) : rows of each matrix by rising numbers of their unknowns
    places (pairs,) : places of `find_places`
    entries (e,) : entries of the triangle, which are increased
    """
    place = 0
    for k in range(len(order)):
        for i in order[k]:
            for j in order[k]:
                entries[places[place]] += matrices[k, i, j]
                place += 1
                if i == j:
                    break
