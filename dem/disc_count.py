"""Determines how many discs a section has by default: enough for the thinnest layer that slides.

A crust or a seam of two discs neither bends nor shears as ground does. With 2500 discs a bank whose crust was 3 discs
thick moved 0.5 m behind its edge, with 5000 discs 1.9 m, and material points 1.7 m; a fill on a seam of 1.5 discs moved
12 m, with 5000 discs 14 m.

More discs agree better with each other, not with the field (with `soil_contacts.DILATION_SHARE` = 0.3). Behind a quay
under cycles of Kh (`kobe_lp_tank_w30`, 2.8 m) two packings of 5000 discs moved by 2.8 and 0.2 m, of 7500 discs by 1.0
and 0.9 m, of 10000 discs by 1.4 and 1.4 m. The crest of the Lower San Fernando dam (9.1 m) sank by 6.9 and 5.6 m in
packings of 5000 discs, and by 2.4 and 3.3 m in packings of 7500.
"""

import numpy as np

from meshes.section.section import Section

DISCS_ACROSS_LAYER = 4.0  # in the thinnest layer that slides, if the number of discs allows it
FEWEST_DISCS, MOST_DISCS = 2500, 5000


def usual_disc_count(section: Section) -> int:
    """Return the default number of soil discs of a section file.

    The layers that slide are those that liquefy in a case and those above them. The thinnest of them is
    `DISCS_ACROSS_LAYER` discs thick if `FEWEST_DISCS` to `MOST_DISCS` discs suffice.

    Parameters
    ----------
    section : Section
        The ground as it stands in the file.

    Returns
    -------
    int
        The number of discs.
    """
    liquefying = [k for k, s in enumerate(section.strata) if s.liquefies_in or s.liquefies_in.triggered]
    if not liquefying:
        return FEWEST_DISCS
    thickness = section.layering.typical_thickness()[: liquefying[-1] + 1]
    radius = 0.5 * float(thickness[thickness > 0.0].min()) / DISCS_ACROSS_LAYER
    return int(np.clip(lattice_count(section, radius), FEWEST_DISCS, MOST_DISCS))


def lattice_count(section: Section, radius: float) -> float:
    """Return the number of discs that fill the section as a triangular lattice.

    Parameters
    ----------
    section : ground whose area is filled
    radius : radius of the discs (m)

    Returns
    -------
    Area of the ground over 2 sqrt(3) radius², not rounded.
    """
    return float(section.layering.areas().sum()) / (np.sqrt(12.0) * radius**2)


def lattice_radius(section: Section, count: float) -> float:
    """Return the radius (m) with which ``count`` discs fill the section as a lattice."""
    return float(np.sqrt(section.layering.areas().sum() / count / np.sqrt(12.0)))
