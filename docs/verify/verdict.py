"""Whether what this program finds for a published case is right."""

from collections.abc import Iterator
from dataclasses import dataclass
from statistics import median
from typing import Literal

from docs.verify.case import Case, Kind, Value
from docs.verify.record import Answer

# How far what was published may be from our bracket, as a share of it, by how it was found. Methods of slices that
# satisfy equilibrium are within 6 % of each other (Duncan 1996); a survey is the mean of such; published elements have
# coarse meshes and criteria of their own.
TOLERANCE: dict[Kind, float] = {
    "closed form": 0.02,
    "limit analysis": 0.005,
    "upper bound": 0.04,
    "equilibrium": 0.05,
    "survey": 0.05,
    "elements": 0.06,
}
# How far the finite elements with ψ = φ may be outside the bracket, below and above: they come from above as the mesh
# gets finer.
BELOW, ABOVE = 0.01, 0.01
# Without dilation a slope is no stronger; by how much the elements may say otherwise.
NO_STRONGER = 0.02

Word = Literal["right", "wrong", "explained", "not run"]


@dataclass(frozen=True)
class CaseVerdict:
    """The verdict in a word, and remarks."""

    word: Word
    remarks: tuple[str, ...]


def judge(case: Case, answer: Answer | None) -> CaseVerdict:
    """Right if the finite elements agree with the bounds and the median of each kind of published value with both."""
    if answer is None:
        return CaseVerdict("not run", ())
    faults = [*_contradictions(answer), *(f"no answer by {text}" for text in answer.failures)]
    apart = list(_apart(case, answer))
    if faults:
        return CaseVerdict("wrong", (*faults, *apart))
    if apart and not case.published.explained:
        return CaseVerdict("wrong", tuple(apart))
    if apart:
        return CaseVerdict("explained", (case.published.explained, *apart, *outside(case, answer), *rolling(answer)))
    return CaseVerdict("right", (*outside(case, answer), *rolling(answer)))


def interval(answer: Answer, kind: Kind) -> tuple[float, float] | None:
    """The range of our answers that a published value of a kind is compared with; None without any.

    Published finite elements mostly have no dilation: their range extends down to our elements without dilation. With a
    cohesionless face the least depth of a failure is each author's choice: all ranges extend down to the shallow
    failure.
    """
    ends = [end for end in (answer.lower, answer.upper) if end is not None]
    if len(ends) < 2 and answer.associated is not None:
        ends.append(answer.associated)
    if not ends:
        return None
    low, high = min(ends), max(ends)
    if kind == "elements":
        low = min([low, *(e for e in (answer.davis, answer.associated) if e is not None)])
    return (low if answer.shallow_failure is None else min(low, answer.shallow_failure)), high


def rolling(answer: Answer) -> Iterator[str]:
    """A sentence on the shallow failure of a cohesionless face, where there is one."""
    if answer.shallow_failure is not None:
        shallow = f"{answer.shallow_failure:.3f}"
        yield f"A cohesionless face fails (shallow failure) at {shallow}; the numbers are of the slope as a whole"


def outside(case: Case, answer: Answer) -> Iterator[str]:
    """A sentence on the published values that the strict bounds exclude, above and below."""
    values = case.published.values
    if answer.upper is not None:
        above = [_named(value) for value in values if value.ends[0] > answer.upper]
        if above:
            yield f"Proven to fail: {', '.join(above)}"
    if answer.lower is not None:
        least = answer.lower if answer.shallow_failure is None else min(answer.lower, answer.shallow_failure)
        below = [_named(value) for value in values if value.ends[1] < least and value.kind != "upper bound"]
        if below:
            yield f"Proven to stand: {', '.join(below)}"


def _named(value: Value) -> str:
    low, high = value.ends
    return f"{low:g}" + (f" to {high:g}" if high > low else "") + f" ({value.author}, {value.method})"


def _contradictions(answer: Answer) -> Iterator[str]:
    """Contradictions among the results of this program."""
    elements, lower, upper = answer.associated, answer.lower, answer.upper
    if elements is not None and lower is not None and elements < (1.0 - BELOW) * lower:
        yield f"elements with ψ = φ find {elements:.4g}, below the lower bound {lower:.4g}"
    if elements is not None and upper is not None and elements > (1.0 + ABOVE) * upper:
        yield f"elements with ψ = φ find {elements:.4g}, {100 * (elements / upper - 1):.0f} % above the upper bound"
    top = upper if upper is not None else elements
    if answer.davis is not None and top is not None and answer.davis > (1.0 + ABOVE + NO_STRONGER) * top:
        yield f"elements find {answer.davis:.4g} by Davis's estimate, more than with ψ = φ"


def _apart(case: Case, answer: Answer) -> Iterator[str]:
    """A sentence for each kind of published value whose median is too far from ours."""
    kinds = dict.fromkeys(value.kind for value in case.published.values)
    for kind in kinds:
        ours = interval(answer, kind)
        if ours is None:
            continue
        low, high = _median([value for value in case.published.values if value.kind == kind])
        off = max(ours[0] - high, low - ours[1], 0.0)
        if off > TOLERANCE[kind] * 0.5 * sum(ours):
            yield f"{kind}: {low:g} published, {ours[0]:.4g} to {ours[1]:.4g} here"


def _median(values: list[Value]) -> tuple[float, float]:
    return median(value.ends[0] for value in values), median(value.ends[1] for value in values)
