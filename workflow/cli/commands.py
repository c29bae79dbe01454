"""Defines the command `noshiro`. Modules are imported when a command is called, so that `noshiro --help` is fast."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from meshes.errors import InputError
from workflow import stages
from workflow.cli.exit_codes import exit_as_program, exit_on_failure
from workflow.cli.options import (
    Columns,
    Folder,
    Force,
    Free,
    Json,
    Model,
    Out,
    Panel,
    Quiet,
    Refine,
    Rows,
    SectionFile,
    Set,
    Size,
    Verbose,
    Version,
    literal_help,
    stages_of_slides,
)
from workflow.cli.section import init, migrate, section
from workflow.cli.study import converge, study
from workflow.run.progress import Verbosity

if TYPE_CHECKING:
    from workflow.cli.invocation import Invocation
    from workflow.run.plan import Choice
    from workflow.run.stage import Job

app = typer.Typer(
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    help="At which seismic coefficient a layered slope fails, and how far it slides once layers in it liquefy.",
)

STAGES = ", ".join(stages.NAMES)


@app.callback()
def root(version: Version = False) -> None:
    """Read the options of all commands."""


@app.command(rich_help_panel=Panel.BEFORE)
def check(section: SectionFile, folder: Out = None, settings: Set = None, json: Json = False) -> None:
    """Validate a section and draw it, without any analysis."""
    from workflow.cli.invocation import Invocation
    from workflow.cli.terminal import say_data, show_soundness, show_strata
    from workflow.figures.ground import sheet_with_borings
    from workflow.report.data import of_section

    invocation = Invocation.of(section, folder, {}, settings)
    picture = invocation.store.folder / "figures" / "section.png"
    if not json:
        show_strata(invocation.config.section)
    invocation.store.save("figures/section.png", sheet_with_borings(invocation.config))
    if json:
        return say_data(of_section(invocation.config, picture))
    return show_soundness(invocation.config, invocation.notices, picture)


@app.command("run", rich_help_panel=Panel.RUN)
def run_all(
    section: SectionFile,
    folder: Out = None,
    settings: Set = None,
    start: Annotated[
        str | None,
        typer.Option(
            "--from", help=f"Run this stage and all after it, changed or not: {STAGES}.", show_default=False,
            autocompletion=lambda: list(stages.NAMES),
        ),
    ] = None,
    only: Annotated[
        list[str] | None,
        typer.Option(
            "--only", help=f"Run this stage only, one of {STAGES}; repeatable.", show_default=False,
            autocompletion=lambda: list(stages.NAMES),
        ),
    ] = None,
    force: Force = False,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Print which stages would run, and why.")] = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
    json: Json = False,
) -> None:  # fmt: skip
    """Run the whole workflow: mesh, FEM, calibrated discs, slides, pictures and report."""
    from workflow.cli.invocation import Invocation
    from workflow.cli.terminal import announce, execute, show_plan
    from workflow.run.plan import Choice
    from workflow.stages import declared

    choice = Choice.of(declared.STAGES, start, only or (), force)
    verbosity = Verbosity.of(quiet, verbose, json)
    invocation = Invocation.of(section, folder, {}, settings)
    warnings = _warn(verbosity, invocation, "run", choice.chosen)
    if dry_run:
        return show_plan(invocation.job(), choice, verbosity)
    announce(invocation.job(), choice, verbosity)
    return execute(invocation.job(), choice, verbosity, warnings)


@app.command(rich_help_panel=Panel.GROUND)
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
    json: Json = False,
) -> None:
    """Mesh a section with quadrilaterals, and draw it. Later commands on the same folder use the same mesh."""
    from workflow.cli.invocation import Invocation, mesh_options
    from workflow.cli.terminal import execute, show_strata

    verbosity = Verbosity.of(quiet, verbose, json)
    options = {"mesh": mesh_options(refine, size, free, columns, rows)}
    invocation = Invocation.of(section, folder, options, settings, afresh=True)
    if verbosity.in_sentences:
        show_strata(invocation.config.section)
    execute(*_up_to("mesh", invocation, force, verbosity))


@app.command(rich_help_panel=Panel.GROUND)
def fem(
    section: SectionFile,
    folder: Out = None,
    kh: Annotated[
        list[float] | None, typer.Option(help="Seismic coefficient at which fields are stored; repeatable.")
    ] = None,
    sides: Annotated[str | None, typer.Option(help="Sides: free-field, smooth, fixed or periodic.")] = None,
    element: Annotated[str | None, typer.Option(help="Finite element: auto, quadratic, reduced or bilinear.")] = None,
    direction: Annotated[str | None, typer.Option(help="Seismic force: both, downhill or uphill.")] = None,
    vertical: Annotated[float | None, typer.Option(help="Vertical seismic coefficient, positive upwards.")] = None,
    associated: Annotated[bool, typer.Option("--associated", help="Take ψ = φ in all strata.")] = False,
    safety_factor: Annotated[
        bool, typer.Option("--safety-factor", help="Also factors of safety and their bounds, at Kh = 0 and every --kh.")
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
    json: Json = False,
) -> None:
    """Find the critical seismic coefficient of a section, and where it fails. Also runs on several MPI ranks."""
    from workflow.cli.invocation import Invocation, mesh_options
    from workflow.cli.terminal import err, execute, out
    from workflow.run.ranks import Ranks

    flow = "associated" if associated else None
    options = {"kh": kh, "sides": sides, "element": element, "direction": direction, "vertical": vertical, "flow": flow}
    invocation = Invocation.of(section, folder, {"mesh": mesh_options(refine, size, free), "fem": options}, settings)
    if safety_factor:
        invocation = invocation.with_safety_factors()
    also = ("bounds",) if safety_factor and invocation.config.bounds.run is not False else ()
    if mesh_file is not None and not mesh_file.is_file():
        raise InputError(str(mesh_file), ["there is no such file"])
    ranks = Ranks()
    if not ranks.is_first:
        from workflow.stages.fem import help_compute

        out.quiet = err.quiet = True
        return help_compute(invocation.job(mesh_file=mesh_file, ranks=ranks), ranks)
    with ranks.leading():
        verbosity = Verbosity.of(quiet, verbose, json)
        return execute(*_up_to("fem", invocation, force, verbosity, also, mesh_file=mesh_file, ranks=ranks))


@app.command(rich_help_panel=Panel.AFTER)
def plot(
    folder: Folder,
    field: Annotated[
        str | None,
        typer.Option(help="Field, such as mobilised; fields of discs: pore_springs, velocity, force_chains."),
    ] = None,
    at: Annotated[float | None, typer.Option(help="One seismic coefficient only, such as 0.2.")] = None,
    json: Json = False,
) -> None:
    """Draw the pictures of a run again, or some of them, without computing anything."""
    from workflow.cli.invocation import stored_job
    from workflow.cli.terminal import redraw, say, say_data
    from workflow.figures.single_figure import draw

    job = stored_job(folder)
    if field is None and at is None:
        return redraw(job, json)
    paths = [str(path) for path in draw(job, field, at)]
    return say_data({"pictures": paths}) if json else say("\n".join(paths))


@app.command(rich_help_panel=Panel.AFTER)
def view(
    folder: Folder,
    field: Annotated[str, typer.Option(help="The field in colour, such as displacement.")] = "displacement",
    at: Annotated[float | None, typer.Option(help="The seismic coefficient. [default: the last]")] = None,
) -> None:
    """Show the FEM results of a run in a window that can be turned and zoomed. The command needs a screen."""
    from workflow.cli.invocation import stored_job
    from workflow.figures.single_figure import window

    window(stored_job(folder), field, at)


@app.command(rich_help_panel=Panel.AFTER)
def report(
    folder: Folder,
    pdf: Annotated[
        bool, typer.Option("--pdf", help="Also print the report as report.pdf, by Chromium or WeasyPrint.")
    ] = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
    json: Json = False,
) -> None:
    """Write summary and report of a run again, from the stored results."""
    from meshes.section.toml_file import read_toml
    from workflow.cli.invocation import left_out_of_report, stored_job
    from workflow.cli.terminal import execute, warn
    from workflow.config.renamed import notices
    from workflow.run.plan import Choice

    job, verbosity = stored_job(folder), Verbosity.of(quiet, verbose, json)
    warn(notices(read_toml(folder / "section.toml")), verbosity)
    warn(left_out_of_report(job), verbosity)
    execute(job, Choice.of(job.stages, only=["report"], force=True), verbosity, pdf=pdf)


@app.command(rich_help_panel=Panel.AFTER)
def compare(
    folders: Annotated[list[Path], typer.Argument(help="Folders of runs with a report.", show_default=False)],
    page: Annotated[
        Path | None, typer.Option("--page", help="Write an HTML page with all pictures, too.", show_default=False)
    ] = None,
    json: Json = False,
) -> None:
    """Compare runs: differences of their inputs, and their results; with --page their pictures, too."""
    from workflow.cli.terminal import say, say_data, show_runs
    from workflow.report import side_by_side

    runs = side_by_side.read(folders)
    if page is not None:
        side_by_side.write_page(runs, page)
    if json:
        return say_data({str(run.folder): run.summary.model_dump(mode="json") for run in runs})
    show_runs(runs)
    return say("" if page is None else f"Page: {page}")


@app.command(rich_help_panel=Panel.GROUND)
def bounds(
    section: SectionFile,
    folder: Out = None,
    gap: Annotated[float | None, typer.Option(help="Required gap: (upper - lower) over their mean.")] = None,
    davis: Annotated[bool | None, typer.Option(help="Also bounds with Davis reduced strength for ψ < φ.")] = None,
    safety_factor: Annotated[
        bool | None,
        typer.Option("--safety-factor", help="Also bounds of the factor of safety, ψ = φ.", show_default=False),
    ] = None,
    sides: Annotated[str | None, typer.Option(help="Sides: free-field, smooth, fixed or periodic.")] = None,
    max_cells: Annotated[int | None, typer.Option(help="Largest number of triangles.")] = None,
    settings: Set = None,
    force: Force = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
    json: Json = False,
) -> None:
    """Find strict bounds of the critical seismic coefficient for ψ = φ, to check the finite elements."""
    from workflow.cli.invocation import Invocation
    from workflow.cli.terminal import execute

    options = {"gap": gap, "davis": davis, "max_cells": max_cells, "safety_factor": safety_factor}
    invocation = Invocation.of(section, folder, {"bounds": options, "fem": {"sides": sides}}, settings)
    invocation = replace(invocation, config=invocation.config.with_settings("bounds", run=True))
    execute(*_up_to("bounds", invocation, force, Verbosity.of(quiet, verbose, json)))


def _of_stage(stage: str, panel: str, words: str, bounds: bool = False) -> None:
    """Return a command that runs a stage after the stages that it needs, and strict bounds if ``bounds`` is true."""

    def command(
        section: SectionFile,
        folder: Out = None,
        settings: Set = None,
        force: Force = False,
        quiet: Quiet = False,
        verbose: Verbose = False,
        json: Json = False,
    ) -> None:
        from workflow.cli.invocation import Invocation
        from workflow.cli.terminal import execute

        invocation = Invocation.of(section, folder, {}, settings)
        invocation.refuse_without_subject(stage)
        also = ("bounds",) if bounds and invocation.config.bounds.run is not False else ()
        execute(*_up_to(stage, invocation, force, Verbosity.of(quiet, verbose, json), also))

    app.command(stages.command_of(stage), help=words, rich_help_panel=panel)(command)


_of_stage("triggering", Panel.LIQUEFACTION, "F_L at the tests of the borings, which strata liquefy, and P_L.")
_of_stage("slices", Panel.GROUND, "Slip circles by Bishop and Spencer, to both sides: factor of safety, critical Kh.")
_of_stage("faces", Panel.GROUND, "Critical Kh and factor of safety of every face, by elements and bounds.", bounds=True)
_of_stage("residual", Panel.GROUND, "Factor of safety with peak, then with post-peak strength, and the critical Kh.")
_of_stage("liquefied", Panel.LIQUEFACTION, "Whether the ground stands once layers have liquefied, and the critical Kh.")
_of_stage("response", Panel.GROUND, "Response of the layers to a record of the rock: profiles with depth, and k_max.")
_of_stage("calibrate", Panel.LIQUEFACTION, "Calibrate the discs to the critical Kh of the finite elements.")


@app.command(rich_help_panel=Panel.LIQUEFACTION)
def slide(
    section: SectionFile,
    folder: Out = None,
    case: Annotated[list[int] | None, typer.Option("--case", help="Compute this case only; repeatable.")] = None,
    model: Model = None,
    settings: Set = None,
    force: Force = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
    json: Json = False,
) -> None:
    """Compute slides after liquefaction, by calibrated discs and by material points."""
    from workflow.cli.invocation import Invocation
    from workflow.cli.terminal import execute

    invocation, cases = Invocation.of(section, folder, {}, settings), tuple(case) if case else None
    invocation.refuse_unknown(cases or ())
    stage, *also = stages_of_slides(invocation.config.slide.methods, None if model is None else model.value)
    execute(*_up_to(stage, invocation, force, Verbosity.of(quiet, verbose, json), also, cases=cases))


for panel, commands in ((Panel.BEFORE, (init, section, migrate)), (Panel.UNCERTAIN, (study, converge))):
    for command in commands:
        app.command(rich_help_panel=panel)(command)
app.registered_commands.sort(key=lambda command: [*Panel].index(Panel(command.rich_help_panel or Panel.RUN)))


def _up_to(
    stage: str, invocation: "Invocation", force: bool, verbosity: Verbosity, also: Sequence[str] = (), **more: Any
) -> "tuple[Job, Choice, Verbosity, list[str]]":
    """Return the arguments of `execute` for a stage and the stages in ``also``, and for the stages that they need and
    that have not run yet. Print the warnings on the settings."""
    from workflow.run.plan import Choice

    job = invocation.job(**more)
    choice = Choice.up_to(job.stages, stage, force, also)
    return job, choice, verbosity, _warn(verbosity, invocation, stages.command_of(stage), choice.chosen)


def _warn(verbosity: Verbosity, invocation: "Invocation", command: str, chosen: Sequence[str]) -> list[str]:
    """Print and return warnings on options stored from an earlier command, and on settings that no stage reads."""
    from workflow.cli.terminal import warn
    from workflow.cli.unread_settings import in_words

    names = [entry.name or entry.callback.__name__ for entry in app.registered_commands if entry.callback]
    return warn([*invocation.notices, *in_words(invocation.unread(chosen), command, names)], verbosity)


def main(arguments: list[str] | None = None, command: Callable[..., Any] = app) -> None:
    """Run a command and exit with its code: 0 done, 2 bad input, 3 no answer, 130 stopped, 1 fault of the program."""
    call = exit_as_program if arguments is None else exit_on_failure
    call(lambda: literal_help(command)(arguments, standalone_mode=True))
