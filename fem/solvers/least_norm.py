"""The least change that meets linear equations, by one sparse factorisation."""

from functools import partial

import clarabel
import numpy as np
from scipy import sparse

from meshes.executor import interruptible

MOST_CORRECTIONS = 30


def smallest_correction(matrix: sparse.spmatrix, residual: np.ndarray) -> np.ndarray:
    """The shortest d with ``matrix`` d = ``residual`` as nearly as rounding allows; rows may depend on each other.

    Clarabel solves min |d|²/2 with these equations by one factorisation of [[1, Aᵀ], [A, 0]], in an approximate minimum
    degree ordering (Amestoy, Davis & Duff 1996). SuperLU's multiple minimum degree takes a hundred times as long to
    order A Aᵀ of thin layers: 81 s for 75,000 equations.
    """
    rows = matrix.shape[0]
    if rows == 0 or not np.any(residual):
        return np.zeros(matrix.shape[1])
    matrix = sparse.csr_matrix(matrix)
    length = np.sqrt(np.asarray(matrix.multiply(matrix).sum(axis=1)).ravel())
    scaled = sparse.diags(1.0 / np.where(length > 0.0, length, 1.0)) @ matrix
    left = residual / np.where(length > 0.0, length, 1.0)
    correction = np.zeros(matrix.shape[1])
    missed = np.inf
    for _ in range(MOST_CORRECTIONS):
        rest = left - scaled @ correction
        if not 0.0 < np.abs(rest).max() < 0.5 * missed:  # met, no longer better, or no number
            break
        missed = np.abs(rest).max()
        correction += missed * interruptible(partial(_shortest, scaled.tocsc(), rest / missed))
    return correction


def _shortest(matrix: sparse.csc_matrix, right: np.ndarray) -> np.ndarray:
    """The shortest d with ``matrix`` d = ``right``, but for the regularisation of the factors."""
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.static_regularization_constant = 1e-10
    settings.max_iter = 1  # with equations alone the point to start from is the solution
    settings.equilibrate_enable = settings.presolve_enable = False
    settings.direct_solve_method = "qdldl"
    rows, size = matrix.shape
    identity, zeros = sparse.identity(size, format="csc"), np.zeros(size)
    solver = clarabel.DefaultSolver(identity, zeros, matrix, right, [clarabel.ZeroConeT(rows)], settings)
    return np.asarray(solver.solve().x)
