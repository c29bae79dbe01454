"""Multiplies the matrix of strain rates at the corners of cells, and its transpose, by vectors (kernels).

The three rows of a corner have the same columns: a velocity is read once for all of them, and both products read the
same 28 bytes for three entries, where two sparse matrices would read 72.
"""

import numpy as np
from numba import njit


@njit(cache=True, nogil=True, error_model="numpy")
def strain_rates(
    starts: np.ndarray, columns: np.ndarray, values: np.ndarray, velocity: np.ndarray, rates: np.ndarray
) -> None:
    """Compute the strain ``rates`` (k, 3) of corners under a ``velocity`` (n,).

    Corner k has the columns ``columns[starts[k] : starts[k + 1]]``, and in each the three ``values`` (entries, 3).
    """
    for k in range(len(starts) - 1):
        a = b = c = 0.0
        for place in range(starts[k], starts[k + 1]):
            v = velocity[columns[place]]
            a += values[place, 0] * v
            b += values[place, 1] * v
            c += values[place, 2] * v
        rates[k, 0], rates[k, 1], rates[k, 2] = a, b, c


@njit(cache=True, nogil=True, error_model="numpy")
def add_forces(
    starts: np.ndarray, columns: np.ndarray, values: np.ndarray, stress: np.ndarray, force: np.ndarray
) -> None:
    """Add the forces of a ``stress`` (k, 3) at the corners to ``force`` (n,); ``starts``, ``columns``, ``values``: as
    in `strain_rates`."""
    for k in range(len(starts) - 1):
        a, b, c = stress[k, 0], stress[k, 1], stress[k, 2]
        for place in range(starts[k], starts[k + 1]):
            force[columns[place]] += values[place, 0] * a + values[place, 1] * b + values[place, 2] * c
