"""The command `noshiro verify`."""

from json import dumps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from meshes.errors import InputError
from workflow.run.spelling import is_legible

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from workflow.verify.collection import Row

JSON_OPTION = typer.Option(
    help="Write the rows to this file as JSON, too; - for standard output, and nothing else there.",
    allow_dash=True,
    dir_okay=False,
    show_default=False,
)
FOLDER_OPTION = typer.Option(help="The cases. [default: tests/verification/published, or slides]", show_default=False)

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
    page: Annotated[bool, typer.Option("--page", help="Make the page of the collection again.")] = False,
    slides: Annotated[bool, typer.Option("--slides", help="Known slides in the place of slopes: how far.")] = False,
    packings: Annotated[int | None, PACKINGS_OPTION] = None,
) -> None:
    """Find the answers of published slopes, or of known slides, and judge them: right, wrong or explained."""

    from rich.console import Console

    from workflow.verify.case import FOLDER
    from workflow.verify.collection import run
    from workflow.verify.record import PARTS

    unknown = [part for part in only or () if part not in PARTS]
    if unknown:
        raise InputError("--only", [f'"{part}": expected one of {", ".join(PARTS)}' for part in unknown])
    wanted = () if judge else tuple(part for part in PARTS if not only or part in only)
    alone = json is not None and str(json) == "-"
    if json is not None and not alone and not json.parent.is_dir():
        raise InputError("--json", [f'"{json}": there is no folder "{json.parent}"'])
    out = Console(highlight=False, quiet=alone)
    if slides:
        from workflow.verify.slides.command import verify_slides

        slide_rows = verify_slides(out, folder, names or [], judge=judge, page=page, packings=packings)
        if json is not None:
            _write(json, slide_rows)
        return
    rows = run(folder or FOLDER, names or (), wanted, lambda row: _tell(out, row))
    out.print(_count(rows))
    if page:
        out.print(str(_page(folder or FOLDER)), soft_wrap=True)
    if json is not None:
        _write(json, [row.as_dict() for row in rows])


def _write(file: Path, rows: list[dict[str, Any]]) -> None:
    text = dumps(rows, indent=1, ensure_ascii=False)
    if str(file) == "-":
        typer.echo(text if is_legible(text) else dumps(rows, indent=1))
    else:
        file.write_text(text + "\n", encoding="utf-8")


def _page(folder: Path) -> Path:
    from workflow.verify.case import FOLDER, read_cases
    from workflow.verify.numbers import keep_numbers
    from workflow.verify.page import counts, write_page
    from workflow.verify.record import FILE, Answer, read_answers

    cases, answers = read_cases(folder), read_answers(folder / FILE, Answer)
    if folder == FOLDER:
        commits = [answer.commit for answer in answers.values()]
        keep_numbers(Path("docs"), "published", "noshiro verify --page", counts(cases, answers), commits)
    return write_page(folder, cases, answers)


def _tell(out: "Console", row: "Row") -> None:
    """One line for a case, and one for each remark on a wrong one."""
    from rich.markup import escape

    from workflow.verify.page import elements, numbers, published

    answer = f"bounds {numbers(row.found)}, elements {elements(row.found)}" if row.found else ""
    line = f"{row.verdict.word:<9} {row.case.name:<26} {published(row.case)}; {answer}"
    out.print(escape(line), soft_wrap=True)
    if row.verdict.word == "wrong":
        for remark in row.verdict.remarks:
            out.print(escape(f"          {remark}"), soft_wrap=True)


def _count(rows: "list[Row]") -> "Table":
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    words = list(dict.fromkeys(row.verdict.word for row in rows))
    table = Table(box=SIMPLE_HEAD, padding=(0, 2, 0, 0))
    for word in words:
        table.add_column(word, justify="right")
    table.add_row(*(str(sum(row.verdict.word == word for row in rows)) for word in words))
    return table
