"""Writes the third number of the first page: the slide after liquefaction, or the displacement of a rigid block."""

from collections.abc import Mapping

from meshes.section.cutting import shown_name
from workflow.earthquake.settings import EarthquakeSettings
from workflow.estimates.slide_error import SlideError
from workflow.report.model_error import NAMES
from workflow.report.numbers import SMALLEST_SLIDE, rough_range, span
from workflow.report.summary_text import at_rest
from workflow.results.cases import CaseAnswer
from workflow.results.governing import MethodSlides, estimates_of, slides_by_weight
from workflow.results.lengths import metres
from workflow.results.material_points import PointCase
from workflow.results.results import Results
from workflow.results.verdicts import HeadlinePart
from workflow.texts.report_texts import Texts

UNDER_KH = "rigid block on the slip surface"  # beginning of the name of a block under cycles of Kh
NEWMARK = "Newmark's block"  # name of this method among those for a rigid block


def slide_headline(results: Results, _: Texts) -> HeadlinePart:
    """Write the slide after liquefaction by the method that counts, and the other method as a second opinion."""
    name = _("slide after liquefaction")
    _set, cases = results.case_set()
    points = dict(results.mpm.cases) if results.mpm is not None else {}
    if not cases and not points:
        if not results.config.section.liquefies:
            return _block(results, _)
        entry = results.no_answer("calibrate") or results.no_answer("slide")
        reason = entry.reason if entry is not None else _("the slides were not computed")
        if entry is None and results.mpm is not None and results.mpm.not_possible:
            reason = _.sentence(results.mpm.not_possible)
        phrase = _("The slide after liquefaction is not known: {reason}.", reason=reason)
        return HeadlinePart(name=name, value="–", interval="", conclusion=phrase)
    names = (shown_name(s.name) for s in results.config.section.strata if s.liquefies_in)
    first, *others = slides_by_weight(results)
    phrase = _(
        "After liquefaction of {layers}, under {shaking}, the surface slides {slide} by {method} ({count}) and {end}.",
        layers=_.listed(list(dict.fromkeys(names))),
        shaking=_.sentence(results.config.slide.shaking),
        slide=_span(first, _),
        method=_(NAMES[first.method]),
        count=_of_cases(first, _),
        end=_end_words(first.cases, _),
    )
    for other in others:
        phrase += " " + _second_opinion(first, other, _)
    return HeadlinePart(name=name, value=_span(first, _), interval=_of_slides(first, _), conclusion=phrase)


def _second_opinion(first: MethodSlides, other: MethodSlides, _: Texts) -> str:
    """Return the reason why the first method counts, and the slide by the other method with its interval."""
    values = {
        "first": _(NAMES[first.method]),
        "other": _(NAMES[other.method]),
        "slide": _span(other, _),
        "interval": _spread(other, _),
    }
    if first.error is None or other.error is None:
        return _("A second opinion, by {other}, is {slide} ({interval}).", **values)
    return _(
        "This number counts, because {first} predicted half of the known {kind} within a factor of {near}, and {other} "
        "within {far}. A second opinion, by {other}, is {slide} ({interval}).",
        kind=_(first.error.kind),
        near=f"{first.error.middle:.2g}",
        far=f"{other.error.middle:.2g}",
        **values,
    )


def _spread(slides: MethodSlides, _: Texts) -> str:
    """Return the interval of a second opinion, in few words."""
    if slides.error is None or slides.interval is None:
        return _("the error on known slides is not known")
    if 2 * slides.error.within < slides.error.cases:
        return _("known slides of this kind were not predicted")
    return _("{span} with the error on known slides", span=rough_range(*slides.interval))


def block_slides(results: Results) -> dict[str, float]:
    """Return the displacement (m) of a rigid block in the earthquake by every method; empty without an earthquake.

    A record of `[sliding_block]`, in both directions, takes the place of the cycles of Kh.
    """
    config = results.config
    has_record = bool(config.sliding_block.accelerogram)
    slides: dict[str, float] = {}
    for row in estimates_of(results) if has_record or config.earthquake != EarthquakeSettings() else ():
        if row.kind not in ("block", "block regression") or row.displacement_m is None:
            continue
        if row.kind == "block" and row.method.startswith(UNDER_KH):
            if not has_record:
                slides[NEWMARK] = row.displacement_m
        elif not row.method.endswith(", mean"):
            slides[row.method] = row.displacement_m
    return slides


def _block(results: Results, _: Texts) -> HeadlinePart:
    """Return the displacement of a rigid block in the earthquake, if nothing liquefies."""
    slides = {
        _("Newmark's block") if method == NEWMARK else _.sentence(method): slide
        for method, slide in block_slides(results).items()
    }
    if not slides:
        phrase = _("No layer of the section liquefies, so no slide was computed.")
        return HeadlinePart(name=_("slide after liquefaction"), value="–", interval="", conclusion=phrase)
    slides_by_method = [
        _("{slide} by {method}", slide=metres(slide), method=method) for method, slide in slides.items()
    ]
    phrase = _(
        "No layer of the section liquefies. In the earthquake the ground that fails slides as a rigid block: {each}.",
        each=_.listed(slides_by_method),
    )
    number = len({method.partition(", ")[0] for method in block_slides(results)})  # both directions are one method
    interval = _("by {number} methods for a rigid block without loss of strength", number=number)
    name = _("displacement in the earthquake")
    return HeadlinePart(name=name, value=span(list(slides.values())), interval=interval, conclusion=phrase)


def _of_cases(slides: MethodSlides, _: Texts) -> str:
    """Return the number of cases that the printed slide, or range of slides, is of."""
    number = len(slides.cases)
    if number == 1:
        return _("one case")
    if max(slides.largest) < SMALLEST_SLIDE or " to " not in span(slides.largest):
        return _("in each of {number} cases of residual strength", number=number)
    return _("range of {number} cases of residual strength", number=number)


def _span(slides: MethodSlides, _: Texts) -> str:
    """Return the largest slides of all cases as a range. The slide of a case that reaches a side of the model, or was
    still moving at the end, is a lower limit: the range is open above, and has one end if every case does."""
    if max(slides.largest) < SMALLEST_SLIDE:
        return f"< {SMALLEST_SLIDE:g} m"
    low, high = metres(min(slides.largest)), metres(max(slides.largest))
    unfinished = [not at_rest(case) for case in slides.cases.values()]
    if not any(unfinished):
        return span(slides.largest)
    if all(unfinished) or low == high:
        return _("over {low}", low=low)
    return _("{low} to over {high}", low=low.removesuffix(" m"), high=high)


def _end_words(cases: Mapping[int, CaseAnswer | PointCase], _: Texts) -> str:
    """Return how the slides end, and the cases that end so if others come to rest."""
    flowing = [number for number, case in cases.items() if isinstance(case, CaseAnswer) and case.flows]
    stopped = [number for number, case in cases.items() if case.stopped_by is not None]
    moving = [number for number, case in cases.items() if not at_rest(case)]
    for numbers, end in (
        (flowing, _("flows by its weight alone")),
        (stopped, _("reaches a side of the model, so that it would slide farther in a longer section")),
        (moving, _("was still moving when the computation ended")),
    ):
        if len(numbers) == len(cases):
            return end
        if len(numbers) == 1:
            return _("in case {number} {end}", number=numbers[0], end=end)
        if numbers:
            return _("in cases {number} {end}", number=_.listed(list(map(str, numbers))), end=end)
    return _("comes to rest")


def _of_slides(slides: MethodSlides, _: Texts) -> str:
    """Return the interval of the largest slide of a method by its error on known slides."""
    error, method = slides.error, _(NAMES[slides.method])
    if error is None or slides.interval is None:
        return _("the error on known slides is not known")
    if 2 * error.within < error.cases:
        return _("no interval: {method} did not predict the known slides of this kind", method=method)
    if not error.bounds_slides:
        return _uncertain(error, method, _) + _numerical(slides, error, _)
    low, high = slides.interval
    values = {"within": error.within, "cases": error.cases, "factor": f"{error.factor:g}", "method": method}
    if not all(at_rest(case) for case in slides.cases.values()):  # nothing limits the slide
        return _(
            "{least} or more by the error of {method}: they predicted {within} of {cases} known slides within a factor "
            "of {factor}",
            least=rough_range(low, low),
            **values,
        )
    known = _(
        "{span} by the error of {method}: they predicted {within} of {cases} known slides within a factor of {factor}",
        span=rough_range(low, high),
        **values,
    )
    return known + _numerical(slides, error, _)


def _numerical(slides: MethodSlides, error: SlideError, _: Texts) -> str:
    """Return the interval by the numerical error if its lower end is below that by the error on known slides."""
    if slides.ends[0] >= min(slides.largest) / error.factor:
        return ""
    return _("; the numerical error alone gives {span}", span=span(slides.ends))


def _uncertain(error: SlideError, method: str, _: Texts) -> str:
    """Return the error of a method whose error is too large for an interval."""
    return _(
        "uncertain by a factor of {factor}: {within} of {cases} known slides were predicted within this factor by "
        "{method}, half of them within a factor of {middle}",
        factor=f"{error.factor:g}",
        within=error.within,
        cases=error.cases,
        method=method,
        middle=f"{error.middle:.2g}",
    )
