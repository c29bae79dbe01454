"""Defines the command `python -m docs.verify` of a checkout for the collections of published slopes and known
slides."""

from json import dumps
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from docs.verify.record import PARTS
from docs.verify.slides.command import verify_slides
from docs.verify.slopes import verify_slopes
from meshes.errors import InputError
from workflow.cli.exit_codes import exit_as_program
from workflow.run.spelling import is_legible

JSON_OPTION = typer.Option(
    help="Also write the rows as JSON to this file; - for standard output, which then has nothing else.",
    allow_dash=True,
    dir_okay=False,
    show_default=False,
)
FOLDER_OPTION = typer.Option(
    help="Folder of the cases; by default tests/verification/published, or slides with --slides.", show_default=False
)

PACKINGS_OPTION = typer.Option(
    min=1,
    max=50,
    help="Number of random packings of every known slide; by default that of its file.",
    show_default=False,
)


def verify(
    names: Annotated[
        list[str] | None, typer.Argument(help="Cases whose names begin with one of these words; all by default.")
    ] = None,
    folder: Annotated[Path | None, FOLDER_OPTION] = None,
    only: Annotated[
        list[str] | None, typer.Option(help="bounds, associated or davis; repeatable.", show_default=False)
    ] = None,
    judge: Annotated[bool, typer.Option("--judge", help="Compute nothing; compare the stored answers.")] = False,
    json: Annotated[Path | None, JSON_OPTION] = None,
    slides: Annotated[bool, typer.Option("--slides", help="Known slides instead of published slopes.")] = False,
    packings: Annotated[int | None, PACKINGS_OPTION] = None,
) -> None:
    """Compute the answers of published slopes, or of known slides, and compare them with the published numbers."""
    unknown = [part for part in only or () if part not in PARTS]
    if unknown:
        raise InputError("--only", [f'"{part}": expected one of {", ".join(PARTS)}' for part in unknown])
    wanted = () if judge else tuple(part for part in PARTS if not only or part in only)
    alone = json is not None and str(json) == "-"
    if json is not None and not alone and not json.parent.is_dir():
        raise InputError("--json", [f'"{json}": there is no folder "{json.parent}"'])
    out = Console(highlight=False, quiet=alone)
    if slides:
        rows = verify_slides(out, folder, names or [], judge_only=judge, packings=packings)
    else:
        rows = verify_slopes(out, folder, names or [], parts=wanted)
    if json is not None:
        text = dumps(rows, indent=1, ensure_ascii=False)
        if alone:
            typer.echo(text if is_legible(text) else dumps(rows, indent=1))
        else:
            json.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    exit_as_program(lambda: typer.run(verify))
