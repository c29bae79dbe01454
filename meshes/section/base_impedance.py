"""Computes the impedance of the ground below a section, through which waves that reach the base leave.

Cycles of Kh stand for the acceleration of the ground at its surface, and so of all the ground above the base. A base as
stiff as rock would reflect the waves, and amplify Kh: a layer with an impedance of a third of that of the half-space
below moves three times as much at its natural period (Kramer 1996, eq. 7.25). Below the base the ground therefore
continues as it is in the section: the impedance follows from the travel time of shear waves, as V_s30 does.
"""

import numpy as np

from meshes.section.section import Section


def base_impedance(section: Section) -> float:
    """Return the impedance of a compliant base times its length: that of the section, averaged over the travel time.

    Parameters
    ----------
    section : the ground above the base

    Returns
    -------
    ρ V_s L in kg/s per metre out of plane: the harmonic mean of ρ V_s over the area, with V_s = sqrt(G/ρ) and G = E /
    (2 (1 + ν)), times the length L of the section.
    """
    strata, areas, (left, right) = section.strata, section.layering.areas(), section.extent
    moduli = [stratum.youngs_modulus / (2.0 * (1.0 + stratum.poissons_ratio)) for stratum in strata]
    impedances = np.sqrt([s.density_seismic * modulus for s, modulus in zip(strata, moduli, strict=True)])
    return float(areas.sum() / np.sum(areas / impedances) * (right - left))
