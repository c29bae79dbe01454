"""States in words what the ground does without a seismic force: that a strict bound proves its failure, and its factor
of safety after shaking."""

from workflow.report.numbers import coefficient
from workflow.results.governing import governing_factor
from workflow.results.results import Results
from workflow.texts.report_texts import Texts


def failure_at_rest(results: Results, texts: Texts | None = None) -> str:
    """Return the proof that the section fails without a seismic force in sentences, with the critical Kh of the finite
    elements that it contradicts; empty if nothing proves this."""
    _, fem, bounds = texts or Texts(), results.fem, results.bounds
    if not results.fails_at_rest or bounds is None:
        return ""
    rises = results.config.section.water_pressure.rises_by_shaking
    factors = [part.upper for part in bounds.factors if part.kh == 0.0 and part.after_shaking == rises and part.upper]
    if bounds.upper is not None and -1.0 < bounds.upper < 0.0:
        proof = _("its critical Kh is at most {upper}", upper=coefficient(bounds.upper))
    elif factors:
        proof = _("its factor of safety is at most {upper}", upper=f"{min(factors):.2f}")
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
    return phrase


def after_shaking(results: Results, texts: Texts | None = None) -> str:
    """Return a sentence on the factor of safety with the excess pore pressure of shaking; empty without any."""
    _, fem = texts or Texts(), results.fem
    if fem is None or fem.after_shaking is None:
        return ""
    factor = governing_factor(results, fem.after_shaking)
    if results.fails_at_rest:
        return _(
            "After shaking, with its excess pore pressure, the section does not stand: its factor of safety is at most "
            "{factor}.",
            factor=f"{factor:.2f}",
        )
    return _("After shaking, with its excess pore pressure, the factor of safety is {factor}.", factor=f"{factor:.2f}")
