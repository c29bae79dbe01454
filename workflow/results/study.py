"""Stores statistics of the samples of a study in study.json, and slides by radius of the discs and time step in
converge.json."""

import math
import re
from statistics import NormalDist
from typing import ClassVar, Literal

from pydantic import Field

from workflow.results.answer import Answer, Known, Part, SectionLabel
from workflow.results.cases import QUANTITIES, Spread
from workflow.uncertain.settings import SamplingMethod

WORDS = {
    "kc": "critical Kh",
    "kc_lower_bound": "lower bound of the critical Kh",
    "kc_upper_bound": "upper bound of the critical Kh",
    "block_slide_m": "slide of the block (m)",
}
Z95 = 1.959963984540054  # of the standard normal distribution: 95 % lie within


class Effect(Part):
    """Holds the effect of one uncertain number on a result."""

    path: str = Field(description='path of the uncertain number in the section file, such as "strata.Silt.cohesion"')
    correlation: float | None = Field(
        description=(
            "Spearman's rank correlation, -1 to 1; for words the root of the share of variance between categories"
        )
    )
    first_order: float | None = Field(
        default=None, description="Sobol' index of first order: share of the variance by this number alone"
    )
    first_order_ci95: tuple[float, float] | None = Field(
        default=None, description="95 % confidence interval by bootstrap"
    )
    total_order: float | None = Field(
        default=None, description="total Sobol' index: share of the variance by this number and its interactions"
    )
    total_order_ci95: tuple[float, float] | None = Field(
        default=None, description="95 % confidence interval by bootstrap"
    )


class ProbabilityCurve(Part):
    """Holds a probability over a coefficient or a length, with its 95 % interval for the number of samples."""

    name: str = Field(description="event of the probability, and what the curve is over, in words")
    coefficient: tuple[float, ...] = Field(
        description="values of Kh, of the peak acceleration over gravity, or of a length (m), by the name"
    )
    probability: tuple[float, ...] = Field(description="probability at each value")
    low: tuple[float, ...] = Field(
        description="lower end of the 95 % interval, by Wilson (1927) for independent samples, by bootstrap for a fit"
    )
    high: tuple[float, ...] = Field(description="upper end of the same interval")


class Group(Part):
    """Holds the samples in which an uncertain word has one of its values."""

    path: str = Field(description="path of the uncertain word in the section file")
    value: str = Field(description="value of the word")
    samples: int = Field(description="number of samples with this value that have the result")
    spread: Spread = Field(description="distribution of the result over these samples, without the single values")


class Result(Part):
    """Holds one result over all samples that have a value of it."""

    name: str = Field(description='name of the column in samples.csv, such as "kc"')
    samples: int = Field(description="number of samples that have this result")
    spread: Spread = Field(
        description="distribution of the result, without the single values, which are in samples.csv"
    )
    effects: tuple[Effect, ...] = Field(description="effects of the uncertain numbers, the strongest first")
    groups: tuple[Group, ...] = Field(
        description="the same result for each value of every uncertain word, such as the sides"
    )

    @property
    def title(self) -> str:
        """Return the name of the result in words."""
        case = re.fullmatch(r"case(\d+)_(\w+)", self.name)
        if case is None or case[2] not in QUANTITIES:
            return WORDS.get(self.name, self.name)
        return f"case {case[1]}, {QUANTITIES[case[2]]} (m)"

    @property
    def is_detail(self) -> bool:
        """Return whether the column is a number of a slide other than its largest displacement."""
        return self.name.startswith("case") and not self.name.endswith("slide_max_m")

    @property
    def by_chance(self) -> float:
        """Return the value that the largest rank correlation of independent numbers exceeds with a probability of 5 %,
        for n samples. Each correlation of independent numbers is nearly normal with variance 1 / (n - 1), and
        Bonferroni's inequality gives the limit for all correlations together.
        """
        if self.samples < 2:
            return 1.0
        quantile = NormalDist().inv_cdf(1.0 - 0.025 / max(1, len(self.effects)))
        return min(1.0, quantile / math.sqrt(self.samples - 1))


class Failure(Part):
    """Holds a reason why samples have no answer."""

    reason: str = Field(description="the reason, in the words of the first sample that has it")
    samples: int = Field(description="number of samples that have it, with other numbers in it or not")


class StudyAnswer(Answer):
    """Holds the distributions of all results, effects of the uncertain numbers on them, and fragility curves."""

    FILE: ClassVar[str] = "study.json"

    section: SectionLabel = Field(description="section with the values of the file")
    parts: tuple[str, ...] = Field(description='requested parts of the study, such as "fem"')
    method: SamplingMethod = Field(description="method of sampling")
    seed: int = Field(description="number that the samples follow from")
    samples: int = Field(description="number of samples")
    failed: int = Field(description="number of samples in which a part has no answer")
    failures: tuple[Failure, ...] = Field(description="reasons why samples have no answer, the most frequent first")
    parts_without_answer: tuple[str, ...] = Field(
        default=(), description="requested parts of the study that have no answer in any sample"
    )
    results: tuple[Result, ...] = Field(description="results, one for each column of samples.csv")
    failure_probability: ProbabilityCurve | None = Field(
        description="probability that the critical Kh is below a given Kh"
    )
    fragility: tuple[ProbabilityCurve, ...] = Field(
        description=(
            "probability that a slide exceeds a length: of the block over Kh or peak acceleration, of the "
            "discs over the length, and over their shaking if it is uncertain"
        )
    )


class Series(Part):
    """Holds one number over ever smaller discs or time steps."""

    name: str = Field(description='name of the result, such as "case1_slide_max_m"')
    refined: Literal["radius", "step"] = Field(description="radius of the discs, or time step")
    sizes: tuple[float, ...] = Field(description="radius of the discs (m), or time step over the stable time step")
    values: tuple[float, ...] = Field(description="mean over the packings at each size")
    half_ci95: tuple[float | None, ...] = Field(description="half of the 95 % interval of each mean")
    limit: float = Field(description="extrapolated limit of the values at size zero")
    order: float | None = Field(description="order of convergence in the size; None if a straight line was fitted")
    remaining_error: Known = Field(description="estimated remaining error of the last value, as a share of the limit")
    converged: bool = Field(description="whether the remaining error is within the tolerance")
    verdict: str = Field(description="the convergence in words")


class ConvergenceAnswer(Answer):
    """Holds all series, and whether all of them have converged."""

    FILE: ClassVar[str] = "converge.json"

    section: SectionLabel = Field(description="section of the discs")
    tolerance: float = Field(description="largest remaining error of a converged number, as a share")
    converged: bool = Field(description="whether no run is without an answer, and all series have converged")
    missing: tuple[str, ...] = Field(description="runs without an answer, and the reasons")
    series: tuple[Series, ...] = Field(description="results over the radius of the discs, and over the time step")
