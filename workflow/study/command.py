"""The command `noshiro study`."""

from pathlib import Path
from typing import Annotated

import typer

from workflow.options import Json, Quiet, Scheduler, SectionFile, Set, Workers


def study(
    section: SectionFile,
    folder: Annotated[
        Path | None,
        typer.Option("--out", help="Folder of the study. [default: runs/<section name>_study]", show_default=False),
    ] = None,
    samples: Annotated[int | None, typer.Option(help="Samples to draw; more go on from fewer.")] = None,
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
    """What if: many samples of the numbers in [uncertain], on all processors or machines; distributions and fragility.

    The same command goes on where it was stopped, and computes only what is new.
    """
    from workflow.ensemble.ensemble import Ensemble
    from workflow.report.study import sentences, write_page
    from workflow.run.store import Store
    from workflow.settings import Input, dotted, merged
    from workflow.study.pictures import draw_all
    from workflow.study.study import run
    from workflow.study.watch import Counted
    from workflow.terminal import say, say_data

    options = {"samples": samples, "method": method, "seed": seed}
    asked = {"study": {key: value for key, value in options.items() if value is not None}}
    given = Input.load(section, merged(dotted(settings or []), asked))
    store = Store(folder or Path("runs") / f"{given.name}_study")
    parts = only or ["fem", "block"]
    with Counted(silent=quiet or json) as counted:
        found = run(given, store, parts, Ensemble(store.folder, workers or given.dem.workers, scheduler), counted)
    draw_all(given, found.table, found.answer, store)
    answer = found.answer
    page = write_page(given, answer, store)
    if json:
        return say_data(answer.model_dump(mode="json"))
    if not quiet:
        for sentence in sentences(given, answer):
            say(sentence)
        say(f"Page: {page}; samples: {store.folder / 'samples.csv'}")
    return None
