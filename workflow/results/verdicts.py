"""Parts of summary.json: crests after each slide, criteria, and the warnings and headline numbers of the report."""

from typing import Literal

from pydantic import Field

from workflow.criteria.settings import CriterionVerdict
from workflow.results.answer import Part

Criterion = Literal["factor of safety", "critical Kh", "displacement", "crest settlement", "freeboard"]
Weight = Literal[1, 2, 3]


class WarningPart(Part):
    """Holds a warning, and its remedy."""

    weight: Weight = Field(description="1: contradicts an answer, 2: changes an answer, 3: a note")
    what: str
    remedy: str = Field(description="empty where the warning says it")


class HeadlinePart(Part):
    """Holds one of the numbers of the first page as text."""

    name: str
    value: str
    interval: str
    conclusion: str


class CrestPart(Part):
    """Holds the state of the crest of a structure after a slide, or after reconsolidation alone. Lengths are in m,
    settlements positive downwards.

    The settlement of slides with drainage includes reconsolidation; in other slides reconsolidation is added.
    """

    structure: str
    by: str = Field(description="what computed it, such as discs, case 1")
    settlement_m: float = Field(description="of the highest ground as wide as the crest, with reconsolidation")
    settlement_low_m: float = Field(description="5 % of all packings are expected below; the same without packings")
    settlement_high_m: float = Field(description="5 % of all packings are expected above")
    reconsolidation_m: float | None = Field(description="of what liquefied below the crest; null where not known")
    freeboard_m: float | None = Field(description="height of the crest above the water; null without water")
    freeboard_low_m: float | None
    freeboard_high_m: float | None
    water_m: float | None = Field(description="elevation of the water beside the structure")
    at_rest: bool = Field(description="whether the slide came to rest: otherwise the crest settles further")


class VerdictPart(Part):
    """Holds the verdict on one quantity and its limit."""

    criterion: Criterion
    of: str = Field(description="the structure or face, and what computed it")
    low: float | None = Field(description="ends of the interval in which the quantity lies (m, or without a unit)")
    high: float | None = Field(description="null without an answer, and where a slide is not at rest")
    limit: float
    kh: float | None = Field(default=None, description="at which a factor of safety is asked for")
    source: str = Field(description="where the limit stands; empty where the file does not say")
    verdict: CriterionVerdict
    reason: str = Field(default="", description="why it is not decided")
