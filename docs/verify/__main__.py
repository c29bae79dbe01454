"""The command `python -m docs.verify` of a checkout: the collections of published slopes and of known slides."""

from json import dumps
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from docs.verify.record import PARTS
from docs.verify.slides.command import verify_slides
from docs.verify.slopes import verify_slopes
from meshes.errors import InputError
from workflow.cli.exit_codes import ended_as_program
from workflow.run.spelling import is_legible

JSON_OPTION = typer.Option(
    help="Write the rows to this file as JSON, too; - for standard output, and nothing else there.",
    allow_dash=True,
    dir_okay=False,
    show_default=False,
)
FOLDER_OPTION = typer.Option(
    help="The cases; tests/verification/published, or slides, if not given.", show_default=False
)

PACKINGS_OPTION = typer.Option(
    min=1,
    max=50,
    help="Random packings of every known slide; as many as its file says if not given.",
    show_default=False,
)


def verify(
    names: Annotated[list[str] | None, typer.Argument(help="Cases whose names begin so; all without any.")] = None,
    folder: Annotated[Path | None, FOLDER_OPTION] = None,
    only: Annotated[
        list[str] | None, typer.Option(help="bounds, associated or davis; repeatable.", show_default=False)
    ] = None,
    judge: Annotated[bool, typer.Option("--judge", help="Compute nothing; judge what was found before.")] = False,
    json: Annotated[Path | None, JSON_OPTION] = None,
    slides: Annotated[bool, typer.Option("--slides", help="Known slides in the place of slopes: how far.")] = False,
    packings: Annotated[int | None, PACKINGS_OPTION] = None,
) -> None:
    """Find the answers of published slopes, or of known slides, and judge them: right, wrong or explained."""
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
    ended_as_program(lambda: typer.run(verify))
