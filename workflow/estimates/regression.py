"""Estimates the displacement by regression over observed cases of liquefaction: Hamada et al. (1986)."""

from dataclasses import dataclass

import numpy as np

from meshes.section.layering import middles
from meshes.section.section import Section
from meshes.section.stratum import liquefying_strata


def hamada(thickness: float, gradient: float) -> float:
    """Return the permanent ground displacement D = 0.75 √H ∛θ (m) by Hamada et al. (1986).

    M. Hamada, S. Yasuda, R. Isoyama, K. Emoto, Study on liquefaction induced permanent ground displacement, Association
    for the Development of Earthquake Prediction in Japan (1986): regression over 60 sections in Niigata and Noshiro.
    ``thickness`` H (m) is the thickness of the liquefied layer; ``gradient`` θ (%) is the larger of the gradients of
    the ground surface and of the lower boundary of the liquefied layer.
    """
    return 0.75 * float(np.sqrt(thickness)) * float(np.cbrt(gradient))


def hamada_as_printed(thickness: float, gradient: float) -> float:
    """Return D = 0.75 ∛H ∛θ (m) as printed in the paper (its equation 18); every other source has the square root
    of H."""
    return 0.75 * float(np.cbrt(thickness)) * float(np.cbrt(gradient))


@dataclass(frozen=True)
class LiquefiedLayers:
    """Holds the input of the regression of Hamada et al. (1986).

    Attributes
    ----------
    thickness : mean thickness of liquefying layers (m), over the part of the section that has any
    gradient : slope of the ground, or of the lower boundary of the liquefying layers if steeper (%)
    thickest : largest thickness of liquefying layers (m)
    """

    thickness: float
    gradient: float
    thickest: float


def liquefied(section: Section, case: int, columns: int = 400) -> LiquefiedLayers | None:
    """Return the liquefied layers of a case taken together; None if none liquefies.

    The thickness is the mean of the total thickness of these layers over the part of the section where it is not zero.
    The gradient is the slope of a straight line fitted, over the same part of the section, to the ground or to the
    lowest boundary of the layers, whichever is steeper. Ground that is added beyond the given ends does not count.
    """
    which = liquefying_strata(section.strata, case)
    left, right = section.given_extent
    x = middles(left, right, columns)
    levels = section.layering.interfaces(x)
    layers = levels[:, :-1] - levels[:, 1:]
    if not which:
        return None
    total = layers[:, which].sum(axis=1)
    liquefies = total > 0.0
    if liquefies.sum() < 2:
        return None
    lowest = np.min([np.where(layers[:, k] > 0.0, levels[:, k + 1], np.inf) for k in which], axis=0)
    gradients = [abs(float(np.polyfit(x[liquefies], line[liquefies], 1)[0])) for line in (levels[:, 0], lowest)]
    return LiquefiedLayers(float(total[liquefies].mean()), 100.0 * max(gradients), float(total.max()))
