"""Contradictions within the results of the discs, each with what to do."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations

import numpy as np

from dem.case import Case
from workflow.report.numbers import coefficient, metre_range, of_cases
from workflow.results.cases import CaseAnswer, RandomPackings
from workflow.results.discs import DiscsAnswer, DiscSearch
from workflow.results.results import Results
from workflow.results.verdicts import Weight

# A case that leaves less strength and slides less by so much (m), and by such a share, contradicts the other.
LESS, LESS_SHARE = 0.1, 0.03
# A surface that falls by so much (m), and so many times the mean of its uphill third, is not told by that mean.
FALLS, FALLS_TIMES = 0.5, 3.0
# Discs that lose such a share of their critical Kh on the way to it do not bear it where it is held.
FALLEN = 0.25
NEAR_KC = 0.95  # of the critical Kh, at which a push has come to it


def contradictions(results: Results) -> Iterator[tuple[Weight, str]]:
    """Contradictions of the results with a weight each: load curves of discs, sides of the box, order of cases,
    settlements.
    """
    _, cases = results.case_set()
    if results.dem is not None and results.no_answer("calibrate") is None:
        yield from ((1, text) for text in of_curve(results.dem))
    yield from ((2, text) for text in of_sides(cases))
    strata = [stratum.name for stratum in results.config.section.strata if stratum.liquefies_in]
    random = results.cases.random if results.cases is not None else None
    config = {number: results.config.cases[number - 1] for number in cases if number <= len(results.config.cases)}
    yield from ((1, text) for text in of_order(config, _largest_slides(cases, random), strata))
    yield from ((2, text) for text in of_settlement(cases))


def of_curve(discs: DiscsAnswer) -> Iterator[str]:
    """Warn where the load-displacement curve of the discs falls far below the critical Kh before it reaches it."""
    fall = deepest_fall(discs.after, soil=discs.model.discs == "soil")
    if discs.after.kc is not None and fall is not None and fall[0] - fall[1] > FALLEN * discs.after.kc:
        yield (
            f"the Kh of the discs falls from {coefficient(fall[0])} to {coefficient(fall[1])} before it reaches the "
            f"critical {coefficient(discs.after.kc)}: under a constant Kh the discs would fail at "
            f"{coefficient(fall[0])}; take this Kh until more discs (dem.elements) or another packing (dem.seed) are "
            "computed"
        )


def deepest_fall(search: DiscSearch, soil: bool) -> tuple[float, float] | None:
    """The largest drop of Kh in a pushover before its critical Kh: from which and to which Kh; None without a drop.

    Parameters
    ----------
    search : DiscSearch
        The search; of ``soil`` discs all trials are points of one push, of others the states that stood are.
    soil : bool
        Whether the discs are soil discs.

    Returns
    -------
    tuple of float or None
        Kh before and after the fall (-).
    """
    points = [(t.displacement_m, t.kh) for t in search.trials] if soil else [(u, kh) for kh, u in search.curve]
    kh = np.array([kh for _, kh in sorted(points)])
    if search.kc is None or not (kh >= NEAR_KC * search.kc).any():
        return None
    kh = kh[: int(np.flatnonzero(kh >= NEAR_KC * search.kc)[-1]) + 1]
    before = np.maximum.accumulate(kh)
    at = int(np.argmax(before - kh))
    return (float(before[at]), float(kh[at])) if before[at] > kh[at] else None


def of_sides(cases: Mapping[int, CaseAnswer]) -> Iterator[str]:
    """Slides that a side of the disc model stopped."""
    for side in ("left", "right"):
        held = [number for number, case in cases.items() if case.stopped_by == side]
        if held:
            lengths = metre_range([cases[number].slide_max_m for number in held])
            yield (
                f"the {side} side of the disc model stopped {of_cases(held)}: {lengths} is "
                f"the least that the ground slides; take a longer section (beyond)"
            )


def of_order(cases: Mapping[int, Case], slides: Mapping[int, float], strata: Sequence[str]) -> Iterator[str]:
    """Cases with less strength and no more stiffness of the ``strata`` than others, but shorter slides (m)."""
    for number, other in combinations(sorted(set(cases) & set(slides)), 2):
        for weak, strong in ((number, other), (other, number)):
            short = slides[strong] - slides[weak]
            if is_weaker(cases[weak], cases[strong], strata) and short > max(LESS, LESS_SHARE * slides[strong]):
                yield (
                    f"case {weak}{_named(cases[weak])} leaves less strength than case {strong}{_named(cases[strong])} "
                    f"and slides less, {slides[weak]:.3g} m and {slides[strong]:.3g} m: what stops them, or how the "
                    "discs happen to lie, decides, and not their strength; take a longer section (beyond) if a side "
                    "stops them, more packings (slide.seeds) if not, and the longer slide until then"
                )


def is_weaker(case: Case, other: Case, strata: Sequence[str]) -> bool:
    """Whether a case leaves the ``strata`` less stiffness or strength than another, and no more of either."""
    pairs = [(getattr(case, name), getattr(other, name)) for name in ("stiffness", "friction", "cohesion")]
    for stratum in strata:
        ratios = case.residual_of(stratum), other.residual_of(stratum)
        strengths = case.strength_of(stratum), other.strength_of(stratum)
        if any(ratios) and any(strengths):  # a ratio and a strength cannot be compared
            return False
        pairs += [ratios, strengths]
    return all(value <= other for value, other in pairs) and any(value < other for value, other in pairs)


def of_settlement(cases: Mapping[int, CaseAnswer]) -> Iterator[str]:
    """Surfaces that fall much further somewhere than on average over a third of the section."""
    largest = {number: case.largest_fall for number, case in cases.items()}
    far = {
        number: fall
        for number, fall in largest.items()
        if fall[0] > max(FALLS, FALLS_TIMES * abs(cases[number].settlement_uphill_m))
    }
    if far:
        falls, places = zip(*far.values(), strict=True)
        yield (
            f"the surface falls by {metre_range(falls)} at x = {_ends(places)} m in {of_cases(list(far))}, far more "
            "than the mean settlements of the thirds of the section: use this value for the settlement of a crest"
        )


def _ends(places: Sequence[float]) -> str:
    low, high = f"{min(places):.0f}", f"{max(places):.0f}"
    return low if low == high else f"{low} to {high}"


def _largest_slides(cases: Mapping[int, CaseAnswer], random: RandomPackings | None) -> dict[int, float]:
    """The largest slide (m) of each case: its mean over random packings where there are several."""
    slides = {number: case.slide_max_m for number, case in cases.items()}
    for number, case in (random.cases if random is not None else {}).items():
        if number in slides and len(case.slide_max_m.values) > 1 and case.slide_max_m.mean is not None:
            slides[number] = case.slide_max_m.mean
    return slides


def _named(case: Case) -> str:
    return f" ({case.name})" if case.name else ""
