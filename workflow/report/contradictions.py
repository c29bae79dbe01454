"""Finds contradictions within the results, each with a remedy."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations

import numpy as np

from dem.case import Case
from workflow.estimates.crest import embankments
from workflow.report.circles import against_elements, of_circles, of_longer_sections
from workflow.report.numbers import coefficient, of_cases, span
from workflow.results.cases import CaseAnswer, MovedSurface, RandomPackings
from workflow.results.discs import DiscsAnswer, DiscSearch
from workflow.results.governing import governing_kh
from workflow.results.lengths import metres
from workflow.results.material_points import PointCase, PointSlidesAnswer
from workflow.results.results import Results
from workflow.results.verdicts import Weight

# A case with less residual strength contradicts the other if it slides less by this length (m), and by this share.
SLIDE_DROP, SLIDE_DROP_SHARE = 0.1, 0.03
# The median settlement of the upslope third hides a fall of the surface by this length (m) and this multiple of it.
SURFACE_FALL, FALL_RATIO = 0.5, 3.0
SIDE_DISTANCE = 0.05  # of the length of the section: ground that falls this near to a side slides away from the side
# Discs whose Kh falls by this share of their critical Kh before they reach it do not resist it as a constant Kh.
REPORTED_FALL = 0.25
# Shares of the largest slide by which the uphill end of a section moves if the slide continues behind it, and the
# largest slide (m) up to which this is not reported.
END_SLIDE_SHARES, LEAST_END = (0.1, 0.8), 2.0
LEVEL_ENDS = 1e-3  # of the relief: ends that differ by less, as they settle, are level
NEAR_KC = 0.95  # of the critical Kh: a displacement-controlled path that reaches this Kh counts as critical


def contradictions(results: Results) -> Iterator[tuple[Weight, str]]:
    """Yield the contradictions of the results with a weight each: load curves of discs, sides of the box, order of
    cases, settlements, slip circles.
    """
    _, cases = results.case_set()
    if results.dem is not None and results.no_answer("calibrate") is None:
        yield from ((1, text) for text in of_curve(results.dem))
    yield from ((2, text) for text in of_sides(cases))
    yield from ((2, text) for text in of_ends(results.mpm))
    random = results.cases.random if results.cases is not None else None
    points = results.mpm.cases if results.mpm is not None else {}
    config, strata = dict(enumerate(results.config.cases, start=1)), liquefied_strata(results)
    lengths = {number: case.slide_max_m for number, case in points.items()}
    yield from ((1, text) for text in of_order(config, _largest_slides(cases, random), strata))
    yield from ((1, text) for text in of_order(config, lengths, strata, "material points"))
    if not embankments(results.config.section.ground):  # else the settlement of the crest is reported
        thirds = {number: (case, case.settlement_uphill_m) for number, case in cases.items()}
        yield from ((2, text) for text in of_settlement(thirds))
    crests = {number: (case, case.settlement_crest_m) for number, case in points.items()}
    yield from ((2, text) for text in of_settlement(crests, "material points"))
    yield from ((3, text) for text in (*of_circles(results), *against_elements(results)))
    if results.slices is not None:
        least, governing = results.slices.least_of_longer, governing_kh(results)
        smaller = least is None or governing is None or least < governing.value
        yield from ((2 if smaller else 3, text) for text in of_longer_sections(results.slices.critical))


def of_curve(discs: DiscsAnswer) -> Iterator[str]:
    """Warn if the load-displacement curve of the discs falls far below the critical Kh before it reaches the critical
    Kh.
    """
    fall = deepest_fall(discs.after, soil=discs.model.discs == "soil")
    if discs.after.kc is not None and fall is not None and fall[0] - fall[1] > REPORTED_FALL * discs.after.kc:
        yield (
            f"the Kh of the discs falls from {coefficient(fall[0])} to {coefficient(fall[1])} before it reaches "
            f"their critical Kh of {coefficient(discs.after.kc)}: under a constant Kh the discs would fail at "
            f"{coefficient(fall[0])}; take this Kh until more discs (dem.elements) or another packing (dem.seed) are "
            "computed"
        )


def deepest_fall(search: DiscSearch, soil: bool) -> tuple[float, float] | None:
    """Return the largest drop of Kh in a pushover before its critical Kh: the Kh before and after it; None without a
    drop.

    Parameters
    ----------
    search : the search, whose curve contains all trials of ``soil`` discs, which are points of one test, and only the
        stable states of other discs
    soil : whether the discs are soil discs

    Returns
    -------
    Kh before and after the fall (-).
    """
    points = [(t.displacement_m, t.kh) for t in search.trials] if soil else [(u, kh) for kh, u in search.curve]
    kh = np.array([kh for _, kh in sorted(points)])
    if search.kc is None or not (kh >= NEAR_KC * search.kc).any():
        return None
    kh = kh[: int(np.flatnonzero(kh >= NEAR_KC * search.kc)[0]) + 1]
    before = np.maximum.accumulate(kh)
    at = int(np.argmax(before - kh))
    return (float(before[at]), float(kh[at])) if before[at] > kh[at] else None


def of_sides(cases: Mapping[int, CaseAnswer]) -> Iterator[str]:
    """Warn of slides that a side of the disc model stopped."""
    for side in ("left", "right"):
        stopped = [number for number, case in cases.items() if case.stopped_by == side]
        if stopped:
            lengths = span([cases[number].slide_max_m for number in stopped])
            yield (
                f"the {side} side of the disc model stopped the slide in {of_cases(stopped)}: {lengths} is a lower "
                f"limit of the slide; take a longer section (setting beyond)"
            )


def of_ends(answer: PointSlidesAnswer | None) -> Iterator[str]:
    """Warn of slides by material points that reach a side or leave through it, or that move the uphill end.

    Ground that slides as a whole, such as an infinite slope, is excluded, since its ends move as far as all other
    ground.
    """
    points = answer.cases if answer is not None else {}
    stopped = {number: case for number, case in points.items() if case.stopped_by is not None}
    if answer is not None and stopped:
        lengths = span([case.slide_max_m for case in stopped.values()])
        end = "reach the fixed side of the section" if answer.sides == "fixed" else "leave the section"
        yield (
            f"material points {end} in {of_cases(sorted(stopped))}: {lengths} is a lower limit of the slide; take "
            f"a longer section (setting beyond)"
        )
    ends = {number: case.slide_along[_uphill_end(case)][1] for number, case in points.items() if case.slide_along}
    moving_ends = {number: end for number, end in ends.items() if points[number].slide_max_m >= LEAST_END}
    along = [
        number
        for number, end in moving_ends.items()
        if END_SLIDE_SHARES[0] < end / points[number].slide_max_m < END_SLIDE_SHARES[1]
    ]
    if along:
        yield (
            f"the upslope end of the section moves with the slide by {span([ends[n] for n in along])} in "
            f"{of_cases(along)}, and the model has no ground behind this end: take a longer section upslope"
        )


def _uphill_end(case: PointCase) -> int:
    """Return the index of the uphill end in the lists of a surface; of ends that are level, of the left one."""
    heights = [z for _, z in case.surface_before]
    return 0 if heights[0] >= heights[-1] - LEVEL_ENDS * (max(heights) - min(heights)) else -1


def liquefied_strata(results: Results) -> dict[int, list[str]]:
    """Return the names of the strata that liquefy in each case, by its number."""
    strata = results.config.section.strata
    numbers = range(1, len(results.config.cases) + 1)
    return {number: [stratum.name for stratum in strata if number in stratum.liquefies_in] for number in numbers}


def of_order(
    cases: Mapping[int, Case], slides: Mapping[int, float], strata: Mapping[int, Sequence[str]], by: str = "discs"
) -> Iterator[str]:
    """Warn of cases that have less strength than other cases and yet slide less (m), by discs or material points.

    ``slides``: slide of each case (m); ``strata``: names of the strata that liquefy in each case; ``by``: the method.
    """
    packings = "" if by != "discs" else ", or the random packing of the discs,"
    remedy = "finer cells (slide.mpm_cells)" if by != "discs" else "more packings (slide.seeds)"
    for number, other in combinations(sorted(set(cases) & set(slides)), 2):
        for weak, strong in ((number, other), (other, number)):
            short = slides[strong] - slides[weak]
            weaker = is_weaker(cases[weak], cases[strong], strata[weak], strata[strong])
            if weaker and short > max(SLIDE_DROP, SLIDE_DROP_SHARE * slides[strong]):
                yield (
                    f"case {weak}{_case_name(cases[weak])} has less residual strength than case "
                    f"{strong}{_case_name(cases[strong])} "
                    f"and slides less by {by}, {metres(slides[weak])} and {metres(slides[strong])}: a side of the "
                    f"model{packings} limits the slides, and not their strength; take a longer section (setting "
                    "beyond) if a "
                    f"side stops the slides, {remedy} otherwise, and rely on the longer slide until then"
                )


def is_weaker(case: Case, other: Case, strata: Sequence[str], of_other: Sequence[str]) -> bool:
    """Return whether a case has less stiffness or strength than another, and no more of either.

    ``strata`` are those that liquefy in the case, ``of_other`` those that liquefy in the other case. A stratum that
    does not liquefy counts as stronger than a stratum that liquefies.
    """
    if not set(of_other) <= set(strata):
        return False
    pairs = [(getattr(case, name), getattr(other, name)) for name in ("stiffness", "friction", "cohesion")]
    for stratum in of_other:
        ratios = case.residual_of(stratum), other.residual_of(stratum)
        strengths = case.strength_of(stratum), other.strength_of(stratum)
        if any(ratios) and any(strengths):  # a ratio and a strength cannot be compared
            return False
        pairs += [ratios, strengths]
    more_liquefies = len(set(strata)) > len(set(of_other))
    return all(value <= than for value, than in pairs) and (
        more_liquefies or any(value < than for value, than in pairs)
    )


def of_settlement(cases: Mapping[int, tuple[MovedSurface, float]], by: str = "discs") -> Iterator[str]:
    """Warn of surfaces that fall much further at one place than the reported settlement (m) of the case.

    The reported settlement is the median settlement of the upslope third for discs, and the fall of the highest level
    of the ground for material points.
    """
    falls = {number: surface.largest_fall for number, (surface, _) in cases.items()}
    large_falls = {k: fall for k, fall in falls.items() if fall[0] > max(SURFACE_FALL, FALL_RATIO * abs(cases[k][1]))}
    if not large_falls:
        return
    lengths, places = zip(*large_falls.values(), strict=True)
    fall, at, of = span(lengths), _range_words(places), of_cases(list(large_falls))
    sides = {_side(cases[number][0], place) for number, (_, place) in large_falls.items()}
    side = sides.pop() if len(sides) == 1 else ""
    if by == "discs" and side:
        yield (
            f"the surface falls by {fall} at x = {at} m in {of}, where it slides away from the {side} side of the "
            "model: take a longer section (setting beyond) before you use this value, which may be smaller there"
        )
    elif by == "discs":
        yield (
            f"the surface falls by {fall} at x = {at} m in {of}, far more than the median settlement of the "
            "upslope third: use this value for structures at this place"
        )
    else:
        yield (
            f"the surface of material points falls by {fall} at x = {at} m in {of}, far more than the highest "
            "ground: use this value for structures at this place"
        )


def _side(surface: MovedSurface, x: float) -> str:
    """Return the side of the model to which a place (m) on a surface is close; empty if the place is close to neither
    side."""
    along = [point[0] for point in surface.surface_before]
    near = SIDE_DISTANCE * (max(along) - min(along))
    return "left" if x < min(along) + near else "right" if x > max(along) - near else ""


def _range_words(places: Sequence[float]) -> str:
    low, high = f"{min(places):.0f}", f"{max(places):.0f}"
    return low if low == high else f"{low} to {high}"


def _largest_slides(cases: Mapping[int, CaseAnswer], random: RandomPackings | None) -> dict[int, float]:
    """Return the largest slide (m) of each case: its mean over random packings where there are several."""
    slides = {number: case.slide_max_m for number, case in cases.items()}
    for number, case in (random.cases if random is not None else {}).items():
        if number in slides and len(case.slide_max_m.values) > 1 and case.slide_max_m.mean is not None:
            slides[number] = case.slide_max_m.mean
    return slides


def _case_name(case: Case) -> str:
    return f" ({case.name})" if case.name else ""
