"""Collects the warnings of a report by weight, each with a remedy; equal warnings of several cases are merged."""

import re
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from meshes.section.cutting import CRACKED, shown_name
from meshes.section.section import Section
from meshes.section.stratum import cases_of
from meshes.section.tension_crack import upright_faces
from workflow.config import notice_lines
from workflow.estimates.level_ground import sliding_level_ground
from workflow.report.contradictions import contradictions
from workflow.report.numbers import SMALLEST_SLIDE, coefficient, of_cases, span
from workflow.results.continuum import FemAnswer, Variant
from workflow.results.discs import SlipSurfaces
from workflow.results.material_points import WARNING
from workflow.results.results import Results
from workflow.results.verdicts import WarningPart, Weight
from workflow.texts.report_texts import listed

CALIBRATION_RATIO = 2.0  # times, or divided by it: a factor on the discs beyond this is reported
SURFACE_DISTANCE = 0.25  # of the height of the section: slip surfaces farther apart than this are reported
SIDE_EFFECT_RATIO = 1.15  # times, or divided by it: other sides that change the critical Kh by more decide it
TENSION_EFFECT_RATIO = 0.9  # of the critical Kh: a smaller one without tensile strength is reported
LEVEL_GROUND_SHARE = 0.97  # of the Kh of level ground: a larger critical Kh is its failure, up to errors of meshes
LIMIT_DISTANCE = 0.1  # of the critical Kh after liquefaction: a Kh of a slide that is nearer to it is reported
REPORTED_SHARE = 0.1  # of a stratum: a smaller part with F_L below 1 is not reported
UNRESOLVED_RATIO = 2.0  # times, or divided by it: a slide whose numerical error alone may be larger is reported
OPEN_KH_RATIO = (
    1.1  # ratio of the largest possible critical Kh to the target of the calibration, from which it is reported
)
# A number or a range in a note, and what is none though it has digits: what stands in quotes, and names as Ac1.
NUMBER = re.compile(r'("[^"]*")|(?<![\w.])(\d+(?:\.\d+)?(?: to \d+(?:\.\d+)?)?)(?![\w.]*\w)')


def warnings(results: Results) -> list[WarningPart]:
    """Find every warning, the most important first: contradictions, then what changes an answer, then notes."""
    merged: dict[tuple[str, str], WarningPart] = {}
    for weight, text in _warnings(results):
        observation, remedy = split_warning(text)
        merged.setdefault((observation, remedy), WarningPart(weight=weight, observation=observation, remedy=remedy))
    return sorted(merged.values(), key=lambda part: part.weight)


def split_warning(text: str) -> tuple[str, str]:
    """Split a warning at its first colon into two sentences: the observation, and the remedy."""
    observation, _, remedy = text.partition(": ")
    return _sentence(observation), _sentence(remedy)


def _sentence(text: str) -> str:
    text = text.strip().rstrip(".")
    return f"{text[0].upper()}{text[1:]}." if text else ""


def _warnings(results: Results) -> Iterator[tuple[Weight, str]]:
    """Yield the weight and text of every warning: the observation, a colon, and the remedy."""
    fem = results.fem
    if fem is not None and fem.verdict == "undecided":
        yield 1, f"the finite elements found no limit load ({fem.reason}): {fem.remedy or 'refine the mesh'}"
    for warning in results.warnings:
        yield (1 if warning.contradiction else 3), f"{warning.observation.rstrip('.')}: {warning.remedy}"
    if results.response is not None and results.response.warning:
        yield 2, f"in the response of the layers to {results.response.record} {results.response.warning}"
    if fem is not None:
        variants = results.variants.variants if results.variants else ()
        yield from sides_warning(fem, results.config.section, variants)
        yield from tension_warning(fem, variants, results.config.section)
    if results.config.section.reconstruction:
        yield 2, "the ground is a reconstruction: confirm the depths of the layers by borings"
    for text in assumed_input(results):
        yield 2, text.replace(": ", ", ", 1) if text.count(": ") > 1 else text  # the first colon follows a key
    for find in (_calibration, _target_range, _fails_between_fixed_sides, _residual_strength, _at_the_limit,
                 _partly_liquefied):  # fmt: skip
        yield from ((2, text) for text in find(results))
    yield from contradictions(results)
    yield from ((2, text) for text in _of_cases(results))
    discs = results.dem
    if discs is not None:
        for text in _elsewhere(discs.slip_surface, float(np.ptp(results.config.section.outline()[:, 1]))):
            yield 2, text
        if discs.model.packing != "random":
            yield 3, 'the discs are in rows, which must climb over each other to slide: take dem.packing = "random"'


def assumed_input(results: Results) -> list[str]:
    """Return the notices about assumed input of the slides, such as an assumed residual strength, that are warnings."""
    if results.mpm is None and not results.case_set()[1]:
        return []
    lines = [line for line in notice_lines(results.config.notices_of_slides) if line.startswith("Warning: ")]
    return [line.removeprefix("Warning: ").rstrip(".") for line in lines]


def _of_cases(results: Results) -> Iterator[str]:
    """Yield the warnings of discs that left the section, and notes of cases."""
    _, cases = results.case_set()
    escaped = [number for number, case in cases.items() if case.escaped]
    if escaped:
        yield f"discs have left the section in {of_cases(escaped)}: take a longer section (setting beyond)"
    yield from merged_notes({number: case.notes for number, case in cases.items()})
    points = results.mpm.cases if results.mpm is not None else {}
    warned = {
        number: [note.removeprefix(WARNING) for note in case.notes if note.startswith(WARNING)]
        for number, case in points.items()
    }
    for text in merged_notes(warned):
        yield f"in the slide by material points {text}: compare this slide with that of the discs"
    yield from _unresolved(results)
    if cases and results.mpm is not None and results.mpm.not_possible:
        yield (
            "the material point method cannot compute the slides, so that those of the discs have no second opinion: "
            "compare them with the rigid block, and with the stability after liquefaction"
        )


def _unresolved(results: Results) -> Iterator[str]:
    """Yield a warning of slides by material points that other cells, or another decay of velocities, may change by more
    than a factor of two."""
    points = results.mpm.cases if results.mpm is not None else {}
    notes = {
        number: [
            "by its numerical error alone the slide by material points is "
            f"{span([case.slide_max_low_m, case.slide_max_high_m])}: take more cells (slide.mpm_cells)"
        ]
        for number, case in sorted(points.items())
        if case.slide_max_m >= SMALLEST_SLIDE
        and not (
            case.slide_max_low_m * UNRESOLVED_RATIO >= case.slide_max_m
            and case.slide_max_high_m <= UNRESOLVED_RATIO * case.slide_max_m
        )
    }
    yield from merged_notes(notes)


def _residual_strength(results: Results) -> Iterator[str]:
    """Yield a warning of liquefying layers without residual strength, or of sand without a strain potential."""
    if results.config.dem.paper or not (results.liquefied or results.mpm or results.case_set()[1]):
        return
    liquefies = [stratum for stratum in results.config.section.strata if stratum.liquefies_in]
    none, without_strain = [], []
    for number in cases_of(liquefies):
        case = results.config.cases[number - 1]
        if any(case.residual_of(stratum.name) or case.strength_of(stratum.name) for stratum in liquefies):
            sand = [stratum.name for stratum in liquefies if stratum.friction_angle > 0.0]
            if sand and not any(case.strain_potential_of(name) for name in sand):
                without_strain.append(number)
        elif not (case.cohesion or case.friction):
            none.append(number)
    if none:
        yield (
            f"the layers that liquefy have no residual strength in {of_cases(none)}, so that the slide has no lower "
            "limit of resistance: give a residual strength (slide.cases, residual or residual_strength)"
        )
    if without_strain:
        yield (
            f"liquefied sand has its residual strength without any shear strain in {of_cases(without_strain)}; in "
            "the field sand shears before it regains strength, so that lateral spreads are underestimated: give "
            "borings, or the shear strain (slide.cases, strain_potential), at most 0.5 in loose sand"
        )


def _partly_liquefied(results: Results) -> Iterator[str]:
    """Yield a warning of each soil that liquefies in a smaller part than counts, and so in none."""
    triggering, ground = results.triggering, {stratum.name: stratum for stratum in results.config.section.strata}
    for part in triggering.strata if triggering is not None else ():
        if part.liquefies or part.name not in ground or ground[part.name].liquefiable:
            continue
        if part.share is not None and part.share >= REPORTED_SHARE and triggering is not None:
            yield (
                f"F_L is below 1 in {100.0 * part.share:.0f} % of {shown_name(part.name)}, less than the "
                f"{100.0 * triggering.share:.0f} % from which a stratum counts as liquefied, so that none of it "
                "liquefies in stability and slides: divide the stratum where its blow counts differ, or lower "
                "triggering.share"
            )


def _at_the_limit(results: Results) -> Iterator[str]:
    """Yield a warning if the constant Kh is close to the limit load of liquefied ground, so that the slide is
    undetermined.
    """
    slide = results.config.slide
    if results.liquefied is None or slide.kh_cycles or slide.accelerogram or not isinstance(slide.kh, float):
        return
    for case in results.liquefied.cases:
        kc = case.kc
        if kc is not None and kc > 0.0 and abs(slide.kh / kc - 1.0) <= LIMIT_DISTANCE:
            yield (
                f"in {of_cases(case.cases)} liquefied ground just stands under Kh = {coefficient(kc)}, so "
                f"that its slide under Kh = {coefficient(slide.kh)} is undetermined: take the cycles or "
                'the record of an earthquake (slide.kh = "earthquake", slide.accelerogram)'
            )


def _target_range(results: Results) -> Iterator[str]:
    """Yield a warning if the critical Kh of the calibration is only known as a range."""
    counterpart = results.dem_counterpart
    if counterpart is not None and results.dem is not None and counterpart.kc_upper > OPEN_KH_RATIO * counterpart.kc:
        yield (
            f"the finite elements with the boundary conditions of the discs ({counterpart.terms}) fail between Kh = "
            f"{coefficient(counterpart.kc)} and {coefficient(counterpart.kc_upper)}, so that discs that fail within "
            "this range are taken as calibrated: compare their slides with those by material points, which need no "
            "calibration"
        )


def sides_warning(fem: FemAnswer, section: Section, variants: Sequence[Variant] = ()) -> Iterator[tuple[Weight, str]]:
    """Return a warning if the critical Kh depends on the condition at the sides, or may depend on it because no other
    condition was computed.
    """
    if level_ground := _level_ground_governs(fem, section):
        yield 3, level_ground
        return
    longer = "a larger value of beyond" if section.beyond else 'beyond = "50 m"'
    remedy, at = f"move the sides away by {longer}", listed(fem.at_sides)
    if at and fem.settings.sides == "free-field":  # farther away it decides as much: level ground slides out there, too
        remedy = (
            f'take fem.sides = "smooth" if level ground continues beyond the {at} side, through which the failing '
            "ground slides out"
        )
    change = next((variant for variant in variants if variant.name == "sides"), None)
    other = change.of(fem.kc) if change is not None else None
    if change is None or other is None or not fem.kc > 0.0:
        if at:
            yield (
                3,
                f"the ground that fails reaches the {at} side, so that the boundary condition there may govern: "
                f"{remedy}",
            )
    elif not 1.0 / SIDE_EFFECT_RATIO <= other / fem.kc <= SIDE_EFFECT_RATIO:
        change_words = f"{abs(100.0 * (other / fem.kc - 1.0)):.0f} % {'larger' if other > fem.kc else 'smaller'}"
        yield (
            2,
            (
                f"with {change.change} the critical Kh is {change_words}, so that the boundary condition at the sides "
                f"governs: {remedy}"
            ),
        )


def tension_warning(fem: FemAnswer, variants: Sequence[Variant], section: Section) -> Iterator[tuple[Weight, str]]:
    """Yield a warning if the critical Kh of ground that resists tension is much larger than without tension, by the
    ``variants`` or else by the finite elements alone.

    From an upright face, such as that of a quay, slices of no thickness topple without tensile strength at any Kh:
    there only ground that fails by its weight counts.
    """
    change = next((variant for variant in variants if variant.name == "tension"), fem.without_tension)
    cracked = change.of(fem.kc) if change is not None else None
    if cracked is None or cracked > TENSION_EFFECT_RATIO * fem.kc or not fem.kc > 0.0:
        return
    if cracked > 0.0 and len(upright_faces(section.ground)):
        return
    has_cracks = any(CRACKED in stratum.name for stratum in section.strata)
    remedy = "give deeper cracks in [tension_crack]" if has_cracks else "give a [tension_crack]"
    remedy += ', or tension = "0 kPa" for strata that may crack'
    if cracked > 0.0:
        yield (
            2,
            f"the ground resists tension, and without tensile strength, as with open cracks, the critical Kh is "
            f"{coefficient(cracked)}, {100.0 * (1.0 - cracked / fem.kc):.0f} % smaller: {remedy}",
        )
    else:
        yield (
            2,
            "the ground resists tension, and without tensile strength, as with open cracks, it fails under its own "
            f"weight: {remedy}",
        )


def _level_ground_governs(fem: FemAnswer, section: Section) -> str:
    """Return a warning if the failing ground reaches a side whose level ground slides at about the critical Kh; empty
    otherwise. If level ground slides at a much smaller Kh, the side holds it, and a longer section has a smaller Kh."""
    decided_by_side = fem.settings.sides == "free-field"  # level ground slides out through it at any distance
    for side in fem.at_sides if fem.kc > 0.0 and not decided_by_side else ():
        failure = sliding_level_ground(section, side, fem.settings.vertical)
        if failure is not None and LEVEL_GROUND_SHARE * failure.kh < fem.kc < SIDE_EFFECT_RATIO * failure.kh:
            near = LEVEL_GROUND_SHARE * fem.kc <= failure.kh
            longer = "changes this critical Kh little" if near else "has a smaller critical Kh, down to that one"
            return (
                f"the ground that fails reaches the {side} side, where level ground slides in "
                f"{shown_name(failure.stratum)} by itself at Kh = {coefficient(failure.kh)} (infinite slope, at "
                f"elevation {failure.elevation:.1f} m): a longer section {longer}; see the faces of structures for the "
                "slope alone"
            )
    return ""


def _elsewhere(surfaces: SlipSurfaces, height: float) -> Iterator[str]:
    """Yield a warning if the slip surfaces of discs and continuum differ, in a section of this ``height`` (m)."""
    apart, lines = surfaces.mean_distance_m, (surfaces.dem, surfaces.fem)
    if apart is not None and apart > SURFACE_DISTANCE * height:
        yield (
            f"the slip surfaces of discs and finite elements lie {apart:.0f} m apart vertically on average: take "
            "smaller discs (dem.elements)"
        )
    elif apart is None and all(lines):
        discs, fem = ([point[0] for point in line] for line in lines)
        yield (
            f"discs fail from x = {min(discs):.0f} to {max(discs):.0f} m, the finite elements from {min(fem):.0f} to "
            f"{max(fem):.0f} m: take smaller discs (dem.elements)"
        )


def _fails_between_fixed_sides(results: Results) -> Iterator[str]:
    """Yield a warning if discs fail under a constant Kh below the critical Kh of their displacement-controlled test."""
    discs = results.dem
    if discs is None or discs.after.kc is None:
        return
    fallen = [s.kh for s in discs.states if s.set == "after" and s.verdict == "fails" and s.kh < discs.after.kc_lower]
    if fallen:
        yield (
            f"the calibrated discs fail under a constant Kh = {min(fallen):g}, below their critical Kh of "
            f"{coefficient(discs.after.kc)} under prescribed displacement: rely on the smaller Kh"
        )


def merged_notes(notes: Mapping[int, Sequence[str]]) -> Iterator[str]:
    """Merge equal notes of several cases. Where the notes have different numbers, the merged note has the range of the
    numbers. The order by importance is unchanged."""
    groups: dict[str, dict[int, list[str]]] = {}
    places: dict[str, int] = {}
    remedies: dict[str, str] = {}
    for case, texts in notes.items():
        for place, note in enumerate(texts):
            fact, _, remedy = note.partition(": ")
            same = NUMBER.sub(lambda match: match[1] or "{}", fact.replace("{", "(").replace("}", ")"))
            groups.setdefault(same, {})[case] = [number for quoted, number in NUMBER.findall(fact) if not quoted]
            places[same] = max(place, places.get(same, 0))
            remedies.setdefault(same, remedy)
    for same in sorted(groups, key=lambda words: places[words]):
        numbers = zip(*groups[same].values(), strict=True)
        remedy = f": {remedies[same]}" if remedies[same] else ""
        yield f"{same.format(*map(_range, numbers))} ({of_cases(list(groups[same]))}){remedy}"


def _range(numbers: Sequence[str]) -> str:
    """Return the range of numbers, each of which may be a range itself."""
    ends = [end for number in numbers for end in number.split(" to ")]
    low, high = min(ends, key=float), max(ends, key=float)
    return low if float(low) == float(high) else f"{low} to {high}"


def _calibration(results: Results) -> Iterator[str]:
    calibration = results.calibration
    if calibration is None:
        return
    if calibration.verdict == "out of reach" and results.no_answer("calibrate") is not None:
        yield (
            "no factor on the strength of the discs gives the critical Kh of the finite elements, so no slide of discs "
            'was computed: take more discs (dem.elements), or dem.out_of_reach = "go on" for the nearest factor'
        )
    elif calibration.verdict == "out of reach":
        yield (
            "calibration failed, since no factor on the strength of the discs gives the critical Kh of the finite "
            "elements, so that the slides of the discs are those of another strength: take more discs (dem.elements), "
            "or rely on material points"
        )
    elif not 1.0 / CALIBRATION_RATIO <= calibration.value <= CALIBRATION_RATIO:
        name = calibration.parameter.replace("_", " ")
        parameters = {"all": "all constants", "strength": "the strength"}.get(name, f"the {name}")
        yield (
            f"the discs fail at the critical Kh of the finite elements only with {parameters} of the contacts "
            f"multiplied by {calibration.value:.2g}: compare the element tests of the layers"
        )
