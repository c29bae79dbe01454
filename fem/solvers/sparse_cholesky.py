"""Sparse matrices that are symmetric and positive definite, or nearly so, factorised on one rank."""

from scipy import sparse
from scipy.sparse.linalg import SuperLU, splu


def factorised(matrix: sparse.spmatrix) -> SuperLU:
    """The factors of a matrix, with pivots on its diagonal and the minimum degree ordering that SuperLU wants for them.

    Raises RuntimeError if it is singular.
    """
    options = {"SymmetricMode": True}
    return splu(sparse.csc_matrix(matrix), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
