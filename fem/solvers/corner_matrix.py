"""Provides the matrix B of strain rates at the corners of a program: products, and the stiffness matrix Σ Bᵀ D B."""

import numpy as np
from scipy import sparse

from fem.kernels.corner_products import add_forces, strain_rates
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
        self._size = rates.shape[1]
        self._triangle = LowerTriangle(self._starts, self._columns, rates.shape[1])

    @property
    def size(self) -> int:
        """Return the number of velocities, n."""
        return self._size

    @property
    def entries(self) -> int:
        """Return the entries of the lower triangle of the stiffness matrix Σ Bᵀ D B."""
        return len(self._triangle.entries)

    def rates(self, velocity: np.ndarray) -> np.ndarray:
        """Return the strain rates B v (k, 3) of a velocity (n,)."""
        rates = np.empty((len(self._starts) - 1, 3))
        strain_rates(self._starts, self._columns, self._values, velocity, rates)
        return rates

    def add_forces(self, stress: np.ndarray, force: np.ndarray) -> None:
        """Add Bᵀ m of a stress (k, 3) to a ``force`` (n,)."""
        add_forces(self._starts, self._columns, self._values, stress, force)

    def factorise(self, stiffness: np.ndarray) -> None:
        """Factorise the matrix for D (k, 3, 3); raise NotPositiveDefiniteError."""
        lower = self._triangle
        lower.entries[:] = 0.0
        add_stiffnesses(stiffness, self._starts, self._values, lower.places, lower.row_start, lower.entries)
        lower.factorise()

    def solve(self, side: np.ndarray) -> np.ndarray:
        """Return the solution (n,) for a right-hand side (n,)."""
        return self._triangle.solve(side)
