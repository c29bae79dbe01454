"""Formats numbers as text, with significant digits and units."""

import math
from collections.abc import Sequence

from fem.search.result_warnings import difference_words
from workflow.results.accuracy import Accuracy, exceeds, falls_below
from workflow.results.continuum import FemAnswer
from workflow.results.lengths import metres
from workflow.texts.report_texts import Texts, listed

SMALLEST_SLIDE = 0.1  # m: discs do not resolve less; a slide of less is reported as none
SMALLEST_ERROR = 0.001  # numerical errors are reported as no less


def number(value: float | None, digits: int = 3) -> str:
    """Return a number with some decimal places; a dash for None."""
    return "–" if value is None else f"{value:.{digits}f}"


def bracket(lower: float | None, upper: float | None, digits: int) -> str:
    """Return two bounds as text; a dash where one is missing."""
    return f"{number(lower, digits)} to {number(upper, digits)}"


def strict_words(lower: float | None, upper: float | None) -> str:
    """Return the strict bounds of a critical Kh, either of which may be missing, after a comma."""
    if lower is not None and upper is not None:
        return f", with strict bounds of {range_of([lower, upper])}"
    return f", at most {coefficient(upper)} by a strict bound" if upper is not None else ""


def scaled(value: float | None, unit: float) -> float | None:
    """Return a value in multiples of a unit; None for None."""
    return None if value is None else value / unit


def span(lengths: Sequence[float]) -> str:
    """Return the range of some slides (m), with the digits of tables: 0.85 to 6.9 m, or one slide if all are equal."""
    return signed_span([max(length, 0.0) for length in lengths])


def signed_span(lengths: Sequence[float]) -> str:
    """Return the range of lengths (m) that may be negative, such as freeboards: -0.30 to 0.57 m."""
    low, high = metres(min(lengths)), metres(max(lengths))
    return low if low == high else f"{low.removesuffix(' m')} to {high}"


def slides_in_words(lengths: Sequence[float]) -> str:
    """Return slides (m) in a sentence, with the digits of tables: 40, 19 and 6.9 m, or one slide if all are equal."""
    phrases = [metres(max(value, 0.0)).removesuffix(" m") for value in lengths]
    return f"{listed(phrases if len(set(phrases)) > 1 else phrases[:1])} m"


def rough(value: float) -> float:
    """Return a number rounded to one digit, or to two if the first digit is 1, which is the accuracy of an interval by
    a factor of error."""
    if value == 0.0:
        return 0.0
    power = math.floor(math.log10(abs(value)))
    first = abs(value) / 10.0**power
    digits = 1 if first < 1.95 else 0
    return round(value, digits - power)


def rough_range(low: float, high: float) -> str:
    """Return an interval of lengths (m) by a factor of error: 0.3 to 3 m."""
    ends = [_plain(rough(max(end, 0.0))) for end in (low, high)]
    return f"{ends[0]} m" if ends[0] == ends[1] else f"{ends[0]} to {ends[1]} m"


def _plain(value: float) -> str:
    return f"{value:.0f}" if value >= 10.0 else f"{value:g}"


def coefficient(kh: float) -> str:
    """Return a seismic coefficient to three places, as in all tables and pictures: 0.234."""
    return f"{kh:.3f}"


def lower_limit(factor: float) -> str:
    """Return a factor of safety at which a search ended without failure, in two digits rounded down: 20, or 3.4."""
    return f"{math.floor(factor):d}" if factor >= 10.0 else f"{math.floor(10.0 * factor) / 10.0:.1f}"


def rough_coefficient(kh: float) -> str:
    """Return a seismic coefficient that may be some per cent off, with two digits: 0.23, or 0.045."""
    return f"{kh:.{2 if kh >= 0.0995 else 3}f}"


def of_cases(numbers: Sequence[int]) -> str:
    """Return cases as in a sentence: cases 1, 2 and 3."""
    return f"case{'s' if len(numbers) > 1 else ''} {listed([str(number) for number in numbers])}"


def case_numbers(numbers: Sequence[int]) -> str:
    """Return the numbers of cases in a cell of a table: 1, 2, 3."""
    return ", ".join(map(str, numbers))


def range_of(values: Sequence[float]) -> str:
    """Return the range of some coefficients, or one of them if all are equal: 0.23 to 0.25."""
    low, high = coefficient(min(values)), coefficient(max(values))
    return low if low == high else f"{low} to {high}"


def rounded_up(value: float) -> float:
    """Return a positive number rounded up to one digit: 0.0043 becomes 0.005."""
    value = max(value, SMALLEST_ERROR)
    power = 10.0 ** math.floor(math.log10(value) + 1e-9)
    return float(f"{math.ceil(value / power - 1e-6) * power:.3g}")


def numerical_error(estimate: Accuracy | None, kc: float) -> str:
    """Return the numerical error of ``kc`` in a sentence."""
    if estimate is None:
        return (
            "The numerical error of the critical Kh is not known, since there is one mesh and no strict bound of the "
            'same flow rule; variants.which = ["mesh"] computes it.'
        )
    error = f"{rounded_up(estimate.error(kc)):g}"
    if not estimate.reliable:
        return (
            f"The sequence of meshes has not converged: the numerical error may be {error}, with the critical Kh "
            f"anywhere from {range_of([estimate.low, estimate.high])}."
        )
    alone = alone_words(estimate, range_of([estimate.low, estimate.high]))
    return f"The numerical error of the critical Kh is below {error}, {estimate.source}{alone}."


def alone_words(error: Accuracy, shown: str) -> str:
    """Return the strict bounds alone in words if the interval that is ``shown`` is another one; else nothing."""
    if error.strict is None or (alone := range_of(error.strict)) == shown:
        return ""
    return f" (by strict bounds alone {alone})"


def range_sentence(answer: FemAnswer, error: Accuracy) -> str:
    """Return the interval of the critical Kh in a sentence, and the value by finite elements if it lies beyond."""
    alone = alone_words(error, range_of([error.low, error.high]))
    if not answer.has_kc:
        return f"The range {error.method} is {range_of([error.low, error.high])}{alone}."
    if exceeds(answer.kc, error.high):
        beyond = f"{difference_words(answer.kc, error.high)} above this range, whose upper end is"
    elif falls_below(answer.kc, error.low):
        beyond = f"{difference_words(answer.kc, error.low)} below this range, whose lower end is"
    else:  # their last digit may be the next one
        return f"The range {error.method} is {range_of([error.low, error.high, answer.kc])}{alone}."
    return (
        f"The range {error.method} is {range_of([error.low, error.high])}{alone}. The finite elements give "
        f"{coefficient(answer.kc)}, {beyond} the critical Kh."
    )


def interval_text(error: Accuracy | None, _: Texts, kh: float, unknown: str = "") -> str:
    """Return the interval of a critical Kh ``kh`` by its ``error`` as a text by ``_``, or that it is ``unknown``. If
    ``kh`` lies beyond the interval by no more than rounding, so that its last digit may be the next one, it is the end
    of the interval."""
    if error is None:
        return unknown or _("numerical error not known: one mesh, no strict bounds")
    rounding = not exceeds(kh, error.high) and not falls_below(kh, error.low)
    low, high = (min(error.low, kh), max(error.high, kh)) if rounding else (error.low, error.high)
    strict = None if error.strict is None else (coefficient(error.strict[0]), coefficient(error.strict[1]))
    return from_to(coefficient(low), coefficient(high), error.method, _, strict)


def from_to(low: str, high: str, method: str, _: Texts, strict: tuple[str, str] | None = None) -> str:
    """Return an interval from ``low`` to ``high`` and its ``method`` as a text by ``_``; if both ends have the same
    digits, the digit that the error is below. The ``strict`` bounds alone are added if their digits differ."""
    alone = ""
    if strict is not None and strict != (low, high):
        alone = _("; strict bounds alone {low} to {high}", low=strict[0], high=strict[1])
    if low == high:
        digit = 10.0 ** -len(low.partition(".")[2])
        return _("error below {digit} {method}", digit=f"{digit:g}", method=_(method)) + alone
    return _("{interval} {method}", interval=_("{low} to {high}", low=low, high=high), method=_(method)) + alone
