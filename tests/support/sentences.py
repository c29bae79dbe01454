"""What the first paragraphs of a report say, held against summary.json: no number in them may be of another origin."""

import re
from collections.abc import Callable, Iterator
from typing import Any

from workflow.estimates.slide_error import slide_error

GRAVITY = 9.80665
NUMBER = r"(-?[\d.]*\d)"
Summary = dict[str, Any]


def disagreements(paragraphs: list[str], summary: Summary) -> list[str]:
    """Sentences that no check knows though they hold a number, or whose numbers are not those of the summary."""
    return [
        one for text in paragraphs for one in _sentences(text) if re.search(r"\d", one) and not _agrees(one, summary)
    ]


def _sentences(text: str) -> Iterator[str]:
    yield from re.split(r"(?<=[.:]) (?=[A-Z])", text)


def _agrees(sentence: str, summary: Summary) -> bool:
    for pattern, holds in CHECKS:
        match = re.search(pattern, sentence)
        if match is not None:
            return holds(summary, *match.groups())
    return False


def _near(told: str, true: float | None) -> bool:
    """Whether a number as told is the true one to its last digit, or to the digit a slide of discs is good for."""
    if true is None:
        return False
    decimals = len(told.partition(".")[2])
    step = 10.0**-decimals if decimals else 10.0 ** (len(told) - len(told.rstrip("0")) if float(told) else 0)
    return abs(float(told) - true) <= 0.5001 * step


def _slides(summary: Summary, cases: str, lengths: str, key: str = "slide_max_m") -> bool:
    """Lengths in the order of the cases, or one where all come to the same."""
    numbers, told = re.findall(r"\d+", cases), re.findall(NUMBER, lengths)
    told = told * len(numbers) if len(told) == 1 else told
    return len(told) == len(numbers) and all(
        _near(one, max(summary["cases"][number][key], 0.0)) for one, number in zip(told, numbers, strict=True)
    )


def _by_weight(summary: Summary, cases: str, lengths: str) -> bool:
    """The same of what slides without any shaking."""
    flow = all(summary["cases"][number]["flows"] for number in re.findall(r"\d+", cases))
    return flow and _slides(summary, cases, lengths, "slide_by_weight_m")


def _estimate(summary: Summary, kind: str, low: str, high: str | None) -> bool:
    found = [one["displacement_m"] for one in summary["comparison"] if kind in one["method"] and one["displacement_m"]]
    return _near(low, min(found)) and _near(high or low, max(found))


def _disagree(summary: Summary, low: str, high: str | None, observed: str, observed_high: str | None) -> bool:
    slides = [max(case["slide_max_m"], 0.0) for case in summary["cases"].values()]
    discs = _near(low, min(slides)) and _near(high or low, max(slides))
    return discs and _estimate(summary, "Hamada", observed, observed_high)


def _other(summary: Summary, prefix: str = "", of: Summary | None = None) -> float | None:
    """The number by the other flow rule: Davis's estimate, or psi = phi."""
    numbers = of or summary["fem"]
    return next(
        (numbers[prefix + name] for name in ("davis", "associated") if numbers[prefix + name] is not None), None
    )


def _safe(summary: Summary, factor: str, other: str | None) -> bool:
    """The factor of safety without shaking, by both flow rules where they differ."""
    found = next(one for one in summary["fem"]["safety_factors"] if one["kh"] == 0.0)
    return _near(factor, found["factor"]) and (other is None or _near(other, _other(summary, of=found)))


def _known_slides(summary: Summary, told: str) -> bool:
    """The error of the model, from the table of the collection, for flows, spreads, or all of them."""
    return any(error is not None and error.sentence() == told for error in map(slide_error, (None, True, False)))


Check = Callable[..., bool]
CASES = r"In (cases? [\d, and]+\d)"
# The first pattern that is found in a sentence decides about it.
CHECKS: tuple[tuple[str, Check], ...] = (
    (rf"^Asked was .* how far it slides under Kh = {NUMBER} once", lambda s, kh: float(kh) == 0.1),
    (r"^There is no answer to the first question: (.*)\.$", lambda s, why: why == s["no_answer"]["fem"]["reason"]),
    (rf"under every Kh up to {NUMBER}, where", lambda s, kh: _near(kh, s["fem"]["kc_lower"])),
    (rf"stands, with a factor of safety of {NUMBER} (?:with|by) .*?(?:[:] {NUMBER})?\.$", _safe),
    (
        rf"it fails \w+, to the \w+, at Kh of about {NUMBER} (?:with|by) .*?(?:[:] {NUMBER}.*)?\.$",
        lambda s, kh, other: _near(kh, s["fem"]["kc"]) and (other is None or _near(other, _other(s, "kc_"))),
    ),
    (
        rf"^A Kh of {NUMBER} is a horizontal acceleration of {NUMBER} m/s²\.",
        lambda s, kh, a: _near(kh, s["fem"]["kc"]) and _near(a, GRAVITY * s["fem"]["kc"]),
    ),
    (rf"^Numerical error is below {NUMBER}, by ", lambda s, error: 0.0 < float(error) < s["fem"]["kc"]),
    (rf"^The sequence of meshes has not converged: the numerical error may be {NUMBER}", lambda s, _: True),
    # a push uphill that leaves through a side counts only if there is nothing else
    (r"^Pushed uphill it fails at Kh of about .*, but only at the ", lambda s: True),
    (rf"^Pushed \w+ it fails at Kh of about {NUMBER}", lambda s, kh: float(kh) >= round(s["fem"]["kc"], 2)),
    (r"^Pushed \w+ it stands up to Kh", lambda s: True),
    (r"^The assumptions matter |^With other assumptions: ", lambda s: True),
    (rf"^Before that, at Kh = {NUMBER}, single grains", lambda s, kh: float(kh) <= s["fem"]["kc"]),
    (
        rf"^Limit analysis proves that it is {NUMBER} to {NUMBER} for",
        lambda s, low, high: _near(low, s["bounds"]["lower"]) and _near(high, s["bounds"]["upper"]),
    ),
    (
        rf"^{CASES}(?: \(.*\))? liquefaction leaves",
        lambda s, cases: set(re.findall(r"\d+", cases)) == set(s.get("cases") or "123"),
    ),
    (
        rf"fail at Kh of about {NUMBER}, {NUMBER} times that",
        lambda s, kh, _: _near(kh, s["dem"]["kc_uncalibrated"]),
    ),
    (rf"^{CASES} the section stays where it is", lambda s, cases: all(
        s["cases"][number]["slide_max_m"] < 0.1 for number in re.findall(r"\d+", cases)
    )),
    (rf"^{CASES} it (?:slides|had slid) about ([\d., and]+) m", _slides),
    (r"^No interval is known, since only one packing", lambda s: "cases_random" not in s or not s["cases_random"]),
    (
        rf"^The methods disagree .* about {NUMBER}(?: to {NUMBER})? m.* gives about {NUMBER}(?: to {NUMBER})? m",
        _disagree,
    ),
    (r"^(.* of the collection were predicted within a factor of [\d.]+ in \d+ of \d+ cases)", _known_slides),
    (rf"^{CASES} it is a flow failure: without any shaking it slides about ([\d., and]+) m in 20 s", _by_weight),
)  # fmt: skip
