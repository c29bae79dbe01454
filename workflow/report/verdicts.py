"""States verdicts on the criteria: satisfied, not satisfied, or not decided."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from meshes.section.stratum import cases_of
from workflow.criteria.settings import common_verdict, judge
from workflow.estimates.crest import freeboard
from workflow.estimates.structures import structures_of
from workflow.report.crests import crest_parts, water_at_crest
from workflow.report.slide_headline import block_slides
from workflow.report.structures import FaceRow, face_rows
from workflow.report.summary_text import at_rest
from workflow.results.cases import MovedSurface
from workflow.results.governing import faces_with_bounds, governing_face_value, governing_factor, governing_kh
from workflow.results.lengths import metres
from workflow.results.results import Results
from workflow.results.slices import CirclePart, FacePart, SlicesAnswer
from workflow.results.verdicts import Criterion, VerdictPart
from workflow.texts.report_texts import Texts

Interval = tuple[str, float | None, float | None, str]  # of what, ends of the interval, why there is no answer
AT_LEAST: tuple[Criterion, ...] = ("factor of safety", "critical Kh", "freeboard")
OF_FACES: tuple[Criterion, ...] = ("factor of safety", "critical Kh")  # of structures, where there are any
OPEN_END = float("inf")  # the upper end of what still grows
BY_BOUNDS = "the section by strict bounds"
BLOCK = "rigid block without loss of strength"
SMALLEST_SPREAD = 1e-3  # m: slides of less have no spread


def verdicts(results: Results) -> list[VerdictPart]:
    """Return verdicts on every quantity with a limit, for every structure and every method."""
    limits = results.config.criteria
    parts: list[VerdictPart] = []
    if (factor := limits.factor_of_safety) is not None:
        parts += _verdict_parts(
            "factor of safety", factor.limit, factor.source, _factors(results, factor.kh), factor.kh
        )
    if (kh := limits.critical_kh) is not None:
        parts += _verdict_parts("critical Kh", kh.limit, kh.source, _critical(results))
    if (far := limits.displacement) is not None:
        parts += _verdict_parts("displacement", float(far.limit), far.source, _displacements(results))
    if (fall := limits.crest_settlement) is not None:
        parts += _verdict_parts("crest settlement", float(fall.limit), fall.source, _settlements(results))
    if (height := limits.freeboard) is not None:
        parts += _verdict_parts("freeboard", float(height.limit), height.source, _freeboards(results))
    return parts


def _verdict_parts(
    criterion: Criterion, limit: float, source: str, ranges: Iterator[Interval], kh: float | None = None
) -> Iterator[VerdictPart]:
    answers = list(ranges) or [("the section", None, None, "it was not computed")]
    for subject, low, high, reason in answers:
        verdict = judge(low, high, limit, criterion in AT_LEAST)
        if verdict == "not decided" and not reason:
            reason = "the limit lies inside the interval"
        yield VerdictPart(
            criterion=criterion,
            subject=subject,
            low=None if low is None or abs(low) == OPEN_END else low,
            high=None if high is None or abs(high) == OPEN_END else high,
            limit=limit,
            kh=kh,
            source=source,
            verdict=verdict,
            reason=reason if verdict == "not decided" else "",
        )


def _factors(results: Results, kh: float) -> Iterator[Interval]:
    for of, face in _sliding(results):
        yield from _by_slices(of, [circle for group in face.factors if group.kh == kh for circle in group.circles])
        if kh == 0.0:
            yield from _by_elements(results, of, face, "factor of safety")
    fem = results.fem
    if kh == 0.0:
        yield from _factor_of_failure(results)
    for group in fem.safety_factors if fem is not None else ():
        if group.kh == kh and _is_of_section(results, group.slip_surface):
            least = governing_factor(results, group)
            most = max(group.factor, group.upper) if least == group.factor else least
            yield "the section by finite elements", least, most, ""


def _factor_of_failure(results: Results) -> Iterator[Interval]:
    """Yield the factor of safety of ground that fails by its weight, which has no other result of finite elements."""
    if (failure := results.failure) is not None and _is_of_section(results, failure.slip_surface):
        upper = results.upper_factor_at_rest
        least = failure.factor if upper is None else min(failure.factor, upper)
        yield "the section by finite elements", least, least, ""


def _critical(results: Results) -> Iterator[Interval]:
    for of, face in _sliding(results):
        critical = face.critical
        yield from _by_slices(of, critical if isinstance(critical, tuple) else () if critical is None else (critical,))
        yield from _by_elements(results, of, face, "critical Kh")
    governing, fem, bounds = governing_kh(results), results.fem, results.bounds
    if results.fails_at_rest and bounds is not None:
        upper = bounds.upper_number
        yield BY_BOUNDS, -OPEN_END, 0.0 if upper is None else min(upper, 0.0), ""
    elif (failure := results.failure) is not None and _is_of_section(results, failure.slip_surface):
        yield "the section by finite elements", -OPEN_END, 0.0, ""
    if governing is None or fem is None:
        return
    if (strict := governing.opposite_bounds) is not None:
        # Where structures have faces, these bounds belong to the face of their direction.
        if results.faces is None or not structures_of(results.config.section):
            yield BY_BOUNDS, -OPEN_END if strict.lower is None else strict.lower, strict.upper, ""
    elif _is_of_section(results, results.slip_surface):
        least = most = governing.value
        if governing.bound is None:
            most = max(most, fem.kc_upper)
        if governing.is_limit:  # the bounds are too wide for a number, or one is missing
            ends = governing.interval
            least = -OPEN_END if ends is None and governing.bound == "upper" else least if ends is None else ends.low
            most = most if ends is None else ends.high
        yield "the section by finite elements", least, most, ""


def _is_of_section(results: Results, surface: Sequence[Sequence[float]] | np.ndarray) -> bool:
    """Return whether a mechanism of the finite elements counts: in a section with structures only if a crest slides
    with it.
    """
    return not any(isinstance(face, FacePart) for _, face in _sliding(results)) or not spared_structures(
        results, surface
    )


def spared_structures(results: Results, surface: Sequence[Sequence[float]] | np.ndarray) -> list[str]:
    """Return the names of the structures if none of their crests lies above a slip surface (n, 2) in m; else empty."""
    structures = structures_of(results.config.section)
    points = [(float(x), float(z)) for x, z in surface]
    if not points or any(structure.slides_with(points) for structure in structures):
        return []
    return [structure.name for structure in structures]


def _sliding(results: Results) -> list[tuple[str, FacePart | SlicesAnswer]]:
    """Return the faces that have slip circles, by name, or the whole section if it has no structures; the result is
    empty if no slip circles were computed."""
    if results.slices is None:
        return []
    faces: list[tuple[str, FacePart | SlicesAnswer]] = [
        (f"{face.structure}, towards the {face.towards}", face) for face in results.slices.faces if not face.reason
    ]
    return faces or [("the section", results.slices)]


def _by_slices(of: str, circles: Sequence[CirclePart]) -> Iterator[Interval]:
    """Yield the interval between Bishop's and Spencer's results on the circle with the smallest result."""
    if not circles:
        yield f"{of}, by slices", None, None, "no circle slides"
        return
    least = min(circles, key=lambda circle: circle.bishop)
    factors = [least.bishop, *([] if least.spencer is None else [least.spencer])]
    yield f"{of}, by slices", min(factors), max(factors), ""


def _by_elements(results: Results, of: str, face: FacePart | SlicesAnswer, criterion: Criterion) -> Iterator[Interval]:
    """Yield the result of a face by finite elements, or the strict bound that the elements lie beyond."""
    faces = faces_with_bounds(results)
    if faces is None or not isinstance(face, FacePart):
        return
    strength = faces.of(face.structure, face.towards)
    value = None if strength is None else strength.critical if criterion == "critical Kh" else strength.safety
    if value is not None and value.reaches_crest:
        least = governing_face_value(value)
        yield f"{of}, by finite elements", least, least, ""


def _displacements(results: Results) -> Iterator[Interval]:
    config = results.config
    for row in face_rows(config, results.slices, faces_with_bounds(results)):
        of = f"{row.name}, {BLOCK}"
        if row.block is not None:
            yield of, row.block.low, row.block.high, ""
        elif row.block_kh is not None:
            reason = "a constant Kh above the critical Kh moves it without end"
            yield of, None, None, "it slides without any shaking" if row.block_kh <= 0.0 else reason
    _, cases = results.case_set()
    slides: list[tuple[str, MovedSurface, bool, tuple[float, float]]] = [
        (f"discs, {config.called(number)}", case, at_rest(case), _packing_ratios(results, number))
        for number, case in sorted(cases.items())
    ]
    slides += [
        (
            f"material points, {config.called(number)}",
            case,
            at_rest(case),
            (
                case.slide_max_low_m / max(case.slide_max_m, SMALLEST_SPREAD),
                case.slide_max_high_m / max(case.slide_max_m, SMALLEST_SPREAD),
            ),
        )
        for number, case in (sorted(results.mpm.cases.items()) if results.mpm is not None else ())
    ]
    places = [
        (structure.name, structure.crest.start, structure.crest.end) for structure in structures_of(config.section)
    ]
    if not places:
        places = [("the section", *config.section.extent)]
        yield from _section_block(results)
    for name, start, end in places:
        for by, case, rests, (least, most) in slides:
            inside = np.abs(case.slides_between(start, end))
            if len(inside):
                slide = float(inside.max())
                high = most * slide if rests else OPEN_END
                yield f"{name}, {by}", least * slide, high, _unrest_reason(rests)
    yield from _not_computed(results)


def _section_block(results: Results) -> Iterator[Interval]:
    """Yield the displacement of a rigid block on the slip surface of a section without structures, as on the first
    page."""
    slides = block_slides(results)
    if slides:
        yield f"the section, {BLOCK}", min(slides.values()), max(slides.values()), ""


def _packing_ratios(results: Results, case: int) -> tuple[float, float]:
    """Return the ratios of both ends of the range of the largest slide over packings to the slide of the packing of
    this run."""
    random = results.cases.random.cases.get(case) if results.cases is not None and results.cases.random else None
    largest = results.case_set()[1][case].slide_max_m
    if random is None or random.slide_max_m.low is None or random.slide_max_m.high is None or largest < SMALLEST_SPREAD:
        return 1.0, 1.0
    return min(random.slide_max_m.low / largest, 1.0), max(random.slide_max_m.high / largest, 1.0)


def _settlements(results: Results) -> Iterator[Interval]:
    for part in crest_parts(results.config, results.cases, results.mpm):
        high = part.settlement_high_m if part.at_rest else OPEN_END
        yield f"{part.structure}, {part.method}", part.settlement_low_m, high, _unrest_reason(part.at_rest)
    for row in _blocks(results):
        yield f"{row.name}, {BLOCK}", 0.0, row.block.high if row.block else None, ""
    yield from _not_computed(results)
    yield from _without_crest(results)


def _freeboards(results: Results) -> Iterator[Interval]:
    for part in crest_parts(results.config, results.cases, results.mpm):
        of = f"{part.structure}, {part.method}"
        if part.freeboard_high_m is None:
            yield of, None, None, "no water level is known at the crest"
        else:
            yield (
                of,
                part.freeboard_low_m if part.at_rest else -OPEN_END,
                part.freeboard_high_m,
                _unrest_reason(part.at_rest),
            )
    structures = {structure.name: structure for structure in structures_of(results.config.section)}
    for row in _blocks(results):
        structure = structures[row.face.structure]
        water = water_at_crest(results.config, structure)
        if water is None or row.block is None:
            yield f"{row.name}, {BLOCK}", None, None, "no water level is known at the crest"
        else:
            least, most = (freeboard(structure.crest.elevation, fall, water) for fall in (row.block.high, 0.0))
            yield f"{row.name}, {BLOCK}", least, most, ""
    yield from _not_computed(results)
    yield from _without_crest(results)


def _blocks(results: Results) -> list[FaceRow]:
    """Return the faces whose settlement is judged by the slide of a rigid block: all faces of sections in which nothing
    liquefies, since no other slide is computed for these sections."""
    if any(stratum.liquefies_in for stratum in results.config.section.strata):
        return []
    return [
        row for row in face_rows(results.config, results.slices, faces_with_bounds(results)) if row.block is not None
    ]


def _without_crest(results: Results) -> Iterator[Interval]:
    """Yield the reason why no crest settles, in a section without structures."""
    if not structures_of(results.config.section):
        yield "the section", None, None, "there is no crest; expected [[structures]] with its feet"


def _unrest_reason(at_rest: bool) -> str:
    return "" if at_rest else "the slide is not at rest"


def _not_computed(results: Results) -> Iterator[Interval]:
    """Yield the cases of liquefaction of which no slide was computed."""
    computed = {*results.case_set()[1], *(results.mpm.cases if results.mpm is not None else ())}
    for number in sorted({*cases_of(results.config.section.strata)} - computed):
        yield f"after liquefaction, {results.config.called(number)}", None, None, "no slide was computed"


def verdict_paragraph(parts: list[VerdictPart], texts: Texts | None = None, liquefies: bool = False) -> Iterator[str]:
    """Yield a sentence on every criterion, with the governing quantities, in the language of the ``texts``. If the
    section ``liquefies``, the sentence says that factors of safety and critical Kh are those without liquefaction."""
    _, phrases = texts or Texts(), []
    for criterion in dict.fromkeys(part.criterion for part in parts):
        parts_of_criterion = [part for part in parts if part.criterion == criterion]
        verdict = common_verdict(tuple(part.verdict for part in parts_of_criterion))
        deciding = [part for part in parts_of_criterion if part.verdict == verdict]
        worst = sorted(deciding, key=_excess, reverse=True)[:3] if verdict != "satisfied" else []
        reasons = [
            f"{_.sentence(part.subject)}: {_.sentence(part.reason) or _.sentence(interval_words(part))}"
            for part in worst
        ]
        reason_words = f" ({_.listed(reasons)})" if reasons else ""
        limit = _number(criterion, parts_of_criterion[0].limit)
        limit = _("at least {limit}", limit=limit) if criterion in AT_LEAST else _("at most {limit}", limit=limit)
        limit += _kh_words(parts_of_criterion[0], _)
        limit += _(", without liquefaction") if liquefies and criterion in OF_FACES else ""
        by_section = criterion not in OF_FACES or any(
            part.subject.startswith("the section") for part in parts_of_criterion
        )
        name = criterion if by_section else f"{criterion} of the faces of structures"
        source = f" [{parts_of_criterion[0].source}]" if parts_of_criterion[0].source else ""
        phrases.append(f"{_.sentence(name)} {limit}{source}: {_.sentence(verdict)}{reason_words}")
    if phrases:
        yield _("Criteria: {each}.").format(each="; ".join(phrases))


def limit_words(part: VerdictPart, texts: Texts) -> str:
    """Return the limit with its unit, and the Kh at which it applies, in the language of the ``texts``."""
    return _number(part.criterion, part.limit) + _kh_words(part, texts)


def _kh_words(part: VerdictPart, _: Texts) -> str:
    """Return the Kh at which a limit applies, after a blank; empty if there is none."""
    return "" if part.kh is None else _(" at Kh = {kh}", kh=f"{part.kh:g}")


def interval_words(part: VerdictPart) -> str:
    """Return the interval of the quantity with its unit, or a dash."""
    ends = [_shown(part, end) for end in (part.low, part.high) if end is not None]
    if len(ends) == 1:
        return f"{'at least' if part.high is None else 'at most'} {ends[0]}"
    return "–" if not ends else ends[0] if ends[0] == ends[1] else f"{ends[0].removesuffix(' m')} to {ends[1]}"


def _shown(part: VerdictPart, value: float) -> str:
    """Return the end of an interval with its unit, lengths in the digits of tables unless these digits place the end on
    the other side of the limit."""
    if part.criterion in ("factor of safety", "critical Kh"):
        return _number(part.criterion, value)
    short = metres(value)
    return short if (float(short.removesuffix(" m")) > part.limit) == (value > part.limit) else f"{value:.2f} m"


def _excess(part: VerdictPart) -> float:
    """Return by how much the worse end of an interval exceeds the limit, infinite if the interval is open there."""
    if part.low is None and part.high is None:
        return -math.inf
    is_least = part.criterion in AT_LEAST
    end = part.low if is_least else part.high
    return math.inf if end is None else part.limit - end if is_least else end - part.limit


def _number(criterion: Criterion, value: float) -> str:
    if criterion == "factor of safety":
        return f"{value:.2f}"
    return f"{value:.3f}" if criterion == "critical Kh" else f"{value:.2f} m"
