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

import numpy as np

from dem.kernels import liquefied_pairs as bond
from dem.neighbourhood import SMALLEST_DISTANCE, Neighbourhood
from dem.state import DiscState


def take_back_shear(state: DiscState) -> None:
    """Set the forces that cancel the shear stress which the pressure between liquefied discs causes, for the present
    list of pairs.

    Parameters
    ----------
    state : discs with a new list of pairs; the columns `COUNTER_ALONG` and `COUNTER_ACROSS` of the history of bonds (N)
        are changed
    """
    wet, i, j = state.liquefied, state.liquefied_i, state.liquefied_j
    degree, of_discs, area = wet[:, bond.SHARE], wet[:, bond.PRESSURE_TERM], wet[:, bond.AREA]
    liquefied = degree > 0.0
    soft = liquefied & (wet[:, bond.KNEE_STRAIN] > 0.0)
    if not soft.any():
        return
    near = Neighbourhood.of(state, wet[:, bond.AT_X], wet[:, bond.AT_Z])
    nx, nz, apart, share = near.nx, near.nz, near.apart, near.share
    wet_area = np.where(liquefied, area, 0.0)
    most = np.maximum(np.maximum(degree[i], degree[j]), SMALLEST_DISTANCE)
    pressure = (2.0 - degree[j] / most) * of_discs[i] + (2.0 - degree[i] / most) * of_discs[j]
    half = -0.5 * pressure * area[i] * area[j] * near.slope * apart
    voids = np.where(area > 0.0, area, 1.0)
    borne_along, borne_across = 0.5 * half * (nx * nx - nz * nz), half * nx * nz
    along_axes = near.mean(-near.sums(borne_along, borne_along) / voids, wet_area)  # (s_xx - s_zz) / 2
    across_axes = near.mean(-near.sums(borne_across, borne_across) / voids, wet_area)  # s_xz
    lever = near.sums(share * apart, share * apart)
    per_stress = np.where(soft, -2.0 * area / np.maximum(lever, SMALLEST_DISTANCE * state.reach), 0.0)
    first, second = per_stress * along_axes, per_stress * across_axes
    twice = np.where(liquefied[i] & liquefied[j], 1.0, 2.0)
    a, b = twice * share * (first[i] + first[j]), twice * share * (second[i] + second[j])
    fx, fz = a * nx + b * nz, b * nx - a * nz
    state.bonds[:, bond.COUNTER_ALONG_AT] = fx * nx + fz * nz
    state.bonds[:, bond.COUNTER_ACROSS_AT] = fz * nx - fx * nz
