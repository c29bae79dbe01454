"""study.json: what the samples of a study say together."""

from typing import ClassVar

from pydantic import Field

from workflow.results.answer import Answer, Part, SectionLabel
from workflow.results.cases import Spread
from workflow.uncertain.settings import Method


class Effect(Part):
    """What one uncertain number does to a result."""

    path: str
    correlation: float | None = Field(
        description="Spearman's rank correlation, -1 to 1; for words the root of the share of variance between them"
    )
    first: float | None = Field(
        default=None, description="Sobol' index of first order: its share of the variance alone"
    )
    first_ci95: tuple[float, float] | None = Field(default=None, description="by bootstrap")
    total: float | None = Field(default=None, description="total Sobol' index: with all it does together with others")
    total_ci95: tuple[float, float] | None = Field(default=None, description="by bootstrap")


class Curve(Part):
    """A probability over a coefficient, with the interval that so many samples leave."""

    name: str
    over: tuple[float, ...]
    chance: tuple[float, ...]
    low: tuple[float, ...] = Field(
        description="95 % interval by Wilson (1927), of independent samples; of a fit by bootstrap"
    )
    high: tuple[float, ...]


class Group(Part):
    """The samples in which an uncertain word has one of its values."""

    path: str
    value: str
    samples: int
    spread: Spread


class Result(Part):
    """One column of results over all samples that have it."""

    name: str
    samples: int = Field(description="that have it")
    spread: Spread = Field(description="without the single values, which stand in samples.csv")
    effects: tuple[Effect, ...] = Field(description="the strongest first")
    groups: tuple[Group, ...] = Field(description="the same for each value of every word, such as the sides")


class Failure(Part):
    """A reason for which samples have no answer, and how many."""

    reason: str
    samples: int


class StudyAnswer(Answer):
    """The distributions of all results, what they hang on, and fragility curves."""

    FILE: ClassVar[str] = "study.json"

    section: SectionLabel
    parts: tuple[str, ...]
    method: Method
    seed: int
    samples: int
    failed: int
    failures: tuple[Failure, ...]
    results: tuple[Result, ...]
    fails: Curve | None = Field(description="probability that the critical Kh is below a Kh")
    fragility: tuple[Curve, ...] = Field(
        description="probability that a slide exceeds a length: of the block over Kh or peak acceleration, of the "
        "discs over the length, and over what shakes them where that is drawn"
    )
