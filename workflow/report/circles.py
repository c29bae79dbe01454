"""Warns of slip circles that strict bounds contradict, that lie far from finite elements, or that a side of the section
cuts off, each with advice.
"""

import math
from collections.abc import Iterator, Sequence
from operator import attrgetter

import numpy as np

from meshes.section.cutting import shown_name
from meshes.section.section import Section
from workflow.estimates.slip_circles import least_balance
from workflow.report.numbers import coefficient
from workflow.results.bounds import BoundsAnswer
from workflow.results.results import Results
from workflow.results.slices import CirclePart, LongerCircle
from workflow.texts.report_texts import listed

# A slip circle does not govern if its Kh exceeds the strict upper bound by this ratio and this difference; a circle
# below the strict lower bound by this ratio and difference contradicts a field of stress in equilibrium.
RATIO_ABOVE_BOUND, KH_ABOVE_BOUND = 1.05, 0.01
RATIO_BELOW_BOUND, KH_BELOW_BOUND = 0.97, 0.002
# Slip circles are far from the finite elements beyond this ratio and this difference of Kh; Spencer's method on the
# slip surface of the finite elements confirms them up to this relative difference.
FAR_RATIO, FAR_KH, AGREEMENT = 1.1, 0.02, 0.1
STEEP_SLOPE = math.tan(math.radians(45.0))  # of a slip surface where it cuts down from the crest
LONGER_SECTION_RATIO = 0.98  # times its critical Kh, below which the circle of a longer section is reported
# Ratio to the smaller critical Kh of both directions above which a circle in a longer section is not reported.
GOVERNING_RATIO = 1.5
LENGTH_STEP = 5.0  # m, to which the length of ground to add is rounded up
STEEPLY = (
    ", since they cut steeply through {strata}, where the normal force on a circle is an assumption of the method; "
    "with ψ = φ the ground resists a larger Kh"
)
FAILS = "the section fails"  # with which the reason of a stage begins if the ground has no critical Kh
CIRCLE_REMEDY = (
    "rely on finite elements and bounds, since the critical mechanism is no circle, for example along a weak layer"
)
TENSION_REMEDY = (
    "rely on finite elements and bounds, since circles have no tension cut-off, or give a [tension_crack], at which "
    "they end"
)


def of_circles(results: Results) -> Iterator[str]:
    """Warn of slip circles above strict upper bounds, and below lower ones.

    A circle above the upper bound overestimates the critical Kh. A circle below the lower bound does not prove failure:
    a circle through ground with friction is not a mechanism with ψ = φ, and methods of slices assume the normal force
    on its base.
    """
    circles, bounds = results.slices, results.bounds
    if circles is None or bounds is None or results.config.fem.direction != "both":
        return
    section = results.config.section
    without_cutoff = results.config.tension_crack.bottom is None and any(s.tension is not None for s in section.strata)
    remedy = TENSION_REMEDY if without_cutoff else CIRCLE_REMEDY
    factors = {group.kh: group.circles[0] for group in circles.factors if group.circles}
    for part in bounds.safety:
        if (circle := factors.get(part.kh)) is None:
            continue
        statement = f"slip circles have a factor of safety of {circle.bishop:.2f} at Kh = {part.kh:g}"
        if part.upper is not None and circle.bishop > RATIO_ABOVE_BOUND * part.upper:
            yield f"{statement}, above the strict upper bound of {part.upper:.2f}: {remedy}"
        if part.lower is not None and circle.bishop < RATIO_BELOW_BOUND * part.lower:
            yield f"{statement}, below the strict lower bound of {part.lower:.2f}{_assumed(section, circle)}"
    if not circles.critical:
        return
    circle = circles.critical[0]
    statement = f"slip circles have a critical Kh of {coefficient(circle.bishop)}"
    upper = bounds.upper_number
    if upper is not None and circle.bishop > RATIO_ABOVE_BOUND * upper + KH_ABOVE_BOUND:
        remedy = _slides_out(bounds) or remedy
        yield f"{statement}, above the strict upper bound of {coefficient(upper)}: {remedy}"
    if bounds.lower is not None and circle.bishop < min(
        RATIO_BELOW_BOUND * bounds.lower, bounds.lower - KH_BELOW_BOUND
    ):
        yield f"{statement}, below the strict lower bound of {coefficient(bounds.lower)}{_assumed(section, circle)}"


def against_elements(results: Results) -> Iterator[str]:
    """Warn of slip circles far from the result of the finite elements with ψ = φ, if strict bounds do not contradict
    the circles already."""
    circles, fem, bounds = results.slices, results.fem, results.bounds
    yield from _against_failure(results)
    if circles is None or fem is None or fem.flow != "associated" or results.config.fem.direction != "both":
        return
    factors = {group.kh: group.circles[0] for group in circles.factors if group.circles}
    strict = {part.kh: (part.lower, part.upper) for part in bounds.safety} if bounds is not None else {}
    for factor in fem.safety_factors:
        circle = factors.get(factor.kh)
        if circle is None or _contradicted(circle.bishop, *strict.get(factor.kh, (None, None))):
            continue
        if abs(math.log(max(circle.bishop, 1e-9) / factor.factor)) > math.log(FAR_RATIO):
            statement = (
                f"slip circles have a factor of safety of {circle.bishop:.2f} at Kh = {factor.kh:g}, while "
                f"finite elements have {factor.factor:.2f}"
            )
            yield statement + _why_far(results, circle, factor.factor, np.array(factor.slip_surface), factor.kh)
    if not circles.critical or not fem.has_kc:
        return
    circle, kh = circles.critical[0], (None, None) if bounds is None else (bounds.lower, bounds.upper)
    apart = abs(circle.bishop - fem.kc)
    if apart > max(FAR_KH, (FAR_RATIO - 1.0) * fem.kc) and not _contradicted(circle.bishop, *kh):
        state = fem.last_in_equilibrium()
        line = np.array(state.slip_surface if state is not None else ())
        statement = f"slip circles have a critical Kh of {coefficient(circle.bishop)}, while finite elements have "
        yield f"{statement}{coefficient(fem.kc)}{_why_far(results, circle, fem.kc, line, None)}"


def _against_failure(results: Results) -> Iterator[str]:
    """Warn of slip circles that stand without a seismic force where finite elements find that the section fails."""
    circles, entry = results.slices, results.no_answer("fem")
    if circles is None or entry is None or not entry.reason.startswith(FAILS) or results.fails_at_rest:
        return
    at_rest = [circle for group in circles.factors if group.kh == 0.0 for circle in group.circles]
    circle = min(at_rest, key=attrgetter("bishop"), default=None)
    if circle is not None and circle.bishop > 1.0 and not results.config.section.water_pressure.rises_by_shaking:
        yield (
            f"slip circles have a factor of safety of {circle.bishop:.2f} at Kh = 0, while finite elements find that "
            f"{entry.reason}: rely on the finite elements, whose slip surface is no circle"
        )


def _contradicted(value: float, lower: float | None, upper: float | None) -> bool:
    """Return whether a factor of safety or critical Kh of circles is so far outside strict bounds that `of_circles`
    reports it.
    """
    above = upper is not None and value > RATIO_ABOVE_BOUND * upper + KH_ABOVE_BOUND
    return above or (lower is not None and value < min(RATIO_BELOW_BOUND * lower, lower - KH_BELOW_BOUND))


def _why_far(results: Results, circle: CirclePart, elements: float, line: np.ndarray, kh: float | None) -> str:
    """Return the reason why the factor of safety or critical Kh of a circle is far from the result of the finite
    ``elements``, whose slip surface is ``line`` (m), and advice."""
    section, fem = results.config.section, results.fem
    place_words = ""
    if len(line):
        place_words = (
            f", which slip from x = {line[0, 0]:.1f} to {line[-1, 0]:.1f} m, down to z = {line[:, 1].min():.1f} m"
        )
    if circle.bishop < elements:
        strata = listed(_cut_steeply(section, circle))
        steeply = STEEPLY.format(strata=strata) if strata else ""
        remedy = "find strict bounds (bounds.run), and report the circles as the more cautious result"
        return f"{place_words}{steeply}: {remedy}"
    if fem is not None and fem.at_sides and kh is None:
        return (
            f"{place_words}: this failure reaches the {listed(list(fem.at_sides))} side, where the section was cut "
            "off; take a longer section"
        )
    spencer = least_balance(section, line, kh, results.config.fem.vertical)
    if spencer is not None and abs(spencer - elements) <= AGREEMENT * elements:
        value = coefficient(spencer) if kh is None else f"{spencer:.2f}"
        place_words += f", while Spencer's method has {value}"
    return f"{place_words}: rely on the finite elements, whose slip surface is no circle"


def longer_circle(circle: CirclePart, circles: Sequence[CirclePart]) -> LongerCircle | None:
    """Return the circle of a longer section that slides at a smaller critical Kh than a ``circle`` that ends at a side.

    It is None if there is none, or if this direction fails at a much larger Kh even there than the least of all
    critical ``circles``.
    """
    least, longer = min(each.bishop for each in circles), circle.longer
    if longer is None or longer.bishop > min(
        LONGER_SECTION_RATIO * circle.bishop, max(GOVERNING_RATIO * least, least + KH_ABOVE_BOUND)
    ):
        return None
    return longer


def of_longer_sections(circles: Sequence[CirclePart]) -> Iterator[str]:
    """Warn of critical circles that end at a side of the section, and slide at a smaller Kh in a longer section."""
    ends: dict[str, list[tuple[CirclePart, LongerCircle]]] = {}
    for circle in circles:
        if (longer := longer_circle(circle, circles)) is not None:
            ends.setdefault(longer.side, []).append((circle, longer))
    for side, pairs in ends.items():
        more = max(min(max(math.ceil(far.past_m / LENGTH_STEP), 1) * LENGTH_STEP, far.beyond_m) for _, far in pairs)
        ways = listed([f"the {circle.towards}" for circle, _ in pairs])
        values = listed([f"{coefficient(far.bishop)} instead of {coefficient(circle.bishop)}" for circle, far in pairs])
        which = "circles towards" if len(pairs) > 1 else "circle towards"
        are = "are" if len(pairs) > 1 else "is"
        yield (
            f"the critical slip {which} {ways} {are} cut off by the {side} side of the section; in a section that is "
            f"lengthened beyond its sides the critical Kh is {values}: extend the section by {more:g} m at this side, "
            f"or add {more:g} m to beyond"
        )


def _slides_out(bounds: BoundsAnswer) -> str:
    """Return advice for a mechanism of the bounds that leaves the section at a side; empty if it does not."""
    sides = bounds.directions[0].leaves if bounds.directions else ()
    if not sides or bounds.sides != "free-field":
        return ""
    return (
        f"the ground slides out at the {listed(sides)} side, where the section was cut off; take fem.sides = "
        '"smooth" if it continues level there'
    )


def _assumed(section: Section, circle: CirclePart) -> str:
    """Return the reason why a circle may fail at a smaller Kh than the ground resists in equilibrium, and advice on
    what to do."""
    strata = _cut_steeply(section, circle)
    if not strata:
        return (
            ", although the circles cut no ground with friction steeply: compare both results with the finite "
            "elements before using one of them"
        )
    what = STEEPLY.format(strata=listed(strata))
    return f"{what}: rely on the strict bounds, and report the circles as the more cautious result"


def _cut_steeply(section: Section, circle: CirclePart) -> list[str]:
    """Return the names of the soils with friction that a circle cuts steeply, from the top down."""
    line = np.array(circle.surface_m)
    middle, step = 0.5 * (line[1:] + line[:-1]), np.diff(line, axis=0)
    steep = middle[np.abs(step[:, 1]) > STEEP_SLOPE * np.abs(step[:, 0])]
    numbers = np.unique(section.stratum_at(steep[:, 0], steep[:, 1]))
    strata = [section.strata[k] for k in numbers.tolist() if k >= 0]
    return list(dict.fromkeys(shown_name(s.name) for s in strata if s.friction_angle > 0.0))
