"""Models the layer above liquefied ground as a linear bar on a smooth incline (Towhata's truss; the paper, Sec. 5)."""

import math
from dataclasses import dataclass

import numpy as np

from meshes.section.layering import middles
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section
from meshes.section.stratum import liquefying_strata

SOURCE = "I. Towhata (1987), as described in Sec. 5 of the paper on section S-13"
VALIDITY = "no strength in the liquefied layer; the layer above is elastic, one end free and the other held"
COLUMNS = 400  # along the section


@dataclass(frozen=True)
class Truss:
    """Holds an elastic bar per metre of width, which represents the layer above liquefied ground.

    Attributes
    ----------
    length : length along the slope (m)
    inclination : inclination of the bar (rad)
    density : density of the bar (kg/m³)
    modulus : E / (1 - ν²) of the bar in plane strain (Pa)
    """

    length: float
    inclination: float
    density: float
    modulus: float

    def displacement(self, along: float) -> float:
        """Return the displacement (m) at a distance s from the fixed end: γ sin β (L s - s²/2) / E'.

        E' u'' + γ sin β = 0 with u = 0 at the fixed end and u' = 0 at the free end. The thickness of the bar cancels;
        the displacement is largest at the free end, γ sin β L² / 2 E'.
        """
        force = self.density * GRAVITY * math.sin(self.inclination)
        return force * (self.length * along - 0.5 * along**2) / self.modulus

    @property
    def end(self) -> float:
        """Return the displacement (m) of the free end."""
        return self.displacement(self.length)


def truss_of(section: Section, case: int) -> Truss | None:
    """Return the strata above the uppermost liquefying stratum of a case as one bar; None if nothing lies above it.

    The bar is as long as the part of the section with liquefying layers; density and modulus are means over the area of
    the strata; the inclination of the bar is the mean inclination of its lower boundary.
    """
    which = liquefying_strata(section.strata, case)
    left, right = section.given_extent
    x = middles(left, right, COLUMNS)
    levels = section.layering.interfaces(x)
    thick = levels[:, :-1] - levels[:, 1:]
    liquefies = (thick[:, which] > 0.0).any(axis=1) if which else np.zeros(COLUMNS, dtype=bool)
    if liquefies.sum() < 2:
        return None
    first = np.array([next(k for k in which if row[k] > 0.0) for row in thick[liquefies]])
    above = np.where(np.arange(thick.shape[1]) < first[:, None], thick[liquefies], 0.0)
    area = above.sum(axis=0)
    if area.sum() <= 0.0:
        return None
    density = np.array([stratum.density_seismic for stratum in section.strata])
    modulus = np.array([s.youngs_modulus / (1.0 - s.poissons_ratio**2) for s in section.strata])
    bottom = levels[liquefies, first]
    slope = abs(float(np.polyfit(x[liquefies], bottom, 1)[0]))
    length = float(np.count_nonzero(liquefies)) * (right - left) / COLUMNS
    share = area / area.sum()
    return Truss(length * math.hypot(1.0, slope), math.atan(slope), float(share @ density), float(share @ modulus))
