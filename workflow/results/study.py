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

    path: str
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
    """Holds a probability over a coefficient, with its 95 % interval for the number of samples."""

    name: str
    coefficient: tuple[float, ...] = Field(description="values of Kh, or of the peak acceleration over gravity")
    probability: tuple[float, ...]
    low: tuple[float, ...] = Field(
        description="lower end of the 95 % interval, by Wilson (1927) for independent samples, by bootstrap for a fit"
    )
    high: tuple[float, ...]


class Group(Part):
    """Holds the samples in which an uncertain word has one of its values."""

    path: str
    value: str
    samples: int
    spread: Spread


class Result(Part):
    """Holds one result over all samples that have a value of it."""

    name: str
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
    """Holds a reason why samples have no answer, in the words of the first such sample, and the number of these
    samples."""

    reason: str
    samples: int


class StudyAnswer(Answer):
    """Holds the distributions of all results, effects of the uncertain numbers on them, and fragility curves."""

    FILE: ClassVar[str] = "study.json"

    section: SectionLabel
    parts: tuple[str, ...]
    method: SamplingMethod
    seed: int
    samples: int
    failed: int
    failures: tuple[Failure, ...]
    parts_without_answer: tuple[str, ...] = Field(
        default=(), description="requested parts of the study that have no answer in any sample"
    )
    results: tuple[Result, ...]
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

    name: str
    refined: Literal["radius", "step"] = Field(description="radius of the discs, or time step")
    sizes: tuple[float, ...] = Field(description="radius of the discs (m), or time step over the stable time step")
    values: tuple[float, ...] = Field(description="mean over the packings at each size")
    half_ci95: tuple[float | None, ...] = Field(description="half of the 95 % interval of each mean")
    limit: float = Field(description="extrapolated limit of the values at size zero")
    order: float | None = Field(description="order of convergence in the size; None if a straight line was fitted")
    remaining_error: Known = Field(description="estimated remaining error of the last value, as a share of the limit")
    converged: bool
    verdict: str


class ConvergenceAnswer(Answer):
    """Holds all series, and whether all of them have converged."""

    FILE: ClassVar[str] = "converge.json"

    section: SectionLabel
    tolerance: float = Field(description="largest remaining error of a converged number, as a share")
    converged: bool
    missing: tuple[str, ...] = Field(description="runs without an answer, and the reasons")
    series: tuple[Series, ...]
