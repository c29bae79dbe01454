"""The stiffness matrix of an interior-point method, Σ Bᵀ D B over the corners of a program, and its factors."""

import numpy as np
from scipy import sparse

from fem.kernels.corner_stiffness import add_stiffnesses, find_places
from fem.solvers.cholmod import Cholesky, NotPositiveDefiniteError

# Shares by which the diagonal is made larger where rounding leaves a pivot that is not positive, one after the other.
# Stiffnesses of corners at yield and of others differ by 1e16 near a solution; refinement takes the share out again.
STIFFER = (1e-13, 1e-12, 1e-11, 1e-10)


class CornerMatrix:
    """Factors of Σ Bᵀ D B for strain rates B of one pattern, and D that change.

    Parameters
    ----------
    rates : csr matrix (3 k, n)
        B, three rows a corner.
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
        touched.data[:] = 1.0
        identity = sparse.identity(rates.shape[1])  # a diagonal everywhere
        pattern = sparse.tril(touched.T @ touched + identity, format="csc")
        pattern.sort_indices()
        pairs = width.astype(np.int64) * (width + 1) // 2
        self._first = np.concatenate([[0], np.cumsum(pairs)])
        self._places = np.empty(int(self._first[-1]), dtype=np.int32)
        find_places(self._starts, self._columns, pattern.indptr, pattern.indices, self._first, self._places)
        self._entries = np.empty(pattern.nnz)
        self._diagonal = pattern.indptr[:-1]  # the first entries of the columns of a lower triangle
        self._factors = Cholesky(pattern)

    @property
    def entries(self) -> int:
        """Entries of its lower triangle."""
        return len(self._entries)

    def factorise(self, stiffness: np.ndarray) -> None:
        """Factors for D (k, 3, 3), of a diagonal as little larger as they need; raises NotPositiveDefiniteError."""
        self._entries[:] = 0.0
        add_stiffnesses(stiffness, self._starts, self._values, self._places, self._first, self._entries)
        diagonal = self._entries[self._diagonal]
        for share in (0.0, *STIFFER):
            self._entries[self._diagonal] = (1.0 + share) * diagonal
            try:
                return self._factors.factorise(self._entries)
            except NotPositiveDefiniteError:
                if share == STIFFER[-1]:
                    raise

    def solve(self, side: np.ndarray) -> np.ndarray:
        """The solution (n,) for a right-hand side (n,)."""
        return self._factors.solve(side[:, None])[:, 0]
