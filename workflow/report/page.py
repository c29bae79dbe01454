"""Renders report.html: one page for screen and paper, with all its pictures."""

import base64
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Any

from markupsafe import Markup

from fem.continuum.strength import flow_of, is_dilating_fully
from meshes.errors import InputError
from meshes.section.polyline import downhill
from meshes.section.section import Section
from workflow.config.tables import ReportSettings
from workflow.estimates.comparison import is_s13
from workflow.estimates.structures import structures_of
from workflow.figures import fonts
from workflow.figures.comparison import PICTURES
from workflow.figures.displacements import slides
from workflow.figures.front import FRONT
from workflow.figures.symbols import in_captions
from workflow.report import tables
from workflow.report.assumptions import assumptions
from workflow.report.captions import collect
from workflow.report.crests import holds_water
from workflow.report.faces import face_lines, note_sentences
from workflow.report.narrow_tables import labelled
from workflow.report.numbering import Labels, Notes
from workflow.report.numbers import case_numbers, number, scaled
from workflow.report.paper import rows
from workflow.report.player import films
from workflow.report.post_liquefaction import just_enough
from workflow.report.residual import residual_details
from workflow.report.second_opinion import second_opinions
from workflow.report.slices import above_bound, below_bound
from workflow.report.stability import stability_rows
from workflow.report.structures import circles_without_crest, face_rows
from workflow.report.summary_text import lies_still, moved_lately, springs_of
from workflow.report.templates import templates
from workflow.report.uncertainty import sources_of_uncertainty
from workflow.report.verdicts import interval_words, limit_words
from workflow.results.cases import equal_cases
from workflow.results.governing import estimates_of, faces_with_bounds
from workflow.results.lengths import metres
from workflow.results.results import Results
from workflow.results.summary import Summary
from workflow.results.verdicts import NOTE_WEIGHT
from workflow.run.log import machine, versions
from workflow.run.progress import duration
from workflow.texts.report_texts import Texts

MOST_TESTS = 60  # in a table
MOST_WARNINGS = 9  # on the first page
WARNINGS_PER_TABLE = 2  # warnings whose room a table of faces or crests takes
LAYERS = "figures/section.png"
VARIED = ("Mesh", "Element", "Step", "Dilation", "Side condition", "Random packing")  # rows of the sensitivity
# Parts of the page with a template of their own.
PARTS = {
    "triggering": "triggering.html.jinja", "residual": "residual.html.jinja", "liquefied": "liquefied.html.jinja",
    "response": "response.html.jinja", "mpm": "mpm.html.jinja", "structures": "structures.html.jinja",
    "crests": "crests.html.jinja", "verdicts": "verdicts.html.jinja", "tests": "tests.html.jinja",
}  # fmt: skip
LOGOS = {".png": "png", ".jpg": "jpeg", ".jpeg": "jpeg", ".svg": "svg+xml"}


def page(results: Results, summary: Summary) -> str:
    """Render the report as one HTML page that needs no other file.

    Parameters
    ----------
    results : results of all stages, with their pictures
    summary : what summary.json holds

    Returns
    -------
    The page, in the language of the settings.
    """
    environment = templates()
    environment.filters["css"] = _css_text
    environment.filters |= {"number": number, "scaled": scaled, "metres": metres, "duration": duration}
    texts = Texts(results.config.report.language)
    environment.globals |= {"_": texts, "alike": equal_cases, "joined": case_numbers}
    template, content = environment.get_template("template.html.jinja"), _content(results, summary, texts)
    first, second = Labels(texts), Labels(texts)
    template.render(content, labels=first)
    second.first_rendering, second.contents = first.numbers, first.sections
    return labelled(in_captions(texts.page(template.render(content, labels=second))))


def _content(results: Results, summary: Summary, texts: Texts) -> dict[str, Any]:
    """Return the content of the template."""
    config, uncertainty_rows = results.config, list(sources_of_uncertainty(results))
    faces = face_rows(config, results.slices, faces_with_bounds(results))
    room = MOST_WARNINGS - WARNINGS_PER_TABLE * (bool(faces) + bool(summary.crests))
    first = [warning for warning in summary.warnings if warning.weight < NOTE_WEIGHT][:room]
    checks = [row for row in uncertainty_rows if row[0] not in VARIED]
    return {
        "config": config,
        "results": results,
        "summary": summary,
        "title": config.section.heading,
        "head": _title_block(config.report),
        "logo": _logo(config.report.logo),
        "written": datetime.now().isoformat(" ", "minutes"),
        "strata_heads": [head.strip().replace("\n", ", ") for head in tables.STRATA_HEADS],
        "strata": list(tables.strata_rows(config.section)),
        "springs": springs_of(results),
        "flow": flow_of(config.section.strata, config.fem.flow),
        "with_discs": results.dem is not None or results.calibration is not None or results.cases is not None,
        "by_davis": not is_dilating_fully(config.section.strata),
        "by_limit_analysis": results.fem is not None and results.fem.by_limit_analysis,
        "sensitivity": [row for row in uncertainty_rows if row[0] in VARIED],
        "checks": checks,
        "later_warnings": [
            warning
            for warning in summary.warnings
            if warning not in first and not any(warning.observation in words for _, words in checks)
        ],
        "stability": stability_rows(results, texts),
        "strata_sources": [tables.source_of(config.section, stratum) for stratum in config.section.strata],
        "parameters": list(tables.parameter_rows(config)),
        "cases": results.case_set()[1],
        "opinions": second_opinions(results.cases, results.mpm),
        "first_warnings": first,
        "thirds": _names_of_thirds(config.section, texts),
        "weights": {1: texts("contradiction"), 2: texts("changes the result"), 3: texts("note")},
        "assumptions": list(assumptions(config)),
        "enough": just_enough(results.liquefied) if results.liquefied else None,
        "residual": list(residual_details(results.residual.steps)) if results.residual is not None else [],
        "faces": faces,
        "holds_water": holds_water(config),
        "crests": summary.crests or (),
        "verdicts": summary.criteria or (),
        "limit_words": limit_words,
        "interval_words": interval_words,
        "above_bound": above_bound,
        "below_bound": below_bound,
        "elsewhere": list(circles_without_crest(config, results.slices)),
        "lines_of_faces": face_lines(results),
        "face_notes": list(note_sentences(results)) if faces else [],
        "estimates": estimates_of(results),
        "slides": list(slides(results)),
        "paper": rows(results),
        "is_s13": is_s13(config.section),
        "pictures": _pictures(results, texts),
        "films": films(results) if config.figures.report_animations else [],
        "Notes": Notes,
        "most_tests": MOST_TESTS,
        "fonts": fonts.notice(tables.texts(config.section)),
        "lies_still": lies_still,
        "moved_lately": moved_lately,
        "stages": results.stages,
        "parts": PARTS,
        "versions": versions(),
        "machine": machine(),
        "written_heads": [symbol for _, symbol, _ in tables.written_columns(config.section)],
        "written_rows": list(tables.written_rows(config.section)),
        "lines": list(tables.line_rows(config.section)),
        "changed": [(name, value, texts.setting(words)) for name, value, words in tables.changed_settings(config)],
    }


def _names_of_thirds(section: Section, texts: Texts) -> tuple[str, str, str]:
    """Return the names of the thirds of the surface, from the higher end, or by side if an embankment has two
    slopes."""
    if not structures_of(section):
        return texts("upslope third"), texts("middle third"), texts("downslope third")
    left, right = texts("left third"), texts("right third")
    first, last = (left, right) if downhill(section.ground) > 0 else (right, left)
    return first, texts("middle third"), last


def _css_text(text: str) -> Markup:
    """Return a text within quotes in a style sheet."""
    return Markup(
        "".join(letter if letter.isalnum() or letter in " .,-_" else f"\\{ord(letter):x} " for letter in text)
    )


def _title_block(report: ReportSettings) -> list[tuple[str, str]]:
    """Return the title block of the report: pairs of a word and a text."""
    return [
        (name, text) for name, text in report if name not in ("logo", "language") and isinstance(text, str) and text
    ]


def _logo(file: str) -> str:
    """Return the logo as a URI of data; empty without one. Raises InputError if it cannot be read."""
    if not file:
        return ""
    kind = LOGOS.get(Path(file).suffix.lower())
    if kind is None:
        raise InputError("report, logo", [f"{file}: expected a picture, one of {', '.join(LOGOS)}"])
    try:
        data = Path(file).read_bytes()
    except OSError as error:
        raise InputError("report, logo", [f"{file}: cannot be read: {error.strerror}"]) from None
    return f"data:image/{kind};base64,{base64.b64encode(data).decode()}"


def _pictures(results: Results, texts: Texts) -> dict[str, list[Any]]:
    """Return the pictures of this run, by the section of the report."""
    names = [name for entry in results.ends.values() for name in entry.pictures]
    names += [name for name in PICTURES if results.store.has(name)]
    by_part: dict[str, list[Any]] = {}
    groups = {f"figures/case{numbers[0]}.png": numbers for numbers in equal_cases(results.case_set()[1])}
    again = {f"figures/case{number}.png" for numbers in groups.values() for number in numbers[1:]}
    for picture in collect(names, results.store.folder, results.config.figures.report_width, texts):
        shown_before = (picture.name == LAYERS and FRONT in names) or picture.name in again
        if len(numbers := groups.get(picture.name, ())) > 1:
            words = texts("Calibrated discs in cases {cases}, whose slides are equal.", cases=case_numbers(numbers))
            picture = replace(picture, caption=words)
        by_part.setdefault(picture.section if picture.main and not shown_before else "further", []).append(picture)
    return by_part
