"""Whether a quantity keeps a limit: satisfied, not satisfied, or not decided."""

from typing import Literal

Verdict = Literal["satisfied", "not satisfied", "not decided"]


def judge(low: float | None, high: float | None, limit: float, at_least: bool) -> Verdict:
    """Compare the interval of a quantity with its limit.

    Parameters
    ----------
    low, high : float or None
        Ends of the interval in which the quantity lies; None where there is no answer.
    limit : float
        The limit in the unit of the quantity.
    at_least : bool
        Whether the limit is the least value that is allowed; otherwise it is the largest one.

    Returns
    -------
    Verdict
        "not decided" without an answer, and where the limit lies inside the interval.
    """
    if low is None or high is None:
        return "not decided"
    keeps = [value >= limit if at_least else value <= limit for value in (low, high)]
    return "satisfied" if all(keeps) else "not decided" if any(keeps) else "not satisfied"


def together(verdicts: tuple[Verdict, ...]) -> Verdict:
    """The verdict on several criteria together, all of which must be satisfied."""
    if "not satisfied" in verdicts:
        return "not satisfied"
    return "satisfied" if verdicts and set(verdicts) == {"satisfied"} else "not decided"
