"""States the results in sentences written from the numbers, for the section of results."""

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any

from dem.slides.slide import WEIGHT_ALONE_TIME, stopped_at
from meshes.section.cutting import shown_name
from meshes.section.stratum import cases_of
from workflow.config import Config
from workflow.report.contradictions import is_weaker, liquefied_strata
from workflow.report.flow_rule import WHEN
from workflow.report.model_error import model_error
from workflow.report.numbers import SMALLEST_SLIDE, coefficient, numerical_error, of_cases, slides_in_words, span
from workflow.report.post_liquefaction import in_short
from workflow.report.tables import factor
from workflow.results.accuracy import Accuracy, accuracy
from workflow.results.cases import CaseAnswer, CaseNumbers
from workflow.results.continuum import FemAnswer, Variant
from workflow.results.governing import estimates_of, governing_kh
from workflow.results.lengths import metres
from workflow.results.material_points import PointCase
from workflow.results.results import Results
from workflow.texts.report_texts import listed

ASSUMED = ("dilation", "sides", "tension")  # variants that show the effect of an assumption
MESH_ERROR_RATIO = 1.02  # times the limit for ψ = φ, which the elements may exceed for their mesh
DISAGREEMENT_RATIO = 3.0  # times: beyond this, methods do not say the same
# A slide that moves less in its last 10 s counts as at rest, though its discs may not: in m, and of all its way.
REST_MOVEMENT, REST_MOVEMENT_SHARE = 0.01, 0.001
ENDS = ("settled", "lying", "moving")  # how slides end, in the order in which they are reported


def springs_of(results: Results) -> dict[str, str]:
    """Return the springs of every set of slides in words, by the name of the set."""
    calibration = results.calibration
    if calibration is not None and calibration.verdict == "out of reach":
        words = "whose calibration failed, with the critical Kh nearest to that of the finite elements"
    elif calibration is not None and (calibration.leaves_open or calibration.verdict == "not asked for"):
        words = fail_alike(results)
    else:
        words = "calibrated to the critical Kh of the finite elements with the same boundary conditions"
    return {
        "calibrated": f"discs {words}",
        "table2": "discs with the springs of the paper's Table 2 as printed",
    }


def fail_alike(results: Results) -> str:
    """Return the common critical Kh of calibrated packings, in words."""
    calibration = results.calibration
    if calibration is not None and calibration.verdict == "not asked for":
        return "with the strength of their element tests, not calibrated to the finite elements"
    if calibration is not None and calibration.leaves_open:
        return "calibrated to within the uncertainty of the finite elements"
    return "calibrated to the same critical Kh"


def findings(results: Results) -> list[str]:
    """Return the paragraphs of details after the first page: cases, accuracy and assumptions, slides, and other
    methods."""
    paragraphs = (
        _cases(results), _failure(results), in_short(results), _slides(results), _disagreement(results),
        _measured(results),
    )  # fmt: skip
    return [" ".join(sentences) for paragraph in paragraphs if (sentences := list(paragraph))]


def _cases(results: Results) -> Iterator[str]:
    if results.config.section.liquefies:
        yield from _cases_are(results.config)


def _failure(results: Results) -> Iterator[str]:
    """Yield sentences on the error of the critical Kh of the continuum, and on the influence of assumptions."""
    fem = results.fem
    if results.kc is None or fem is None:
        return
    if fem.davis is not None or fem.associated is not None:
        yield WHEN
    error, governing = accuracy(results, fem), governing_kh(results)
    if governing is not None and governing.opposite_bounds is not None:
        error = governing.interval
    yield numerical_error(error, fem.kc if governing is None else governing.value)
    yield from _assumed(results, fem, error)
    yield from _shallow(results, fem)


def _assumed(results: Results, fem: FemAnswer, error: Accuracy | None) -> Iterator[str]:
    """Yield a sentence on the critical Kh with other assumptions: with those that matter more than the numerical error,
    or with all if none does.
    """
    most, variants = _most(results, fem), results.variants.variants if results.variants is not None else ()
    others = {variant: kc for variant in variants if variant.name in ASSUMED and (kc := variant.of(fem.kc)) is not None}
    others = {
        variant: kc for variant, kc in others.items() if variant.name != "dilation" or kc <= MESH_ERROR_RATIO * most
    }
    if not others:
        return
    sentences = {variant: _with_change(variant, kc) for variant, kc in others.items()}
    if error is None:
        yield from sentences.values()
        return
    matter = [text for variant, text in sentences.items() if abs(others[variant] - fem.kc) > error.error(fem.kc)]
    yield f"The assumptions matter {'more' if matter else 'no more'} than the numerical error."
    yield from matter or sentences.values()


def _with_change(variant: Variant, kc: float) -> str:
    """Return a sentence on the critical Kh with a changed assumption, which is scaled if the change was computed on a
    coarser mesh."""
    change, _, conditions = variant.change.partition(", ")
    if variant.kc_without is None or not conditions:
        return f"With {variant.change} the critical Kh is {coefficient(kc)}."
    return f"With {change} the critical Kh is {coefficient(kc)}, by the ratio of two results ({conditions})."


def _most(results: Results, fem: FemAnswer) -> float:
    """Return the largest possible critical Kh for any flow rule: the upper bound with the same sides, or the critical
    Kh with ψ = φ. A path with smaller ψ and a larger critical Kh had too coarse a mesh, and is disregarded.
    """
    bounds, full = results.bounds, fem.kc if fem.flow == "associated" else math.inf
    if fem.associated is not None:
        full = fem.associated.kc
    if bounds is None or bounds.upper is None or bounds.sides != fem.settings.sides:
        return full
    return min(full, bounds.upper)


def _shallow(results: Results, fem: FemAnswer) -> Iterator[str]:
    """Yield the shallow failures of cohesionless faces, and whether the mechanism leaves the section at a side."""
    for face in fem.shallow_failures:
        if face.is_edge(fem.settings.least_depth):
            continue
        when = f"At Kh = {coefficient(face.kh)} already" if face.kh > 0.0 else "By its own weight"
        yield (
            f"{when}, the cohesionless face of "
            f"{shown_name(face.stratum, quoted=False)} from x = {face.start_x_m:g} to {face.end_x_m:g} m fails as an "
            "infinite slope (shallow failure)."
        )
    sides = fem.associated.at_sides if fem.associated is not None else ()
    if sides:
        yield f"With ψ = φ the failing ground reaches the {listed(sides)} side of the section."


def _slides(results: Results) -> Iterator[str]:
    """Yield sentences on the slide of each case and on its end, the governing set of discs first."""
    first, cases = results.case_set()
    if not cases:
        return
    springs = springs_of(results)
    yield f"The following slides are those of {springs.get(first, first)}."
    yield from _prediction(results)
    yield from _by_end(cases)
    yield _interval(results)
    yield from model_error(results)
    for other, compared in (results.cases.sets if results.cases is not None else {}).items():
        if other != first and compared:
            yield f"For comparison, the following slides are those of {springs.get(other, other)}."
            yield from _by_end(compared)


def _prediction(results: Results) -> Iterator[str]:
    """Yield a sentence on the ratio of the critical Kh of the uncalibrated discs to the critical Kh of their FEM
    model."""
    calibration = results.calibration
    if calibration is not None and calibration.predicted_kc is not None and calibration.predicted_ratio is not None:
        yield (
            f"Uncalibrated, the discs fail at Kh = {coefficient(calibration.predicted_kc)}, "
            f"{calibration.predicted_ratio:.2f} times the critical Kh of the finite elements{_alike(results)}."
        )


def _alike(results: Results) -> str:
    """Return in words the boundary conditions and flow rule of the FEM model that the discs are compared with, and its
    critical Kh."""
    counterpart = results.dem_counterpart
    if counterpart is None:
        return ""
    instead = f" ({counterpart.instead})" if counterpart.instead else ""
    most = (
        f" (at most {coefficient(counterpart.kc_upper)})"
        if coefficient(counterpart.kc_upper) != coefficient(counterpart.kc)
        else ""
    )
    return f" with {counterpart.terms}{instead}, which is {coefficient(counterpart.kc)}{most}"


def _by_end(cases: dict[int, CaseAnswer]) -> Iterator[str]:
    """Yield sentences on the cases that come to rest, on those still moving, and on those that a side of the box
    stopped."""
    stays = [number for number, case in cases.items() if case.settled and case.slide_max_m < SMALLEST_SLIDE]
    if stays:
        yield f"In {of_cases(stays)} the surface moves less than {SMALLEST_SLIDE:g} m."
    ends: dict[tuple[str, str | None], list[int]] = {}
    for number, case in cases.items():
        if number not in stays:
            end = "settled" if case.settled or rests_at_side(case) else "lying" if lies_still(case) else "moving"
            ends.setdefault((end, case.stopped_by), []).append(number)
    for (end, side), numbers in sorted(ends.items(), key=lambda item: ENDS.index(item[0][0])):
        lengths = slides_in_words([cases[number].slide_max_m for number in numbers])
        until = f", where the {side} side of the disc model stops it" if side else ""
        if end == "settled":
            yield f"In {of_cases(numbers)} the surface slides {lengths}{until or ' and comes to rest'}."
        elif end == "lying":
            lately = moved_lately([cases[number] for number in numbers])
            yield f"In {of_cases(numbers)} the surface slides {lengths}{until}; it moved {lately} in the last 10 s."
        else:
            seconds = max(cases[number].seconds_simulated for number in numbers)
            against = f", against the {side} side of the disc model," if side else ""
            yield (
                f"In {of_cases(numbers)} the surface had slid {lengths}{against} after {seconds:.0f} s and was still "
                "moving: these are not final values."
            )
    stopped = [number for number, case in cases.items() if case.stopped_by is not None]
    if stopped:
        yield (
            f"In a longer section the slide of {of_cases(stopped)} would be longer, because the disc model ends at the "
            "side of the section."
        )
    flowing = {number: case.slide_by_weight_m for number, case in cases.items() if case.flows}
    if flowing:
        far = slides_in_words([slide for slide in flowing.values() if slide is not None])
        yield (
            f"In {of_cases(list(flowing))} this is a flow failure: without shaking the surface slides {far} within "
            f"{WEIGHT_ALONE_TIME:g} s."
        )


def lies_still(case: CaseNumbers) -> bool:
    """Return whether a slide that did not come to rest hardly moved in its last 10 s."""
    limit = max(REST_MOVEMENT, REST_MOVEMENT_SHARE * abs(case.slide_max_m))
    return case.moved_lately_m is not None and case.moved_lately_m < limit


def rests_at_side(case: CaseAnswer) -> bool:
    """Return whether a side of the disc model brought the slide to rest."""
    return case.stopped_by is not None and case.reason == stopped_at(case.stopped_by)


def at_rest(case: CaseNumbers | PointCase) -> bool:
    """Return whether a slide came to rest, or almost, and no side of the model stopped it."""
    if case.stopped_by is not None:
        return False
    return case.settled or (isinstance(case, CaseNumbers) and lies_still(case))


def moved_lately(cases: Sequence[CaseNumbers]) -> str:
    """Return the largest movement of slides that are almost at rest, in their last 10 s."""
    most = max(case.moved_lately_m or 0.0 for case in cases)
    return f"less than {100 * REST_MOVEMENT:.0f} cm" if most < REST_MOVEMENT else f"{100 * most:.0f} cm"


# Words for properties of a case that are not factors on properties of the layers.
PROPERTY_WORDS = {
    "residual": "a residual strength of {} of the vertical effective stress",
    "residual_strength": "a residual strength of {}",
    "strain_potential": "a shear strain of {} before strength is regained",
    "volumetric_strain": "{} less of {whose} volume",
}


def _cases_are(config: Config) -> Iterator[str]:
    """Yield the first sentences on the cases: the strength and stiffness of the layers that liquefy in each case. Cases
    of the same layers that leave the same properties share a sentence."""
    alike: dict[tuple[tuple[str, ...], frozenset[str]], list[int]] = {}
    for number in cases_of(config.section.strata):
        liquefied = [stratum.name for stratum in config.section.strata if number in stratum.liquefies_in]
        layers = tuple(dict.fromkeys(shown_name(name, quoted=False) for name in liquefied))
        strengths = frozenset(key for key in ("residual", "residual_strength") if dict(config.cases[number - 1])[key])
        alike.setdefault((layers, strengths), []).append(number)
    yield from (_what_is_left(config, numbers, layers) for (layers, _), numbers in alike.items())


def _what_is_left(config: Config, numbers: Sequence[int], layers: Sequence[str]) -> str:
    """Return a sentence on what liquefaction leaves of some layers in the cases of these ``numbers``."""
    cases = [{**dict(assumed := config.cases[number - 1]), "damping": assumed.damping_left} for number in numbers]
    phrases, lost = [], []
    whose = "its" if len(layers) == 1 else "their"
    for name in [name for name in cases[0] if name != "name"]:
        shown = _shown(name, [case[name] for case in cases])
        if shown == "1" and name not in PROPERTY_WORDS:
            continue  # as it was
        if shown != "0":
            phrases.append(
                PROPERTY_WORDS.get(name, "{} of {whose} " + name.replace("_", " ")).format(shown, whose=whose)
            )
        elif name not in PROPERTY_WORDS:
            lost.append(name.replace("_", " "))
    called = [case["name"] for case in cases if case["name"]]
    nothing = f", and none of {whose} {listed(lost)}" if lost else ""
    names = f" ({listed(called)})" if len(called) == len(cases) else ""
    if config.dem.paper and any(case["residual"] or case["residual_strength"] for case in cases):
        nothing += "; the discs of the paper have no residual strength"
    return f"In {of_cases(numbers)}{names} liquefaction leaves {listed(list(layers))} with {listed(phrases)}{nothing}."


def _shown(name: str, values: Sequence[Any]) -> str:
    """Return the remaining share of one property in each case, by stratum if the shares differ."""
    strata = list(dict.fromkeys(stratum for value in values if isinstance(value, dict) for stratum in value))
    each = []
    for stratum in strata or [""]:
        phrases = [factor(value.get(stratum, 0.0) if isinstance(value, dict) else value, name) for value in values]
        where = f" in {shown_name(stratum, quoted=False)}" if len(strata) > 1 else ""
        each.append(listed(phrases if len(set(phrases)) > 1 else phrases[:1]) + where)
    return ", ".join(each)


def _interval(results: Results) -> str:
    """Return a clause on the spread of the largest slide (m) over random packings, if there are several packings."""
    random = results.cases.random if results.cases is not None else None
    spreads = {number: case.slide_max_m for number, case in random.cases.items()} if random is not None else {}
    alike: dict[str, list[int]] = {}
    for number, spread in spreads.items():
        if spread.mean is not None and len(spread.values) > 1:
            alike.setdefault(_spread(spread.mean, spread.values, spread.mean_ci95), []).append(number)
    phrases = [f"{phrase} in {of_cases(numbers)}" for phrase, numbers in alike.items()]
    if not phrases:
        return "One packing of discs was computed, so no interval is known; slide.seeds = [1, 2] gives one."
    count = max(len(spread.values) for spread in spreads.values())
    order = ""
    strata, cases = liquefied_strata(results), enumerate(results.config.cases, start=1)
    weaker = all(is_weaker(case, before, strata[k], strata[j]) for (j, before), (k, case) in pairwise(cases))
    if random is not None and random.rising and weaker:
        on = "each" if random.rising == count else str(random.rising)
        order = f" Each case slides further than the case before on {on} of these packings."
    return f"On {count} random packings {fail_alike(results)} the largest slide is {listed(phrases)}.{order}"


def _spread(mean: float, values: Sequence[float], interval: Sequence[float] | None) -> str:
    """Return a slide on several packings: the mean, and the range over packings if the range is larger than the digits
    shown."""
    phrases = [span(values)] if span(values) != slides_in_words([mean]) else []
    if interval is not None and span(interval) != slides_in_words([mean]):
        phrases.append(f"95 % interval of the mean of all packings: {span(interval)}")
    return slides_in_words([mean]) + (f" ({'; '.join(phrases)})" if phrases else "")


def _disagreement(results: Results) -> Iterator[str]:
    """Yield a sentence if methods disagree by more than a factor of three."""
    _, cases = results.case_set()
    discs = [max(case.slide_max_m, 0.0) for case in cases.values()]
    rows = [row for row in estimates_of(results) if row.applies]
    observed, blocks = (
        [row.displacement_m for row in rows if row.kind == kind and row.displacement_m is not None]
        for kind in ("regression", "block")
    )
    points = [max(case.slide_max_m, 0.0) for case in results.mpm.cases.values()] if results.mpm is not None else []
    values = [*discs, *points, *observed, *blocks]
    if not discs or values == discs or max(values) <= DISAGREEMENT_RATIO * min(values):
        return
    phrases = [f"discs {span(discs)}"]
    phrases += [f"material points {span(points)}"] if points else []
    phrases += [f"regression over observed slides {span(observed)}"] if observed else []
    phrases += [f"rigid block on the slip surface {span(blocks)}"] if blocks else []
    yield f"The methods differ by more than a factor of three: {listed(phrases)}."
    if blocks:
        yield "The rigid block has the strength before liquefaction, so it does not predict slides after it."
    if observed:
        yield (
            "The regression is an average over gentle slopes of liquefied sand; the regression does not depend "
            "on shaking and strength, and flow failures are excluded."
        )
    if observed and max(discs) > DISAGREEMENT_RATIO * min(observed) and not any(case.flows for case in cases.values()):
        yield (
            "Where the discs slide much farther than the regression, check the stiffness and strength of the liquefied "
            "layers, and whether the discs came to rest."
        )


def _measured(results: Results) -> Iterator[str]:
    """Yield a comparison of measured displacements with the discs: at the same place if the place is given, else with
    the largest slide.
    """
    _, cases = results.case_set()
    for observation in results.config.report.observed if cases else ():
        phrase = f"The measured displacement is {observation.displacement:.3g} m ({observation.name})"
        computed = results.slides_at(observation.x)
        place_words = "at most" if computed is None else f"there, at x = {observation.x:g} m,"
        slides = [case.slide_max_m for case in cases.values()] if computed is None else computed.values()
        numbers = listed(list(dict.fromkeys(metres(max(slide, 0.0)) for slide in slides)))
        yield f"{phrase}; the discs slide {place_words} {numbers} in {of_cases(list(cases))}."
