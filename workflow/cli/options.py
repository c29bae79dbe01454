"""Defines the options that commands have in common."""

from collections.abc import Callable, Sequence
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer


def _version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"noshiro {version('noshiro')}")
        raise typer.Exit


class SlideModel(StrEnum):
    """Names the methods that compute a slide."""

    discs = "discs"
    mpm = "mpm"


class Panel(StrEnum):
    """Names the groups of commands in the help, in their order."""

    BEFORE = "Before a run"
    RUN = "The whole workflow"
    GROUND = "Stability without liquefaction"
    LIQUEFACTION = "Liquefaction"
    UNCERTAIN = "Uncertain numbers"
    AFTER = "After a run"


Version = Annotated[bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")]
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
Force = Annotated[bool, typer.Option("--force", help="Run again even if nothing has changed.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print only errors.")]
Verbose = Annotated[bool, typer.Option("--verbose", "-v", help="Print details of every step.")]
Json = Annotated[bool, typer.Option("--json", help="Print the answers as JSON, and nothing else.")]
Workers = Annotated[
    int | None, typer.Option(help="Processes of this machine. [default: dem.workers]", show_default=False)
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        help="Address of a Dask scheduler whose workers are used, such as tcp://host:8786.", show_default=False
    ),
]
Model = Annotated[
    SlideModel | None,
    typer.Option(
        "--model", show_default=False,
        help="By calibrated discs, or by the continuum with the material point method. [default: slide.methods]",
    ),
]  # fmt: skip


def literal_help(call: Callable[..., Any]) -> Any:
    """Return a command line whose help shows words in brackets unchanged; return any other function as it is."""
    from rich.markup import escape

    if not isinstance(call, typer.Typer):
        return call
    program: Any = typer.main.get_command(call)
    for command in (program, *program.commands.values()):
        for text in (command, *command.params):
            if text.help:
                text.help = escape(text.help)
    return program


def stages_of_slides(methods: Sequence[str], model: str | None) -> list[str]:
    """Return the stages of the slides by a ``model`` or, by default, by the ``methods`` of the settings. Discs are also
    calibrated if they are asked for and the settings want material points alone."""
    wanted = methods if model is None else (model,)
    if "discs" not in wanted:
        return ["mpm"]
    return ["slide", *([] if "discs" in methods else ["calibrate"]), *(["mpm"] if "mpm" in wanted else [])]
