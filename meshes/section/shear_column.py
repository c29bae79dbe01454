"""Integrates a column of layers that shear on a base at rest: an endless slope (kernel).

Each layer has a shear stress τ(γ) that resists the motion of the ground above it: a straight line up to a strain
potential, a second one up to the strength, then slip. A dashpot is in parallel, but ground never resists with more than
its strength. While a layer liquefies, its law changes in proportion to the time of its onset, or its stiffness by a
power. Quantities are positive to the right; a shear stress is positive if it holds the ground above it back from moving
to the right.
"""

import math

import numpy as np
from numba import njit

# Columns of the law of a layer: strength (Pa), strain potential (-), stress there (Pa), strain from there to the
# strength (-), and viscosity while the strain is less than the strain potential, and else (Pa s).
STRENGTH, POTENTIAL, KNEE, REGAINING, SOFT_VISCOSITY, VISCOSITY = range(6)


@njit(cache=True, nogil=True, error_model="numpy")
def shear_column(
    mass: np.ndarray,
    thickness: np.ndarray,
    pull: np.ndarray,
    laws: np.ndarray,
    begin: np.ndarray,
    onset: float,
    dt: float,
    acceleration: np.ndarray,
    every: int,
    by_stiffness: bool,
) -> np.ndarray:
    """Return the velocity of the top of each layer in time.

    Parameters
    ----------
    mass (n,) : mass at the top of each layer, from the lowest layer up (kg/m²)
    thickness (n,) : thickness of each layer (m)
    pull (n,) : force by weight on each mass (N/m²); the column is at rest under it at the beginning
    laws (2, n, 6) : law of each layer before and after liquefaction, columns as in `STRENGTH` and the names after it
    begin (n,) : time at which each layer begins to liquefy (s), infinite if it does not
    onset : time in which a layer liquefies (s)
    dt : time step (s)
    acceleration (steps,) : horizontal acceleration of all masses in each step (m/s²)
    every : steps between two records
    by_stiffness : whether, while a layer liquefies, the stiffness below its strain potential falls as a power of the
        stiffness after liquefaction over that before; otherwise the strain potential grows in proportion to time

    Returns
    -------
    Velocity (records, n) in m/s at the end of the steps ``every``, 2 ``every``, ...
    """
    n = len(mass)
    speed, strain, stress = np.zeros(n), np.zeros(n), np.zeros(n)
    above = 0.0
    for k in range(n - 1, -1, -1):
        above += pull[k]
        stress[k] = above
        strain[k] = above * laws[0, k, REGAINING] / laws[0, k, STRENGTH]
    out = np.zeros((len(acceleration) // every, n))
    law = np.zeros(6)
    for step in range(len(acceleration)):
        for k in range(n):
            upper = stress[k + 1] if k + 1 < n else 0.0
            speed[k] += dt * ((pull[k] + upper - stress[k]) / mass[k] + acceleration[step])
        for k in range(n):
            degree = (step * dt - begin[k]) / onset if onset > 0.0 else 1.0 * (step * dt >= begin[k])
            degree = min(max(degree, 0.0), 1.0)
            for part in range(6):
                law[part] = laws[0, k, part] + degree * (laws[1, k, part] - laws[0, k, part])
            if by_stiffness and 0.0 < degree < 1.0 and laws[1, k, POTENTIAL] > 0.0:
                stiff = laws[0, k, STRENGTH] / laws[0, k, REGAINING]
                soft = laws[1, k, KNEE] / laws[1, k, POTENTIAL]
                law[KNEE] = laws[1, k, KNEE]
                law[POTENTIAL] = law[KNEE] / (stiff * (soft / stiff) ** degree)
            rate = (speed[k] - (speed[k - 1] if k > 0 else 0.0)) / thickness[k]
            limit = law[POTENTIAL] + law[REGAINING]
            strain[k] = min(max(strain[k] + dt * rate, -limit), limit)
            size = abs(strain[k])
            if size < law[POTENTIAL]:
                elastic, viscosity = law[KNEE] * size / law[POTENTIAL], law[SOFT_VISCOSITY]
            else:
                share = (size - law[POTENTIAL]) / law[REGAINING]
                elastic, viscosity = law[KNEE] + (law[STRENGTH] - law[KNEE]) * share, law[VISCOSITY]
            total = math.copysign(elastic, strain[k]) + viscosity * rate
            stress[k] = min(max(total, -law[STRENGTH]), law[STRENGTH])
        if (step + 1) % every == 0:
            out[(step + 1) // every - 1] = speed
    return out
