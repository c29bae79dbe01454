"""The first page of the report: three numbers with their intervals, and one sentence of conclusion for each."""

from collections.abc import Iterator, Mapping, Sequence

from dem.settings import SlideMethod
from meshes.section.cutting import shown_name
from meshes.section.quantity import GRAVITY
from workflow.earthquake.settings import EarthquakeSettings
from workflow.estimates.comparison import estimates
from workflow.estimates.slide_error import slide_error
from workflow.estimates.structures import structures_of
from workflow.report.accuracy import METHODS, Accuracy, accuracy, proven_by, rounded_up
from workflow.report.faces import face_lines
from workflow.report.numbers import coefficient, of_cases, rough_range, span
from workflow.report.paper import rows
from workflow.report.residual import residual_verdict
from workflow.report.summary_text import CONTRADICTED, at_rest
from workflow.report.texts import Texts
from workflow.report.verdicts import spared
from workflow.results.answer import FORCE
from workflow.results.cases import CaseAnswer
from workflow.results.continuum import FactorOfSafety, FemAnswer
from workflow.results.lengths import metres
from workflow.results.material_points import PointCase
from workflow.results.results import Results
from workflow.results.verdicts import HeadlinePart

CLOSE_BOUNDS = 0.95  # of the upper bound: a lower one above it tells the critical Kh better than coarse elements
LEAST_SLIDE = 0.1  # m: discs do not resolve less
NAMES: Mapping[SlideMethod, str] = {"discs": "discs", "mpm": "material points"}
FLOW: Mapping[str, str] = {
    "associated": "associated flow, ψ = φ",
    "davis": "Davis reduced strength",
    "section": "non-associated flow with the given ψ",
}
IN_FULL = {**FLOW, "davis": "Davis reduced strength, for soil that dilates less than ψ = φ"}  # where it is first named
SIDES: Mapping[str, str] = {
    "free-field": "free-field sides", "smooth": "smooth sides", "fixed": "fixed sides", "periodic": "periodic sides",
}  # fmt: skip


def headlines(results: Results, _: Texts) -> tuple[HeadlinePart, ...]:
    """Write the three numbers: critical Kh, factor of safety without shaking, and slide after liquefaction; or
    the displacement of a rigid block in the earthquake, where nothing liquefies.

    Parameters
    ----------
    results : Results
        Results of the stages; a missing number becomes a dash with its reason.
    _ : Texts
        The texts in the language of the report.
    """
    three = (_critical(results, _), _safety(results, _), _slide(results, _))
    return tuple(headline.model_copy(update={"value": _.sentence(headline.value)}) for headline in three)


def _critical(results: Results, _: Texts) -> HeadlinePart:
    fem, name = results.fem, _("critical Kh")
    entry = results.no_answer("fem")
    if fem is None or entry is not None:
        reason = entry.reason if entry is not None else _("the finite element analysis was not run")
        return HeadlinePart(name=name, value="–", interval="", conclusion=_("No critical Kh: {reason}.", reason=reason))
    if not fem.has_kc:
        least = coefficient(fem.kc_lower)
        if fem.verdict == "no failure":
            phrase = _("The section stands at every Kh up to {kh}, where the search ended.", kh=least)
            return HeadlinePart(name=name, value=f"> {least}", interval="", conclusion=phrase)
        phrase = _("The critical Kh was not found: {reason}.", reason=fem.reason)
        return HeadlinePart(name=name, value=f"≥ {least}", interval="", conclusion=phrase)
    error = accuracy(results, fem)
    conditions = _("{sides}, {flow}", sides=_(SIDES[fem.settings.sides]), flow=_(IN_FULL[fem.flow]))
    if error is not None and fem.kc > CONTRADICTED * error.high:
        return _contradicted(results, fem, error, conditions, _)
    phrase = _(
        "The section fails {way} at Kh = {kc} ({acceleration} m/s²), with {conditions}.",
        way=_way(results, fem, _),
        kc=coefficient(fem.kc),
        acceleration=f"{fem.kc * GRAVITY:.2g}",
        conditions=conditions,
    )
    if fem.davis is not None and fem.flow == "associated":
        phrase += " " + _(
            "With Davis reduced strength, a low estimate for soil that dilates less, it is {kc}.",
            kc=coefficient(fem.davis.kc) if fem.davis.verdict in ("plateau", "peak") else "0",
        )
    if names := spared(results, results.slip_surface):
        x = [point[0] for point in results.slip_surface]
        phrase += " " + _(
            "This mechanism reaches from x = {left} to {right} m, and no crest slides with it ({structures}).",
            left=f"{min(x):.0f}",
            right=f"{max(x):.0f}",
            structures=_.listed(names),
        )
        phrase += _first_face(results, _)
    return HeadlinePart(name=name, value=coefficient(fem.kc), interval=_interval(error, _), conclusion=phrase)


def _first_face(results: Results, _: Texts) -> str:
    """The face of a structure that fails first by finite elements, as a sentence after a blank; empty without any."""
    lines = [(line.critical.elements, line) for line in face_lines(results) if line.of_structure]
    known = [(kc, line) for kc, line in lines if kc is not None]
    if not known:
        return ""
    kc, line = min(known, key=lambda pair: pair[0])
    low = line.critical.davis
    values = {"structure": line.name, "side": _.sentence(line.side), "kc": coefficient(kc)}
    if low is None or line.safety.elements is None:
        return " " + _("Of the crests, {structure} slides first ({side}), at Kh = {kc}.", **values)
    return " " + _(
        "Of the crests, {structure} slides first ({side}), at Kh = {kc} ({davis} with Davis reduced strength); without "
        "shaking its factor of safety is {factor}.",
        **values,
        davis=coefficient(low),
        factor=f"{line.safety.elements:.2f}",
    )


def _way(results: Results, fem: FemAnswer, _: Texts) -> str:
    """The direction of failure: downslope or upslope, or the side for ground that falls to both sides."""
    if structures_of(results.config.section):
        return _("to the {side}", side=_(fem.towards))
    return _("{direction}, to the {side},", direction=_(FORCE[fem.direction]), side=_(fem.towards))


def _contradicted(results: Results, fem: FemAnswer, error: Accuracy, conditions: str, _: Texts) -> HeadlinePart:
    """The sentence on the critical Kh if strict bounds are below the finite elements: the bounds themselves if they are
    close, else the upper bound as a limit.
    """
    if error.low >= CLOSE_BOUNDS * error.high:
        phrase = _(
            "The section fails {way} at Kh = {low} to {high} {method}; the finite elements give {kc}, which is "
            "{excess} % more ({conditions}).",
            way=_way(results, fem, _),
            low=coefficient(error.low),
            high=coefficient(error.high),
            method=_(error.method),
            kc=coefficient(fem.kc),
            excess=f"{100.0 * (fem.kc / error.high - 1.0):.1f}",
            conditions=conditions,
        )
        value = coefficient(error.high)
    else:
        phrase = _(
            "The section fails at Kh = {high} {method}, below the {kc} of the finite elements: use {high} as an upper "
            "limit ({conditions}).",
            high=coefficient(error.high),
            method=_(error.method),
            kc=coefficient(fem.kc),
            conditions=conditions,
        )
        value = f"≤ {coefficient(error.high)}"
    return HeadlinePart(name=_("critical Kh"), value=value, interval=_interval(error, _), conclusion=phrase)


def _interval(error: Accuracy | None, _: Texts) -> str:
    if error is None:
        return _("numerical error not known: one mesh, no strict bounds")
    return _from_to(coefficient(error.low), coefficient(error.high), error.method, _)


def _from_to(low: str, high: str, method: str, _: Texts) -> str:
    """An interval and its method; one number where both ends are the same."""
    both = _("{low} to {high}", low=low, high=high) if low != high else low
    return _("{interval} {method}", interval=both, method=_(method))


def _safety(results: Results, _: Texts) -> HeadlinePart:
    fem, name = results.fem, _("factor of safety")
    factor = (
        next((candidate for candidate in fem.safety_factors if candidate.kh == 0.0), None) if fem is not None else None
    )
    entry = results.no_answer("fem")
    if entry is not None:
        phrase = _("No factor of safety: {reason}.", reason=entry.reason)
        return HeadlinePart(name=name, value="–", interval="", conclusion=phrase)
    if fem is None or factor is None:
        phrase = _("No factor of safety was computed; fem.safety_factor_at = [0.0] asks for one.")
        return HeadlinePart(name=name, value="–", interval="", conclusion=phrase)
    if factor.verdict == "no failure":
        phrase = _(
            "Without shaking the section stands with its strength divided by {factor}.", factor=f"{factor.factor:.2f}"
        )
        return HeadlinePart(name=name, value=f"> {factor.factor:.2f}", interval="", conclusion=phrase)
    word = "Without shaking the section stands, with a factor of safety of {factor} ({flow})."
    if factor.factor < 1.0:
        word = "Without shaking the section does not stand: its factor of safety is {factor} ({flow})."
    phrase = _(word, factor=f"{factor.factor:.2f}", flow=_(FLOW[fem.flow]))
    if factor.davis is not None:
        phrase += " " + _("With Davis reduced strength the factor of safety is {factor}.", factor=f"{factor.davis:.2f}")
    interval = _of_safety(results, fem, factor, _)
    value = f"{factor.factor:.2f}" if interval else "–"  # a number whose error nobody knows is no headline
    unknown = _("numerical error not known: one mesh, no strict bounds")
    return HeadlinePart(name=name, value=value, interval=interval or unknown, conclusion=phrase)


def _of_safety(results: Results, fem: FemAnswer, factor: FactorOfSafety, _: Texts) -> str:
    """The interval of a factor of safety: strict bounds of the same conditions, else the error of its mesh, else the
    distance of the critical Kh of the same mesh from its strict bounds. The interval is empty if none of these is
    known.
    """
    bounds = results.bounds
    if bounds is not None and bounds.sides == fem.settings.sides and fem.flow == "associated":
        for strict in bounds.safety:
            if strict.kh == factor.kh and strict.lower is not None and strict.upper is not None:
                low, high = f"{strict.lower:.2f}", f"{strict.upper:.2f}"
                return _from_to(low, high, proven_by(strict.shallow_failure is not None), _)
    if factor.rest is not None:
        low = f"{factor.factor * (1.0 - factor.rest):.2f}"
        return _from_to(low, f"{factor.factor:.2f}", METHODS[0], _)
    error = accuracy(results, fem)
    if error is None or not fem.has_kc or error.low <= 0.0:
        return ""
    return _(
        "computed on one mesh, whose critical Kh has an error of at most {error} % {method}",
        error=f"{100.0 * rounded_up(error.error(fem.kc) / error.low):g}",
        method=_(error.method),
    )


def _slide(results: Results, _: Texts) -> HeadlinePart:
    name = _("slide after liquefaction")
    _set, cases = results.case_set()
    points = dict(results.mpm.cases) if results.mpm is not None else {}
    if not cases and not points:
        if not results.config.section.liquefies:
            return _block(results, _)
        entry = results.no_answer("calibrate") or results.no_answer("slide")
        reason = entry.reason if entry is not None else _("the slides were not computed")
        phrase = _("The slide after liquefaction is not known: {reason}.", reason=reason)
        return HeadlinePart(name=name, value="–", interval="", conclusion=phrase)
    count = max(len(cases), len(points))
    by = [_("{slide} by calibrated discs", slide=_span(cases))] if cases else []
    by += [_("{slide} by material points", slide=_span(points))] if points else []
    names = (shown_name(s.name, quoted=False) for s in results.config.section.strata if s.liquefies_in)
    phrase = _(
        "After liquefaction of {layers}, under {shaking}, the surface slides {slide} ({count}) and {end}.",
        layers=_.listed(list(dict.fromkeys(names))),
        shaking=_.sentence(results.config.slide.shaking),
        slide=_.listed(by),
        count=_("one case") if count == 1 else _("{number} cases of residual strength", number=count),
        end=_end([*cases.values(), *points.values()], _),
    )
    value = _span({**cases, **{-number: point for number, point in points.items()}})
    return HeadlinePart(name=name, value=value, interval=_of_slides(results, _), conclusion=phrase)


def _block(results: Results, _: Texts) -> HeadlinePart:
    """The displacement of a rigid block in the earthquake, where nothing liquefies."""
    config = results.config
    has_shaking = config.earthquake != EarthquakeSettings() or bool(config.sliding_block.accelerogram)
    slides = {
        _("Newmark's block") if row.kind == "block" else row.method: row.displacement_m
        for row in (estimates(config.section, config, results.kc, results.slip_surface) if has_shaking else ())
        if row.kind in ("block", "block regression") and row.displacement_m is not None
    }
    if not slides:
        phrase = _("No layer of the section liquefies, so no slide was computed.")
        return HeadlinePart(name=_("slide after liquefaction"), value="–", interval="", conclusion=phrase)
    each = [_("{slide} by {method}", slide=metres(slide), method=method) for method, slide in slides.items()]
    phrase = _(
        "No layer of the section liquefies. In the earthquake the ground that fails slides as a rigid block: {each}.",
        each=_.listed(each),
    )
    interval = _("by {number} methods for a rigid block without loss of strength", number=len(slides))
    name = _("displacement in the earthquake")
    return HeadlinePart(name=name, value=span(list(slides.values())), interval=interval, conclusion=phrase)


Slides = Mapping[int, CaseAnswer] | Mapping[int, PointCase] | Mapping[int, CaseAnswer | PointCase]


def _span(cases: Slides) -> str:
    slides = [max(case.slide_max_m, 0.0) for case in cases.values()]
    return f"< {LEAST_SLIDE:g} m" if max(slides) < LEAST_SLIDE else span(slides)


def _end(cases: Sequence[CaseAnswer | PointCase], _: Texts) -> str:
    if any(isinstance(case, CaseAnswer) and case.flows for case in cases):
        return _("flows by its weight alone")
    if all(at_rest(case) for case in cases):
        return _("comes to rest")
    if any(case.stopped_by is not None for case in cases):
        return _("reaches a side of the model, so that it would slide farther in a longer section")
    return _("was still moving when the computation ended")


def _of_slides(results: Results, _: Texts) -> str:
    """The interval of the largest slide by the method that predicted known slides better, with its error."""
    predicted = _predicted(results)
    known = {case.flows for case in results.case_set()[1].values()}
    flows = known.pop() if len(known) == 1 else None
    errors = [error for method in predicted if (error := slide_error(flows, method)) is not None]
    if not errors:
        return _("the error on known slides is not known")
    error = min(errors, key=lambda error: error.middle)
    moved, method = predicted[error.method], _(NAMES[error.method])
    if 2 * error.within < error.cases:
        return _("no interval: {method} did not predict the known slides of this kind", method=method)
    if not error.bounds_slides:
        return _(
            "uncertain by a factor of {factor}: {within} of {cases} known slides were predicted within it by {method}, "
            "half of them within a factor of {middle}",
            factor=f"{error.factor:g}",
            within=error.within,
            cases=error.cases,
            method=method,
            middle=f"{error.middle:.2g}",
        )
    return _(
        "{span} by the error of {method}: they predicted {within} of {cases} known slides within a factor of {factor}",
        span=rough_range(*error.interval(min(moved), max(moved))),
        within=error.within,
        cases=error.cases,
        factor=f"{error.factor:g}",
        method=method,
    )


def _predicted(results: Results) -> dict[SlideMethod, list[float]]:
    """Largest slides (m) by method, over cases and packings that slide downhill."""
    random = results.cases.random if results.cases is not None else None
    discs = [case.slide_max_m for case in results.case_set()[1].values()]
    for case in random.cases.values() if random is not None else ():
        discs += case.slide_max_m.values
    points = [case.slide_max_m for case in results.mpm.cases.values()] if results.mpm is not None else []
    slides: dict[SlideMethod, list[float]] = {"discs": discs, "mpm": points}
    moved = {method: [slide for slide in lengths if slide > 0.0] for method, lengths in slides.items()}
    return {method: lengths for method, lengths in moved.items() if lengths}


def conclusions(results: Results, _: Texts) -> Iterator[str]:
    """Sentences of the first page after the numbers: choice of Kh, governing slide, and the paper."""
    yield from _without_shaking(results, _)
    if results.residual is not None:
        yield residual_verdict(results.residual.steps, _)
    yield from _why_kh(results, _)
    if results.cases is not None and len([name for name, cases in results.cases.sets.items() if cases]) > 1:
        yield _(
            "The slides of the calibrated discs govern; those of discs with the springs of the paper are for "
            "comparison."
        )
    compared = [row for row in rows(results) if row.agrees is not None]
    off = [row for row in compared if not row.agrees]
    if off:
        discs = [row for row in compared if "calibrated" in row.quantity]
        yield _(
            "{off} of {all} comparisons with the paper disagree; of the {discs} for the calibrated discs "
            "{off_discs} do: the depths of the layers are a reconstruction.",
            off=len(off),
            all=len(compared),
            off_discs=len([row for row in discs if not row.agrees]),
            discs=len(discs),
        )


def _without_shaking(results: Results, _: Texts) -> Iterator[str]:
    """A sentence on whether the continuum still stands after liquefaction, without shaking."""
    cases = results.liquefied.cases if results.liquefied is not None else ()
    flows = [number for case in cases if case.stands == "flows" for number in case.cases]
    stands = [number for case in cases if case.stands == "stands" for number in case.cases]
    if flows:
        yield _(
            "After liquefaction the section does not stand, even without shaking, in {cases}.", cases=of_cases(flows)
        )
    if stands:
        yield _("After liquefaction the section still stands without shaking in {cases}.", cases=of_cases(stands))


def _why_kh(results: Results, _: Texts) -> Iterator[str]:
    """A comparison of the constant Kh of the slides with the limit load after liquefaction."""
    slide = results.config.slide
    if results.liquefied is None or not results.case_set()[1] or slide.accelerogram or slide.kh_cycles or not slide.kh:
        return
    kc = [case.kc if case.kc is not None else 0.0 for case in results.liquefied.cases]
    if not kc:
        return
    low, high = min(kc), max(kc)
    if high <= 0.0:  # no Kh at all is needed, as the sentence on ground that does not stand tells
        return
    limit = coefficient(low) if coefficient(low) == coefficient(high) else f"{coefficient(low)} to {coefficient(high)}"
    word = "The slides are computed at Kh = {kh}, which exceeds the critical Kh after liquefaction, {limit}."
    if slide.kh < 0.9 * low:
        word = "The slides are computed at Kh = {kh}, below the critical Kh after liquefaction, {limit}."
    elif slide.kh <= 1.1 * high:
        word = (
            "The slides are computed at Kh = {kh}, which is about the critical Kh after liquefaction, {limit}: small "
            "changes of strength change the slide much."
        )
    yield _(word, kh=f"{slide.kh:g}", limit=limit)
