"""fem/liquefied.json: whether the continuum still stands once layers have liquefied, case by case."""

from typing import ClassVar, Literal

from pydantic import Field

from fem.continuum.loads import Direction
from fem.settings import Sides
from workflow.results.answer import Answer, Part, SectionLabel

Stands = Literal["stands", "flows"]


class LiquefiedStratum(Part):
    """A liquefied stratum and its residual strength."""

    name: str
    cohesion_kPa: float  # noqa: N815
    friction_deg: float
    over_effective: float = Field(description="the cohesion over the mean vertical effective stress")


class LiquefiedCase(Part):
    """Cases that leave the strata the same strength: their numbers, and what the ground then bears."""

    cases: tuple[int, ...]
    names: tuple[str, ...] = Field(description="what these cases are called; empty for those without a name")
    strata: tuple[LiquefiedStratum, ...]
    stands: Stands = Field(description="without shaking: by strict bounds where they decide, else by the elements")
    reason: str
    kc: float | None = Field(
        description="critical Kh after liquefaction, by finite elements; None: it fails under its weight"
    )
    direction: Direction | None = Field(
        default=None, description="direction of the seismic force with the smallest critical Kh"
    )
    kc_lower: float | None = Field(description="strict bounds of that Kh, ψ = φ; None where they were not found")
    kc_upper: float | None
    factor: float | None = Field(description="factor of safety at Kh = 0 by finite elements, sides held horizontally")
    factor_lower: float | None = Field(description="strict bounds of that factor, with the sides of [fem], ψ = φ")
    factor_upper: float | None
    notes: tuple[str, ...] = Field(description="what could not be found, and why")


class LiquefiedAnswer(Answer):
    """Stability after liquefaction, before any slide."""

    FILE: ClassVar[str] = "fem/liquefied.json"

    section: SectionLabel
    sides: Sides
    cases: tuple[LiquefiedCase, ...]
