"""fem/variants.json: the critical Kh of the continuum with one thing changed at a time."""

from typing import ClassVar, Literal

from pydantic import Field

from workflow.results.answer import Answer, Part
from workflow.results.continuum import PathVerdict


class Variant(Part):
    """One change, and the critical Kh with it; None where there is none."""

    name: str
    change: str = Field(description="what is changed, in words")
    kc: float | None
    kc_upper: float | None
    verdict: PathVerdict | Literal["no answer"]
    reason: str
    seconds: float = Field(description="computing time")
    kc_without: float | None = Field(
        default=None,
        description="the critical Kh without the change, where both were found on a coarser mesh than the answer",
    )

    def of(self, kc: float) -> float | None:
        """What the change makes of the critical Kh ``kc`` of the answer: on another mesh, by the same ratio."""
        if self.kc is None or self.kc_without is None:
            return self.kc
        return kc * self.kc / self.kc_without


class VariantsAnswer(Answer):
    """Every change that was asked for."""

    FILE: ClassVar[str] = "fem/variants.json"

    variants: tuple[Variant, ...]
