"""Assembles and factorises the stiffness matrix of an interior-point method, Σ Bᵀ D B over the corners of a program."""

import numpy as np
from scipy import sparse

from fem.kernels.corner_stiffness import add_stiffnesses
from fem.solvers.lower_triangle import LowerTriangle


class CornerMatrix:
    """Factorises Σ Bᵀ D B for a constant B and changing D.

    Parameters
    ----------
    rates (3 k, n) : the matrix B of strain rates, three rows for each corner
    """

    def __init__(self, rates: sparse.csr_matrix) -> None:
        corners = rates.shape[0] // 3
        entries = rates.tocoo()
        touched = sparse.csr_matrix(
            (np.ones(entries.nnz), (entries.row // 3, entries.col)), shape=(corners, rates.shape[1])
        )
        touched.sum_duplicates()
        touched.sort_indices()
        self._starts, self._columns = touched.indptr.astype(np.int64), touched.indices
        width = np.diff(self._starts)
        keys = np.repeat(np.arange(corners), width) * rates.shape[1] + self._columns
        self._values = np.zeros((touched.nnz, 3))
        place = np.searchsorted(keys, (entries.row // 3).astype(np.int64) * rates.shape[1] + entries.col)
        self._values[place, entries.row % 3] = entries.data
        self._triangle = LowerTriangle(self._starts, self._columns, rates.shape[1])

    @property
    def entries(self) -> int:
        """Return the entries of the lower triangle of the stiffness matrix Σ Bᵀ D B."""
        return len(self._triangle.entries)

    def factorise(self, stiffness: np.ndarray) -> None:
        """Factorise the matrix for D (k, 3, 3); raise NotPositiveDefiniteError."""
        lower = self._triangle
        lower.entries[:] = 0.0
        add_stiffnesses(stiffness, self._starts, self._values, lower.places, lower.row_start, lower.entries)
        lower.factorise()

    def solve(self, side: np.ndarray) -> np.ndarray:
        """Return the solution (n,) for a right-hand side (n,)."""
        return self._triangle.solve(side)
