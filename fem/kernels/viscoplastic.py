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
    """Add a share of the elastic stress to the inviscid one, in place.

    Parameters
    ----------
    b : weight of the elastic stress (-)
    strain_increment (n, 4) : strain increment of the step (-)
    stress_old (n, 4) : stress before the step (Pa)
    material (n,) : numbers of the materials
    elastic (materials, 4, 4) : Hooke's law (Pa)
    stress (n, 4) : inviscid stress (Pa), which becomes the weighted mean
    tangent (n, 4, 4) : inviscid tangent (Pa), which becomes the weighted mean; may be empty
    plastic_strain_increment (n, 4) : plastic strain increment, which is reduced (-)
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
