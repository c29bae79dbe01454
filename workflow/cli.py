"""The command `noshiro`."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from fem import dolfinx_api
from fem.errors import UnstableError
from meshes.errors import InputError
from meshes.quadrilaterals import BadMeshError, QuadMesh, generate
from meshes.section import Section
from workflow import pipeline
from workflow.settings import Input
from workflow.store import Store

if TYPE_CHECKING:  # it loads PETSc, which a section and its mesh can do without
    from fem.path import Walk

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


class NoAnswerError(RuntimeError):
    """A stage that ended without an answer; what it found is written."""


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
    """The whole workflow, as far as it exists: mesh and FEM."""
    run = Input.load(section)
    store = _store(run, folder)
    _show_strata(run)
    quads = pipeline.mesh_stage(run, store)
    pipeline.mesh_figures(run, quads, store)
    _run_fem(run, store, quads)


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
    quads = pipeline.mesh_stage(run, store)
    pipeline.mesh_figures(run, quads, store)
    _show_mesh(quads, store)


@app.command()
def fem(
    section: SectionFile,
    folder: Out = None,
    kh: Annotated[
        list[float] | None, typer.Option(help="Seismic coefficient whose fields are kept; repeatable.")
    ] = None,
    sides: Annotated[str | None, typer.Option(help="roller, fixed or tied.")] = None,
    element: Annotated[str | None, typer.Option(help="auto, quadratic, reduced or bilinear.")] = None,
    direction: Annotated[str | None, typer.Option(help="downhill or uphill.")] = None,
    vertical: Annotated[float | None, typer.Option(help="Vertical seismic coefficient, positive upwards.")] = None,
    associated: Annotated[bool, typer.Option("--associated", help="Dilation angle = friction angle.")] = False,
    safety_factor: Annotated[
        bool, typer.Option("--safety-factor", help="Factors of safety too, at Kh = 0 and at every --kh.")
    ] = False,
    refine: Refine = None,
    size: Size = None,
    free: Free = False,
    mesh_file: Annotated[
        Path | None, typer.Option("--mesh", help="A gmsh file with the section's groups, instead of a new mesh.")
    ] = None,
) -> None:
    """Find the critical seismic coefficient of a section, and where it fails. Runs under mpirun, too."""
    options = {
        "kh": kh,
        "sides": sides,
        "element": element,
        "direction": direction,
        "vertical": vertical,
        "flow": "associated" if associated else None,
    }
    run = Input.load(section, {"mesh": _mesh_options(refine, size, free, None, None), "fem": options})
    if safety_factor and not run.fem.safety_factor_at:
        settings = run.fem.model_copy(update={"safety_factor_at": (0.0, *run.fem.kh)})
        run = run.model_copy(update={"fem": settings})
    _run_fem(run, _store(run, folder), pipeline.given_mesh(run, mesh_file) if mesh_file else None)


def _run_fem(run: Input, store: Store, quads: QuadMesh | None) -> None:
    """Find the critical Kh on a mesh, or on one made as the settings say, and tell it."""
    dolfinx_api.require()
    from mpi4py import MPI

    from workflow.fem_stage import fem_stage

    comm = MPI.COMM_WORLD
    first = comm.rank == 0
    out.quiet = err.quiet = not first
    with err.status("FEM: gravity") as status:

        def progress(what: str, walk: "Walk") -> None:
            step = walk.steps[-1]
            status.update(
                f"FEM: step {len(walk.steps)}, {what} = {walk.factor:.4f}, displacement {walk.displacement:.4f} m, "
                f"{step.iterations} iterations, {100 * step.plastic_share:.0f} % plastic"
            )

        if quads is None:
            quads = pipeline.mesh_stage(run, store) if first else generate(run, run.mesh)
        _show_mesh(quads, store)
        result, factors = fem_stage(run, quads, store if first else None, comm, progress)
    out.print(f"Critical Kh = [bold]{result.kc:.4f}[/], at most {result.upper:.4f}: {result.verdict}, {result.reason}.")
    if result.remedy:
        out.print(f"To improve on this: {result.remedy}.")
    for factor in factors:
        out.print(
            f"Factor of safety at Kh = {factor.kh:g}: [bold]{factor.factor:.3f}[/], at most {factor.upper:.3f}: "
            f"{factor.verdict}, {factor.reason}."
        )
    out.print(f"Results and pictures are in {store.folder}/", soft_wrap=True)
    if result.verdict == "undecided":
        raise NoAnswerError(f"the path ended undecided: {result.reason}; {result.remedy}")


@app.command()
def bounds(
    section: SectionFile,
    folder: Out = None,
    gap: Annotated[float | None, typer.Option(help="(upper - lower) over their mean at which to stop.")] = None,
    davis: Annotated[bool, typer.Option("--davis", help="Reduce c and tan φ by ψ < φ: a proxy, no bound.")] = False,
    sides: Annotated[str | None, typer.Option(help="roller or fixed.")] = None,
    max_cells: Annotated[int | None, typer.Option(help="Triangles at which to stop.")] = None,
) -> None:
    """Strict lower and upper bound of the critical seismic coefficient, ψ = φ; the judge of the finite elements."""
    from workflow.bounds_stage import bounds_stage, in_words

    options = {"gap": gap, "davis": davis or None, "max_cells": max_cells}
    run = Input.load(section, {"bounds": options, "fem": {"sides": sides}})
    store = _store(run, folder)
    with err.status("Bounds: first mesh") as status:
        answer = bounds_stage(run, store, lambda found: status.update(escape(f"Bounds: {in_words(found)}")))
    out.print(f"[bold]{escape(answer['words'])}[/]", soft_wrap=True)
    out.print(f"Sides {answer['sides']}, flow {escape(answer['flow'])}", soft_wrap=True)
    out.print(f"{escape(answer['reason'])} {len(answer['history'])} meshes, {answer['seconds']:.0f} s.", soft_wrap=True)
    out.print(f"Results and pictures are in {store.folder}/", soft_wrap=True)
    if answer["verdict"] == "no bracket":
        raise NoAnswerError(answer["reason"])


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
    except (BadMeshError, UnstableError, NoAnswerError) as error:
        what = "No usable mesh" if isinstance(error, BadMeshError) else "No answer"
        err.print(escape(f"{what}: {error}"), style="red", soft_wrap=True)
        sys.exit(NO_ANSWER)
    except (KeyboardInterrupt, SystemExit) as stop:
        if isinstance(stop, SystemExit) and stop.code != STOPPED:
            raise
        err.print("Stopped.", style="yellow")  # typer turns Ctrl-C into an exit without a word
        sys.exit(STOPPED)


if __name__ == "__main__":
    main()
