"""Impedance of the ground below a section, by which waves that reach its base leave."""

import numpy as np

from meshes.section.section import Section


def base_impedance(section: Section) -> float:
    """Return the impedance of a compliant base times its length: ρ V_s L of the lowest stratum, or the mean of all
    strata if larger.

    Parameters
    ----------
    section : Section
        The ground above the base.

    Returns
    -------
    float
        Impedance times length in kg/s per metre out of plane, with V_s = sqrt(G/ρ) and G = E / (2 (1 + ν)).
    """
    strata, areas, (left, right) = section.strata, section.layering.areas(), section.extent
    moduli = [stratum.youngs_modulus / (2.0 * (1.0 + stratum.poissons_ratio)) for stratum in strata]
    impedances = np.sqrt([s.density_seismic * modulus for s, modulus in zip(strata, moduli, strict=True)])
    return float(max(impedances[-1], np.average(impedances, weights=areas)) * (right - left))
