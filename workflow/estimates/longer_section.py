"""Finds the critical slip circle of a longer section, for circles that end at a side of the given section."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from meshes.errors import InputError
from meshes.section.section import Section
from meshes.section.tension_crack import TensionCrack
from workflow.estimates.deeper_circles import ground_of_circles
from workflow.estimates.slip_circles import NO_CRACK

SIDE_TOLERANCE = 2e-3  # of the width of the section: a circle that ends nearer to a side ends at it
THICKNESSES = 3.0  # of the ground at the side, by which it is continued


@dataclass(frozen=True)
class LongerSectionCircle:
    """Holds the critical circle of a section that was lengthened beyond both sides.

    Attributes
    ----------
    side : side at which the circle of the given section ends
    past_m : distance by which the longer circle reaches past that side (m); 0 if it stays within
    beyond_m : length over which the ground was continued (m)
    bishop : critical Kh by Bishop's simplified method
    """

    side: Literal["left", "right"]
    past_m: float
    beyond_m: float
    bishop: float


def circle_of_longer_section(
    section: Section,
    ends: tuple[float, float],
    critical: float,
    towards: int,
    least_depth: float,
    vertical: float = 0.0,
    crack: TensionCrack = NO_CRACK,
) -> LongerSectionCircle | None:
    """Find the circle with the least critical Kh in a longer section if the circle of the given section ends at a side.

    Parameters
    ----------
    section : the section as given; its ground, layers and water continue level past both sides
    ends : x (m) of the left and the right end of the critical circle of the section
    critical : the critical Kh of that circle (-)
    towards, least_depth, vertical, crack : as in `ground_of_circles`

    Returns
    -------
    The circle; None if the given circle ends at no side, the section cannot be continued, or no circle of the longer
    section has a smaller critical Kh.
    """
    left, right = section.extent
    near = SIDE_TOLERANCE * (right - left)
    at: list[tuple[Literal["left", "right"], int]] = [("left", 0), ("right", -1)]
    sides = [(name, end) for name, end in at if abs(ends[end] - (left, right)[end]) <= near]
    if not sides:
        return None
    side, end = sides[0]
    column = section.layering.interfaces(np.array([(left, right)[end]]))[0]
    beyond = float(np.ceil(THICKNESSES * (column[0] - column[-1]))) + (section.beyond or 0.0)
    data = section.model_dump(mode="python", exclude_none=True, by_alias=True)
    try:
        longer = Section.parse({**data, "beyond": f"{beyond:g} m"}, section.name)
    except InputError:  # such as a line of water that ends at the side
        return None
    circle = ground_of_circles(longer, towards, None, least_depth, vertical, crack)[1]
    if circle is None or circle.bishop >= critical:
        return None
    reach = circle.surface[end, 0] - (left, right)[end]
    past = max(0.0, float(-reach if side == "left" else reach))
    return LongerSectionCircle(side, past, beyond - (section.beyond or 0.0), circle.bishop)
