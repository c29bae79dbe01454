"""Decides which answer counts in report, console and pictures if several methods give one."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from dem.settings import SlideMethod
from workflow.estimates.slide_error import SlideError, slide_error
from workflow.results.accuracy import Accuracy, accuracy, exceeds, strict_factor
from workflow.results.cases import CaseAnswer
from workflow.results.continuum import FactorOfSafety
from workflow.results.material_points import PointCase
from workflow.results.results import Results

CLOSE_BOUNDS = 0.95  # of the upper bound: a lower one above it gives the critical Kh better than coarse elements


@dataclass(frozen=True)
class GoverningKh:
    """Holds the critical Kh that counts if several methods give one.

    Attributes
    ----------
    value : the critical Kh (-)
    by_elements : whether the critical Kh is the value by finite elements. Otherwise it is the upper end of its
        interval, which the finite elements exceed.
    is_limit : whether the critical Kh is only an upper limit, because the ends of its interval are far apart
    interval : interval of the critical Kh by meshes and strict bounds; None if it is not known
    """

    value: float
    by_elements: bool = True
    is_limit: bool = False
    interval: Accuracy | None = None

    @property
    def text(self) -> str:
        """Return the critical Kh to three places, with a sign for an upper limit."""
        return f"{'≤ ' if self.is_limit else ''}{self.value:.3f}"


def governing_kh(results: Results) -> GoverningKh | None:
    """Return the critical Kh that counts: the value by finite elements or, if this value exceeds the upper bound, the
    bound. Return None without any value.
    """
    kc, fem = results.kc, results.fem
    if kc is None or fem is None:
        return None
    interval = accuracy(results, fem)
    if interval is None or not exceeds(kc, interval.high):
        return GoverningKh(kc, interval=interval)
    return GoverningKh(interval.high, False, interval.low < CLOSE_BOUNDS * interval.high, interval)


def governing_factor(results: Results, factor: FactorOfSafety) -> float:
    """Return the factor of safety that counts: the value by finite elements or, if this value exceeds the strict upper
    bound, the bound."""
    fem = results.fem
    strict = strict_factor(results, fem, factor, fem.flow) if fem is not None else None
    return governing_value(factor.factor, None if strict is None else strict.upper)


def governing_value(value: float, upper: float | None) -> float:
    """Return the critical Kh or factor of safety that counts: the ``value`` of the finite elements, or its strict upper
    bound, if there is one and the finite elements exceed it."""
    return value if upper is None or not exceeds(value, upper) else upper


@dataclass(frozen=True)
class MethodSlides:
    """Holds the slides after liquefaction by one method.

    Attributes
    ----------
    method : "discs" or "mpm", the material points
    cases : the cases by number
    ends : smallest and largest of the largest slides (m), over the cases and over all packings of discs
        or the numerical interval of material points
    error : error of the method on known slides of this kind; None without any known slide
    """

    method: SlideMethod
    cases: Mapping[int, CaseAnswer | PointCase]
    ends: tuple[float, float]
    error: SlideError | None

    @property
    def largest(self) -> tuple[float, ...]:
        """Return the largest slide (m) of each case, at least 0."""
        return tuple(max(case.slide_max_m, 0.0) for case in self.cases.values())

    @property
    def interval(self) -> tuple[float, float] | None:
        """Return the largest slide (m) with the error on known slides; None if the error is not known, or nothing
        slides."""
        return None if self.error is None or self.ends[1] <= 0.0 else self.error.interval(*self.ends)

    @property
    def of_largest(self) -> tuple[int, CaseAnswer | PointCase]:
        """Return number and answer of the case with the largest slide."""
        number = max(self.cases, key=lambda case: self.cases[case].slide_max_m)
        return number, self.cases[number]


def slides_by_weight(results: Results) -> tuple[MethodSlides, ...]:
    """Return the slides by every method that computed any, first the method whose predictions were nearer to known
    slides."""
    discs = results.case_set()[1]
    points = dict(results.mpm.cases) if results.mpm is not None else {}
    flowing = {case.flows for case in discs.values()}
    flows = flowing.pop() if len(flowing) == 1 else None
    random = results.cases.random if results.cases is not None else None
    of_discs = [case.slide_max_m for case in discs.values()]
    for case in random.cases.values() if random is not None else ():
        of_discs += case.slide_max_m.values
    of_points = [end for case in points.values() for end in (case.slide_max_low_m, case.slide_max_high_m)]
    each: dict[SlideMethod, tuple[Mapping[int, CaseAnswer | PointCase], list[float]]] = {
        "discs": (discs, of_discs),
        "mpm": (points, of_points),
    }
    return tuple(
        MethodSlides(method, cases, (max(min(ends), 0.0), max(*ends, 0.0)), slide_error(flows, method))
        for method in by_weight([slide_error(flows, method) for method in each])
        for cases, ends in (each[method],)
        if cases
    )


def by_weight(errors: Sequence[SlideError | None]) -> list[SlideMethod]:
    """Return the methods, first the one with the smaller error on half of the known slides; discs first if no error is
    known."""
    known = [error for error in errors if error is not None]
    methods = [error.method for error in sorted(known, key=lambda error: error.middle)]
    every: tuple[SlideMethod, ...] = ("discs", "mpm")
    return [*methods, *(method for method in every if method not in methods)]
