"""Decides which answer counts in report, console and pictures if several methods give one."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from dem.settings import SlideMethod
from fem.continuum.loads import Direction, sign_of
from workflow.estimates.comparison import estimates
from workflow.estimates.estimate import Estimate, with_flow_failure
from workflow.estimates.slices import LEFT, RIGHT
from workflow.estimates.slide_error import SlideError, slide_error
from workflow.results.accuracy import Accuracy, accuracy, exceeds, falls_below, proven_by, strict_factor, strict_kh
from workflow.results.bounds import DirectionPart
from workflow.results.cases import CaseAnswer
from workflow.results.continuum import FactorOfSafety, FemAnswer
from workflow.results.faces import FacesAnswer, FaceStrength, FaceValue
from workflow.results.material_points import PointCase
from workflow.results.results import Results

CLOSE_BOUNDS = 0.95  # of the upper bound: a lower one above it gives the critical Kh better than coarse elements


@dataclass(frozen=True)
class GoverningKh:
    """Holds the critical Kh that counts if several methods give one.

    Attributes
    ----------
    value : the critical Kh (-)
    bound : the strict bound that counts, because the finite elements lie beyond it; None if the finite elements count
    is_limit : whether the critical Kh is only an upper or a lower limit, because the ends of its interval are far apart
    interval : interval of the critical Kh by meshes and strict bounds; None if it is not known
    opposite_bounds : strict bounds with the seismic force against the direction of the finite elements, if their upper
        bound is below the critical Kh in that direction, and counts; else None
    """

    value: float
    bound: Literal["lower", "upper"] | None = None
    is_limit: bool = False
    interval: Accuracy | None = None
    opposite_bounds: DirectionPart | None = None

    @property
    def text(self) -> str:
        """Return the critical Kh to three places, with a sign for an upper or lower limit."""
        return f"{self.sign} {self.value:.3f}" if self.is_limit else f"{self.value:.3f}"

    @property
    def sign(self) -> str:
        """Return the relation of the critical Kh to its value: "=", or "≤" or "≥" for a limit."""
        return "=" if not self.is_limit else "≤" if self.bound == "upper" else "≥"


def governing_kh(results: Results) -> GoverningKh | None:
    """Return the critical Kh that counts.

    Parameters
    ----------
    results : results of the run

    Returns
    -------
    The value by finite elements or, if this value lies beyond a strict bound, the bound; None without a critical Kh.
    """
    kc, fem = results.kc, results.fem
    if kc is None or fem is None:
        return None
    interval = accuracy(results, fem)
    ends = strict_kh(results, fem, fem.flow, fem.direction) if interval is None else (interval.low, interval.high)
    low, high = (None, None) if ends is None else ends
    bound = _governing_bound(kc, low, high)
    is_limit = bound is not None and (low is None or high is None or low < CLOSE_BOUNDS * high)
    governing = GoverningKh(governing_value(kc, low, high), bound, is_limit, interval)
    return _against_elements(results, fem, governing.value) or governing


def _against_elements(results: Results, fem: FemAnswer, kc: float) -> GoverningKh | None:
    """Return the upper bound in the other direction than that of the finite elements as the critical Kh, if it is below
    ``kc``: coarse elements took the wrong direction for the one that fails first. None if it is not below."""
    bounds = results.bounds
    if bounds is None or bounds.sides != fem.settings.sides or fem.flow == "non-associated":
        return None
    bracket = bounds if fem.flow == "associated" else bounds.substitute
    first = bracket.directions[0] if bracket is not None and bracket.directions else None
    if first is None or first.direction == fem.direction or first.upper is None or not exceeds(kc, first.upper):
        return None
    low = first.upper if first.lower is None else first.lower
    interval = Accuracy(low, first.upper, proven_by(bounds.strengthened), True)
    is_limit = first.lower is None or first.lower < CLOSE_BOUNDS * first.upper
    return GoverningKh(first.upper, "upper", is_limit, interval, first)


def governing_factor(results: Results, factor: FactorOfSafety) -> float:
    """Return the factor of safety that counts.

    Parameters
    ----------
    results : results of the run, which include the bounds
    factor : factor of safety by finite elements

    Returns
    -------
    The value by finite elements or, if this value lies beyond a strict bound, the bound (-); at most 1 if the strict
    upper bound of Kh limits it, see `is_limited_by_kh`.
    """
    fem = results.fem
    if fem is None:
        return factor.factor
    strict = strict_factor(results, fem, factor, fem.flow)
    lower, upper = (None, None) if strict is None else (strict.lower, strict.upper)
    if is_limited_by_kh(results, factor):
        lower, upper = None, 1.0
    return governing_value(factor.factor, lower, upper)


def is_limited_by_kh(results: Results, factor: FactorOfSafety) -> bool:
    """Return whether a strict upper bound of Kh below 0 proves that a factor of safety is at most 1.

    A factor without shaking is that between sides held horizontally. Its own lower bound above 1 and a mechanism that
    moves free-field sides do not contradict each other: between held sides the ground stands.

    Parameters
    ----------
    results : results of the run, which include the bounds
    factor : factor of safety by finite elements

    Returns
    -------
    True for the factor at rest of the ground that has this Kh, if its own strict bounds are neither a lower one above 1
    nor an upper one of at most 1, and the mechanism is also one between sides held horizontally.
    """
    fem, bounds = results.fem, results.bounds
    if fem is None or bounds is None or not results.fails_at_rest or factor != fem.at_rest:
        return False
    strict = strict_factor(results, fem, factor, fem.flow)
    lower, upper = (None, None) if strict is None else (strict.lower, strict.upper)
    if (lower is not None and lower > 1.0) or (upper is not None and upper <= 1.0):
        return False
    return bounds.fails_with_smooth_sides


def stands_with_smooth_sides(results: Results, factor: FactorOfSafety) -> bool:
    """Return whether ground that fails without a seismic force at free-field sides stands between smooth sides.

    Parameters
    ----------
    results : results of the run, which include the bounds
    factor : factor of safety by finite elements, between sides held horizontally

    Returns
    -------
    True if a strict bound proves the failure, and this factor is the one at rest and counts above 1.
    """
    at_rest = results.fem is not None and factor == results.fem.at_rest
    return results.fails_at_rest and at_rest and governing_factor(results, factor) > 1.0


def governing_value(value: float, lower: float | None, upper: float | None) -> float:
    """Return the critical Kh or factor of safety that counts: of finite elements, or the strict bound it lies beyond.

    A mechanism proves that the ground does not resist more than the upper bound, a stress field in equilibrium that it
    does not resist less than the lower one; finite elements prove neither.

    Parameters
    ----------
    value : critical Kh or factor of safety by finite elements (-)
    lower, upper : its strict bounds (-); None for a missing one

    Returns
    -------
    The value, or the bound (-).
    """
    ends = {None: value, "lower": lower, "upper": upper}
    end = ends[_governing_bound(value, lower, upper)]
    return value if end is None else end


def _governing_bound(value: float, lower: float | None, upper: float | None) -> Literal["lower", "upper"] | None:
    """Return the strict bound that the ``value`` of the finite elements lies beyond; None if there is none."""
    if upper is not None and exceeds(value, upper):
        return "upper"
    return "lower" if lower is not None and falls_below(value, lower) else None


def governing_face_value(value: FaceValue) -> float:
    """Return the critical Kh or factor of safety of a face that counts.

    Parameters
    ----------
    value : critical Kh or factor of safety of the face by finite elements, with its strict bounds

    Returns
    -------
    The value with ψ = φ by finite elements, or the strict bound that it lies beyond (-).
    """
    return governing_value(value.value, value.lower, value.upper)


def value_of_face(elements: FaceValue | None, circle: float | None) -> tuple[float | None, bool]:
    """Return the critical Kh or factor of safety of a face, and whether it is by finite elements.

    Parameters
    ----------
    elements : value of the face by finite elements; None without one
    circle : value of the slip circle with which a part of the crest slides (-); None without one

    Returns
    -------
    The value of the finite elements that counts (-) or, where no part of the crest slides in their failure, that of the
    circle; and whether it is by finite elements.
    """
    if elements is not None and elements.reaches_crest:
        return governing_face_value(elements), True
    return circle, False


def estimates_of(results: Results) -> list[Estimate]:
    """Return all estimates of displacement by simple methods, with the critical Kh that counts.

    Parameters
    ----------
    results : results of the run

    Returns
    -------
    The estimates; those of lateral spreads do not apply if liquefied ground flows without shaking.
    """
    cases = results.liquefied.cases if results.liquefied is not None else ()
    factors = [case.factor for case in cases if case.verdict == "flows" and case.factor is not None]
    governing, config = governing_kh(results), results.config
    kc = None if governing is None else governing.value
    return with_flow_failure(estimates(config.section, config, kc, results.slip_surface), factors)


def faces_with_bounds(results: Results) -> FacesAnswer | None:
    """Return the faces of structures with the strict bounds of each value.

    Parameters
    ----------
    results : results of the run, which include the bounds

    Returns
    -------
    The faces; a face that fails first, without strong zones, has the bounds of the section, where there are any. None
    if the faces were not computed.
    """
    if results.faces is None:
        return None
    bounded = tuple(_with_bounds(results, face) for face in results.faces.faces)
    return results.faces.model_copy(update={"faces": bounded})


def _with_bounds(results: Results, face: FaceStrength) -> FaceStrength:
    ends = {"critical": section_kh_bounds(results, face.towards), "safety": section_factor_bounds(results)}
    bounded = {
        quantity: value.model_copy(
            update={
                "lower": value.lower if lower is None else lower,
                "upper": value.upper if upper is None else upper,
            }
        )
        for quantity, (lower, upper) in ends.items()
        if (value := getattr(face, quantity)) is not None and not value.strong_zones
    }
    return face.model_copy(update=bounded)


def section_kh_bounds(results: Results, towards: Literal["left", "right"]) -> tuple[float | None, float | None]:
    """Return the strict bounds of the critical Kh of the section with the seismic force to one side.

    Parameters
    ----------
    results : results of the run, which include the bounds
    towards : side of the section towards which the seismic force acts

    Returns
    -------
    Lower and upper bound with ψ = φ (-), None for a missing one.
    """
    bounds = results.bounds
    if bounds is None:
        return None, None
    is_downhill = sign_of(results.config.section, "downhill") == (LEFT if towards == "left" else RIGHT)
    direction: Direction = "downhill" if is_downhill else "uphill"
    part = bounds.towards(direction) or (bounds if bounds.direction == direction else None)
    return (None, None) if part is None else (part.lower, part.upper)


def section_factor_bounds(results: Results) -> tuple[float | None, float | None]:
    """Return the strict bounds of the factor of safety of the section without shaking.

    Parameters
    ----------
    results : results of the run, which include the bounds

    Returns
    -------
    Lower and upper bound with ψ = φ (-), None for a missing one.
    """
    fem = results.fem
    factor = next((row for row in fem.safety_factors if row.kh == 0.0), None) if fem is not None else None
    if fem is not None and factor is not None:
        strict = strict_factor(results, fem, factor, "associated")
    else:
        parts = results.bounds.safety if results.bounds is not None else ()
        strict = next((part for part in parts if part.kh == 0.0), None)
    return (None, None) if strict is None else (strict.lower, strict.upper)


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
    """Return the slides by every method that computed any.

    Parameters
    ----------
    results : results of the run

    Returns
    -------
    The slides by discs and by material points, in the order of ``by_weight``; empty without any slide.
    """
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
    """Return the methods in the order of their weight: first the one whose predictions were nearer to known slides.

    Parameters
    ----------
    errors : errors of the methods on known slides; None for an unknown one

    Returns
    -------
    The methods by the factor that half of their predictions did not exceed, then those without an error, discs first.
    """
    known = [error for error in errors if error is not None]
    methods = [error.method for error in sorted(known, key=lambda error: error.middle)]
    every: tuple[SlideMethod, ...] = ("discs", "mpm")
    return [*methods, *(method for method in every if method not in methods)]
