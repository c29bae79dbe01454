"""Describes the shear of ground that has liquefied by cyclic mobility: it strains by its strain potential before it
regains strength.

Sand that liquefies in an earthquake, and is not so loose that it flows, has next to no stiffness until it has strained
by its strain potential γ_max. Then it dilates and reaches its residual strength (Yasuda, Yoshida, Adachi et al. 1999,
J. JSCE 638/III-49, 71-89: two straight lines). The slope of the first line follows from the displacement of gently
sloping ground, (S + 0.2) ∫ γ_max dz (Zhang, Robertson & Brachman 2004, J. Geotech. Geoenviron. Eng. 130, 861-871; S is
the slope in %). Under a shear stress of S/100 of the total vertical stress, such ground strains by γ_max if S = 0.8 %;
below shallow water this stress is 1.4 % of the vertical effective stress before the earthquake.
"""

import numpy as np

STRESS_AT_POTENTIAL = 0.014  # shear stress at γ_max over the vertical effective stress
LARGEST_SHARE = 0.5  # largest value of this stress over the residual strength
REGAINING_STRAIN = 0.1  # shear strain beyond γ_max at which the residual strength is reached


def stress_at_potential(effective: np.ndarray, strength: np.ndarray) -> np.ndarray:
    """Return the shear stress at which liquefied ground has strained by its strain potential.

    Parameters
    ----------
    effective (n,) : vertical effective stress before the earthquake (Pa), compression positive
    strength (n,) : residual strength (Pa)

    Returns
    -------
    Shear stress (n,) in Pa.
    """
    return np.minimum(STRESS_AT_POTENTIAL * np.maximum(effective, 0.0), LARGEST_SHARE * strength)
