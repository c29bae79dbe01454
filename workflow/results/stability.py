"""fem/residual.json, fem/liquefied.json: whether the ground still stands after large shear strains, or after layers
have liquefied.
"""

from typing import ClassVar, Literal

from pydantic import Field

from fem.continuum.loads import Direction
from fem.settings import Sides
from workflow.results.answer import Answer, Line, Part, SectionLabel

Stands = Literal["stands", "flows"]


class Bearing(Part):
    """Holds whether the ground stands, its factor of safety and its critical Kh."""

    stands: Stands = Field(description="without shaking: by strict bounds where they decide, else by the elements")
    reason: str
    kc: float | None = Field(description="critical Kh by finite elements; None: it fails under its weight")
    direction: Direction | None = Field(
        default=None, description="direction of the seismic force with the smallest critical Kh"
    )
    kc_lower: float | None = Field(description="strict bounds of that Kh, ψ = φ; None where they were not found")
    kc_upper: float | None
    factor: float | None = Field(description="factor of safety at Kh = 0 by finite elements, sides held horizontally")
    factor_lower: float | None = Field(description="strict bounds of that factor, with the sides of [fem], ψ = φ")
    factor_upper: float | None
    notes: tuple[str, ...] = Field(description="what could not be found, and why")


ResidualVerdict = Literal["stands", "would continue", "fails", "undecided"]


class SoftenedStratum(Part):
    """Holds a stratum and its strength after large shear strains."""

    name: str
    cohesion_kPa: float  # noqa: N815
    friction_deg: float


class AlongSurface(Part):
    """Holds the factors of safety by Spencer's method, on the slip surface of the ground with peak strength."""

    surface_m: Line = Field(description="points [x, elevation] of the slip surface (m)")
    peak: float | None = Field(description="with peak strength; None where forces and moments do not balance")
    residual: float | None = Field(description="with residual strength, once the ground has slid along it")


class TwoSteps(Part):
    """Holds the verdict of two steps: first with peak strength, then with residual strength."""

    strata: tuple[SoftenedStratum, ...]
    verdict: ResidualVerdict = Field(
        description="stands: with residual strength, too; would continue: with peak strength alone; undecided: not "
        "with residual strength, and peak strength has no answer"
    )
    peak: float | None = Field(description="factor of safety at Kh = 0 with peak strength, by finite elements")
    along: AlongSurface | None = Field(description="None where the elements have no slip surface")
    everywhere: Bearing = Field(description="of the ground with residual strength wherever there is one")
    notes: tuple[str, ...] = Field(default=(), description="what could not be found with peak strength, and why")


class ResidualAnswer(Answer):
    """Holds the results on stability with residual strength."""

    FILE: ClassVar[str] = "fem/residual.json"

    section: SectionLabel
    sides: Sides
    steps: TwoSteps


class LiquefiedStratum(Part):
    """Holds a liquefied stratum and its residual strength."""

    name: str
    cohesion_kPa: float  # noqa: N815
    friction_deg: float
    over_effective: float = Field(description="the cohesion over the mean vertical effective stress")


class LiquefiedCase(Bearing):
    """Holds cases with equal residual strengths: their numbers, and the stability of the ground."""

    cases: tuple[int, ...]
    names: tuple[str, ...] = Field(description="what these cases are called; empty for those without a name")
    strata: tuple[LiquefiedStratum, ...]


class LiquefiedAnswer(Answer):
    """Holds the results on stability after liquefaction, before any slide."""

    FILE: ClassVar[str] = "fem/liquefied.json"

    section: SectionLabel
    sides: Sides
    cases: tuple[LiquefiedCase, ...]
