"""Stores in fem/residual.json and fem/liquefied.json whether the ground still stands after large shear strains, or
after layers have liquefied.
"""

# ruff: noqa: N815 (units are written as they are)

from typing import ClassVar, Literal

from pydantic import Field

from fem.continuum.loads import Direction
from fem.settings import Sides
from workflow.results.answer import Answer, Line, Part, SectionLabel
from workflow.results.faces import FaceAtRest
from workflow.results.slices import CirclesAtRest

BearingVerdict = Literal["stands", "flows"]


class Bearing(Part):
    """Holds whether the ground stands, its factor of safety and its critical Kh."""

    verdict: BearingVerdict = Field(
        description=(
            "whether the ground stands without shaking: by strict bounds if they decide it, else by finite elements"
        )
    )
    reason: str = Field(description="reason of the verdict, in words")
    kc: float | None = Field(description="critical Kh by finite elements; None if the ground fails under its weight")
    direction: Direction | None = Field(
        default=None, description="direction of the seismic force with the smallest critical Kh"
    )
    kc_lower: float | None = Field(description="strict lower bound of the critical Kh, ψ = φ; None without a bound")
    kc_upper: float | None = Field(description="strict upper bound of the critical Kh, ψ = φ; null without a bound")
    factor: float | None = Field(description="factor of safety at Kh = 0 by finite elements, sides held horizontally")
    factor_lower: float | None = Field(
        description="strict lower bound of the factor of safety at Kh = 0, with the sides of [fem], ψ = φ"
    )
    factor_upper: float | None = Field(
        description="strict upper bound of the factor of safety at Kh = 0, as the lower one"
    )
    notes: tuple[str, ...] = Field(description="results that could not be computed, and the reasons")


ResidualVerdict = Literal["stands", "would stop", "would continue", "fails", "undecided"]


class SoftenedStratum(Part):
    """Holds a stratum and its strength after large shear strains."""

    name: str = Field(description="name of the stratum")
    cohesion_kPa: float = Field(description="cohesion after large shear strains")
    friction_deg: float = Field(description="friction angle after large shear strains")


class AlongSurface(Part):
    """Holds the factors of safety by Spencer's method, on the slip surface of the ground with peak strength."""

    surface_m: Line = Field(description="points [x, elevation] of the slip surface (m)")
    peak: float | None = Field(
        description="factor of safety with peak strength; None if forces and moments do not balance"
    )
    residual: float | None = Field(
        description="factor of safety with residual strength, after the ground has slid along the surface"
    )


class PeakAndResidual(Part):
    """Holds the verdict of two steps: first with peak strength, then with residual strength."""

    strata: tuple[SoftenedStratum, ...] = Field(description="strata with a strength after large shear strains")
    verdict: ResidualVerdict = Field(
        description=(
            '"stands": the ground stands even with residual strength everywhere; "would stop": with residual strength '
            'it stands along the slip surface of peak strength only; "would continue": it stands only with peak '
            'strength; "fails": it fails with peak strength, too; "undecided": it fails with residual strength, and '
            "there is no answer with peak strength"
        )
    )
    peak: float | None = Field(description="factor of safety at Kh = 0 with peak strength, by finite elements")
    along: AlongSurface | None = Field(
        description="factors of safety along the slip surface; None if the finite elements have no slip surface"
    )
    everywhere: Bearing = Field(
        description="stability of the ground if all strata with a residual strength have it everywhere"
    )
    notes: tuple[str, ...] = Field(
        default=(), description="results with peak strength that could not be computed, and the reasons"
    )


class ResidualAnswer(Answer):
    """Holds the results on stability with residual strength."""

    FILE: ClassVar[str] = "fem/residual.json"

    section: SectionLabel = Field(description="section of the strata")
    sides: Sides = Field(description="boundary condition of the sides")
    steps: PeakAndResidual = Field(description="stability with peak strength, and with residual strength")


class LiquefiedStratum(Part):
    """Holds a liquefied stratum and its residual strength."""

    name: str = Field(description="name of the stratum")
    cohesion_kPa: float = Field(description="residual strength, mean over the stratum")
    friction_deg: float = Field(description="friction angle of the liquefied soil, 0 as a rule")
    residual_strength_ratio: float = Field(description="residual strength over the mean vertical effective stress")

    def scaled(self, multiple: float) -> "LiquefiedStratum":
        """Return the stratum with a multiple of its residual strength."""
        return self.model_copy(
            update={
                "cohesion_kPa": multiple * self.cohesion_kPa,
                "residual_strength_ratio": multiple * self.residual_strength_ratio,
            }
        )


class LiquefiedCase(Bearing):
    """Holds cases with equal residual strengths: their numbers, and the stability of the ground."""

    cases: tuple[int, ...] = Field(description="numbers of these cases")
    names: tuple[str, ...] = Field(description="names of these cases; empty for cases without a name")
    strata: tuple[LiquefiedStratum, ...] = Field(description="liquefied strata in these cases")
    circles: CirclesAtRest | None = Field(
        default=None, description="slip circles with the least factors of safety at Kh = 0; null without any strength"
    )
    faces: tuple[FaceAtRest, ...] = Field(
        default=(), description="factors of safety of the faces of structures by finite elements; empty without any"
    )


class LiquefiedAnswer(Answer):
    """Holds the results on stability after liquefaction, before any slide."""

    FILE: ClassVar[str] = "fem/liquefied.json"

    section: SectionLabel = Field(description="section of the strata")
    sides: Sides = Field(description="boundary condition of the sides")
    cases: tuple[LiquefiedCase, ...] = Field(description="cases, together where their residual strengths are equal")
    required: tuple[LiquefiedStratum, ...] = Field(
        default=(),
        description=(
            "strata with the residual strength for a factor of safety of 1 by finite elements, in the proportions of "
            "the strongest case; empty if some case stands, or without such a strength"
        ),
    )
    required_lower: tuple[LiquefiedStratum, ...] = Field(
        default=(), description="strict lower bound of the required strength; empty if none was found"
    )
    required_upper: tuple[LiquefiedStratum, ...] = Field(
        default=(), description="strict upper bound of the required strength; empty if none was found"
    )
