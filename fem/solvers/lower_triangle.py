"""Assembles and factorises the lower triangle of a positive definite matrix that is the sum of many small matrices."""

import numpy as np
from scipy import sparse

from fem.kernels.lower_triangle import find_places
from fem.solvers.cholmod import Cholesky, NotPositiveDefiniteError

# Shares by which the diagonal is made larger where rounding leaves a pivot that is not positive, one after the other.
# Stiffnesses of corners at yield and of others differ by 1e16 near a solution; refinement takes the share out again.
DIAGONAL_SHIFTS = (1e-13, 1e-12, 1e-11, 1e-10)


class LowerTriangle:
    """Factorises matrices of one pattern.

    Attributes
    ----------
    entries : ndarray (e,)
        Entries of the lower triangle, column by column; they are set before ``factorise``.
    diagonal : ndarray (n,)
        Places of the diagonal among the entries.
    row_start, places : ndarrays (k + 1,), (pairs,)
        Small matrix i has its lower triangle, row by row, at ``places[row_start[i] : row_start[i + 1]]`` of the
        entries.

    Parameters
    ----------
    starts (k + 1,), columns : unknowns of the small matrices in rising order: ``columns[starts[i] : starts[i + 1]]``
        are those of number i
    size : number of unknowns, n
    nested : whether the unknowns are ordered by nested dissection, see ``Cholesky``
    """

    def __init__(self, starts: np.ndarray, columns: np.ndarray, size: int, nested: bool = True) -> None:
        touched = sparse.csr_matrix((np.ones(len(columns)), columns, starts), shape=(len(starts) - 1, size))
        identity = sparse.identity(size)  # a diagonal everywhere
        pattern = sparse.tril(touched.T @ touched + identity, format="csc")
        pattern.sort_indices()
        width = np.diff(starts)
        self.row_start = np.concatenate([[0], np.cumsum(width * (width + 1) // 2)])
        self.places = np.empty(int(self.row_start[-1]), dtype=np.int32)
        find_places(starts, columns, pattern.indptr, pattern.indices, self.row_start, self.places)
        self.entries = np.empty(pattern.nnz)
        self.diagonal = pattern.indptr[:-1]
        self._factors = Cholesky(pattern, nested)

    def factorise(self) -> None:
        """Factorise the ``entries``, with the smallest of `DIAGONAL_SHIFTS` added to the diagonal that makes the
        matrix positive definite.

        Raises NotPositiveDefiniteError if no share makes the matrix positive definite.
        """
        diagonal = self.entries[self.diagonal]
        for share in (0.0, *DIAGONAL_SHIFTS):
            self.entries[self.diagonal] = (1.0 + share) * diagonal
            try:
                return self._factors.factorise(self.entries)
            except NotPositiveDefiniteError:
                if share == DIAGONAL_SHIFTS[-1]:
                    raise

    def solve(self, side: np.ndarray) -> np.ndarray:
        """Return the solution (n,) for a right-hand side (n,)."""
        return self._factors.solve(side[:, None])[:, 0]
