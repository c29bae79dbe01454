"""Truncates distributions to the values that fields of the input accept (a strength: 0 or more)."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import BaseModel, TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

from meshes.section.sentences import limit_words, model_at
from workflow.uncertain.distribution import Distribution
from workflow.uncertain.path import changed_value, places, value_at

# The smallest and the largest probability of a sample.
EXTREMES = 2.0**-54, 1.0 - 2.0**-53
HALVINGS = 60
REPORTED_CUT_OFF = 1e-4  # share of a distribution that is cut off, from which it is reported

Models = Sequence[type[BaseModel]]  # whose fields stand side by side in an input
Check = Callable[[Any], str]  # what is wrong with a number that is drawn; empty where nothing is


@dataclass(frozen=True)
class AdmissibleRange:
    """Holds the range of probabilities in which a distribution has only admissible numbers.

    Attributes
    ----------
    low, high : ends of the range (0 to 1)
    notice : share of the distribution that is cut off, with the reason; empty if it is negligible
    problem : reason why an end in the input is impossible; empty if the ends are possible
    """

    low: float = 0.0
    high: float = 1.0
    notice: str = ""
    problem: str = ""

    def within(self, probability: float) -> float:
        """Convert a probability (0 to 1) of the truncated distribution to the probability of the same number in the
        whole distribution.
        """
        return self.low + probability * (self.high - self.low)


def reach_of(
    data: Mapping[str, Any], numbers: Mapping[str, Distribution], models: Models
) -> dict[str, AdmissibleRange]:
    """Return the range of each distribution that the fields of the input accept.

    Tails of normal and lognormal distributions are truncated where the field refuses the number. If the field refuses
    an end that the input states (uniform, triangular, list, truncation), this is a problem.

    Parameters
    ----------
    data : nested tables of the input
    numbers : distributions by their paths in the input
    models : models whose fields stand side by side in the input; the last one has all other keys

    Returns
    -------
    Ranges of probabilities by path, with notices and problems.
    """
    return {
        path: _reach(path, distribution, _check_of(data, path, distribution, models))
        for path, distribution in numbers.items()
    }


def _reach(path: str, distribution: Distribution, check: Check) -> AdmissibleRange:
    name = f'uncertain, "{path}"'
    if distribution.list is not None:
        others = [value for value in distribution.list if value != distribution.at(0.5)]
        return AdmissibleRange(
            problem="\n".join(f"{name}: {listed!r} in its list: {text}" for listed in others if (text := check(listed)))
        )
    at = distribution.at
    if check(at(0.5)):
        return AdmissibleRange()  # its median is reported with the whole input
    if distribution.kind in ("uniform", "triangular") or distribution.truncation is not None:
        ends = distribution.truncation or getattr(distribution, distribution.kind)
        refused = [(end, check(at(extreme))) for end, extreme in zip((ends[0], ends[-1]), EXTREMES, strict=True)]
        return AdmissibleRange(problem="\n".join(f"{name}: it reaches {end}: {text}" for end, text in refused if text))
    low, high = (_furthest(lambda probability: not check(at(probability)), extreme) for extreme in EXTREMES)
    messages = [
        f"{name}: {100.0 * share:.2g} % of its {distribution.kind} distribution lie {side} "
        f"{distribution.written(round(at(bound), 9) + 0.0)} and are cut off ({check(at(end))})"
        for side, bound, share, end in (
            ("below", low, low, EXTREMES[0]), ("above", high, 1.0 - high, EXTREMES[1]),
        )
        if share > REPORTED_CUT_OFF
    ]  # fmt: skip
    return AdmissibleRange(low, high, "\n".join(messages))


def _check_of(data: Mapping[str, Any], path: str, distribution: Distribution, models: Models) -> Check:
    """Check a drawn number by the fields that its path names."""
    fields = []
    try:
        for place in places(data, path):
            here = next(
                model_at(place, model) for model in models if str(place[0]) in model.model_fields or model is models[-1]
            )
            field = here.model_fields.get(str(place[-1])) if here is not None else None
            if field is not None:
                fields.append((value_at(data, place), _adapter(field)))
    except ValueError:  # a path that leads nowhere is reported with the whole input
        fields = []

    def check(drawn: Any) -> str:
        for before, adapter in fields:
            try:
                adapter.validate_python(changed_value(before, distribution, drawn))
            except ValidationError as error:
                return _sentence(error)
            except ValueError as error:
                return str(error)
        return ""

    return check


def _adapter(field: FieldInfo) -> TypeAdapter[Any]:
    kind: Any = field.annotation
    return TypeAdapter(Annotated[kind, *field.metadata] if field.metadata else kind)


def _sentence(error: ValidationError) -> str:
    first = error.errors()[0]
    if limit := limit_words(first):
        return f"expected {limit}"
    text = str(first["ctx"]["error"]) if first["type"] == "value_error" else first["msg"]
    return text[:1].lower() + text[1:]


def _furthest(is_possible: Callable[[float], bool], end: float) -> float:
    """Return the probability between the median and ``end`` (0 or 1) up to which all numbers are admissible; ``end`` if
    all are.
    """
    if is_possible(end):
        return round(end)
    inside, outside = 0.5, end
    for _ in range(HALVINGS):
        middle = 0.5 * (inside + outside)
        inside, outside = (middle, outside) if is_possible(middle) else (inside, middle)
    return inside
