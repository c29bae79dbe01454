"""fem/liquefied.json: whether the continuum still stands once layers have liquefied, case by case."""

from typing import ClassVar

from pydantic import Field

from fem.settings import Sides
from workflow.results.answer import Answer, Part, SectionLabel
from workflow.results.bearing import Bearing


class LiquefiedStratum(Part):
    """A liquefied stratum and its residual strength."""

    name: str
    cohesion_kPa: float  # noqa: N815
    friction_deg: float
    over_effective: float = Field(description="the cohesion over the mean vertical effective stress")


class LiquefiedCase(Bearing):
    """Cases with equal residual strengths: their numbers, and the stability of the ground."""

    cases: tuple[int, ...]
    names: tuple[str, ...] = Field(description="what these cases are called; empty for those without a name")
    strata: tuple[LiquefiedStratum, ...]


class LiquefiedAnswer(Answer):
    """Stability after liquefaction, before any slide."""

    FILE: ClassVar[str] = "fem/liquefied.json"

    section: SectionLabel
    sides: Sides
    cases: tuple[LiquefiedCase, ...]
