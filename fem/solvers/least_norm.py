"""Computes the smallest correction that fulfils linear equations, by one sparse factorisation."""

from collections.abc import Callable
from functools import partial

import clarabel
import numpy as np
from scipy import sparse

from fem.solvers import cholmod
from meshes.executor import interruptible

MOST_CORRECTIONS = 30
# Added to the diagonal of A Aᵀ, where the rows of A have the length 1, so that rows may depend on each other. The
# residual that the shift leaves is removed by the next correction.
DIAGONAL_SHIFT = 1e-10
# Number of equations from which CHOLMOD is faster than Clarabel; and the largest residual (-) that counts as zero.
# CHOLMOD may not reach it, since A Aᵀ has the square of the condition number of A; Clarabel then corrects the residual.
CHOLMOD_EQUATIONS, LARGEST_RESIDUAL = 500, 1e-13


def smallest_correction(matrix: sparse.spmatrix, residual: np.ndarray) -> np.ndarray:
    """Return the shortest d with ``matrix`` d = ``residual`` to rounding; rows may be linearly dependent.

    The solution is Aᵀ (A Aᵀ)⁻¹ ``residual``, by CHOLMOD. Clarabel corrects the remaining residual, or all of it where
    CHOLMOD is missing: it solves min |d|²/2 with these equations by one factorisation of [[1, Aᵀ], [A, 0]], in an
    approximate minimum degree ordering (Amestoy, Davis & Duff 1996), in twice the time. SuperLU's multiple minimum
    degree takes a hundred times as long to order A Aᵀ of thin layers: 81 s for 75,000 equations.

    Parameters
    ----------
    matrix (m, n) : coefficients A of the equations; rows may have different units, since each is scaled to length 1
    residual (m,) : right-hand side, what the equations lack

    Returns
    -------
    The correction d (n,); zero without equations or where the residual is zero. If the equations contradict each other,
    the residual that no correction removes remains: the caller checks it.
    """
    rows = matrix.shape[0]
    if rows == 0 or not np.any(residual):
        return np.zeros(matrix.shape[1])
    matrix = sparse.csr_matrix(matrix)
    length = np.sqrt(np.asarray(matrix.multiply(matrix).sum(axis=1)).ravel())
    scaled = sparse.diags(1.0 / np.where(length > 0.0, length, 1.0)) @ matrix
    left = residual / np.where(length > 0.0, length, 1.0)
    correction = np.zeros(matrix.shape[1])
    by_clarabel = partial(_shortest, scaled.tocsc())
    if (
        rows >= CHOLMOD_EQUATIONS
        and np.all(np.isfinite(left))
        and (by_cholmod := _normal_equations(scaled)) is not None
    ):
        correction = _refined(scaled, left, correction, by_cholmod)
        if np.abs(left - scaled @ correction).max() <= LARGEST_RESIDUAL:
            return correction
    return _refined(scaled, left, correction, lambda rest: interruptible(partial(by_clarabel, rest)))


def _refined(
    scaled: sparse.csr_matrix, left: np.ndarray, correction: np.ndarray, shortest: Callable[[np.ndarray], np.ndarray]
) -> np.ndarray:
    """Return the correction, refined by adding the ``shortest`` solution for the remaining residual until this residual
    no longer falls.
    """
    missed = np.inf
    for _ in range(MOST_CORRECTIONS):
        rest = left - scaled @ correction
        if not 0.0 < np.abs(rest).max() < 0.5 * missed:  # met, no longer better, or no number
            break
        missed = np.abs(rest).max()
        correction = correction + missed * shortest(rest / missed)
    return correction


def _normal_equations(scaled: sparse.csr_matrix) -> Callable[[np.ndarray], np.ndarray] | None:
    """Return a function that computes the shortest d with ``scaled`` d = a right-hand side by Cholesky factors,
    regularised by `DIAGONAL_SHIFT`; None without factors.
    """
    if not cholmod.available():
        return None
    lower = sparse.tril(scaled @ scaled.T + DIAGONAL_SHIFT * sparse.identity(scaled.shape[0]), format="csc")
    lower.sort_indices()
    try:
        factors = cholmod.Cholesky(lower, nested=False)  # for one factorisation minimum degree takes half the time
        factors.factorise(lower.data)
    except (MemoryError, cholmod.NotPositiveDefiniteError):
        return None
    return lambda right: scaled.T @ factors.solve(right[:, None])[:, 0]


def _shortest(matrix: sparse.csc_matrix, right: np.ndarray) -> np.ndarray:
    """Return the shortest d with ``matrix`` d = ``right``, except for the regularisation of the factors."""
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
