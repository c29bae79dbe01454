"""Defines the commands `noshiro study` and `noshiro converge`."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any

import typer

from workflow.cli.options import Json, Quiet, Scheduler, SectionFile, Set, Workers
from workflow.run.progress import Verbosity

if TYPE_CHECKING:
    from workflow.config import Config
    from workflow.run.store import Store

Tables = Mapping[str, Mapping[str, Any]]


def study(
    section: SectionFile,
    folder: Annotated[
        Path | None,
        typer.Option("--out", help="Folder of the study. [default: runs/<section name>_study]", show_default=False),
    ] = None,
    samples: Annotated[
        int | None, typer.Option(help="Number of samples; a larger number continues a smaller one.")
    ] = None,
    only: Annotated[
        list[str] | None,
        typer.Option("--only", help="What to compute: fem, bounds, block, slide; repeatable. [default: fem, block]"),
    ] = None,
    method: Annotated[str | None, typer.Option(help="sobol, latin, or saltelli for Sobol' indices.")] = None,
    seed: Annotated[int | None, typer.Option(help="Seed of the samples.")] = None,
    workers: Workers = None,
    scheduler: Scheduler = None,
    settings: Set = None,
    quiet: Quiet = False,
    json: Json = False,
) -> None:
    """Compute distributions and fragility by many samples of the numbers in [uncertain], on all processors or machines.

    If the study was stopped, the same command continues it, and computes only missing samples.
    """
    from workflow.cli.terminal import TaskCounter, say, say_data
    from workflow.report.study import sentences, write_page
    from workflow.study.ensemble import Ensemble
    from workflow.study.study import draw_all, run

    options = {"samples": samples, "method": method, "seed": seed}
    overrides = {"study": {key: value for key, value in options.items() if value is not None}}
    parts, verbosity = only or ["fem", "block"], Verbosity.of(quiet, False, json)
    config, store, warnings = _opened("study", section, folder, settings, parts, verbosity, overrides)
    with TaskCounter(silent=quiet or json) as counted:
        result = run(config, store, parts, Ensemble(store.folder, workers or config.dem.workers, scheduler), counted)
    draw_all(config.section, result.table, result.answer, store)
    answer = result.answer
    page = write_page(config, answer, store)
    if json:
        say_data({**answer.model_dump(mode="json"), "warnings": warnings})
    elif not quiet:
        for sentence in sentences(config, answer):
            say(sentence)
        say(f"Page: {page}; samples: {store.folder / 'samples.csv'}")
    result.refuse_parts_without_answer()


def converge(
    section: SectionFile,
    folder: Annotated[
        Path | None,
        typer.Option(
            "--out", help="Folder of the results. [default: runs/<section name>_converge]", show_default=False
        ),
    ] = None,
    within: Annotated[float, typer.Option(help="Largest remaining error (%).", min=0.01, max=100.0)] = 10.0,
    workers: Workers = None,
    scheduler: Scheduler = None,
    settings: Set = None,
    quiet: Quiet = False,
    json: Json = False,
) -> None:
    """Check whether slides converge: compute them with smaller discs (1, 0.71 and 0.5 of the radius) and smaller time
    steps.

    If the computation was stopped, the same command continues it.
    """
    from workflow.cli.terminal import TaskCounter, say, say_data
    from workflow.figures.study import convergence
    from workflow.study.converge import run
    from workflow.study.ensemble import Ensemble

    verbosity = Verbosity.of(quiet, False, json)
    config, store, warnings = _opened("converge", section, folder, settings, ["slide"], verbosity)
    ensemble = Ensemble(store.folder, workers or config.dem.workers, scheduler)
    with TaskCounter(silent=quiet or json) as counted:
        answer = run(config, store, within / 100.0, ensemble, counted)
    store.save("figures/converge.png", convergence(answer.series, config.section.heading))
    if json:
        return say_data({**answer.model_dump(mode="json"), "warnings": warnings})
    if not quiet:
        for series in answer.series:
            values = ", ".join(f"{value:.3g}" for value in series.values)
            say(f"{series.name} over the {series.refined}: {values}, tends to {series.limit:.3g}; {series.verdict}")
        say("All slides have converged." if answer.converged else "Not all slides have converged.")
        for reason in answer.missing:
            say(f"Without an answer: {reason}")
    return None


def _opened(
    command: str,
    section: Path,
    folder: Path | None,
    settings: Sequence[str] | None,
    parts: Sequence[str],
    verbosity: Verbosity,
    overrides: Tables = MappingProxyType({}),
) -> "tuple[Config, Store, list[str]]":
    """Return config and folder of a command, and its printed warnings: on old names of settings, and on settings of the
    command line that no part of a study reads."""
    from meshes.section.toml_file import read_toml
    from workflow.cli.invocation import dotted
    from workflow.cli.terminal import warn
    from workflow.config import merged
    from workflow.config.after_triggering import load_config
    from workflow.config.renamed import notices
    from workflow.run.store import Store

    changed = dotted(settings or [])
    config = load_config(section, merged(changed, overrides))
    old_words = notices(merged(read_toml(section), changed))
    warnings = warn([*old_words, *_unread(changed, command, parts)], verbosity)
    return config, Store(folder or Path("runs") / f"{config.section.name}_{command}"), warnings


def _unread(settings: Tables, command: str, parts: Sequence[str]) -> list[str]:
    """Return warnings on settings of the command line that no part of a study reads."""
    from workflow.cli.unread_settings import in_words, is_read, keys_of
    from workflow.stages import NAMES, command_of
    from workflow.study.parts import read_by

    reads = read_by(parts)
    unread = [key for key in keys_of(settings) if not is_read(key, reads)]
    return in_words(unread, command, [command_of(stage) for stage in NAMES])
