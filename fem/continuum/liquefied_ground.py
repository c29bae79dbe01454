"""Gives liquefied strata a residual strength without friction, and a stiffness at which they hardly change their
volume.
"""

import math
from collections.abc import Mapping
from typing import Any

from meshes.section.liquefies import RemainingStrength
from meshes.section.section import Section

# Poisson's ratio of undrained liquefied ground: it keeps its volume and presses on the sides nearly as a liquid does,
# with ν / (1 - ν) = 0.96 of its weight.
UNDRAINED_POISSON = 0.49
# Strength over the vertical effective stress of ground whose residual strength is given as zero: the method needs a
# positive strength.
LEAST_STRENGTH_RATIO = 1e-3


def liquefied_section(section: Section, remains: Mapping[int, RemainingStrength]) -> Section:
    """Return the section after liquefaction of some strata, which then have ψ = 0 and ν of at least 0.49.

    Parameters
    ----------
    section : the ground before liquefaction
    remains : retained strength of each stratum that liquefies, by the number of the stratum from the top, from 0

    Returns
    -------
    The section with reduced c and tan φ. Where neither friction nor a residual strength ratio remains, the cohesion is
    at least 0.001 of the mean vertical effective stress of the stratum.
    """
    strata = list(section.strata)
    for k, remains_of in remains.items():
        friction = math.atan(remains_of.friction * math.tan(strata[k].friction_angle))
        cohesion = remains_of.cohesion * strata[k].cohesion + remains_of.strength
        if friction == 0.0 and not remains_of.residual:
            cohesion = max(cohesion, LEAST_STRENGTH_RATIO * section.cohesion_field.mean_effective_stress(k))
        table = strata[k].with_multiple_of_cohesion(remains_of.cohesion).strength_table
        change: dict[str, Any] = {
            "strength_table": None if remains_of.residual or not remains_of.cohesion else table,
            "cohesion": cohesion,
            "cohesion_increase": remains_of.cohesion * strata[k].cohesion_increase,
            "cohesion_minimum": None,
            "strength_ratio": remains_of.cohesion * (strata[k].strength_ratio or 0.0),
            "friction_angle": friction,
            "dilation_angle": 0.0,
            "poissons_ratio": max(UNDRAINED_POISSON, strata[k].poissons_ratio),
        }
        if remains_of.residual:
            removed = dict.fromkeys(("ocr", "pre_overburden_pressure", "consolidated_below"))
            change |= {**removed, "ocr_exponent": 0.0, "strength_ratio": remains_of.residual}
        strata[k] = strata[k].model_copy(update=change)
    return section.with_strata(strata)
