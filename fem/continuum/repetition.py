"""Checks whether a section can have periodic sides. The section is then one period of an endless row of equal sections,
each higher or lower than its neighbour by the same height.

Weight, strength and effective stress repeat from period to period. The gradient of the pore pressure, through which the
water acts on the skeleton, repeats as well. The pore pressure itself need not repeat: under still water it is larger in
a lower period, by γw times the difference in height. The difference of pressure is a load on the section, -u n on both
sides, since effective stresses on periodic sides balance each other and total stresses do not.
"""

import numpy as np

from meshes.errors import InputError
from meshes.section.alike_sides import has_alike_sides
from meshes.section.section import Section

# Difference (Pa) up to which two pressures count as equal: 1 cm of water.
PRESSURE_TOLERANCE = 100.0


def refuse_other_sides(section: Section) -> None:
    """Refuse a section that cannot have periodic sides, since its layers or its water differ at the two sides.

    Parameters
    ----------
    section : the ground

    Raises
    ------
    InputError
        If the thicknesses of layers, or the water pressures, differ at the two sides.
    """
    refuse_other_water(section)
    if not has_alike_sides(section.strata, section.layering):
        remedy = 'expected layers of the same thickness at both; use sides = "smooth", "free-field" or "fixed"'
        raise InputError(section.name, [f'fem, sides = "periodic": the left and right sides differ; {remedy}'])


def refuse_other_water(section: Section) -> None:
    """Refuse a section whose water is not periodic.

    Pressures in and on the ground at the two sides may differ by one constant; excess pore pressures by shaking must be
    equal. Sections that are thicker at one side pass; ``refuse_other_sides`` refuses them.

    Parameters
    ----------
    section : the ground

    Raises
    ------
    InputError
        If the pressures differ otherwise, by more than 100 Pa, or if the inertia of free water acts (westergaard) and
        the water is deeper at one side.
    """
    water, layers = section.water_pressure, section.layering
    ends = layers.left[0], layers.right[-1]
    heights = [end[0] - end[-1] for end in ends]
    if not water.present or abs(heights[0] - heights[1]) > layers.tolerance:
        return
    depths = np.unique(np.concatenate([end[0] - end for end in ends]))
    depths = depths[np.append(np.diff(depths) > layers.tolerance, True)]
    still, excess = zip(*(_along_side(section, side, depths) for side in (0, 1)), strict=True)
    change = still[1] - still[0]
    problems = []
    if np.ptp(change) > PRESSURE_TOLERANCE:
        problems.append(
            f"the pore pressure changes from the left to the right side by {change.min() / 1e3:.1f} kPa at one depth "
            f"and by {change.max() / 1e3:.1f} kPa at another; expected a water table at the same depth at both sides, "
            "or still water above the whole section"
        )
    elif (
        abs(change[-1]) > PRESSURE_TOLERANCE
        and abs(change[-1] - water.unit_weight * (ends[0][0] - ends[1][0])) > PRESSURE_TOLERANCE
    ):
        deep = [side[-1] / water.unit_weight for side in still]
        problems.append(
            f"the water is {deep[0]:.4g} m deep at the left side and {deep[1]:.4g} m at the right one; expected still "
            "water above the whole section, or no free water"
        )
    elif water.moves and abs(change[-1]) > PRESSURE_TOLERANCE:
        problems.append("westergaard = true needs water that is as deep at both sides")
    if np.abs(excess[1] - excess[0]).max() > PRESSURE_TOLERANCE:
        problems.append(
            "the excess pore pressure by shaking differs between the sides; expected equal pressures at equal depths"
        )
    if problems:
        raise InputError(section.name, [f'fem, sides = "periodic": {text}' for text in problems])


def _along_side(section: Section, side: int, depths: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return two arrays (n,) in Pa for the left (0) or right (1) side. The first array contains the pore pressure at
    both ends of each interval between ``depths`` (m) and, as its last entry, the pressure of free water on the ground.
    The second array contains the excess pore pressure by shaking.
    """
    water, layers = section.water_pressure, section.layering
    elevation = layers.left[0] if side == 0 else layers.right[-1]
    x, inside = layers.x[-side], layers.x[[0, 1] if side == 0 else [-2, -1]].mean()
    z = elevation[0] - np.concatenate([depths[:-1], depths[1:], [0.0]])
    middle = np.tile(elevation[0] - 0.5 * (depths[:-1] + depths[1:]), 2)
    points, near = (np.column_stack([np.full(len(z), x_of_points), z]) for x_of_points in (x, inside))
    stratum = section.stratum_at(np.full(len(middle), x), middle)
    at_rest = water.at_rest(points[:-1], near[:-1], stratum)
    on_ground = water.on_ground(points[-1:], near[-1:])
    return np.concatenate([at_rest, on_ground]), water.excess(points[:-1], near[:-1], stratum)
