"""converge.json: how slides depend on the radius of the discs and on the time step."""

from typing import ClassVar, Literal

from pydantic import Field

from workflow.results.answer import Answer, Known, Part, SectionLabel


class Series(Part):
    """One number over ever smaller discs or steps."""

    name: str
    over: Literal["radius", "step"]
    sizes: tuple[float, ...] = Field(description="radius (m), or step over the stable one")
    values: tuple[float, ...] = Field(description="means over the packings")
    half_ci95: tuple[float | None, ...] = Field(description="half of the 95 % interval of each mean")
    limit: float = Field(description="what the values tend to")
    order: float | None = Field(description="power of the size; None where a straight line was fitted")
    left: Known = Field(description="what may be left of the error of the last value, as a share of the limit")
    converged: bool
    verdict: str


class ConvergenceAnswer(Answer):
    """All series, and whether all of them have converged."""

    FILE: ClassVar[str] = "converge.json"

    section: SectionLabel
    within: float = Field(description="share that was asked for")
    converged: bool
    missing: tuple[str, ...] = Field(description="runs without an answer, and why")
    series: tuple[Series, ...]
