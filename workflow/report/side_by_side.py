"""Compares several runs: differences of their inputs, results, and pictures."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from os.path import commonpath
from pathlib import Path
from typing import Any

from meshes.errors import InputError
from workflow.config import Config
from workflow.config.after_triggering import load_config
from workflow.report.captions import Picture, collect
from workflow.report.numbers import bracket, number
from workflow.report.tables import setting_text
from workflow.report.templates import templates
from workflow.results.cases import CaseNumbers
from workflow.results.lengths import metres
from workflow.results.summary import Summary
from workflow.run.store import Store

WIDTH = 900  # px of a picture: several are shown in a row


@dataclass(frozen=True)
class ComparedRun:
    """Holds a run in a comparison.

    Attributes
    ----------
    folder : folder of the run
    config : its section and settings
    summary : its results
    """

    folder: Path
    config: Config
    summary: Summary


def read(folders: Sequence[Path]) -> list[ComparedRun]:
    """Return the runs in some folders.

    Parameters
    ----------
    folders : folders of finished runs

    Returns
    -------
    The runs, in the order of the folders.

    Raises
    ------
    InputError : if a folder holds no run; every such folder is named
    """
    summaries, problems = [], []
    for folder in folders:
        try:
            path = folder / "section.toml"
            config = load_config(path)
            summaries.append(ComparedRun(folder, config, Summary.read(Store(folder))))
        except InputError as error:
            problems += [f"{error.source}: {problem}" for problem in error.problems]
    if problems:
        remedy = "noshiro report FOLDER writes the report and summary.json of a run of single commands"
        raise InputError("compare", [*problems, f"expected folders of runs with a report: {remedy}"])
    return summaries


def differences(runs: Sequence[ComparedRun]) -> Iterator[tuple[str, list[str]]]:
    """Yield the settings in which the inputs differ.

    Parameters
    ----------
    runs : the compared runs

    Yields
    ------
    Name of a setting, and its value in each run.
    """
    flat = [dict(_leaves(run.config.to_data(), "")) for run in runs]
    for key in dict.fromkeys(key for values_of_run in flat for key in values_of_run):
        values = [setting_text(values_of_run[key]) if key in values_of_run else "–" for values_of_run in flat]
        if len(set(values)) > 1:
            yield key, values


def _leaves(data: Any, name: str) -> Iterator[tuple[str, Any]]:
    """Yield the values of nested tables by their dotted names; strata by the names of strata."""
    if isinstance(data, dict):
        for key, value in data.items():
            yield from _leaves(value, f"{name}.{key}" if name else key)
    elif isinstance(data, list) and data and all(isinstance(item, dict) for item in data):
        for place, item in enumerate(data, start=1):
            yield from _leaves(item, f"{name} {item.get('name', place)}")
    else:
        yield name, data


def run_names(runs: Sequence[ComparedRun]) -> list[str]:
    """Return the folders of the runs, without the common part of their paths.

    Parameters
    ----------
    runs : the compared runs

    Returns
    -------
    A name for each run.
    """
    shared = commonpath([run.folder.absolute().parent for run in runs])
    return [str(run.folder.absolute().relative_to(shared)) for run in runs]


def rows(runs: Sequence[ComparedRun]) -> Iterator[tuple[str, list[str]]]:
    """Yield the results as rows. Quantities that no run has are left out.

    Parameters
    ----------
    runs : the compared runs

    Yields
    ------
    Name of a quantity, and its value in each run.
    """
    for name, values in _all_rows(runs):
        if set(values) != {"–"}:
            yield name, values


def _all_rows(runs: Sequence[ComparedRun]) -> Iterator[tuple[str, list[str]]]:
    columns: dict[str, Callable[[Summary], str]] = {
        "section": lambda summary: f"{summary.section.name}, {summary.section.sha256[:12]}",
        "sides": lambda summary: summary.fem.sides if summary.fem else "–",
        "critical Kh, finite elements": _continuum,
        "strict bounds, ψ = φ": lambda summary: (
            bracket(summary.bounds.lower, summary.bounds.upper, 3) if summary.bounds else "–"
        ),
        "factor of safety at Kh = 0": _safety,
        "critical Kh, uncalibrated discs": lambda summary: number(summary.dem.kc_uncalibrated) if summary.dem else "–",
        "critical Kh, discs": lambda summary: number(summary.dem.kc) if summary.dem else "–",
        "factor on the discs": lambda summary: (
            number(summary.dem.calibrated.value) if summary.dem and summary.dem.calibrated else "–"
        ),
    }
    for name, tell in columns.items():
        yield name, [tell(run.summary) for run in runs]
    for case in sorted({case for run in runs for case in run.summary.cases or {}}):
        cases_of_runs = [(run.summary.cases or {}).get(case) for run in runs]
        yield f"case {case}: largest slide", [_slide(summary) for summary in cases_of_runs]
        yield (
            f"case {case}: settlement, upslope third",
            [metres(summary.settlement_uphill_m) if summary else "–" for summary in cases_of_runs],
        )
    yield "computing time", [f"{sum(run.summary.seconds.values()):.0f} s" for run in runs]


def _continuum(summary: Summary) -> str:
    fem = summary.fem
    if summary.fails_at_rest:
        return "below 0 (fails without shaking)"
    if fem is None:
        return "–"
    return (
        f"{number(fem.kc)} ({fem.verdict})" if fem.kc is not None else f"above {number(fem.kc_lower)} ({fem.verdict})"
    )


def _safety(summary: Summary) -> str:
    if summary.failure is not None:
        return f"{summary.failure.factor:.2f}"
    factors = summary.fem.safety_factors if summary.fem is not None else ()
    return next((f"{factor.factor:.2f}" for factor in factors if factor.kh == 0.0), "–")


def _slide(case: CaseNumbers | None) -> str:
    if case is None:
        return "–"
    return metres(case.slide_max_m) + ("" if case.settled else ", not at rest")


def page(runs: Sequence[ComparedRun]) -> str:
    """Return the comparison as one HTML page with the pictures of all runs; it needs no other file."""
    pictures = [_pictures(run.folder) for run in runs]
    names = dict.fromkeys(name for pictures_of_run in pictures for name in pictures_of_run)
    return (
        templates()
        .get_template("side_by_side.html.jinja")
        .render(
            runs=run_names(runs),
            differences=list(differences(runs)),
            rows=list(rows(runs)),
            pictures=[(name, [pictures_of_run.get(name) for pictures_of_run in pictures]) for name in names],
        )
    )


def write_page(runs: Sequence[ComparedRun], path: Path) -> None:
    """Write the page that compares runs.

    Parameters
    ----------
    runs : the compared runs
    path : the HTML file

    Raises
    ------
    InputError : if the file cannot be written
    """
    try:
        path.write_text(page(runs), encoding="utf-8")
    except OSError as error:
        raise InputError(str(path), [f"cannot be written: {error.strerror or error}"]) from None


def _pictures(folder: Path) -> dict[str, Picture]:
    names = sorted(str(path.relative_to(folder)) for path in (folder / "figures").glob("*.png"))
    return {picture.name: picture for picture in collect(names, folder, WIDTH)}
