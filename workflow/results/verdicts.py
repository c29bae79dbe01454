"""Defines parts of summary.json: crests after each slide, criteria, and the warnings and headline numbers of the
report."""

from typing import Literal

from pydantic import Field

from workflow.criteria.settings import CriterionVerdict
from workflow.results.answer import Part

Criterion = Literal["factor of safety", "critical Kh", "displacement", "crest settlement", "freeboard"]
Weight = Literal[1, 2, 3]
NOTE_WEIGHT = 3  # of warnings that stand among the checks, not on the first page


class WarningPart(Part):
    """Holds a warning, and its remedy."""

    weight: Weight = Field(description="importance: 1 contradicts an answer, 2 changes an answer, 3 is a note")
    observation: str = Field(description="what was observed, a sentence with its numbers")
    remedy: str = Field(description="advice on what to do; empty if the warning itself says it")


class HeadlinePart(Part):
    """Holds one of the numbers of the first page as text."""

    name: str = Field(description="name of the quantity")
    value: str = Field(description='value with its unit, or a limit, such as "< 0"')
    interval: str = Field(description="interval of the value and its source; empty without one")
    conclusion: str = Field(description="sentences on what the value means")


class CrestPart(Part):
    """Holds the state of the crest of a structure after a slide, or after reconsolidation alone.

    Lengths are in m, settlements positive downwards. The settlement of slides with drainage includes reconsolidation;
    in other slides reconsolidation is added.
    """

    structure: str = Field(description="name of the structure")
    method: str = Field(description='method that computed the slide, such as "discs, case 1"')
    settlement_m: float = Field(
        description="settlement of the highest ground as wide as the crest, with reconsolidation"
    )
    settlement_low_m: float = Field(
        description="lower end of the range of the settlement over all packings; equal to it without packings"
    )
    settlement_high_m: float = Field(description="upper end of the range of the settlement over all packings")
    reconsolidation_m: float | None = Field(
        description="settlement by reconsolidation of the liquefied ground below the crest; null if it is not known"
    )
    freeboard_m: float | None = Field(description="height of the crest above the water; null without water")
    freeboard_low_m: float | None = Field(
        description="lower end of the range of the freeboard, as that of the settlement; null without water"
    )
    freeboard_high_m: float | None = Field(description="upper end of the range of the freeboard; null without water")
    water_m: float | None = Field(description="elevation of the water beside the structure")
    at_rest: bool = Field(description="whether the slide came to rest; if not, the crest settles further")


class VerdictPart(Part):
    """Holds the verdict on one quantity and its limit."""

    criterion: Criterion = Field(description="quantity that has a limit")
    subject: str = Field(description="structure or face, and the method")
    low: float | None = Field(description="lower end of the interval in which the quantity lies (m, or without a unit)")
    high: float | None = Field(
        description="upper end of the interval; null without an answer, and if a slide is not at rest"
    )
    limit: float = Field(description="limit of the quantity (m, or without a unit)")
    kh: float | None = Field(default=None, description="Kh at which the factor of safety is required")
    source: str = Field(description="source of the limit; empty if the file does not state one")
    verdict: CriterionVerdict = Field(description='"satisfied", "not satisfied", or "not decided"')
    reason: str = Field(default="", description="reason why the verdict is not decided")
