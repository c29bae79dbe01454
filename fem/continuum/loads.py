"""Determines the direction of the seismic load, and which strata can be analysed, for finite elements and for limit
analysis."""

from collections.abc import Mapping, Sequence
from typing import Literal

import numpy as np

from fem.errors import UnstableError
from fem.settings import FemSettings, Sides
from meshes.errors import InputError
from meshes.section.cutting import key_in_file
from meshes.section.polyline import downhill
from meshes.section.section import Section, Stratum
from meshes.section.uplift import Uplift

Direction = Literal["downhill", "uphill"]
# What to do where pore pressure lifts the ground.
ADVICE_ON_UPLIFT = "check the water levels, or relieve the pressure"
# Largest difference of both ends of the ground, as a share of its relief, at which they count as level with each other.
LARGEST_SHARE_OF_RELIEF = 0.1


def seismic_sign(section: Section, settings: FemSettings) -> int:
    """Return the side to which the seismic force acts.

    Parameters
    ----------
    section : the ground, whose surface defines downhill
    settings : settings with the direction of the force; of "both", downhill is computed first

    Returns
    -------
    +1 if the force acts to the right, -1 to the left.
    """
    return sign_of(section, direction_of(settings))


def direction_of(settings: FemSettings, opposite: bool = False) -> Direction:
    """Return the direction of the seismic force that the settings name.

    Parameters
    ----------
    settings : settings with the direction of the force; "both" counts as "downhill"
    opposite : whether to return the opposite direction

    Returns
    -------
    "downhill" or "uphill".
    """
    return "uphill" if (settings.direction == "uphill") != opposite else "downhill"


def sign_of(section: Section, direction: Direction) -> int:
    """Return the side to which a direction points.

    Parameters
    ----------
    section : the ground, whose surface defines downhill: from its higher end to its lower end
    direction : "downhill" or "uphill"

    Returns
    -------
    +1 if the direction is to the right, -1 if it is to the left.
    """
    return downhill(section.ground) * (1 if direction == "downhill" else -1)


def counting_directions(
    section: Section, side_condition: Sides, sides_reached: Mapping[Direction, Sequence[str]]
) -> list[Direction]:
    """Return the directions of the seismic force, among those analysed, whose failures count for the smaller Kh.

    Through sides that are held horizontally no ground leaves: every failure counts. Between free-field sides an uphill
    failure that reaches a side does not count if a downhill one was analysed: no slope fails there, but ground that
    only the K0 stress on the side supports. Where both ends of the ground are level with each other, as of a levee or a
    cutting, neither direction is uphill: a failure that reaches a side then does not count if another reaches none.

    Parameters
    ----------
    section : the ground
    side_condition : what the sides do; periodic sides count as held
    sides_reached : sides that the failure reaches, "left" or "right", for each direction that was analysed

    Returns
    -------
    The directions that count, at least one.
    """
    if side_condition != "free-field":
        return list(sides_reached)
    inside = [direction for direction, sides in sides_reached.items() if not sides]
    if len(sides_reached) == 1 or has_level_ends(section):
        return inside or list(sides_reached)
    return [direction for direction in sides_reached if direction == "downhill" or direction in inside]


def has_level_ends(section: Section) -> bool:
    """Return whether both ends of the ground are level with each other."""
    elevations = section.ground[:, 1]
    return bool(abs(elevations[-1] - elevations[0]) <= LARGEST_SHARE_OF_RELIEF * np.ptp(elevations))


def soils(section: Section) -> tuple[Stratum, ...]:
    """Return the strata of the section, if they can be analysed.

    Parameters
    ----------
    section : the ground

    Returns
    -------
    All strata, from the top down.

    Raises
    ------
    InputError
        For strata without strength: c = 0 and φ = 0.
    UnstableError
        If pore water lifts sand without cohesion.
    """
    weak = [
        f"{key_in_file(section.strata, k)}: cohesion and friction angle are both 0; expected a strength"
        for k, s in enumerate(section.strata)
        if not s.has_cohesion and s.friction_angle == 0.0
    ]
    if weak:
        raise InputError(section.name, weak)
    if section.uplift is not None and section.uplift.bare:
        raise uplift_error(section.uplift)
    return section.strata


def excess_pressure_advice(strata: Sequence[Stratum]) -> str:
    """Return advice on what to check if excess pore pressure by shaking leaves no equilibrium.

    Parameters
    ----------
    strata : strata of the section

    Returns
    -------
    A part of a sentence with the excess pore pressure ratios; empty without excess pore pressure.
    """
    ratios = {s.name: s.excess_pore_pressure_ratio for s in strata if s.excess_pore_pressure_ratio}
    named = ", ".join(f'{ratio:g} in "{name}"' for name, ratio in ratios.items())
    return named and (
        f"check excess_pore_pressure_ratio, which is {named}; sand that liquefies keeps a residual strength: see "
        "liquefies_in"
    )


def uplift_error(uplift: Uplift, reason: str = "there is no equilibrium") -> UnstableError:
    """Return the error for uplift: the pore pressure exceeds the weight of the soil above.

    Parameters
    ----------
    uplift : place and pressure of the uplift
    reason : beginning of the message

    Returns
    -------
    The error, to be raised, with advice on what to do.
    """
    return UnstableError(f"{reason}: {uplift.description}", ADVICE_ON_UPLIFT)
