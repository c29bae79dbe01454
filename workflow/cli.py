"""The command `noshiro`."""

import sys
import traceback
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.markup import escape

from meshes.errors import InputError, NoAnswerError
from meshes.quad_mesh import BadMeshError
from meshes.section.section import Section
from workflow import stages
from workflow.run import pipeline
from workflow.run.display import Display
from workflow.run.plan import Choice
from workflow.run.ranks import Ranks
from workflow.run.stage import Job
from workflow.run.store import Store
from workflow.settings import Input, dotted, merged
from workflow.terminal import err, execute, out, show_plan, show_strata
from workflow.verify.command import verify

DONE, FAULT, BAD_INPUT, NO_ANSWER, STOPPED = 0, 1, 2, 3, 130

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    help="At which seismic coefficient a layered slope fails, and how far it slides once layers in it liquefy.",
)

SectionFile = Annotated[Path, typer.Argument(help="The section, a TOML file.", readable=False, show_default=False)]
Folder = Annotated[Path, typer.Argument(help="The folder of a run.", show_default=False)]
Out = Annotated[
    Path | None,
    typer.Option("--out", help="Folder for the results. [default: runs/<section name>]", show_default=False),
]
Refine = Annotated[int | None, typer.Option(help="Divide every cell size by this whole number.")]
Size = Annotated[str | None, typer.Option(help='Target cell size, such as "1.5 m".')]
Free = Annotated[bool, typer.Option("--free", help="Free quadrilaterals instead of columns and rows.")]
Columns = Annotated[int | None, typer.Option(help="Columns of a mapped mesh.")]
Rows = Annotated[int | None, typer.Option(help="Rows of a mapped mesh.")]
Set = Annotated[
    list[str] | None,
    typer.Option("--set", help="Any setting by its name, such as fem.sides=fixed; repeatable.", show_default=False),
]
Force = Annotated[bool, typer.Option("--force", help="Run again even where nothing has changed.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Say nothing but what went wrong.")]
Verbose = Annotated[bool, typer.Option("--verbose", "-v", help="Say every step.")]


@app.callback()
def root() -> None:
    """Keep subcommands even while there is one."""


@app.command()
def init(
    file: Annotated[Path, typer.Argument(help="The file to write.")] = Path("section.toml"),
) -> None:
    """Write a commented example of a section to start from."""
    from workflow.example import write_example

    write_example(file)
    out.print(f"{file} is a section that runs as it is. Change it to yours, then: noshiro run {file}", soft_wrap=True)


@app.command()
def check(section: SectionFile, folder: Out = None, settings: Set = None) -> None:
    """Validate a section and draw it; nothing else."""
    from workflow.figures.ground import draw_section

    given = _input(section, {}, settings)
    store = _store(given, folder)
    show_strata(given)
    with store.writing("figures/section.png") as path:
        draw_section(given, path)
    for notice in given.notices:
        out.print(f"Mind: {notice}.", soft_wrap=True, markup=False)
    out.print(f"The section is sound. Picture: {store.folder / 'figures' / 'section.png'}", soft_wrap=True)


@app.command("run")
def run_all(
    section: SectionFile,
    folder: Out = None,
    settings: Set = None,
    start: Annotated[
        str | None, typer.Option("--from", help="Run this stage and all after it, changed or not.", show_default=False)
    ] = None,
    only: Annotated[
        list[str] | None, typer.Option("--only", help="Run this stage only; repeatable.", show_default=False)
    ] = None,
    force: Force = False,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Say what would run, and why; nothing else.")] = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """The whole workflow: mesh, FEM, calibrated discs, slides, pictures and report."""
    choice = Choice.of(stages.STAGES, start, only or (), force)
    job = _job(_input(section, {}, settings), folder)
    if dry_run:
        return show_plan(job, choice)
    if not quiet:
        show_strata(job.given)
    return execute(job, choice, quiet, verbose)


@app.command()
def mesh(
    section: SectionFile,
    folder: Out = None,
    refine: Refine = None,
    size: Size = None,
    free: Free = False,
    columns: Columns = None,
    rows: Rows = None,
    settings: Set = None,
    force: Force = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Mesh a section with quadrilaterals and draw both."""
    given = _input(section, {"mesh": _mesh_options(refine, size, free, columns, rows)}, settings)
    if not quiet:
        show_strata(given)
    _execute_up_to("mesh", _job(given, folder), force, quiet, verbose)


@app.command()
def fem(
    section: SectionFile,
    folder: Out = None,
    kh: Annotated[
        list[float] | None, typer.Option(help="Seismic coefficient whose fields are kept; repeatable.")
    ] = None,
    sides: Annotated[str | None, typer.Option(help="roller, fixed or tied.")] = None,
    element: Annotated[str | None, typer.Option(help="auto, quadratic, reduced or bilinear.")] = None,
    direction: Annotated[str | None, typer.Option(help="both, downhill or uphill.")] = None,
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
    settings: Set = None,
    force: Force = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
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
    given = _input(section, {"mesh": _mesh_options(refine, size, free, None, None), "fem": options}, settings)
    if safety_factor:
        asked = tuple(sorted({0.0, *given.fem.kh, *given.fem.safety_factor_at}))
        wanted = given.fem.model_copy(update={"safety_factor_at": asked})
        given = given.model_copy(update={"fem": wanted})
    if mesh_file is not None and not mesh_file.is_file():
        raise InputError(str(mesh_file), ["there is no such file"])
    ranks = Ranks()
    job = _job(given, folder, mesh_file=mesh_file, ranks=ranks)
    if not ranks.first:
        out.quiet = err.quiet = True
        return stages.fem.help_compute(job, ranks)
    with ranks.leading():
        return _execute_up_to("fem", job, force, quiet, verbose)


@app.command()
def plot(
    folder: Folder,
    field: Annotated[
        str | None,
        typer.Option(help="One field: such as mobilised; of the discs pore_springs, velocity or force_chains."),
    ] = None,
    at: Annotated[float | None, typer.Option(help="One seismic coefficient only, such as 0.2.")] = None,
) -> None:
    """Draw the pictures of a run again, or single ones, without computing anything."""
    from workflow.figures.single import draw

    job = stages.stored_job(folder)
    if field is None and at is None:
        with Display(out, err, job.stages) as display:
            told = pipeline.redraw_all(job, display)
        for line in told:
            out.print(escape(line), soft_wrap=True)
        out.print(f"Pictures are in {folder / 'figures'}/", soft_wrap=True)
        return
    for path in draw(job, field, at):
        out.print(str(path), soft_wrap=True)


@app.command()
def view(
    folder: Folder,
    field: Annotated[str, typer.Option(help="The field in colour, such as displacement.")] = "displacement",
    at: Annotated[float | None, typer.Option(help="The seismic coefficient. [default: the last]")] = None,
) -> None:
    """Look at the FEM results of a run in a window that can be turned and zoomed. Needs a screen."""
    from workflow.figures.single import window

    window(stages.stored_job(folder), field, at)


@app.command()
def report(folder: Folder, quiet: Quiet = False, verbose: Verbose = False) -> None:
    """Write summary and report of a run again, from what is there."""
    job = stages.stored_job(folder)
    execute(job, Choice.of(job.stages, only=["report"], force=True), quiet, verbose)


@app.command()
def liquefaction(
    section: SectionFile,
    folder: Out = None,
    settings: Set = None,
    force: Force = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """F_L at the blow counts of the borings, which strata liquefy, and P_L; nothing else."""
    _execute_up_to("triggering", _job(_input(section, {}, settings), folder), force, quiet, verbose)


@app.command()
def bounds(
    section: SectionFile,
    folder: Out = None,
    gap: Annotated[float | None, typer.Option(help="(upper - lower) over their mean at which to stop.")] = None,
    davis: Annotated[bool | None, typer.Option(help="Bound Davis's substitute for ψ < φ, too.")] = None,
    sides: Annotated[str | None, typer.Option(help="roller or fixed.")] = None,
    max_cells: Annotated[int | None, typer.Option(help="Triangles at which to stop.")] = None,
    settings: Set = None,
    force: Force = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Strict lower and upper bound of the critical seismic coefficient, ψ = φ; the judge of the finite elements."""
    options = {"run": True, "gap": gap, "davis": davis, "max_cells": max_cells}
    given = _input(section, {"bounds": options, "fem": {"sides": sides}}, settings)
    _execute_up_to("bounds", _job(given, folder), force, quiet, verbose)


@app.command()
def calibrate(
    section: SectionFile,
    folder: Out = None,
    settings: Set = None,
    force: Force = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Calibrate the discs so that they fail at the Kh that the finite elements found."""
    _execute_up_to("calibrate", _job(_input(section, {}, settings), folder), force, quiet, verbose)


@app.command()
def slide(
    section: SectionFile,
    folder: Out = None,
    case: Annotated[list[int] | None, typer.Option("--case", help="This case only; repeatable.")] = None,
    settings: Set = None,
    force: Force = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """How far the calibrated discs slide once layers have liquefied."""
    job = _job(_input(section, {}, settings), folder, cases=tuple(case) if case else None)
    _execute_up_to("slide", job, force, quiet, verbose)


app.command()(verify)


def _input(section: Path, options: Mapping[str, Mapping[str, Any]], settings: list[str] | None) -> Input:
    """The input of a command: the file, over it the settings of the command line, over those its options."""
    given = {
        table: {key: value for key, value in values.items() if value is not None} for table, values in options.items()
    }
    read = Input.load(section, merged(dotted(settings or []), given))
    if read.sliding_block.accelerogram:
        from workflow.estimates.accelerogram import of_input

        of_input(read)  # a record that cannot be read is told now, not after minutes
    return read


def _job(given: Input, folder: Path | None, **options: Any) -> Job:
    return Job(given, _store(given, folder), stages.STAGES, **options)


def _execute_up_to(stage: str, job: Job, force: bool, quiet: bool, verbose: bool) -> None:
    """Run a stage, and before it what it needs and is not there yet."""
    execute(job, Choice.up_to(job.stages, stage, force), quiet, verbose)


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


def _store(given: Section, folder: Path | None) -> Store:
    return Store(folder or Path("runs") / given.name)


def main(arguments: list[str] | None = None, command: Callable[..., Any] = app) -> None:
    """Run a command and leave with its exit code: 0 done, 2 bad input, 3 no answer, 130 stopped, 1 our fault."""
    try:
        command(arguments, standalone_mode=True)
    except InputError as error:
        err.print(escape(str(error)), style="red", soft_wrap=True)
        sys.exit(BAD_INPUT)
    except NoAnswerError as error:
        what = "No usable mesh" if isinstance(error, BadMeshError) else "No answer"
        err.print(escape(f"{what}: {error}"), style="red", soft_wrap=True)
        sys.exit(NO_ANSWER)
    except (KeyboardInterrupt, SystemExit) as stop:
        if isinstance(stop, SystemExit) and stop.code != STOPPED:
            raise
        err.print("Stopped.", style="yellow")  # typer turns Ctrl-C into an exit without a word
        sys.exit(STOPPED)
    except MemoryError:
        err.print("Out of memory: take larger cells or discs, or a machine with more.", style="red")
        sys.exit(BAD_INPUT)
    except Exception as error:
        err.print(escape(traceback.format_exc()), soft_wrap=True)
        err.print(
            escape(f"This is a fault of noshiro, not of your input: {type(error).__name__}: {error}"),
            "Please report it with log.txt and your section; what was computed is kept.",
            style="red",
            soft_wrap=True,
        )
        sys.exit(FAULT)


if __name__ == "__main__":
    main()
