"""report.html: one page that holds everything, to be read on a screen or on paper."""

from datetime import datetime
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape

from workflow.estimates.comparison import constant_kh, estimates
from workflow.figures.fem import conditions
from workflow.report import tables
from workflow.report.captions import collect
from workflow.report.paper import is_s13, rows
from workflow.report.uncertainty import doubts
from workflow.results.results import Results
from workflow.results.summary import Summary
from workflow.run.log import machine, versions
from workflow.run.progress import duration


def page(results: Results, summary: Summary) -> str:
    """The report as HTML; nothing in it is fetched from anywhere."""
    environment = Environment(
        loader=PackageLoader("workflow.report", "."),
        autoescape=select_autoescape(default_for_string=True, default=True),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"number": number, "scaled": scaled, "metres": metres, "duration": duration}
    return environment.get_template("template.html.jinja").render(
        run=results.run,
        results=results,
        summary=summary,
        title=results.run.title or results.run.name,
        written=datetime.now().isoformat(" ", "minutes"),
        strata_heads=[head.strip().replace("\n", ", ") for head in tables.STRATA_HEADS],
        strata=list(tables.strata_rows(results.run)),
        conditions=conditions(results.run, results.fem.element) if results.fem is not None else "",
        doubts=list(doubts(results)),
        estimates=estimates(results.run, results.kc),
        kh=constant_kh(results.run),
        paper=rows(results),
        is_s13=is_s13(results.run),
        pictures=_pictures(results),
        stages=results.stages,
        versions=versions(),
        machine=machine(),
        input=results.run.to_toml(),
    )


def _pictures(results: Results) -> dict[str, list[Any]]:
    """The pictures of what belongs to the input, by the part of the report."""
    from workflow.figures.comparison import PICTURES

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


def scaled(value: float | None, unit: float) -> float | None:
    """A value in multiples of a unit, where there is one."""
    return None if value is None else value / unit


def metres(value: float | None) -> str:
    """A length in metres to the centimetre, or a dash."""
    return "–" if value is None else f"{value:.2f} m"
