"""Writes intervals of numbers, and what they follow from, as texts in the language of the report."""

from workflow.report.numbers import coefficient
from workflow.results.accuracy import Accuracy
from workflow.texts.report_texts import Texts


def interval_text(error: Accuracy | None, _: Texts, unknown: str = "") -> str:
    """Return the interval of a critical Kh, or that it is ``unknown``."""
    if error is None:
        return unknown or _("numerical error not known: one mesh, no strict bounds")
    strict = None if error.strict is None else (coefficient(error.strict[0]), coefficient(error.strict[1]))
    return from_to(coefficient(error.low), coefficient(error.high), error.method, _, strict)


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
