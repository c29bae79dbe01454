"""Multiplies the matrix of a cone program in standard form, and its transpose, by vectors."""

import numpy as np
from scipy import sparse

from fem.solvers.corner_matrix import CornerMatrix


class ProgramMatrix:
    """Holds the matrix A of a program (``interior_point.Standard``) as its strain rates and a few other entries.

    Nearly all entries are strain rates: a corner has the rows [-volume, -sin φ difference, -sin φ shear] or, where
    φ = 0, [0, -difference, -shear] and a row of its volume among the equations. The others are the first row, which
    holds the load, and the columns after those of the velocities.

    Parameters
    ----------
    matrix (rows, unknowns) : A
    sine (k,), clay (k,) : slopes of the cones and numbers of the corners of clay, as in ``interior_point.Corners``
    rates : strain rates at the corners
    """

    def __init__(self, matrix: sparse.csr_matrix, sine: np.ndarray, clay: np.ndarray, rates: CornerMatrix) -> None:
        self._rates, self._clay = rates, np.flatnonzero(clay >= 0)
        self._velocities, self._first_cone = rates.size, 1 + len(self._clay)
        self._end = self._first_cone + 3 * len(sine)
        self._factor = -np.column_stack([np.where(clay >= 0, 0.0, 1.0), sine, sine])
        self._load = np.asarray(matrix[0].todense()).ravel()
        entries = matrix.tocoo()
        others = (entries.row > 0) & (entries.col >= self._velocities)
        places = entries.row[others], entries.col[others]
        self._others = sparse.csr_matrix((entries.data[others], places), shape=matrix.shape)
        self._others_t = self._others.T.tocsr()

    def times(self, y: np.ndarray) -> np.ndarray:
        """Return A y."""
        rates, product = self._rates.rates(y[: self._velocities]), self._others @ y
        product[0] = self._load @ y
        product[1 : self._first_cone] += rates[self._clay, 0]
        rates *= self._factor
        product[self._first_cone : self._end] += rates.ravel()
        return product

    def transposed_times(self, z: np.ndarray) -> np.ndarray:
        """Return Aᵀ z."""
        stress = self._factor * z[self._first_cone : self._end].reshape(-1, 3)
        stress[self._clay, 0] += z[1 : self._first_cone]
        product = self._others_t @ z
        product += z[0] * self._load
        self._rates.add_forces(stress, product)
        return product
