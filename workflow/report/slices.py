"""States limit equilibrium of slices in sentences: circles by Bishop and Spencer, and Spencer's method on the slip
surface of the finite elements.
"""

from collections.abc import Iterator, Sequence

from meshes.section.cutting import shown_name
from workflow.report.circles import (
    RATIO_ABOVE_BOUND,
    RATIO_BELOW_BOUND,
    against_elements,
    longer_circle,
    of_circles,
    of_longer_sections,
)
from workflow.report.numbers import coefficient
from workflow.results.results import Results
from workflow.results.slices import CirclePart, SlicesAnswer
from workflow.results.stability import LiquefiedCase
from workflow.texts.report_texts import listed

KH_DIGITS = 3  # of a critical Kh; a factor of safety has fewer


def slices_sentences(answer: SlicesAnswer, rises_by_shaking: bool = False) -> Iterator[str]:
    """Yield the critical circles, one sentence for each factor of safety and for the critical Kh.

    ``rises_by_shaking``: whether shaking raises the pore pressure, which then acts with Kh and not before shaking.
    """
    if answer.reason:
        yield f"No slip circle: {answer.reason}."
    yield from _factor_sentences(answer, rises_by_shaking)
    if answer.after_shaking is not None and answer.after_shaking.circles:
        circles = _circle_list(answer.after_shaking.circles, 2)
        yield f"Factor of safety at Kh = 0 after shaking, with its excess pore pressure, by slip circles: {circles}."
    if answer.critical:
        fails = "the ground fails without shaking"
        if rises_by_shaking:
            fails = "the ground fails by the excess pore pressure of shaking, without any seismic force"
        yield f"Critical Kh by slip circles: {_critical_list(answer.critical, fails)}."
    for text in of_longer_sections(answer.critical):
        observation, _, remedy = text.partition(": ")
        yield f"Warning: {observation[0].upper()}{observation[1:]}. To do: {remedy}."
    if not answer.critical and not any(factors.circles for factors in answer.factors):
        return
    if answer.endless:
        yield (
            "Warning: The slope continues beyond its periodic sides, and slip circles end there. They cannot follow a "
            "failure parallel to the slope, which may have a much smaller factor of safety. To do: rely on finite "
            "elements and bounds."
        )
    if answer.weak_layers:
        layers = " and ".join(map(shown_name, answer.weak_layers))
        yield (
            f"Warning: Slip circles cut across {layers}, thin and weaker than the ground beside it, and cannot follow "
            "it. The slope may have a much smaller factor of safety. To do: rely on finite elements and bounds."
        )
    if answer.strong_blocks:
        blocks = " and ".join(map(shown_name, answer.strong_blocks))
        yield (
            f"Warning: Slip circles cannot follow the outline of {blocks}, much stronger than the ground below it, "
            "which may slide or tip as a block at a much smaller factor of safety. To do: rely on finite elements and "
            "bounds."
        )


def _factor_sentences(answer: SlicesAnswer, rises_by_shaking: bool) -> Iterator[str]:
    """Yield the circles with the least factors of safety, and the sides where no circle has one."""
    for factors in answer.factors:
        if factors.circles:
            when = " before shaking" if rises_by_shaking and factors.kh == 0.0 else ""
            yield f"Factor of safety at Kh = {factors.kh:g}{when} by slip circles: {_circle_list(factors.circles, 2)}."
        if factors.kh == 0.0 and not rises_by_shaking and (sides := _sides_without_strength(answer)):
            yield (
                f"Towards the {listed(sides)} no slip circle has a factor of safety at Kh = 0 by Bishop's method: the "
                "ground has next to no strength, or the circles leave it too steeply."
            )


def _sides_without_strength(answer: SlicesAnswer) -> list[str]:
    """Return the sides towards which circles fail without a seismic force, but none has a factor of safety above 0."""
    with_factor = {circle.towards for factors in answer.factors if factors.kh == 0.0 for circle in factors.circles}
    return [circle.towards for circle in answer.critical if circle.bishop < 0.0 and circle.towards not in with_factor]


def contradicted_circles(results: Results) -> Iterator[str]:
    """Warn of slip circles that strict bounds or finite elements of the same section contradict."""
    for text in (*of_circles(results), *against_elements(results)):
        observation, _, remedy = text.partition(": ")
        yield f"Warning: {observation[0].upper()}{observation[1:]}. To do: {remedy}."


def circles_after_liquefaction(case: LiquefiedCase) -> Iterator[str]:
    """Yield the factors of safety of liquefied ground by slip circles, and a warning if they are far above its strict
    upper bound."""
    if case.circles is None or not case.circles.circles:
        return
    yield f"By slip circles it is {_circle_list(case.circles.circles, 2)}."
    if above_bound(case):
        yield (
            f"Warning: Slip circles are above the strict upper bound of {case.factor_upper:.2f}, which counts: the "
            "critical mechanism follows the liquefied ground, and is no circle."
        )
    if below_bound(case):
        yield (
            f"Slip circles are below the strict lower bound of {case.factor_lower:.2f}: through ground with friction "
            "they are no mechanism with ψ = φ, and the normal force on them is an assumption. They are the more "
            "cautious result."
        )


def above_bound(case: LiquefiedCase) -> bool:
    """Return whether the slip circles of a case of liquefaction are far above its strict upper bound."""
    if case.circles is None or not case.circles.circles or case.factor_upper is None:
        return False
    return case.circles.circles[0].bishop > RATIO_ABOVE_BOUND * case.factor_upper


def below_bound(case: LiquefiedCase) -> bool:
    """Return whether the slip circles of a case of liquefaction are far below its strict lower bound."""
    if case.circles is None or not case.circles.circles or case.factor_lower is None:
        return False
    return case.circles.circles[0].bishop < RATIO_BELOW_BOUND * case.factor_lower


def _critical_list(circles: Sequence[CirclePart], fails: str) -> str:
    """Return the critical Kh of circles, each side that fails without a seismic force with the words for this."""
    negative = [circle.bishop < 0.0 for circle in circles]
    if all(negative):
        return f"{_circle_list(circles, KH_DIGITS)}: {fails}"
    words = []
    for circle, fell in zip(circles, negative, strict=True):
        longer = longer_circle(circle, circles)
        in_longer = "" if longer is None else f", and {coefficient(longer.bishop)} by Bishop's in a longer section"
        words.append(_words(circle, KH_DIGITS) + in_longer + (f" ({fails})" if fell else ""))
    return "; ".join(words)


def _circle_list(circles: Sequence[CirclePart], digits: int) -> str:
    return "; ".join(_words(circle, digits) for circle in circles)


def _words(circle: CirclePart, digits: int) -> str:
    ends = f"x = {circle.surface_m[0][0]:.1f} to {circle.surface_m[-1][0]:.1f} m"
    words = f"to the {circle.towards} ({ends}) {circle.bishop:.{digits}f} by Bishop's method"
    if circle.spencer is not None:
        words += f", {circle.spencer:.{digits}f} by Spencer's"
    elif circle.frictionless:
        words += ", which without friction follows from moments alone (no balance of forces by Spencer's method)"
    else:
        words += " (no balance by Spencer's method)"
    smaller = "Kh" if digits == KH_DIGITS else "factor"
    below = f", for failures below the cohesionless face, which fails at a smaller {smaller}"
    return words + (below if circle.strengthened else "")
