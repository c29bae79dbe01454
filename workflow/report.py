"""report.html: one page that holds everything, to be read on a screen or on paper."""

from collections.abc import Iterator
from datetime import datetime
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape

from workflow import tables
from workflow.comparison import constant_kh, estimates
from workflow.fem_figures import conditions
from workflow.log import machine, versions
from workflow.pictures import collect
from workflow.progress import duration
from workflow.reference import is_s13, rows
from workflow.results import Results
from workflow.stages import stages

STAGE_OF_PART = {"mesh": "ground", "fem": "fem", "bounds": "bounds", "calibrate": "dem", "slide": "slide"}


def page(results: Results, summary: dict[str, Any]) -> str:
    """The report as HTML; nothing in it is fetched from anywhere."""
    environment = Environment(
        loader=PackageLoader("workflow", "."),
        autoescape=select_autoescape(default_for_string=True, default=True),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"number": number, "metres": metres, "duration": duration}
    return environment.get_template("report.html.jinja").render(
        run=results.run,
        results=results,
        summary=summary,
        title=results.run.title or results.run.name,
        written=datetime.now().isoformat(" ", "minutes"),
        strata_heads=[head.strip().replace("\n", ", ") for head in tables.STRATA_HEADS],
        strata=list(tables.strata_rows(results.run)),
        conditions=conditions(results.run, results.fem["element"]) if results.fem else "",
        doubts=list(doubts(results)),
        estimates=estimates(results.run, results.kc),
        kh=constant_kh(results.run),
        paper=rows(results),
        is_s13=is_s13(results.run),
        case_set=results.case_set(),
        pictures=_pictures(results),
        stages=[stage for stage in stages() if stage.name != "report"],
        versions=versions(),
        machine=machine(),
        input=results.run.to_toml(),
    )


def _pictures(results: Results) -> dict[str, list[Any]]:
    """The pictures of what belongs to the input, by the part of the report."""
    from workflow.report_figures import PICTURES

    names = [name for entry in results.ends.values() for name in entry.pictures]
    names += [name for name in PICTURES if results.store.has(name)]
    settings = results.run.figures
    by_part: dict[str, list[Any]] = {}
    for picture in collect(names, results.store.folder, settings.report_width, settings.report_animations):
        by_part.setdefault(picture.part, []).append(picture)
    return by_part


def number(value: float | None, digits: int = 3) -> str:
    """A number to so many places, or a dash."""
    return "–" if value is None else f"{value:.{digits}f}"


def metres(value: float | None) -> str:
    """A length in metres to the centimetre, or a dash."""
    return "–" if value is None else f"{value:.2f} m"


def doubts(results: Results) -> Iterator[tuple[str, str]]:
    """On what the answers hang, and what is known of how much: pairs of a heading and sentences."""
    fem = results.fem
    if fem is not None:
        yield (
            "Bracket",
            (
                f"Kh = {fem['kc_lower']:.4f} stood, with every step converged to {fem['settings']['tolerance']:g} of the weight; "
                f"the path rises to at most {fem['kc_upper']:.4f}. Why it ended: {fem['reason']}."
            ),
        )
        yield (
            "Mesh",
            (
                f"{fem['mesh']['quadrilaterals']} quadrilaterals ({fem['mesh']['method']}), {fem['element']} element. "
                "A mesh twice as fine gives less; on S-13 the quadratic element loses 1.3 % and the bilinear one 5 % "
                "(fem/README.md). Check with --set mesh.refine=2."
            ),
        )
        yield (
            "Step",
            (
                f"First step of Kh {fem['settings']['first_step']:g}, then as Newton's method allows; Kh is an unknown on the path, "
                "not a number at which a solver gave up. Other steps changed the critical Kh of S-13 by less than 0.5 %."
            ),
        )
        yield "Dilation", _dilation(results)
        yield "Side condition", _sides(results)
    if results.bounds is not None:
        yield "Strict bounds", _bounds(results)
    if results.dem is not None:
        model = results.dem["model"]
        yield (
            "Packing",
            (
                f"{model['packing']}, {model['elements']} discs of {model['radius_m']:g} m. On a triangular lattice rows must climb "
                "over each other, 30° of dilation that no parameter takes away; the critical Kh is calibrated, the "
                "volume change of the lattice is not."
            ),
        )
        surfaces = results.dem["slip_surface"]
        if surfaces.get("mean_distance_m") is not None:
            yield (
                "Slip surface",
                (
                    f"Discs and continuum fail {surfaces['mean_distance_m']:.1f} m apart on average, in the same layer along "
                    f"{100 * surfaces['same_stratum_share']:.0f} % of the length."
                ),
            )
    random = results.cases.get("random") if results.cases else None
    if random:
        told = "; ".join(
            f"case {case}: {values['slide_max_m']['mean']:.2f} ± {values['slide_max_m']['spread']:.2f} m"
            for case, values in sorted(random["cases"].items())
        )
        yield "Random packing", f"Largest slide over {len(random['seeds'])} packings, mean and spread: {told}."


def _dilation(results: Results) -> str:
    if results.run.fem.flow == "associated":
        return "ψ = φ, which real soils do not have: an upper limit, often by a fifth."
    return (
        "Dilation angles as given for each stratum. With ψ = φ the critical Kh would be larger, for S-13 by a fifth; "
        "check with --set fem.flow=associated."
    )


def _sides(results: Results) -> str:
    words = {
        "roller": "The sides may move horizontally under their K0 stress, and not vertically",
        "fixed": "The sides are held in both directions, which helps the slope to stand",
        "tied": "Both sides move alike: the section is one of many in a row",
    }
    return words[results.run.fem.sides] + ". For S-13 fixed sides raise the critical Kh by a quarter or more."


def _bounds(results: Results) -> str:
    bounds = results.bounds
    assert bounds is not None
    told = (
        f"With ψ = φ the critical Kh lies between {bounds['lower']:.4f} and {bounds['upper']:.4f} "
        f"({bounds['sides']} sides)."
    )
    if results.kc is None or results.run.fem.flow != "associated" or results.run.fem.sides != bounds["sides"]:
        return told + " The answer above is for other conditions, and is not judged by them."
    inside = bounds["lower"] <= results.kc <= bounds["upper"]
    return told + (" The FEM's lies inside." if inside else " The FEM's lies outside: refine the mesh.")
