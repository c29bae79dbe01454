"""Calibrates discs: finds the factor on their constants with which their critical Kh is equal to that of the FEM.

For soil discs one factor multiplies the strength, as in strength reduction: friction and cohesion, but not rolling
friction and stiffness. The uncalibrated critical Kh of soil discs is a prediction.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from dem.search.calibrator import PARAMETERS, Calibrator, middle
from dem.search.critical import Search
from dem.search.pushover import Continuum
from dem.settings import DemSettings

SINGLE_PARAMETERS = PARAMETERS[:3]
SENSITIVITIES = (0.5, 2.0)
CONCURRENT_FACTORS = 2  # constant, so that the search does not depend on the number of workers
NARROWINGS = 12  # searches at most once the target is bracketed
# Ratio of two factors at which the search ends: the change of Kh is then small, and jumps of Kh are random.
NARROWEST_BRACKET = 1.01
SMALLEST_STEP = 0.1  # distance of a new factor from the ends of the bracket, over its length

CalibrationVerdict = Literal["calibrated", "out of reach"]


@dataclass(frozen=True)
class Calibration:
    """Holds the result of a calibration: the factor that reaches the target, or the closest one.

    Attributes
    ----------
    target : required critical Kh: the nearest value within the bracket of the continuum
    tolerance : allowed difference to the target
    parameter : name of the constants that the factor multiplies
    value : the factor
    range : least and largest factor allowed
    verdict : "calibrated" or "out of reach"
    reason : reason of the verdict, in words
    search : the critical Kh with that factor
    sensitivity (parameter, factor, Search) : the critical Kh with each parameter halved and doubled; the name "" marks
        the search for uncalibrated discs
    trials (factor, Search) : every factor that was tried on the parameter, sorted by size, since the order of trials
        depends on which of several searches ends first
    """

    target: float
    tolerance: float
    parameter: str
    value: float
    range: tuple[float, float]
    verdict: CalibrationVerdict
    reason: str
    search: Search
    sensitivity: tuple[tuple[str, float, Search], ...]
    trials: tuple[tuple[float, Search], ...]


def sensitivities(calibrator: Calibrator) -> list[tuple[str, float, Search]]:
    """Return the critical Kh with each parameter halved and doubled, one at a time."""
    wanted = [("", 1.0), *((p, f) for p in SINGLE_PARAMETERS for f in SENSITIVITIES)]
    searches = calibrator.search_all(wanted, fine=False)
    return [(p, f, search) for (p, f), search in zip(wanted, searches, strict=True)]


def choose(calibrator: Calibrator, table: Sequence[tuple[str, float, Search]], target: float) -> str:
    """Return the parameter with the largest influence among those that reach the target with half or twice their value.

    If none reaches the target, the ends of the ranges are tried; then the parameter that comes closest is chosen.
    """
    base = middle(next(s for p, _, s in table if not p))
    weaker = target < base
    reached = {p: [middle(s) for q, _, s in table if q == p] for p in SINGLE_PARAMETERS}

    def able() -> list[str]:
        return [p for p in reached if any((kc - target) * (base - target) <= 0.0 for kc in reached[p])]

    if not able():
        low, high = calibrator.settings.factors
        ends = calibrator.search_all([(p, low if weaker else high) for p in SINGLE_PARAMETERS])
        for p, search in zip(SINGLE_PARAMETERS, ends, strict=True):
            reached[p].append(middle(search))
    if not able():
        return min(SINGLE_PARAMETERS, key=lambda p: min(abs(kc - target) for kc in reached[p]))
    moved = {p: abs(middle(s) - base) for p, f, s in table if p and (f < 1.0) == weaker}
    return max(able(), key=lambda p: moved[p])


def best(
    calibrator: Calibrator, target: float, parameter: str, table: Sequence[tuple[str, float, Search]]
) -> Calibration:
    """Calibrate one parameter; for "auto" the parameter is taken from `choose`, or is "all" if the critical Kh
    jumps past the target.

    calibrator: calibrator of the discs; target: critical Kh to reach; parameter: name of the parameter; table: searches
    that were done (name, factor, result).
    """
    if parameter == "auto" and calibrator.settings.model == "soil":
        parameter = "strength"
    if parameter != "auto":
        return calibrate(calibrator, target, parameter, table)
    calibration = calibrate(calibrator, target, choose(calibrator, table, target), table)
    if calibration.verdict == "calibrated":
        return calibration
    other = calibrate(calibrator, target, "all", table)
    return min(calibration, other, key=lambda c: (c.verdict != "calibrated", abs(middle(c.search) - target)))


def calibrated(calibrator: Calibrator, continuum: Continuum, one_at_a_time: bool, first: float = 1.0) -> Calibration:
    """Find the factor with which the discs reach the nearest critical Kh within the bracket of the continuum.

    Parameters
    ----------
    calibrator : searches the critical Kh at a factor
    continuum : critical Kh of the finite elements
    one_at_a_time : whether all sensitivities are computed before the calibration
    first : factor that is tried first, such as the factor of another packing

    Returns
    -------
    The factor, its search and all trials. If the first search has no bracket, the target is `Continuum.kc`.
    """
    table = sensitivities(calibrator) if one_at_a_time else []
    base = calibrator.search(calibrator.settings.parameter.replace("auto", "strength"), first)
    target = continuum.kc if base.kc is None else continuum.nearest(middle(base))
    return best(calibrator, target, calibrator.settings.parameter, table or ([("", 1.0, base)] if first == 1.0 else []))


def calibrate(
    calibrator: Calibrator, target: float, parameter: str, table: Sequence[tuple[str, float, Search]]
) -> Calibration:
    """Find the factor at which the critical Kh of the discs is within the tolerance of a target.

    The factor is bracketed by known searches, then from 1 towards the ends of the range; then the bracket is narrowed.

    Parameters
    ----------
    calibrator : Calibrator
        Searches for the critical Kh at a factor, and stores the results.
    target : float
        Critical Kh of the continuum (-).
    parameter : str
        Name of the constants that the factor multiplies, such as "strength".
    table : sequence of (parameter, factor, Search)
        Sensitivities, which are copied into the result.

    Returns
    -------
    Calibration
        The result; its verdict is "calibrated" only if the search with this factor ended in a bracket.
    """
    settings = calibrator.settings
    low, high = settings.factors
    tried = {f: s for (p, f), s in calibrator.searches.items() if p in ("", parameter) and low <= f <= high}

    def met() -> bool:
        return any(_meets_target(search, target, settings.tolerance) for search in tried.values())

    first = 1.0 if 1.0 in tried else min(tried, default=1.0)
    for outwards in _expanding_factors(first, tried.get(first), target, settings):
        if met() or _bracket(tried, target) is not None:
            break
        tried |= zip(outwards, calibrator.search_all([(parameter, f) for f in outwards]), strict=True)
    for _ in range(NARROWINGS):
        ends = _bracket(tried, target)
        if met() or ends is None or ends[1] / ends[0] < NARROWEST_BRACKET:
            break
        factor = _interpolated_factor(tried, target, *ends)
        tried[factor] = calibrator.search(parameter, factor)
    tried = dict(sorted(tried.items(), key=lambda pair: pair[0]))
    value = min(tried, key=lambda f: (tried[f].verdict != "bracketed", abs(middle(tried[f]) - target)))
    verdict: CalibrationVerdict = (
        "calibrated" if _meets_target(tried[value], target, settings.tolerance) else "out of reach"
    )
    reason = f"critical Kh {middle(tried[value]):.3f} for a target of {target:.3f}"
    if verdict != "calibrated":
        reason = _out_of_reach(settings, parameter, tried, value, target)
    return Calibration(
        target, settings.tolerance, parameter, value, (low, high), verdict, reason, tried[value], tuple(table),
        tuple(tried.items()),
    )  # fmt: skip


def _interpolated_factor(tried: dict[float, Search], target: float, low: float, high: float) -> float:
    """Return the factor of the next trial: linear interpolation of Kh in the logarithm of the factor, not too near to
    either trial.
    """
    below, above = middle(tried[low]) - target, middle(tried[high]) - target
    share = float(np.clip(below / (below - above), SMALLEST_STEP, 1.0 - SMALLEST_STEP))
    return float(low * (high / low) ** share)


def _out_of_reach(
    settings: DemSettings, parameter: str, tried: dict[float, Search], value: float, target: float
) -> str:
    """Return why no factor reaches the target, in words."""
    reach = [middle(search) for search in tried.values()]
    message = (
        f"with {parameter} times {min(tried):.3g} to {max(tried):.3g} the discs fail at Kh = {min(reach):.3f} to "
        f"{max(reach):.3f}, not at {target:.3f}; the nearest is {middle(tried[value]):.3f} at {value:.3g}"
    )
    return f"calibration failed: {message}" if settings.model == "soil" else message


def _expanding_factors(
    first: float, base: Search | None, target: float, settings: DemSettings
) -> Iterator[list[float]]:
    """Yield the factors of the trials, from the ``first`` with its search towards the end that the target requires.

    The factors are halves, quarters, ... or doubles, two at a time for any number of workers. For soil discs, whose
    range is short, the first factor is the target over the uncalibrated critical Kh.
    """
    low, high = settings.factors
    weaker = base is None or middle(base) > target
    end = low if weaker else high
    if settings.model == "soil":
        ratio = first * target / middle(base) if base is not None and middle(base) > 0.0 else end
        steps = [ratio] if low < ratio < high else []
        count = 1
    else:
        steps = [f for f in ((0.5 if weaker else 2.0) ** k for k in range(1, 40)) if low < f < high]
        count = CONCURRENT_FACTORS
    steps.append(end)
    for start in range(0, len(steps), count):
        yield steps[start : start + count]


def _meets_target(search: Search, target: float, tolerance: float) -> bool:
    return search.verdict == "bracketed" and abs(middle(search) - target) <= tolerance


def _bracket(tried: dict[float, Search], target: float) -> tuple[float, float] | None:
    """Return the narrowest pair of neighbouring factors with the target between their critical Kh."""
    factors = sorted(tried)
    pairs = [(a, b) for a, b in pairwise(factors) if (middle(tried[a]) - target) * (middle(tried[b]) - target) < 0.0]
    return min(pairs, key=lambda p: p[1] / p[0]) if pairs else None
