"""fem/residual.json: whether the ground still stands with its residual strength after large shear strains."""

from typing import ClassVar, Literal

from pydantic import Field

from fem.settings import Sides
from workflow.results.answer import Answer, Line, Part, SectionLabel
from workflow.results.bearing import Bearing

Verdict = Literal["stands", "would continue", "fails", "undecided"]


class SoftenedStratum(Part):
    """A stratum and its strength after large shear strains."""

    name: str
    cohesion_kPa: float  # noqa: N815
    friction_deg: float


class AlongSurface(Part):
    """Factors of safety by Spencer's method, on the slip surface of the ground with peak strength."""

    surface_m: Line = Field(description="points [x, elevation] of the slip surface (m)")
    peak: float | None = Field(description="with peak strength; None where forces and moments do not balance")
    residual: float | None = Field(description="with residual strength, once the ground has slid along it")


class TwoSteps(Part):
    """The verdict of two steps: peak strength first, then residual strength."""

    strata: tuple[SoftenedStratum, ...]
    verdict: Verdict = Field(
        description="stands: with residual strength, too; would continue: with peak strength alone; undecided: not "
        "with residual strength, and peak strength has no answer"
    )
    peak: float | None = Field(description="factor of safety at Kh = 0 with peak strength, by finite elements")
    along: AlongSurface | None = Field(description="None where the elements have no slip surface")
    everywhere: Bearing = Field(description="of the ground with residual strength wherever there is one")
    notes: tuple[str, ...] = Field(default=(), description="what could not be found with peak strength, and why")


class ResidualAnswer(Answer):
    """Stability with residual strength."""

    FILE: ClassVar[str] = "fem/residual.json"

    section: SectionLabel
    sides: Sides
    steps: TwoSteps
