"""Writes the first page of the report: three numbers with their intervals, and one sentence of conclusion for each."""

from collections.abc import Iterator, Mapping, Sequence

from fem.search.result_warnings import difference_words
from meshes.section.cutting import shown_name
from meshes.section.quantity import GRAVITY
from workflow.estimates.structures import structures_of
from workflow.report.at_rest import after_shaking, critical_without_answer, failure_at_rest, safety_of_failure
from workflow.report.crests import crest_parts, crests_in_short
from workflow.report.first_crests import with_crests
from workflow.report.flow_rule import FLOW
from workflow.report.numbers import coefficient, from_to, interval_text, lower_limit, of_cases, rounded_up
from workflow.report.paper import rows
from workflow.report.post_liquefaction import just_enough
from workflow.report.residual import residual_verdict
from workflow.report.slide_headline import slide_headline
from workflow.results.accuracy import METHODS, accuracy, proven_by, strict_factor
from workflow.results.answer import FORCE
from workflow.results.bounds import DirectionPart
from workflow.results.continuum import FactorOfSafety, FemAnswer
from workflow.results.governing import (
    GoverningKh,
    governing_factor,
    governing_kh,
    is_limited_by_kh,
    stands_with_smooth_sides,
)
from workflow.results.results import Results
from workflow.results.verdicts import HeadlinePart
from workflow.texts.report_texts import Texts

IN_FULL = {**FLOW, "davis": "Davis reduced strength, for soil that dilates less than ψ = φ"}  # where it is first named
SIDES: Mapping[str, str] = {
    "free-field": "free-field sides", "smooth": "smooth sides", "fixed": "fixed sides", "periodic": "periodic sides",
}  # fmt: skip


def headlines(results: Results, _: Texts) -> tuple[HeadlinePart, ...]:
    """Return the three numbers: critical Kh, factor of safety without shaking, and slide after liquefaction. If nothing
    liquefies, the third number is the displacement of a rigid block in the earthquake.

    Parameters
    ----------
    results : results of the stages; a missing number becomes a dash with its reason
    _ : texts in the language of the report
    """
    three = (
        with_crests(_critical(results, _), results, results.slip_surface, "critical", _),
        with_crests(_safety(results, _), results, _surface_at_rest(results), "safety", _),
        slide_headline(results, _),
    )
    return tuple(headline.model_copy(update={"value": _.sentence(headline.value)}) for headline in three)


def _critical(results: Results, _: Texts) -> HeadlinePart:
    fem, name = results.fem, _("critical Kh")
    if fem is None or results.no_answer("fem") is not None:
        return critical_without_answer(results, name, _)
    if results.fails_at_rest:
        return HeadlinePart(name=name, value="< 0", interval="", conclusion=failure_at_rest(results, _))
    if not fem.has_kc:
        least = coefficient(fem.kc_lower)
        if fem.verdict == "no failure":
            phrase = _("The section stands at every Kh up to {kh}, the largest Kh of the search.", kh=least)
            return HeadlinePart(name=name, value=f"> {least}", interval="", conclusion=phrase)
        phrase = _("The critical Kh was not found: {reason}.", reason=fem.reason)
        return HeadlinePart(name=name, value=f"≥ {least}", interval="", conclusion=phrase)
    governing = governing_kh(results)
    assert governing is not None
    excluded = _excluded_failure(fem, governing.value, _)
    conditions = _("{sides}, {flow}", sides=_(SIDES[fem.settings.sides]), flow=_(IN_FULL[fem.flow]))
    if governing.bound is not None:
        return _contradicted(results, fem, governing, conditions, excluded, _)
    phrase = _(
        "The section fails {way} at Kh = {kc} ({acceleration} m/s²), with {conditions}.",
        way=_direction_words(results, fem, _),
        kc=coefficient(fem.kc),
        acceleration=f"{fem.kc * GRAVITY:.2g}",
        conditions=conditions,
    )
    if fem.davis is not None and fem.flow == "associated":
        stands = fem.davis.verdict in ("plateau", "peak") and fem.davis.kc > 0.0
        word = (
            "With Davis reduced strength, a low estimate for soil that dilates less, the section fails without shaking."
        )
        if stands:
            word = "With Davis reduced strength, a low estimate for soil that dilates less, the critical Kh is {kc}."
        phrase += " " + _(word, kc=coefficient(fem.davis.kc))
    return HeadlinePart(
        name=name,
        value=coefficient(fem.kc),
        interval=interval_text(governing.interval, _, fem.kc),
        conclusion=phrase + excluded,
    )


def _excluded_failure(fem: FemAnswer, kc: float, _: Texts) -> str:
    """Return a sentence, after a blank, on the first shallow failure of a cohesionless face, which the critical Kh
    ``kc`` excludes; empty if no face fails before the section."""
    faces = [face for face in fem.shallow_failures if not face.is_edge(fem.settings.least_depth) and face.kh < kc]
    if not faces:
        return ""
    first = min(faces, key=lambda face: face.kh)
    place = {
        "stratum": shown_name(first.stratum),
        "start": f"{first.start_x_m:g}",
        "end": f"{first.end_x_m:g}",
    }
    if first.kh <= 0.0:
        return " " + _(
            "The cohesionless face of {stratum} from x = {start} to {end} m fails by its own weight; this shallow "
            "failure is excluded.",
            **place,
        )
    return " " + _(
        "The cohesionless face of {stratum} from x = {start} to {end} m fails at Kh = {kh} already; this shallow "
        "failure is excluded.",
        **place,
        kh=coefficient(first.kh),
    )


def _surface_at_rest(results: Results) -> Sequence[Sequence[float]]:
    """Return the slip surface of the factor of safety without shaking; empty without any."""
    factors = results.fem.safety_factors if results.fem is not None else ()
    return next((factor.slip_surface for factor in factors if factor.kh == 0.0), ())


def _direction_words(results: Results, failing: FemAnswer | DirectionPart, _: Texts) -> str:
    """Return the direction of failure: downslope or upslope, or the side for ground that falls to both sides.

    ``failing``: the finite elements, or the bounds of the other direction if they count."""
    if structures_of(results.config.section):
        return _("to the {side}", side=_(failing.towards))
    return _("{direction}, to the {side},", direction=_(FORCE[failing.direction]), side=_(failing.towards))


def _contradicted(
    results: Results, fem: FemAnswer, kh: GoverningKh, conditions: str, excluded: str, _: Texts
) -> HeadlinePart:
    """Return the sentence on the critical Kh if the finite elements lie beyond a strict bound. The end of the interval
    then counts: as the critical Kh if the bounds are close, else as a limit. The finite elements are a second opinion.
    ``excluded``: sentence on an excluded shallow failure, added at the end.
    """
    word = (
        "The section fails {way} at Kh = {kc} ({conditions}). The finite elements give a Kh that is {excess} higher, "
        "but the section cannot resist more than the strict upper bound, which is therefore reported."
    )
    if kh.bound == "lower":
        word = (
            "The section fails {way} at Kh = {kc} ({conditions}). The finite elements give a Kh that is {excess} "
            "lower, but a stress field in equilibrium proves that the section resists the strict lower bound, which is "
            "therefore reported."
        )
    if kh.is_limit and kh.bound == "upper":
        word = (
            "The section fails {way} at Kh = {kc} or less ({conditions}). The finite elements give a Kh that is "
            "{excess} higher, but the section cannot resist more than the strict upper bound, which is therefore "
            "reported as an upper limit."
        )
    if kh.is_limit and kh.bound == "lower":
        word = (
            "The section fails {way} at Kh = {kc} or more ({conditions}). The finite elements give a Kh that is "
            "{excess} lower, but a stress field in equilibrium proves that the section resists the strict lower "
            "bound, which is therefore reported as a lower limit."
        )
    in_direction = fem if kh.opposite_bounds is None or fem.opposite is None else fem.opposite
    phrase = _(
        word,
        way=_direction_words(results, kh.opposite_bounds or fem, _),
        kc=coefficient(kh.value),
        conditions=conditions,
        excess=difference_words(in_direction.kc, kh.value),
    )
    phrase += excluded
    interval = interval_text(kh.interval, _, kh.value, _("by this strict bound alone"))
    return HeadlinePart(name=_("critical Kh"), value=kh.text, interval=interval, conclusion=phrase)


def _safety(results: Results, _: Texts) -> HeadlinePart:
    fem, name = results.fem, _("factor of safety")
    factor = (
        next((candidate for candidate in fem.safety_factors if candidate.kh == 0.0), None) if fem is not None else None
    )
    if results.failure is not None:
        return safety_of_failure(results, results.failure, name, _)
    entry = results.no_answer("fem")
    if entry is not None:
        phrase = _("No factor of safety: {reason}.", reason=entry.reason)
        return HeadlinePart(name=name, value="–", interval="", conclusion=phrase)
    if fem is None or factor is None:
        phrase = _("No factor of safety was computed; fem.safety_factor_at = [0.0] requests one.")
        return HeadlinePart(name=name, value="–", interval="", conclusion=phrase)
    if factor.verdict == "no failure":
        phrase = _(
            "Without shaking the section stands with its strength divided by {factor}.",
            factor=lower_limit(factor.factor),
        )
        return HeadlinePart(name=name, value=f"> {lower_limit(factor.factor)}", interval="", conclusion=phrase)
    governing = governing_factor(results, factor)
    phrase = _(_word_of_safety(results, fem, factor, governing), factor=f"{governing:.2f}", flow=_(FLOW[fem.flow]))
    if governing < factor.factor:
        phrase += " " + _(
            "The finite elements give a factor of safety that is {excess} % higher, but the section cannot resist more "
            "than the strict upper bound, which is therefore reported.",
            excess=f"{100.0 * (factor.factor / governing - 1.0):.1f}",
        )
    elif governing > factor.factor:
        phrase += " " + _(
            "The finite elements give a factor of safety that is {excess} % lower, but a stress field in equilibrium "
            "proves that the section resists the strict lower bound, which is therefore reported.",
            excess=f"{100.0 * (1.0 - factor.factor / governing):.1f}",
        )
    if factor.davis is not None:
        phrase += " " + _("With Davis reduced strength the factor of safety is {factor}.", factor=f"{factor.davis:.2f}")
    if fem.after_shaking is not None:
        phrase += " " + after_shaking(results, _)
    value, interval = _value_of_safety(results, fem, factor, _)
    if fem.after_shaking is not None:
        name = _("factor of safety before shaking")
        interval += _("; {value} after shaking", value=f"{governing_factor(results, fem.after_shaking):.2f}")
    return HeadlinePart(name=name, value=value, interval=interval, conclusion=phrase)


def _word_of_safety(results: Results, fem: FemAnswer, factor: FactorOfSafety, governing: float) -> str:
    """Return the sentence on whether the section stands without shaking, by the factor of safety that is governing."""
    word = "Without shaking the section stands, with a factor of safety of {factor} ({flow})."
    if stands_with_smooth_sides(results, factor):
        word = (
            "Between sides held horizontally the section stands without shaking, with a factor of safety of {factor} "
            "({flow}); with free-field sides it does not stand."
        )
    elif results.fails_at_rest and factor == fem.at_rest:
        word = "Without shaking the section does not stand: its factor of safety is at most {factor} ({flow})."
    elif governing < 1.0:
        word = "Without shaking the section does not stand: its factor of safety is {factor} ({flow})."
    elif fem.after_shaking is not None:
        word = "Before shaking the section stands, with a factor of safety of {factor} ({flow})."
    return word


def _value_of_safety(results: Results, fem: FemAnswer, factor: FactorOfSafety, _: Texts) -> tuple[str, str]:
    """Return the factor of safety that counts and its interval. A number without a known error is no headline."""
    governing, interval = governing_factor(results, factor), _of_safety(results, fem, factor, _)
    if is_limited_by_kh(results, factor):
        return "≤ 1.00", _("by the strict upper bound of the critical Kh")
    if not interval:
        return "–", _("numerical error not known: one mesh, no strict bounds")
    return f"{governing:.2f}", interval


def _of_safety(results: Results, fem: FemAnswer, factor: FactorOfSafety, _: Texts) -> str:
    """Return the interval of a factor of safety. The interval follows from strict bounds under the same conditions and
    the error by the mesh, else from the distance between the critical Kh on the same mesh and its strict bounds. The
    interval is empty if none of these is known.
    """
    strict = strict_factor(results, fem, factor, fem.flow)
    by_meshes = (
        None if factor.remaining_error is None else (factor.factor * (1.0 - factor.remaining_error), factor.factor)
    )
    if strict is not None and strict.lower is not None and strict.upper is not None:
        low, high, method = strict.lower, strict.upper, proven_by(strict.shallow_failure is not None)
        alone = f"{low:.2f}", f"{high:.2f}"
        if by_meshes is not None and by_meshes[0] <= high and low <= by_meshes[1]:
            low, high, method = max(low, by_meshes[0]), min(high, by_meshes[1]), f"{method} and {METHODS[0][3:]}"
        counts = governing_factor(results, factor)  # its last digit may be the next one
        low, high = min(low, counts), max(high, counts)
        return from_to(f"{low:.2f}", f"{high:.2f}", method, _, alone)
    if by_meshes is not None:
        return from_to(f"{by_meshes[0]:.2f}", f"{by_meshes[1]:.2f}", METHODS[0], _)
    error = accuracy(results, fem)
    if error is None or not fem.has_kc or error.low <= 0.0:
        return ""
    return _(
        "one mesh; the error of the critical Kh on this mesh is at most {error} % {method}",
        error=f"{100.0 * rounded_up(error.error(fem.kc) / error.low):g}",
        method=_(error.method),
    )


def conclusions(results: Results, _: Texts) -> Iterator[str]:
    """Yield the sentences of the first page after the numbers, on the choice of Kh, the governing slide, and the
    paper."""
    yield from _without_shaking(results, _)
    yield from crests_in_short(tuple(crest_parts(results.config, results.cases, results.mpm)), _)
    if results.residual is not None:
        yield residual_verdict(results.residual.steps, _)
    yield from _why_kh(results, _)
    if results.cases is not None and len([name for name, cases in results.cases.sets.items() if cases]) > 1:
        yield _(
            "Discs are calibrated unless the text says otherwise; discs with the springs of the paper serve for "
            "comparison."
        )
    compared = [row for row in rows(results) if row.agrees is not None]
    off = [row for row in compared if not row.agrees]
    if off:
        discs = [row for row in compared if "calibrated" in row.quantity]
        yield _(
            "{off} of {all} comparisons with the paper disagree, among them {off_discs} of the {discs} comparisons "
            "for calibrated discs. One cause is that the depths of the layers are a reconstruction.",
            off=len(off),
            all=len(compared),
            off_discs=len([row for row in discs if not row.agrees]),
            discs=len(discs),
        )


def _without_shaking(results: Results, _: Texts) -> Iterator[str]:
    """Yield a sentence on whether the continuum still stands after liquefaction, without shaking."""
    cases = results.liquefied.cases if results.liquefied is not None else ()
    flows = [number for case in cases if case.verdict == "flows" for number in case.cases]
    stands = [number for case in cases if case.verdict == "stands" for number in case.cases]
    if flows:
        yield _(
            "After liquefaction the section does not stand, even without shaking, in {cases}.", cases=of_cases(flows)
        )
        if results.liquefied is not None and (enough := just_enough(results.liquefied)) is not None:
            yield _.sentence(f"{enough.description}.")
    if stands:
        yield _("After liquefaction the section still stands without shaking in {cases}.", cases=of_cases(stands))


def _why_kh(results: Results, _: Texts) -> Iterator[str]:
    """Yield a comparison of the constant Kh of the slides with the limit load after liquefaction."""
    slide = results.config.slide
    if results.liquefied is None or not results.case_set()[1] or slide.accelerogram or slide.kh_cycles or not slide.kh:
        return
    kc = [case.kc if case.kc is not None else 0.0 for case in results.liquefied.cases]
    if not kc:
        return
    low, high = min(kc), max(kc)
    if high <= 0.0:  # the ground fails without Kh, which another sentence reports
        return
    limit = coefficient(low) if coefficient(low) == coefficient(high) else f"{coefficient(low)} to {coefficient(high)}"
    word = "The slides are computed at Kh = {kh}, which exceeds the critical Kh after liquefaction, {limit}."
    if slide.kh < 0.9 * low:
        word = "The slides are computed at Kh = {kh}, below the critical Kh after liquefaction, {limit}."
    elif slide.kh <= 1.1 * high:
        word = (
            "The slides are computed at Kh = {kh}, which is about the critical Kh after liquefaction, {limit}: small "
            "changes of strength change the slide strongly."
        )
    yield _(word, kh=f"{slide.kh:g}", limit=limit)
