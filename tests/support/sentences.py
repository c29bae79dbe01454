"""Compares the numbers in the first paragraphs of a report with summary.json."""

import re
from collections.abc import Callable, Iterator
from typing import Any

from workflow.estimates.slide_error import slide_error

GRAVITY = 9.80665
NUMBER = r"(-?[\d.]*\d)"
Summary = dict[str, Any]


def disagreements(paragraphs: list[str], summary: Summary) -> list[str]:
    """Return the sentences whose numbers are unknown to all checks, or differ from those of the summary."""
    return [
        sentence
        for text in paragraphs
        for sentence in _sentences(text)
        if re.search(r"\d", sentence) and not _agrees(sentence, summary)
    ]


def _sentences(text: str) -> Iterator[str]:
    yield from re.split(r"(?<=[.:]) (?=[A-Z])", text)


def _agrees(sentence: str, summary: Summary) -> bool:
    for pattern, holds in CHECKS:
        match = re.search(pattern, sentence)
        if match is not None:
            return holds(summary, *match.groups())
    return False


def _near(message: str, true: float | None) -> bool:
    """Return whether a reported number equals the true one to its last digit, or to the accuracy of a slide of
    discs."""
    if true is None:
        return False
    decimals = len(message.partition(".")[2])
    step = 10.0**-decimals if decimals else 10.0 ** (len(message) - len(message.rstrip("0")) if float(message) else 0)
    return abs(float(message) - true) <= 0.5001 * step


def _slides(summary: Summary, cases: str, lengths: str, key: str = "slide_max_m") -> bool:
    """Return the lengths in the order of the cases, or one if all are equal."""
    numbers, matches = re.findall(r"\d+", cases), re.findall(NUMBER, lengths)
    matches = matches * len(numbers) if len(matches) == 1 else matches
    return len(matches) == len(numbers) and all(
        _near(item, max(summary["cases"][number][key], 0.0)) for item, number in zip(matches, numbers, strict=True)
    )


def _by_weight(summary: Summary, cases: str, lengths: str) -> bool:
    """Return the same for slides without shaking."""
    flow = all(summary["cases"][number]["flows"] for number in re.findall(r"\d+", cases))
    return flow and _slides(summary, cases, lengths, "slide_by_weight_m")


def _estimate(summary: Summary, kind: str, low: str, high: str | None) -> bool:
    values = [
        item["displacement_m"] for item in summary["comparison"] if kind in item["method"] and item["displacement_m"]
    ]
    return _near(low, min(values)) and _near(high or low, max(values))


def _disagree(summary: Summary, low: str, high: str | None, observed: str, observed_high: str | None) -> bool:
    slides = [max(case["slide_max_m"], 0.0) for case in summary["cases"].values()]
    discs = _near(low, min(slides)) and _near(high or low, max(slides))
    return discs and _estimate(summary, "Hamada", observed, observed_high)


def _span_of_slides(summary: Summary, low: str, high: str | None) -> bool:
    slides = [max(case["slide_max_m"], 0.0) for case in summary["cases"].values()]
    return _near(low, min(slides)) and _near(high or low, max(slides))


def _paper(summary: Summary, off: str, count: str, off_discs: str, discs: str) -> bool:
    """Return how many comparisons with the paper disagree, of all and of those of the calibrated discs."""
    compared = [row for row in summary["paper"] if row["agrees"] is not None]
    calibrated_rows = [row for row in compared if "calibrated" in row["quantity"]]
    results = [
        sum(not row["agrees"] for row in compared),
        len(compared),
        sum(not row["agrees"] for row in calibrated_rows),
        len(calibrated_rows),
    ]
    return results == [int(off), int(count), int(off_discs), int(discs)]


def _safe(summary: Summary, factor: str, key: str = "factor") -> bool:
    """Return the factor of safety without shaking, or the one by Davis's estimate."""
    return _near(factor, next(item for item in summary["fem"]["safety_factors"] if item["kh"] == 0.0)[key])


def _any_safe(summary: Summary, result: str | None, searched: str | None) -> bool:
    return _safe(summary, result or searched or "")


def _known_slides(summary: Summary, message: str) -> bool:
    """Return the error of the model from the table of the collection, for flows, spreads, or all."""
    return any(error is not None and error.sentence() == message for error in map(slide_error, (None, True, False)))


Check = Callable[..., bool]
CASES = r"In (cases? [\d, and]+\d)"
# The first pattern that is found in a sentence decides about it.
CHECKS: tuple[tuple[str, Check], ...] = (
    (r"^No (?:critical Kh|factor of safety): (.*)\.$", lambda s, why: why == s["no_answer"]["fem"]["reason"]),
    (rf"stands at every Kh up to {NUMBER}, the largest Kh of the", lambda s, kh: _near(kh, s["fem"]["kc_lower"])),
    (rf"with a factor of safety of {NUMBER} \(|with its strength divided by {NUMBER}\.", _any_safe),
    (r"^No factor of safety was computed; fem.safety_factor_at = \[0.0\] requests one", lambda s: True),
    (
        rf"^The section fails \w+, to the \w+, at Kh = {NUMBER} \({NUMBER} m/s²\)",
        lambda s, kh, a: _near(kh, s["fem"]["kc"]) and _near(a, GRAVITY * s["fem"]["kc"]),
    ),
    (
        rf"^The section fails \w+, to the \w+, at Kh = {NUMBER} or less \(",
        lambda s, kh: _near(kh, min(s["fem"]["kc"], s["bounds"]["upper"])),
    ),
    (
        rf"^The finite elements give a Kh that is {NUMBER} % higher, but the section cannot resist more than",
        lambda s, more: _near(more, 100.0 * (s["fem"]["kc"] / s["bounds"]["upper"] - 1.0)),
    ),
    (rf"^With Davis reduced strength the factor of safety is {NUMBER}\.", lambda s, factor: _safe(s, factor, "davis")),
    (rf"^With Davis reduced strength, .* the critical Kh is {NUMBER}\.", lambda s, kh: _near(kh, s["fem"]["kc_davis"])),
    (
        rf"^The section fails at Kh = {NUMBER} by (?:strict )?bounds[\w ]*, below the {NUMBER} ",
        lambda s, high, kh: _near(high, s["bounds"]["upper"]) and _near(kh, s["fem"]["kc"]),
    ),
    (
        rf"^The section fails \w+, to the \w+, at Kh = {NUMBER} to {NUMBER} by (?:strict )?bounds",
        lambda s, low, high: float(low) <= float(high) and _near(high, s["bounds"]["upper"]),
    ),
    (
        r"the surface slides < 0.1 m by (?:calibrated )?discs",
        lambda s: max(case["slide_max_m"] for case in s["cases"].values()) < 0.1,
    ),
    (
        rf"^After liquefaction of .* the surface slides (?:over )?{NUMBER}(?: to {NUMBER})? m by discs",
        _span_of_slides,
    ),
    (
        rf"^The slides are computed at Kh = {NUMBER}, .* after liquefaction, {NUMBER}",
        lambda s, kh, limit: any(_near(limit, sentence["kc"]) for sentence in s["liquefied"]),
    ),
    (r"^(\d+) of (\d+) comparisons with the paper disagree, among them (\d+) of the (\d+) comparisons", _paper),
    (
        rf"^The numerical error of the critical Kh is below {NUMBER}, by ",
        lambda s, error: 0.0 < float(error) < s["fem"]["kc"],
    ),
    (rf"^The sequence of meshes has not converged: the numerical error may be {NUMBER}", lambda s, _: True),
    (r"^The assumptions matter |^With .* instead of .* the critical Kh is ", lambda s: True),
    (
        rf"^The cohesionless face of .* fails at Kh = {NUMBER} already; this shallow failure is excluded",
        lambda s, kh: float(kh) <= s["fem"]["kc"] + 5e-4,
    ),
    (rf"^At Kh = {NUMBER} already, the cohesionless face", lambda s, kh: float(kh) <= s["fem"]["kc"] + 5e-4),
    (
        rf"^{CASES}(?: \(.*\))? liquefaction leaves",
        lambda s, cases: set(re.findall(r"\d+", cases)) == set(s.get("cases") or "123"),
    ),
    (
        rf"^Uncalibrated, the discs fail at Kh = {NUMBER}, {NUMBER} times",
        lambda s, kh, _: _near(kh, s["dem"]["kc_uncalibrated"]),
    ),
    (rf"^{CASES} the surface moves less than", lambda s, cases: all(
        s["cases"][number]["slide_max_m"] < 0.1 for number in re.findall(r"\d+", cases)
    )),
    (rf"^{CASES} the surface (?:slides|had slid) ([\d., and]+) m", _slides),
    (r"^One packing of discs was computed", lambda s: "cases_random" not in s or not s["cases_random"]),
    (
        rf"^The methods differ .* discs {NUMBER}(?: to {NUMBER})? m.* slides {NUMBER}(?: to {NUMBER})? m",
        _disagree,
    ),
    (r"^(.* of the collection were predicted by discs within a factor of [\d.]+ in \d+ of \d+ cases)", _known_slides),
    (rf"^{CASES} this is a flow failure: without shaking the surface slides ([\d., and]+) m within 20 s", _by_weight),
)  # fmt: skip
