"""Determines the direction of the seismic load, and which strata can be analysed, for finite elements and for limit
analysis."""

from collections.abc import Sequence
from typing import Literal

from fem.errors import UnstableError
from fem.settings import FemSettings
from meshes.errors import InputError
from meshes.section.cutting import key_in_file
from meshes.section.polyline import downhill
from meshes.section.section import Section, Stratum
from meshes.section.uplift import Uplift

Direction = Literal["downhill", "uphill"]


def seismic_sign(section: Section, settings: FemSettings) -> int:
    """Return the direction of the seismic force: +1 to the right, -1 to the left. For the setting "both", return the
    direction that is computed first.
    """
    return sign_of(section, direction_of(settings))


def direction_of(settings: FemSettings, opposite: bool = False) -> Direction:
    """Return the direction of the seismic force that the settings name, or "downhill" if they name both. Return the
    opposite direction if ``opposite``."""
    return "uphill" if (settings.direction == "uphill") != opposite else "downhill"


def sign_of(section: Section, direction: Direction) -> int:
    """Return +1 if "downhill" or "uphill" is to the right, -1 if it is to the left."""
    return downhill(section.ground) * (1 if direction == "downhill" else -1)


def soils(section: Section) -> tuple[Stratum, ...]:
    """Return the strata of the section; raise InputError for strata without strength, UnstableError if pore water lifts
    sand without cohesion.
    """
    weak = [
        f"{key_in_file(section.strata, k)}: cohesion and friction angle are both 0; expected a strength"
        for k, s in enumerate(section.strata)
        if not s.has_cohesion and s.friction_angle == 0.0
    ]
    if weak:
        raise InputError(section.name, weak)
    if section.uplift is not None and section.uplift.bare:
        raise lifted(section.uplift)
    return section.strata


def excess_pressure_advice(strata: Sequence[Stratum]) -> str:
    """Return advice on what to check if excess pore pressure by shaking leaves no equilibrium; empty without excess
    pore pressure."""
    ratios = {s.name: s.excess_pore_pressure_ratio for s in strata if s.excess_pore_pressure_ratio}
    named = ", ".join(f'{ratio:g} in "{name}"' for name, ratio in ratios.items())
    return named and (
        f"check excess_pore_pressure_ratio, which is {named}; sand that liquefies keeps a residual strength: see "
        "liquefies_in"
    )


def lifted(uplift: Uplift, reason: str = "there is no equilibrium") -> UnstableError:
    """Return the UnstableError for uplift: the pore pressure exceeds the weight of the soil above."""
    return UnstableError(f"{reason}: {uplift.words}", "check the water levels, or relieve the pressure")
