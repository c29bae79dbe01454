"""Describes the shear of ground that has liquefied by cyclic mobility: it strains by its strain potential before it
regains strength.

Sand that liquefies in an earthquake, and is not so loose that it flows, has next to no stiffness until it has strained
by a multiple of its strain potential γ_max. Then it dilates and reaches its residual strength (Yasuda, Yoshida, Adachi
et al. 1999, J. JSCE 638/III-49, 71-89: two straight lines). The first line follows from the displacement of gently
sloping ground, (S + 0.2) ∫ γ_max dz for slopes S of 0.2 to 3.5 % (Zhang, Robertson & Brachman 2004, J. Geotech.
Geoenviron. Eng. 130, 861-871). Under a shear stress of S/100 of the total vertical stress, such ground strains by γ_max
if S = 0.8 %, which below shallow water is 1.4 % of the vertical effective stress before the earthquake. On the steepest
of these slopes it strains by 3.7 γ_max, where the first line ends, at a strain of 0.8 at most.
"""

from typing import NamedTuple

import numpy as np

NO_STRESS = 1e-3  # Pa
STRESS_AT_POTENTIAL = 0.014  # shear stress at γ_max over the vertical effective stress
LARGEST_MULTIPLE = 3.7  # of γ_max: strain at the end of the first line
# Largest strain there, unless γ_max is larger: both models of large displacement rotate the stress with the ground, so
# that at a strain γ they have only sin γ / γ of the stress on the line.
LARGEST_STRAIN = 0.8
LARGEST_SHARE = 0.5  # largest value of the stress there over the residual strength
REGAINING_STRAIN = 0.1  # shear strain beyond the first line at which the residual strength is reached


class SoftRange(NamedTuple):
    """Holds the end of the first line of the stress-strain law.

    Attributes
    ----------
    strain (n,) : shear strain (-)
    stress (n,) : shear stress (Pa)
    """

    strain: np.ndarray
    stress: np.ndarray


def soft_range(potential: float, effective: np.ndarray, strength: np.ndarray) -> SoftRange:
    """Return how far liquefied ground is soft: the end of the first line of its stress-strain law.

    Parameters
    ----------
    potential : strain potential γ_max (-)
    effective (n,) : vertical effective stress before the earthquake (Pa), compression positive
    strength (n,) : residual strength (Pa)

    Returns
    -------
    Strain and stress; the stress is at most half of the residual strength, and the strain at least γ_max.
    """
    at_potential = STRESS_AT_POTENTIAL * np.maximum(effective, NO_STRESS)
    largest_multiple = np.clip(LARGEST_STRAIN / potential, 1.0, LARGEST_MULTIPLE)
    multiple = np.clip(LARGEST_SHARE * strength / at_potential, 1.0, largest_multiple)
    return SoftRange(potential * multiple, np.minimum(multiple * at_potential, LARGEST_SHARE * strength))
