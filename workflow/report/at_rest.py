"""States in words what the ground does without a seismic force: that a strict bound proves its failure, and its factor
of safety after shaking."""

from workflow.report.flow_rule import FLOW
from workflow.report.numbers import coefficient
from workflow.results.continuum import FactorOfSafety, FailureAnswer, FemAnswer
from workflow.results.governing import governing_factor, stands_with_smooth_sides
from workflow.results.results import Results
from workflow.results.verdicts import HeadlinePart
from workflow.texts.report_texts import Texts

# Words of the reason why finite elements have no critical Kh: the ground fails at rest, or only between free sides.
FAILURE_REASON, SMOOTH_SIDES_REASON = "the section fails under its own weight", "stands with its sides held"


def failure_at_rest(results: Results, texts: Texts | None = None) -> str:
    """Return the proof that the section fails without a seismic force.

    Parameters
    ----------
    results : results of the run, with strict bounds
    texts : texts in the language of the report; None for English

    Returns
    -------
    Sentences, with the critical Kh of the finite elements that the proof contradicts; empty if nothing proves a
    failure.
    """
    _, fem, bounds = texts or Texts(), results.fem, results.bounds
    if not results.fails_at_rest or bounds is None:
        return ""
    rises = results.config.section.water_pressure.rises_by_shaking
    factor = results.upper_factor_at_rest
    if (upper := bounds.upper_number) is not None and upper < 0.0:
        proof = _("its critical Kh is at most {upper}", upper=f"{upper:.3g}")
    elif factor is not None and factor < 1.0:  # between held sides the ground may stand
        proof = _("its factor of safety is at most {upper}", upper=f"{factor:.2f}")
    else:
        proof = _("no horizontal force could stabilise it")
    cause = _("by its weight and the excess pore pressure of shaking") if rises else _("under its own weight")
    phrase = _("Strict bounds prove that the section fails without a seismic force, {cause}: {proof}.",
               cause=cause, proof=proof)  # fmt: skip
    if fem is not None and fem.has_kc and results.no_answer("fem") is None:
        phrase += " " + _(
            "The finite elements, whose cells are too coarse for this failure, give a critical Kh of {kc}, which does "
            "not count.",
            kc=coefficient(fem.kc),
        )
    if fem is not None and fem.at_rest is not None and stands_with_smooth_sides(results, fem.at_rest):
        phrase += " " + _(
            "This mechanism moves a side of the section, as free-field sides permit; the factor of safety is that "
            "between sides held horizontally."
        )
    return phrase


def after_shaking(results: Results, texts: Texts | None = None) -> str:
    """Return a sentence on the factor of safety with the excess pore pressure of shaking; empty without any."""
    _, fem = texts or Texts(), results.fem
    if fem is None or fem.after_shaking is None:
        return ""
    factor = governing_factor(results, fem.after_shaking)
    if results.fails_at_rest and not stands_with_smooth_sides(results, fem.after_shaking):
        return _(
            "After shaking, with its excess pore pressure, the section does not stand: its factor of safety is at most "
            "{factor}.",
            factor=f"{factor:.2f}",
        )
    return _("After shaking, with its excess pore pressure, the factor of safety is {factor}.", factor=f"{factor:.2f}")


def when_words(factor: FactorOfSafety, answer: FemAnswer) -> str:
    """Return the Kh of a factor of safety in words. If shaking raises the pore pressure, the factors without a seismic
    force are those before and after shaking."""
    at_kh = f"at Kh = {factor.kh:g}"
    if factor.after_shaking:
        return f"{at_kh} after shaking, with its excess pore pressure"
    if factor.kh != 0.0 or answer.after_shaking is None:
        return at_kh
    return f"{at_kh} before {'and after ' if is_same_after_shaking(answer) else ''}shaking"


def is_same_after_shaking(answer: FemAnswer) -> bool:
    """Return whether the excess pore pressure of shaking leaves the factor of safety as it is, since the ground that
    fails has none."""
    after = answer.after_shaking
    before = next((factor for factor in answer.safety_factors if factor.kh == 0.0), None)
    pairs = [] if after is None or before is None else [(after.factor, before.factor), (after.davis, before.davis)]
    return bool(pairs) and all(f"{item or 0.0:.3f}" == f"{other or 0.0:.3f}" for item, other in pairs)


def critical_without_answer(results: Results, name: str, _: Texts) -> HeadlinePart:
    """Return the headline of the critical Kh without one by finite elements: below 0 where ground fails by its weight.

    ``results``: results of the stages; ``name``: name of the number; ``_``: texts in the language of the report.
    """
    entry = results.no_answer("fem")
    reason = entry.reason if entry is not None else _("the finite element analysis was not run")
    if results.failure is None and not results.fails_at_rest:
        fails = reason.startswith(FAILURE_REASON) and SMOOTH_SIDES_REASON not in reason
        phrase = _("No critical Kh: {reason}.", reason=reason)
        return HeadlinePart(name=name, value="< 0" if fails else "–", interval="", conclusion=phrase)
    phrase = failure_at_rest(results, _) or _("The section fails without shaking, so that it has no critical Kh.")
    return HeadlinePart(name=name, value="< 0", interval="", conclusion=phrase)


def safety_of_failure(results: Results, failure: FailureAnswer, name: str, _: Texts) -> HeadlinePart:
    """Return the headline of the factor of safety of ground that fails by its weight.

    ``results``, ``name``, ``_``: as above; ``failure``: factor of safety by finite elements.
    """
    factor, upper = failure.factor, results.upper_factor_at_rest
    limited = upper is not None and upper < factor
    value = f"{upper:.2f}" if limited else f"{factor:.2f}"
    sentence = (
        "Without shaking the section does not stand: its factor of safety is at most {factor} ({flow})."
        if limited
        else "Without shaking the section does not stand: its factor of safety is {factor} ({flow})."
    )
    phrase = _(sentence, factor=value, flow=_(FLOW[failure.flow]))
    if failure.davis is not None:
        phrase += " " + _(
            "With Davis reduced strength the factor of safety is {factor}.", factor=f"{failure.davis:.2f}"
        )
    return HeadlinePart(name=name, value=f"< {value}" if limited else value, interval="", conclusion=phrase)
