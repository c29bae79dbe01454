"""Removes the shear stress that the pressure of liquefied discs causes, since pore water has no shear stress.

The pressure between two discs acts along the line of centres. On average over all directions the forces between discs
are an isotropic pressure, but the few neighbours of a disc are denser in some directions than in others. The pressure
in shearing ground therefore contributes a shear stress of 0.5 to 0.9 % of the effective stress, which matters for the
displacement of ground with a strain potential. The deviatoric part of this stress, a mean over neighbours, is measured
with every new list of pairs (virial of Love 1927). Until the next list, opposite forces on the two discs of a pair
subtract this deviatoric part: for a stress s and the unit vector n of the line of centres the force is k s n, with k =
2 (V_i/S_i + V_j/S_j) w as for the bonds (`kernels.liquefied_pairs`), so that the sum of these forces has the stress s.
For discs without a strain potential nothing is subtracted: their total strength is adjusted instead
(`liquefied_ground`).
"""

from collections.abc import Callable

import numpy as np

from dem.kernels import liquefied_pairs as bond
from dem.state import DiscState, nearest_image

SMALLEST_DISTANCE = 1e-9  # reaches: no pair counts as nearer


def take_back_shear(state: DiscState) -> None:
    """Set the forces that cancel the shear stress which the pressure between liquefied discs causes, for the present
    list of pairs.

    Parameters
    ----------
    state : discs with a new list of pairs; the columns `COUNTER_ALONG` and `COUNTER_ACROSS` of the history of bonds (N)
        are changed
    """
    wet, i, j = state.liquefied, state.liquefied_i, state.liquefied_j
    soft = (wet[:, bond.SHARE] > 0.0) & (wet[:, bond.KNEE_STRAIN] > 0.0)
    if not soft.any():
        return
    dx, dz = wet[j, bond.AT_X] - wet[i, bond.AT_X], wet[j, bond.AT_Z] - wet[i, bond.AT_Z]
    dx, dz = nearest_image(dx, dz, state.repeats)
    apart = np.maximum(np.hypot(dx, dz), SMALLEST_DISTANCE * state.reach)
    nx, nz, q = dx / apart, dz / apart, np.minimum(apart / state.reach, 1.0)
    rest, scale = 1.0 - q, 7.0 / (np.pi * state.reach**2)
    width, slope = scale * rest**4 * (1.0 + 4.0 * q), -20.0 * scale * q * rest**3 / state.reach
    share = rest * rest * (1.0 + 2.0 * q)
    area = wet[:, bond.AREA]
    liquefied = wet[:, bond.SHARE] > 0.0
    inside = liquefied[i] & liquefied[j]
    twice = np.where(inside, 1.0, 2.0)

    def over_pairs(to_first: np.ndarray, to_second: np.ndarray) -> np.ndarray:
        return np.bincount(i, to_first, len(state)) + np.bincount(j, to_second, len(state))

    def shared(values: np.ndarray) -> np.ndarray:
        return over_pairs(values, values)

    mean = _mean(over_pairs, i, j, np.where(inside, width, 0.0), np.where(liquefied, area, 0.0), scale)
    of_discs, degree = wet[:, bond.PRESSURE_TERM], wet[:, bond.SHARE]
    most = np.maximum(np.maximum(degree[i], degree[j]), SMALLEST_DISTANCE)
    pressure = (2.0 - degree[j] / most) * of_discs[i] + (2.0 - degree[i] / most) * of_discs[j]
    pressure_force = -pressure * area[i] * area[j] * slope
    half, voids = 0.5 * pressure_force * apart, np.where(area > 0.0, area, 1.0)
    along_axes = mean(-shared(0.5 * half * (nx * nx - nz * nz)) / voids)  # (s_xx - s_zz) / 2
    across_axes = mean(-shared(half * nx * nz) / voids)  # s_xz
    lever = shared(share * apart)
    per_stress = np.where(soft, -2.0 * area / np.maximum(lever, SMALLEST_DISTANCE * state.reach), 0.0)
    first, second = per_stress * along_axes, per_stress * across_axes
    a, b = twice * share * (first[i] + first[j]), twice * share * (second[i] + second[j])
    fx, fz = a * nx + b * nz, b * nx - a * nz
    state.bonds[:, bond.COUNTER_ALONG_AT] = fx * nx + fz * nz
    state.bonds[:, bond.COUNTER_ACROSS_AT] = fz * nx - fx * nz


def _mean(
    over_pairs: Callable[[np.ndarray, np.ndarray], np.ndarray],
    i: np.ndarray, j: np.ndarray, width: np.ndarray, area: np.ndarray, at_zero: float,
) -> Callable[[np.ndarray], np.ndarray]:  # fmt: skip
    """Return the mean of values (n,) of discs over their liquefied neighbours, weighted by the kernel and the areas of
    the neighbours.

    over_pairs: function that adds up two values of every pair, for its disc i and its disc j, to a sum for every disc;
    i, j (pairs,): discs of each pair; width (pairs,): W, 0 but for two
    liquefied discs (1/m2); area (n,): areas of liquefied discs, 0 for others (m2); at_zero: W at no distance (1/m2).
    """
    weight = at_zero * area + over_pairs(width * area[j], width * area[i])
    whole = np.where(weight > 0.0, weight, 1.0)

    def mean(values: np.ndarray) -> np.ndarray:
        near = over_pairs(width * area[j] * values[j], width * area[i] * values[i])
        return np.asarray((at_zero * area * values + near) / whole)

    return mean
