"""Decides whether the answer of the program for a published slope is right."""

from collections.abc import Iterator
from dataclasses import dataclass
from statistics import median
from typing import Literal

from docs.verify.case import Case, Kind, Value
from docs.verify.record import Answer

# Largest distance of a published value from the bracket of the program, as a share of the bracket, by method. Methods
# of slices that satisfy equilibrium are within 6 % of each other (Duncan 1996); a survey is their mean; published
# finite elements have coarse meshes and other failure criteria.
TOLERANCE: dict[Kind, float] = {
    "closed form": 0.02,
    "limit analysis": 0.005,
    "upper bound": 0.04,
    "equilibrium": 0.05,
    "survey": 0.05,
    "elements": 0.06,
}
# Largest distance of the finite elements with ψ = φ below and above the bracket, which they approach from above as the
# mesh becomes finer.
TOLERANCE_BELOW, TOLERANCE_ABOVE = 0.01, 0.01
# A slope without dilation is not stronger; this is the tolerance for the finite elements.
DAVIS_TOLERANCE = 0.02

Word = Literal["right", "wrong", "explained", "not run"]


@dataclass(frozen=True)
class CaseVerdict:
    """Holds the verdict in a word, and remarks."""

    word: Word
    remarks: tuple[str, ...]


def judge(case: Case, answer: Answer | None) -> CaseVerdict:
    """Return the verdict on a case. It is right if the finite elements agree with the bounds, and the median of each
    kind of published values agrees with both."""
    if answer is None:
        return CaseVerdict("not run", ())
    faults = [*_contradictions(answer), *(f"no answer by {text}" for text in answer.failures)]
    apart = list(_differences(case, answer))
    if faults:
        return CaseVerdict("wrong", (*faults, *apart))
    if apart and not case.published.explained:
        return CaseVerdict("wrong", tuple(apart))
    if apart:
        return CaseVerdict("explained", (case.published.explained, *apart, *outside(case, answer), *rolling(answer)))
    return CaseVerdict("right", (*outside(case, answer), *rolling(answer)))


def interval(answer: Answer, kind: Kind) -> tuple[float, float] | None:
    """Return the range of the answers of the program that a published value of a kind is compared with; None without an
    answer.

    Most published finite elements have no dilation: for them the range extends down to the finite elements without
    dilation. If there is a cohesionless face, every author chooses the least depth of failures: all ranges then extend
    down to the shallow failure.
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
    """Yield a sentence on the shallow failure of a cohesionless face, if there is one."""
    if answer.shallow_failure is not None:
        shallow = f"{answer.shallow_failure:.3f}"
        yield f"A cohesionless face fails (shallow failure) at {shallow}; the numbers are of the slope as a whole"


def outside(case: Case, answer: Answer) -> Iterator[str]:
    """Yield sentences on the published values that lie above or below the strict bounds."""
    values = case.published.values
    if answer.upper is not None:
        above = [_value_words(value) for value in values if value.ends[0] > answer.upper]
        if above:
            yield f"Proven to fail: {', '.join(above)}"
    if answer.lower is not None:
        least = answer.lower if answer.shallow_failure is None else min(answer.lower, answer.shallow_failure)
        below = [_value_words(value) for value in values if value.ends[1] < least and value.kind != "upper bound"]
        if below:
            yield f"Proven to stand: {', '.join(below)}"


def _value_words(value: Value) -> str:
    low, high = value.ends
    return f"{low:g}" + (f" to {high:g}" if high > low else "") + f" ({value.author}, {value.method})"


def _contradictions(answer: Answer) -> Iterator[str]:
    """Yield contradictions among the answers of the program."""
    elements, lower, upper = answer.associated, answer.lower, answer.upper
    if elements is not None and lower is not None and elements < (1.0 - TOLERANCE_BELOW) * lower:
        yield f"elements with ψ = φ find {elements:.4g}, below the lower bound {lower:.4g}"
    if elements is not None and upper is not None and elements > (1.0 + TOLERANCE_ABOVE) * upper:
        yield f"elements with ψ = φ find {elements:.4g}, {100 * (elements / upper - 1):.0f} % above the upper bound"
    top = upper if upper is not None else elements
    if answer.davis is not None and top is not None and answer.davis > (1.0 + TOLERANCE_ABOVE + DAVIS_TOLERANCE) * top:
        yield f"elements find {answer.davis:.4g} by Davis's estimate, more than with ψ = φ"


def _differences(case: Case, answer: Answer) -> Iterator[str]:
    """Yield a sentence for each kind of published values whose median differs too much from the answers of the
    program."""
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
