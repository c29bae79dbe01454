"""Gives the layers at the sides of a section."""

from collections.abc import Iterable

import numpy as np

from meshes.section.section import Section


def interfaces_at(section: Section, right: bool) -> np.ndarray:
    """Return the elevations of all interfaces of a section at one of its sides.

    Parameters
    ----------
    section : the ground
    right : whether the side is the right one

    Returns
    -------
    Elevations (n,) from the surface down (m).
    """
    layering = section.layering
    return layering.right[-1] if right else layering.left[0]


def lowest_liquefied(section: Section, right: bool, strata: Iterable[int]) -> float | None:
    """Return the elevation at which the ground beyond a side can slide.

    Parameters
    ----------
    section : the ground
    right : whether the side is the right one
    strata : numbers of the strata that liquefy

    Returns
    -------
    The lowest bottom of these strata at the side (m); None if none of them lies there.
    """
    levels, tolerance = interfaces_at(section, right), section.layering.tolerance
    return min((float(levels[k + 1]) for k in strata if levels[k] - levels[k + 1] > tolerance), default=None)


def liquefies_at_both_sides(section: Section) -> bool:
    """Return whether a stratum that liquefies, or may by its blow counts, lies at each side.

    Parameters
    ----------
    section : the ground

    Returns
    -------
    True if there is one at the left and one at the right side.
    """
    strata = [k for k, s in enumerate(section.strata) if s.liquefies_in or s.liquefies_in.triggered]
    return all(lowest_liquefied(section, right, strata) is not None for right in (False, True))
