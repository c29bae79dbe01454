"""Computes the Kh at which level ground slides at a depth, in closed form.

Level ground that continues without end slides on the horizontal plane with the smallest strength over the seismic force
above it (an infinite slope of inclination 0, Skempton & DeLory 1957, with a horizontal acceleration). The failure of a
section that reaches one of its sides at this Kh is the failure of the ground beside the slope. A longer section has the
same critical Kh.
"""

from typing import NamedTuple

import numpy as np

from meshes.section.overburden import overburden
from meshes.section.section import Section

SIDE_SHARE = 0.01  # of the length of the section: distance from a side at which the ground is examined
LEVEL_SLOPE = 0.01  # slope (-) up to which the ground beside a side counts as level
INTERFACE_DISTANCE = 1e-4  # of the depth of a section: distance from the interface of two layers


class SlidingGround(NamedTuple):
    """Holds the failure of level ground: its Kh, and the stratum and the elevation (m) in which it slides."""

    kh: float
    stratum: str
    elevation: float


def sliding_level_ground(section: Section, side: str, vertical: float) -> SlidingGround | None:
    """Find the smallest Kh at which the level ground at a side of a section slides, min (c + σ'v tan φ) / σv.

    σv is the weight of the mass that shakes, and σ'v is reduced by Kv and by excess pore pressure. Strength over weight
    is monotone within a stratum whose cohesion is linear, so that the ends of the strata are examined.

    Parameters
    ----------
    section : the section of the ground
    side : "left" or "right"
    vertical : coefficient Kv of the vertical acceleration (-), positive upwards

    Returns
    -------
    The failure; None if the ground at this side is not level.
    """
    ground, length = section.ground, float(np.ptp(section.ground[:, 0]))
    x = float(ground[0, 0] + SIDE_SHARE * length if side == "left" else ground[-1, 0] - SIDE_SHARE * length)
    ends = np.interp([x - SIDE_SHARE * length, x + SIDE_SHARE * length], *ground.T)
    if abs(ends[1] - ends[0]) > LEVEL_SLOPE * 2.0 * SIDE_SHARE * length:
        return None
    levels = np.unique(section.layering.interfaces(np.array([x]))[0])[::-1]
    step = INTERFACE_DISTANCE * float(levels[0] - levels[-1])
    depths = [levels[0] - level + shift for level in levels[1:] for shift in (-step, step)][:-1]
    return min((_failure(section, x, float(depth), vertical) for depth in depths), key=lambda failure: failure.kh)


def _failure(section: Section, x: float, depth: float, vertical: float) -> SlidingGround:
    stress = overburden(section, x, depth)
    soil = section.strata[stress.stratum]
    elevation = float(np.interp(x, *section.ground.T)) - depth
    place = np.array([[x, elevation]])
    cohesion = float(section.cohesion_field.at(place, place, np.array([stress.stratum]))[0])
    effective = (1.0 - soil.excess_pore_pressure_ratio) * stress.effective - vertical * stress.total
    strength = cohesion + max(effective, 0.0) * float(np.tan(soil.friction_angle))
    return SlidingGround(strength / stress.total, soil.name, elevation)
