"""Gives sand that will liquefy the laws of liquefied ground before the shaking, while it still has its strength.

Contacts of discs cannot be replaced by pore pressure and bonds while the ground is loaded up to its strength: the discs
rearrange, and meanwhile the ground is too weak. With contacts that faded out as the ground liquefied, endless slopes
slid by up to 0.7 m at 0.9 of their yield coefficient. The contacts of strata that liquefy are therefore replaced in
ground at rest. As sand liquefies, the strength of its bonds falls from that before liquefaction to the residual
strength (`liquefied_strength.Weakening`). Saturated sand is undrained before liquefaction, too: it keeps its volume,
and its strength p tan phi + c, with the effective overburden p. Stresses are in Pa.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dem.case import Case
from dem.ground import Ground
from dem.liquefied_ground import is_liquefying, liquefy, set_reference_density, set_share
from dem.model import DiscModel
from dem.pressure_balance import balance_pressures
from dem.slides.liquefied_strength import before_liquefaction


def replace_contacts_of_sand(start: DiscModel, ground: Ground, strata: Sequence[int], case: Case) -> DiscModel:
    """Return the discs with the laws of liquefied ground in all strata that liquefy.

    Parameters
    ----------
    start : soil discs at rest
    ground : the ground in which the discs lie
    strata : numbers of the strata that liquefy
    case : stiffness and strength after liquefaction, which determine the stiffness of bonds

    Returns
    -------
    A copy of the discs, not yet at rest (`until_rest.come_to_rest`), or ``start`` itself if all that liquefies is clay,
    which has these laws already.
    """
    sand = np.isin(start.layer, strata) & ~start.fixed & ~is_liquefying(start)
    if not sand.any():
        return start
    model = start.copy()
    liquefy(model, before_liquefaction(model, ground, strata, case)._replace(discs=sand))
    balance_pressures(model, sand)
    layers = model.springs.layers
    model.set_springs([replace(s, faded=1.0) if k in strata else s for k, s in enumerate(layers)])
    set_share(model, np.where(model.fixed, 0.0, 1.0))
    model.make_list()
    set_reference_density(model, sand)
    return model
