"""States the assessment of liquefaction by borings in sentences."""

from collections.abc import Iterator

from meshes.section.cutting import shown_name
from workflow.results.triggering import ResidualPart, StratumPart, TriggeringAnswer
from workflow.texts.report_texts import listed


def triggering_sentences(answer: TriggeringAnswer) -> Iterator[str]:
    """Return sentences on which strata liquefy, from triggering.json."""
    motion = answer.motion
    spread = f" ({motion.low_gal:.0f} to {motion.high_gal:.0f}, one standard deviation)" if motion.sigma else ""
    magnitude = f", M {answer.magnitude:g}" if answer.magnitude is not None else ""
    peak = f"a peak acceleration of {motion.median_gal:.0f} gal{spread}{magnitude}"
    yield f"The method is {answer.method}, with {peak}, {motion.relation}."
    yield from dict.fromkeys(map(stratum_sentence, answer.strata))  # parts of a soil share their tests
    yield from dict.fromkeys(map(_left_sentence, answer.residual_strengths))
    for boring in answer.borings:
        yield f"Boring {boring.name}: liquefaction potential index P_L = {boring.potential:.1f}, risk {boring.risk}."


def _left_sentence(stratum: ResidualPart) -> str:
    """Return a sentence on the residual strength and strains of a stratum where F_L is below 1."""
    phrases = [f"{pascals / 1e3:.1f} kPa ({stratum.residual[title]:.2f} σ'v) by {title}"
            for title, pascals in stratum.strength_Pa.items()]  # fmt: skip
    drains = f"By drainage it loses {100.0 * stratum.volumetric_strain:.1f} % of its volume."
    if stratum.strain_potential > 0.0:
        strain = f"{100.0 * stratum.strain_potential:.0f} %"
        drains = f"Its shear strain before it regains strength is {strain}. {drains}"
    keeps = "is outside the range of all relations of residual strength"
    if phrases:
        keeps = f"keeps a residual strength of {listed(phrases)}"
    return f"Where F_L is below 1, {shown_name(stratum.stratum)} {keeps}. {drains}"


def stratum_sentence(stratum: StratumPart) -> str:
    """Return whether a stratum liquefies, or why this was not assessed."""
    name = shown_name(stratum.name)
    if not stratum.assessed or stratum.share is None:
        return f"{name} was not assessed ({stratum.reason})."
    word = "liquefies" if stratum.liquefies else "does not liquefy"
    phrase = f"{name} {word}: F_L is below 1 in {100.0 * stratum.share:.0f} % of it"
    if stratum.lowest_factor is not None:
        phrase += f", and the smallest F_L is {stratum.lowest_factor:.2f}"
    not_assessed = stratum.tests - stratum.assessed
    return phrase + (
        f"; {not_assessed} of {stratum.tests} tests in it were not assessed ({stratum.reason})."
        if not_assessed
        else "."
    )
