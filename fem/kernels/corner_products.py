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
    """Compute the strain rates of corners under a velocity.

    Parameters
    ----------
    starts (k + 1,) : corner i has the columns ``columns[starts[i] : starts[i + 1]]``
    columns (entries,) : numbers of the velocities on which the strain rates of each corner depend
    values (entries, 3) : derivatives of the three strain rates by each of these velocities (1/m)
    velocity (n,) : velocities
    rates (k, 3) : set to the strain rates
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
    """Add the forces of a stress at the corners to a force, by the transposed matrix of `strain_rates`.

    Parameters
    ----------
    starts, columns, values : matrix of strain rates, as in `strain_rates`
    stress (k, 3) : multipliers of the strain rates
    force (n,) : increased by the forces
    """
    for k in range(len(starts) - 1):
        a, b, c = stress[k, 0], stress[k, 1], stress[k, 2]
        for place in range(starts[k], starts[k + 1]):
            force[columns[place]] += values[place, 0] * a + values[place, 1] * b + values[place, 2] * c
