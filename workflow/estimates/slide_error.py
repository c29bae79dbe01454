"""Gives the error of the predictions of known slides, for the report.

The table beside this file is written by `python -m docs.known_slides` from the results of the collection of known
slides.
"""

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files
from statistics import median

from dem.settings import SlideMethod

METHOD_SUFFIXES: dict[SlideMethod, str] = {"discs": " by discs", "mpm": " by material points"}
TABLE = "slide_errors.csv"
FACTORS = (1.5, 2.0, 3.0, 5.0, 10.0)
COVERED_SHARE = 2.0 / 3.0  # of the cases that the factor is to hold
LARGEST_ERROR = 3.0  # times: with a larger error an interval of slides spans two orders of magnitude and says nothing
FEWEST_CASES = 3  # cases, below which those of other kinds are counted as well


@dataclass(frozen=True)
class SlideError:
    """Holds the error of a method in predicting known slides.

    Attributes
    ----------
    kind : kind of the slides that were compared, in words
    factor : factor between prediction and measurement that most cases do not exceed
    within, cases : number of cases within the factor, and number of all cases
    middle : factor between prediction and measurement that half of the predictions did not exceed
    method : method of the predictions: "discs" or "mpm"
    """

    kind: str
    factor: float
    within: int
    cases: int
    middle: float
    method: SlideMethod = "discs"

    def sentence(self) -> str:
        """Return the sentence on the error of a slide."""
        named = f"{self.kind[0].upper()}{self.kind[1:]} of the collection"
        return (
            f"{named} were predicted{METHOD_SUFFIXES[self.method]} within a factor of {self.factor:g} in {self.within} "
            f"of {self.cases} cases"
        )

    @property
    def bounds_slides(self) -> bool:
        """Return whether the error is small enough for an interval of slides."""
        return self.factor <= LARGEST_ERROR

    def interval(self, low: float, high: float) -> tuple[float, float]:
        """Return the interval of slides (m) that follows from predictions and the error of the method."""
        return low / self.factor, high * self.factor


def slide_error(flows: bool | None = None, method: SlideMethod = "discs") -> SlideError | None:
    """Return the error in predicting known field slides.

    Only flow failures, or only lateral spreads, are compared if the collection has at least 3 cases of this kind.

    Parameters
    ----------
    flows : whether the slide flows by its weight alone; None if this is not known
    method : method of the predictions

    Returns
    -------
    The error; None if no field case of the collection was computed.
    """
    rows = _rows(method)
    field = [(kind, ratio) for group, kind, ratio in rows if group == "field"]
    if flows is not None:
        wanted = "flow" if flows else "spread"
        chosen = [ratio for kind, ratio in field if kind == wanted]
        if len(chosen) >= FEWEST_CASES:
            return error_of("flow failures" if flows else "lateral spreads", chosen, method)
    return error_of("field slides", [ratio for _, ratio in field], method)


def error_of(kind: str, ratios: Sequence[float], method: SlideMethod = "discs") -> SlideError | None:
    """Return the smallest of `FACTORS` within which two thirds of the ratios lie, or the largest factor if none is
    large enough; None without any ratio.
    """
    if not ratios:
        return None
    off = [max(ratio, 1.0 / ratio) if ratio > 0.0 else float("inf") for ratio in ratios]
    for factor in FACTORS:
        within = sum(distance <= factor for distance in off)
        if within >= COVERED_SHARE * len(off):
            break
    return SlideError(kind, factor, within, len(off), median(off), method)


def _rows(method: SlideMethod) -> list[tuple[str, str, float]]:
    place = files("workflow.estimates") / TABLE
    if not place.is_file():
        return []
    with place.open(encoding="utf-8") as source:
        rows = [row for row in csv.DictReader(source) if row["method"] == method]
    return [(row["group"], row["kind"], float(row["ratio"])) for row in rows]
