"""Gives the numerical error of the critical Kh, by the sequence of meshes and by strict bounds."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import assert_never

from fem.continuum.loads import Direction
from fem.continuum.strength import Flow
from workflow.results.bounds import SafetyPart
from workflow.results.continuum import FactorOfSafety, FemAnswer
from workflow.results.results import Results

# Two meshes whose answers differ by a larger share cannot show that the sequence converges.
COARSE_ERROR = 0.1
# Error of a sequence that has not converged, over the change between its last meshes.
WIDENING = 2.0
# A critical Kh or a factor of safety lies above an upper bound, or below a lower one, if it does so by half of the last
# digit reported, and by this share of the bound.
LAST_DIGIT, LAST_SHARE = 0.0005, 0.0005
# What an interval can follow from.
METHODS = (
    "by the sequence of meshes", "by strict bounds", "by strict bounds (shallow failures excluded)",
    "by strict bounds and the sequence of meshes",
    "by strict bounds (shallow failures excluded) and the sequence of meshes",
)  # fmt: skip


@dataclass(frozen=True)
class Accuracy:
    """Holds the interval of the critical Kh, for fixed assumptions, by numerical error.

    Attributes
    ----------
    low, high : ends of the interval (-)
    source : source of the interval
    reliable : whether the sequence of meshes has converged, or strict bounds limit the interval
    strict : the strict bounds alone, where the sequence of meshes makes the interval narrower; else None
    """

    low: float
    high: float
    source: str
    reliable: bool
    strict: tuple[float, float] | None = None

    @property
    def method(self) -> str:
        """Return the method of the interval, in few words."""
        return self.source.partition(",")[0]

    def error(self, kc: float) -> float:
        """Return the possible error of ``kc`` (-)."""
        return max(abs(kc - self.low), abs(kc - self.high))


def accuracy(results: Results, fem: FemAnswer) -> Accuracy | None:
    """Return the interval of the critical Kh by the sequence of meshes and by strict bounds.

    Parameters
    ----------
    results : results of the run, which include the bounds
    fem : critical Kh by finite elements

    Returns
    -------
    The interval (-): that of the meshes within the bounds; that of the bounds alone if the sequence has not converged
    or lies beyond them. None if there is only one mesh and a bound of its flow rule is missing, or if the only bound
    contradicts the meshes.
    """
    meshes, strict = of_meshes(fem, _halved(results)), strict_kh(results, fem, fem.flow, fem.direction)
    if strict is None:
        return meshes
    low, high = strict
    if low is None or high is None:
        return _limited(meshes, low, high)
    bounds = proven_by(results.bounds is not None and results.bounds.strengthened)
    if meshes is None or not meshes.reliable or meshes.low > high or meshes.high < low:
        return Accuracy(low, high, bounds, True)
    ends = max(low, meshes.low), min(high, meshes.high)
    return Accuracy(*ends, f"{bounds} and {meshes.method[3:]}", True, None if ends == strict else (low, high))


def _limited(meshes: Accuracy | None, low: float | None, high: float | None) -> Accuracy | None:
    """Return the interval by ``meshes`` that one strict bound, ``low`` or ``high``, cuts off; None if it is empty."""
    least, most = -math.inf if low is None else low, math.inf if high is None else high
    if meshes is None or exceeds(meshes.low, most) or falls_below(meshes.high, least):
        return None
    return replace(meshes, low=min(max(least, meshes.low), most), high=max(min(most, meshes.high), least))


def exceeds(value: float, upper: float) -> bool:
    """Return whether a critical Kh or a factor of safety lies above an upper bound by more than rounding.

    Parameters
    ----------
    value : critical Kh or factor of safety (-)
    upper : its strict upper bound (-)

    Returns
    -------
    True above the bound by more than ``LAST_DIGIT`` and more than the share ``LAST_SHARE`` of the bound.
    """
    return value > upper + max(LAST_DIGIT, LAST_SHARE * abs(upper))


def falls_below(value: float, lower: float) -> bool:
    """Return whether a critical Kh or a factor of safety lies below a lower bound by more than rounding.

    Parameters
    ----------
    value : critical Kh or factor of safety (-)
    lower : its strict lower bound (-)

    Returns
    -------
    True below the bound by more than ``LAST_DIGIT`` and more than the share ``LAST_SHARE`` of the bound.
    """
    return value < lower - max(LAST_DIGIT, LAST_SHARE * abs(lower))


def strict_factor(results: Results, fem: FemAnswer, factor: FactorOfSafety, flow: Flow) -> SafetyPart | None:
    """Return the strict bounds of a factor of safety, for the same Kh, sides and flow rule.

    A lower bound of ground with strengthened faces does not count for finite elements without: shallow ground may fail
    before.

    Parameters
    ----------
    results : results of the run, which include the bounds
    fem : finite elements, whose sides count
    factor : factor of safety by these elements
    flow : flow rule of the factor; there are bounds of factors of safety with ψ = φ only

    Returns
    -------
    The bounds, either of which may be None; None without any bound.
    """
    bounds = results.bounds
    if bounds is None or bounds.sides != fem.settings.sides or flow != "associated":
        return None
    place = (factor.kh, factor.after_shaking)
    part = next((part for part in bounds.factors if (part.kh, part.after_shaking) == place), None)
    if part is None or (part.lower is None and part.upper is None):
        return None
    other_ground = part.shallow_failure is not None and factor.shallow_failure is None
    below = part.lower is not None and falls_below(factor.factor, part.lower)
    return part.model_copy(update={"lower": None}) if other_ground and below else part


def remaining_error(factor: FactorOfSafety, strict: SafetyPart | None) -> float | None:
    """Return the share by which a factor of safety may still be too large.

    Parameters
    ----------
    factor : factor of safety by finite elements
    strict : its strict bounds, see ``strict_factor``; None without any

    Returns
    -------
    The remaining error of the sequence of meshes, and no more than the strict lower bound leaves, as a share of the
    factor (-); None if neither is known.
    """
    if strict is None or strict.lower is None:
        return factor.remaining_error
    left = max(0.0, 1.0 - strict.lower / factor.factor)
    return left if factor.remaining_error is None else min(left, factor.remaining_error)


def proven_by(strengthened: bool) -> str:
    """Return the name of the bounds that limit an interval.

    Parameters
    ----------
    strengthened : whether the bounds are of ground with a cohesion at its bare faces, so that shallow failures do not
        count

    Returns
    -------
    The beginning of one of the ``METHODS``.
    """
    return "by strict bounds (shallow failures excluded)" if strengthened else "by strict bounds"


def of_meshes(fem: FemAnswer, halved: float | None = None) -> Accuracy | None:
    """Return the interval of the critical Kh by the sequence of meshes, wider if the sequence has not converged.

    Parameters
    ----------
    fem : critical Kh by finite elements, with the answers on all meshes
    halved : critical Kh on cells of half the size (-), if it was computed after a single mesh: the error is
        proportional to one over the number of cells, so that a third of the difference remains (Richardson 1911)

    Returns
    -------
    The interval (-); None for a single mesh without ``halved``.
    """
    values = [mesh.kc for mesh in fem.meshes]
    if len(values) >= 2 and fem.kc_limit is not None:
        limit = fem.kc_limit
    elif halved is not None:
        values, limit = [fem.kc, halved], halved - (fem.kc - halved) / 3.0
    else:
        return None
    ends = [fem.kc, fem.kc_upper, values[-1], limit]
    if _converges(values):
        return Accuracy(min(ends), max(ends), f"by the sequence of meshes, which tends to {limit:.3f}", True)
    left = WIDENING * max(abs(values[-1] - limit), abs(values[-1] - values[-2]))
    low, high = max(0.0, min(*ends, values[-1] - left)), max(ends)
    return Accuracy(low, high + (left if values[-1] > values[-2] else 0.0), "by the sequence of meshes", False)


def _converges(values: Sequence[float]) -> bool:
    """Return whether answers on ever finer meshes fall by ever smaller amounts. If there are two answers, they must be
    close."""
    last = values[-2] - values[-1]
    if last < 0.0:
        return False
    if len(values) == 2:
        return last <= COARSE_ERROR * abs(values[-1])
    return last <= abs(values[-3] - values[-2])


def _halved(results: Results) -> float | None:
    """Return the critical Kh on cells of half the size, if it was computed."""
    variants = results.variants.variants if results.variants is not None else ()
    return next((variant.kc for variant in variants if variant.name == "mesh" and variant.kc_without is None), None)


def strict_kh(
    results: Results, fem: FemAnswer, flow: Flow, direction: Direction
) -> tuple[float | None, float | None] | None:
    """Return the strict lower and upper bound of a critical Kh.

    An upper bound with ψ = φ holds for every ψ ≤ φ (Radenkovic 1961).

    Parameters
    ----------
    results : results of the run, which include the bounds
    fem : finite elements; bounds count for the same sides only
    flow : flow rule of the critical Kh
    direction : direction of the seismic force

    Returns
    -------
    Lower and upper bound (-), None for a missing one; None without any bound.
    """
    bounds = results.bounds
    if bounds is None or bounds.sides != fem.settings.sides:
        return None
    full = bounds.towards(direction)
    match flow:
        case "associated":
            bracket = full
        case "davis":
            bracket = bounds.substitute.towards(direction) if bounds.substitute is not None else None
        case "non-associated":
            bracket = None
        case _:
            assert_never(flow)
    uppers = [part.upper for part in (bracket, full) if part is not None and part.upper is not None]
    lower, upper = None if bracket is None else bracket.lower, min(uppers, default=None)
    return None if lower is None and upper is None else (lower, upper)
