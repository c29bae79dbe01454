"""On what the answers hang, and by how much: mesh, step, dilation, sides, bounds, packing."""

from collections.abc import Iterator

from workflow.results.bounds import BoundsAnswer
from workflow.results.continuum import FemAnswer
from workflow.results.discs import DiscsAnswer
from workflow.results.results import Results
from workflow.results.variants import Variant

SIDES = {
    "roller": "The sides may move horizontally under their K0 stress, and not vertically",
    "fixed": "The sides are held in both directions, which helps the slope to stand",
    "tied": "Both sides move alike: the section is one of many in a row",
}


def doubts(results: Results) -> Iterator[tuple[str, str]]:
    """Pairs of a heading and sentences."""
    if results.fem is not None:
        variants = results.variants.variants if results.variants is not None else ()
        seen = {variant.name: _seen(variant, results.kc) for variant in variants}
        for heading, words, name in _continuum(results, results.fem):
            yield heading, f"{words} {seen[name]}".strip() if name in seen else words
    if results.bounds is not None:
        yield "Strict bounds", _bounds(results, results.bounds)
    if results.dem is not None:
        yield from _discs(results.dem)
    random = results.cases.random if results.cases is not None else None
    if random is not None and any(case.slide_max_m.values for case in random.cases.values()):
        yield (
            "Random packing",
            (
                "The table below has the cases on random packings, calibrated to the same critical Kh: what they share "
                "with the lattice does not come from its order."
            ),
        )


def _seen(variant: Variant, kc: float | None) -> str:
    """What a variant came to, in words."""
    if variant.kc is None or kc is None:
        return f"Here, {variant.change}: {variant.verdict}, {variant.reason}."
    by = 100.0 * (variant.kc / kc - 1.0)
    return f"Here, {variant.change}: critical Kh = {variant.kc:.4f} ({by:+.1f} %)."


def _continuum(results: Results, fem: FemAnswer) -> Iterator[tuple[str, str, str]]:
    """Heading, sentences, and the name of the variant that shows it."""
    settings, mesh = fem.settings, fem.mesh
    yield (
        "Bracket",
        f"Kh = {fem.kc_lower:.4f} stood, every step converged to {settings.tolerance:g} of the weight; the path "
        f"rises to at most {fem.kc_upper:.4f}. Why it ended: {fem.reason}.",
        "",
    )
    yield (
        "Mesh",
        f"{mesh.quadrilaterals} quadrilaterals ({mesh.method}), {fem.element} element. A finer mesh gives "
        "less: one twice as fine takes 1.3 % off S-13 with the quadratic element and 5 % with the bilinear one "
        "(fem/README.md). To see it here: --set 'variants.which=[\"mesh\"]'.",
        "mesh",
    )
    yield "Element", "Where a mesh is too coarse the two elements differ.", "element"
    yield (
        "Step",
        f"The first step of Kh was {settings.first_step:g}. Kh is an unknown on the path, and not a number at "
        "which a solver gave up: first steps from 0.005 to 0.05 changed the critical Kh of S-13 by less than 0.5 %.",
        "step",
    )
    flow = (
        "ψ = φ, which no real soil has: an upper limit, often by a fifth."
        if results.run.fem.flow == "associated"
        else "Dilation angles as given for each stratum. With ψ = φ the critical Kh of S-13 is larger by a fifth."
    )
    yield "Dilation", flow, "dilation"
    yield (
        "Side condition",
        f"{SIDES[results.run.fem.sides]}. Fixed sides raise the critical Kh of S-13 by a quarter or more.",
        "sides",
    )


def _bounds(results: Results, bounds: BoundsAnswer) -> str:
    """Whether the critical Kh of the FEM lies inside, where it is one of the same conditions."""
    run = results.run
    told = f"{bounds.words} ({bounds.sides} sides; {bounds.flow.rstrip('.')})."
    same = run.fem.flow == "associated" and run.fem.sides == bounds.sides
    if results.kc is None or not same:
        return told + " The FEM's critical Kh above is for other conditions (flow or sides), and is not judged by it."
    if bounds.lower is not None and results.kc < bounds.lower:
        return told + " The FEM's critical Kh is below the lower bound: it found less than there is."
    if bounds.upper is not None and results.kc > bounds.upper:
        return told + " The FEM's critical Kh is above the upper bound: refine the mesh."
    return told + " The FEM's critical Kh lies inside."


def _discs(dem: DiscsAnswer) -> Iterator[tuple[str, str]]:
    model, surfaces = dem.model, dem.slip_surface
    told = f"Packing: {model.packing}, {model.elements} discs of {model.radius_m:.3g} m."
    if model.packing != "random":
        told += (
            " On a triangular lattice rows must climb over each other, 30° of dilation that no parameter takes away: "
            "the critical Kh is calibrated, the volume change of the lattice is not."
        )
    else:
        told += (
            f" Voids take {100.0 * model.porosity:.0f} % of the area. Another seed packs them differently; "
            "--set 'slide.seeds=[1, 2, 3]' says how much that matters."
        )
    yield "Packing", told
    if surfaces.mean_distance_m is not None and surfaces.same_stratum_share is not None:
        yield (
            "Slip surface",
            f"Discs and continuum fail {surfaces.mean_distance_m:.1f} m apart on average, in the same layer along "
            f"{100 * surfaces.same_stratum_share:.0f} % of the length.",
        )
