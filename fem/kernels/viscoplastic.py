"""Adds a small overstress to the stress of a step, which makes the solution with non-associated flow unique (kernel).

With the inviscid stress s_p of the step and the elastic one s_e, Duvaut & Lions' model integrated by backward Euler is

    s = (1 - b) s_p + b s_e,    b = T / (T + dt)    (Simo & Hughes 1998, eq. 2.7.16),

with the relaxation time T. The tangent is the same weighted mean of the inviscid and the elastic tangent. Components
and signs as in ``mohr_coulomb``.
"""

import numba as nb
import numpy as np


@nb.njit(cache=True, nogil=True)
def add_overstress(
    b: float,
    strain_increment: np.ndarray,
    stress_old: np.ndarray,
    material: np.ndarray,
    elastic: np.ndarray,
    stress: np.ndarray,
    tangent: np.ndarray,
    plastic_strain_increment: np.ndarray,
) -> None:
    """Add a share of the elastic stress to the inviscid one, in place; ``b`` is the weight of the elastic stress.

    ``strain_increment``, ``stress_old``, ``stress`` and ``plastic_strain_increment`` are (n, 4), ``tangent`` is (n, 4,
    4) or empty, ``material`` (n,) contains indices of ``elastic`` (materials, 4, 4).
    """
    for point in range(len(stress)):
        law = elastic[material[point]]
        for i in range(4):
            trial = stress_old[point, i]
            for j in range(4):
                trial += law[i, j] * strain_increment[point, j]
            stress[point, i] += b * (trial - stress[point, i])
            plastic_strain_increment[point, i] *= 1.0 - b
        if len(tangent):
            for i in range(4):
                for j in range(4):
                    tangent[point, i, j] += b * (law[i, j] - tangent[point, i, j])
