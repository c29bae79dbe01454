"""States the sensitivity of the results to mesh, step, dilation, sides, bounds and packing."""

from collections.abc import Iterator

from workflow.report.assumptions import FLOWS, SIDES
from workflow.report.console import meshes_sentences
from workflow.report.flow_rule import critical_with_flow
from workflow.report.numbers import coefficient
from workflow.report.summary_text import fail_alike
from workflow.report.warnings import assumed_input
from workflow.results.bounds import BoundsAnswer
from workflow.results.continuum import FemAnswer, Variant
from workflow.results.discs import DiscsAnswer
from workflow.results.results import Results
from workflow.texts.report_texts import listed

TENSION = "Ground with a cohesion resists tension, up to c / tan φ without a tension cut-off. Open cracks resist none."
ROUNDED_SHARE = 0.005  # a share of Kh that is none in whole per cent


def sources_of_uncertainty(results: Results) -> Iterator[tuple[str, str]]:
    """Yield the sources of uncertainty as pairs of a heading and sentences."""
    assumed = assumed_input(results)  # which stands among the warnings
    notices = [text for text in results.config.notices if text not in assumed]
    if notices:
        yield "Ground and mesh", " ".join(f"{text[0].upper()}{text[1:]}." for text in notices)
    if results.older:
        yield (
            "Version of the program",
            f"Results of {listed(results.older)} were computed by another version of the program than this report; "
            "noshiro run computes them again.",
        )
    if results.fem is not None:
        variants = results.variants.variants if results.variants is not None else ()
        seen = {variant.name: _seen(variant, results.kc) for variant in variants}
        for heading, words, name in _continuum(results, results.fem):
            yield heading, f"{words} {seen[name]}".strip() if name in seen else words
    if results.bounds is not None:
        yield "Strict bounds", _bounds(results, results.bounds)
    random = results.cases.random if results.cases is not None else None
    if results.dem is not None:
        yield from _discs(results.dem, several=random is not None and len(random.seeds) > 1)
    if random is not None and any(case.slide_max_m.values for case in random.cases.values()):
        rows = results.dem is not None and results.dem.model.packing != "random"
        yield (
            "Random packing",
            f"The table below shows the cases on random packings {fail_alike(results)}: "
            + (
                "slides that are the same on random packings and on discs in rows do not depend on the order of the "
                "rows."
                if rows
                else "their differences are due to the random packing alone."
            ),
        )


def _meshes(fem: FemAnswer, results: Results) -> Iterator[str]:
    """Yield sentences on the dependence of the critical Kh on the mesh."""
    phrases = list(meshes_sentences(fem, results))
    yield from phrases or [
        "A finer mesh gives a smaller Kh. The option --set 'variants.which=[\"mesh\"]' computes how much smaller."
    ]


def _seen(variant: Variant, kc: float | None) -> str:
    """Return the result of a variant, in words."""
    if variant.kc is None or kc is None:
        return f"In this run, with {variant.change}: {variant.verdict}, {variant.reason}."
    without = variant.kc_without or kc
    comparison = f" instead of {coefficient(without)}" if variant.kc_without is not None else ""
    by = 100.0 * (variant.kc / without - 1.0)
    change_words = f"{by:+.1f} %" if abs(by) >= 0.05 else "no change"
    kh_words = f"{coefficient(variant.kc)}{comparison} ({change_words})"
    return f"In this run, with {variant.change}, the critical Kh is {kh_words}."


def _continuum(results: Results, fem: FemAnswer) -> Iterator[tuple[str, str, str]]:
    """Yield heading and sentences of every source of uncertainty of the finite elements, with the name of the variant
    that shows its influence."""
    mesh = fem.mesh
    yield "Bracket", _bracket(fem), ""
    yield (
        "Mesh",
        " ".join(
            [f"{mesh.quadrilaterals} quadrilaterals ({mesh.method}), {fem.element} element.", *_meshes(fem, results)]
        ),
        "mesh",
    )
    yield (
        "Element",
        "On a mesh that is too coarse the quadratic and the reduced element give different results.",
        "element",
    )
    yield (
        "Step",
        "The critical Kh follows from finite element limit analysis, which has no steps of Kh."
        if fem.by_limit_analysis
        else f"The first step of Kh was {fem.settings.first_step:g}. Kh is an unknown of the equilibrium path: the "
        "critical Kh is not the value at which the solver failed to converge.",
        "step",
    )
    yield "Dilation", _dilation(fem), "dilation"
    yield "Side condition", SIDES[results.config.fem.sides], "sides"
    yield "Tensile strength", TENSION, "tension"


def _bracket(fem: FemAnswer) -> str:
    """Return the limit load of the mesh, or the end of the path that was followed to find it."""
    if fem.by_limit_analysis:
        return (
            f"The limit load of this mesh by finite element limit analysis is Kh = {coefficient(fem.kc)}. "
            f"Displacements were computed up to Kh = {coefficient(fem.kc_lower)}, with every step in equilibrium to "
            f"{fem.settings.tolerance:g} of the weight."
        )
    return (
        f"At Kh = {coefficient(fem.kc_lower)} the ground was in equilibrium, with every step converged to "
        f"{fem.settings.tolerance:g} of the weight; on this mesh the path rises to at most "
        f"{coefficient(fem.kc_upper)}. Why the path ended: {fem.reason}."
    )


def _dilation(fem: FemAnswer) -> str:
    """Return the assumed flow rule, and the critical Kh by the other flow rule."""
    how = FLOWS[fem.flow]
    if fem.associated is None and fem.davis is None:
        return how
    return f"{how} Critical Kh {critical_with_flow(fem, coefficient)}."


def _bounds(results: Results, bounds: BoundsAnswer) -> str:
    """Return sentences on the strict bounds, and whether the critical Kh of the FEM lies within them if the conditions
    are the same.
    """
    phrase = f"{bounds.description} ({bounds.sides} sides; {bounds.flow.rstrip('.')})."
    contradictions = [f"{warning.observation} To do: {warning.remedy}." for warning in results.warnings_by_bounds()]
    return " ".join([phrase, *(contradictions or ["No result of the finite elements contradicts these bounds."])])


def _discs(dem: DiscsAnswer, several: bool) -> Iterator[tuple[str, str]]:
    """Yield sentences on the packing of the discs; ``several``: whether several packings were computed."""
    model, surfaces = dem.model, dem.slip_surface
    phrase = f"Packing: {model.packing}, {model.elements} discs of {model.radius_m:.3g} m radius."
    if model.surface_off_mean_m is not None and model.surface_off_worst_m is not None:
        phrase += (
            f" Before the slide the surface of the discs lies {model.surface_off_mean_m:.2f} m from the section's on "
            "average, and "
            f"{model.surface_off_worst_m:.2f} m at the worst place."
        )
    if model.packing != "random":
        phrase += (
            " On a triangular lattice rows must climb over each other, a dilation of 30° that no parameter removes: "
            "the critical Kh is calibrated, the volume change of the lattice is not."
        )
    else:
        phrase += f" Voids take {100.0 * model.porosity:.0f} % of the area. Another seed gives another packing"
        phrase += "." if several else "; --set 'slide.seeds=[1, 2, 3]' shows the influence of the packing."
    yield "Packing", phrase
    if surfaces.mean_distance_m is not None and surfaces.same_stratum_share is not None:
        deeper = ""
        if surfaces.excess_above is not None and surfaces.excess_above < ROUNDED_SHARE:
            deeper = " The slip surface of the discs lies higher; along it the continuum would fail at the same Kh."
        elif surfaces.excess_above is not None:
            deeper = (
                " The slip surface of the discs lies higher; along it the continuum would fail at a Kh that is "
                f"{100 * surfaces.excess_above:.0f} % larger."
            )
        yield (
            "Slip surface",
            "Where both exist, the slip surfaces of the discs and of the continuum lie "
            f"{surfaces.mean_distance_m:.1f} m apart vertically on average; along "
            f"{100 * surfaces.same_stratum_share:.0f} % of this extent they lie in the same layer." + deeper,
        )
