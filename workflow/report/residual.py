"""States stability with peak and with residual strength in sentences."""

from collections.abc import Iterator

from meshes.section.cutting import shown_name, whole_soil
from workflow.report.post_liquefaction import factors
from workflow.results.stability import PeakAndResidual
from workflow.texts.report_texts import Texts, listed


def residual_verdict(steps: PeakAndResidual, _: Texts) -> str:
    """Return the verdict from peak and residual strength together, in a sentence."""
    if steps.verdict == "stands":
        return _("With residual strength in all strata that have one the ground still stands without shaking.")
    if steps.verdict == "fails":
        return _("The ground does not stand without shaking even with its peak strength.")
    if steps.verdict == "undecided":
        return _(
            "With its residual strength the ground does not stand without shaking; its factor of safety with peak "
            "strength was not found."
        )
    along = steps.along
    if steps.verdict == "would stop" and along is not None and along.residual is not None:
        return _(
            "With its peak strength the ground stands without shaking, and a slide along the slip surface of peak "
            "strength stops there: its factor of safety with residual strength is {factor}. With residual strength in "
            "all strata that have one the ground does not stand.",
            factor=f"{along.residual:.2f}",
        )
    return _(
        "With its peak strength the ground stands without shaking, with its residual strength it does not: where it "
        "has slid before, or begins to slide, the slide continues."
    )


def residual_details(steps: PeakAndResidual) -> Iterator[str]:
    """Yield sentences on the strengths, the factors of safety of the verdict, and missing results."""
    # Parts of a stratum that zones, cracks or water divide are named once.
    strata = [
        f"c = {each.cohesion_kPa:.3g} kPa, φ = {each.friction_deg:.3g}° in {shown_name(whole_soil(each.name))}"
        for each in steps.strata
    ]
    yield f"The residual strength is {listed(list(dict.fromkeys(strata)))}."
    if steps.peak is not None:
        yield f"With peak strength the factor of safety at Kh = 0 is {steps.peak:.2f} by finite elements."
    along = steps.along
    if along is not None and along.residual is not None:
        peak = f" ({along.peak:.2f} with peak strength)" if along.peak is not None else ""
        value = f"{along.residual:.2f} by Spencer's method{peak}"
        yield f"With residual strength along the slip surface of peak strength the factor of safety is {value}."
    if steps.everywhere.factor is not None or steps.everywhere.factor_lower is not None:
        yield f"With residual strength everywhere the factor of safety is {factors(steps.everywhere)}."
    if steps.everywhere.kc is not None:
        yield f"With residual strength the critical Kh is {steps.everywhere.kc:.3f} by finite elements."
    for note in (*steps.notes, *steps.everywhere.notes):
        yield f"Warning: {note}."


def residual_sentences(steps: PeakAndResidual) -> Iterator[str]:
    """Yield sentences on the verdict and its details, for the terminal."""
    yield residual_verdict(steps, Texts("en"))
    yield from (f"    {sentence}" for sentence in residual_details(steps))
