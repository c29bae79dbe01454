"""The command `noshiro`."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from meshes.errors import InputError
from meshes.quadrilaterals import BadMeshError, QuadMesh
from meshes.section import Section
from workflow import pipeline
from workflow.settings import Input
from workflow.store import Store

DONE, BAD_INPUT, NO_ANSWER, STOPPED = 0, 2, 3, 130

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    help="At which seismic coefficient a layered slope fails, and how far it slides once layers in it liquefy.",
)
out = Console(highlight=False)
err = Console(stderr=True, highlight=False)

SectionFile = Annotated[Path, typer.Argument(help="The section, a TOML file.", show_default=False)]
Out = Annotated[
    Path | None,
    typer.Option("--out", help="Folder for the results. [default: runs/<section name>]", show_default=False),
]
Refine = Annotated[int | None, typer.Option(help="Divide every cell size by this whole number.")]
Size = Annotated[str | None, typer.Option(help='Target cell size, such as "1.5 m".')]
Free = Annotated[bool, typer.Option("--free", help="Free quadrilaterals instead of columns and rows.")]
Columns = Annotated[int | None, typer.Option(help="Columns of a mapped mesh.")]
Rows = Annotated[int | None, typer.Option(help="Rows of a mapped mesh.")]


@app.callback()
def root() -> None:
    """Keep subcommands even while there is one."""


@app.command()
def check(section: SectionFile, folder: Out = None) -> None:
    """Validate a section and draw it; nothing else."""
    run = Input.load(section)
    store = _store(run, folder)
    _show_strata(run)
    pipeline.check_stage(run, store)
    out.print(f"The section is sound. Picture: {store.folder / 'figures' / 'section.png'}")


@app.command("run")
def run_all(section: SectionFile, folder: Out = None) -> None:
    """The whole workflow, as far as it exists: the mesh."""
    mesh(section, folder)


@app.command()
def mesh(
    section: SectionFile,
    folder: Out = None,
    refine: Refine = None,
    size: Size = None,
    free: Free = False,
    columns: Columns = None,
    rows: Rows = None,
) -> None:
    """Mesh a section with quadrilaterals and draw both."""
    run = Input.load(section, {"mesh": _mesh_options(refine, size, free, columns, rows)})
    store = _store(run, folder)
    _show_strata(run)
    _show_mesh(pipeline.mesh_stage(run, store), store)


def _mesh_options(
    refine: int | None, size: str | None, free: bool, columns: int | None, rows: int | None
) -> dict[str, Any]:
    """The options of `mesh` as settings; a plain number for the size is metres."""
    try:
        wanted: str | float | None = size if size is None else float(size)
    except ValueError:
        wanted = size
    method = "free" if free else None
    return {"refine": refine, "size": wanted, "method": method, "columns": columns, "rows": rows}


def _store(run: Section, folder: Path | None) -> Store:
    return Store(folder or Path("runs") / run.name)


def _show_strata(run: Section) -> None:
    if run.reconstruction:
        out.print(f"[bold]Reconstruction.[/] {escape(run.reconstruction_note)}")
    table = Table(title=escape(run.title or run.name), title_justify="left", box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    heads = (
        "stratum",
        "area\nm²",
        "thickness\nm",
        "from-to x\nm",
        "E\nMPa",
        "ν\n",
        "ρ ord/seis\nt/m³",
        "c\nkPa",
        "φ/ψ\ndeg",
    )
    for head in heads:
        table.add_column(head, justify="left" if head == "stratum" else "right")
    for row in pipeline.strata_rows(run):
        table.add_row(*(escape(cell) for cell in row))
    out.print(table)


def _show_mesh(result: QuadMesh, store: Store) -> None:
    quality = result.quality()
    out.print(
        f"{quality.quadrilaterals} quadrilaterals, {quality.nodes} nodes ({result.method}). "
        f"Smallest scaled Jacobian {quality.smallest_scaled_jacobian:.3f}, worst corner {quality.worst_angle:.1f}°, "
        f"largest aspect ratio {quality.largest_aspect_ratio:.2f}."
    )
    out.print(f"Mesh and pictures are in {store.folder}/", soft_wrap=True)


def main(arguments: list[str] | None = None, command: Callable[..., Any] = app) -> None:
    """Run a command and leave with its exit code: 0 done, 2 bad input, 3 no answer, 130 stopped."""
    try:
        command(arguments, standalone_mode=True)
    except InputError as error:
        err.print(escape(str(error)), style="red", soft_wrap=True)
        sys.exit(BAD_INPUT)
    except BadMeshError as error:
        err.print(escape(f"No usable mesh: {error}"), style="red", soft_wrap=True)
        sys.exit(NO_ANSWER)
    except KeyboardInterrupt:
        err.print("Stopped.", style="yellow")
        sys.exit(STOPPED)


if __name__ == "__main__":
    main()
