"""fem/variants.json: the critical Kh of the continuum with one thing changed at a time."""

from typing import ClassVar, Literal

from pydantic import Field

from workflow.results.answer import Answer, Part
from workflow.results.continuum import Verdict


class Variant(Part):
    """One change, and the critical Kh with it; None where the path has none."""

    name: str
    change: str = Field(description="what is changed, in words")
    kc: float | None
    kc_upper: float | None
    verdict: Verdict | Literal["no answer"]
    reason: str
    seconds: float = Field(description="computing time")


class VariantsAnswer(Answer):
    """Every change that was asked for."""

    FILE: ClassVar[str] = "fem/variants.json"

    variants: tuple[Variant, ...]
