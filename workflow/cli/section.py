"""Defines the command `noshiro section`."""

from pathlib import Path
from typing import Annotated

import typer

COLUMNS_OPTION = typer.Option(
    help="A column of a .csv, as standard name = name in the file, such as layer=Stratum; repeatable, or with commas.",
    show_default=False,
)
LAYERS_OPTION = typer.Option(
    help="The column that names the layers, such as GEOL_LEG of an .ags or Stratum of a .csv. [default: GEOL_GEOL, or "
    "layer]",
    show_default=False,
)

BORINGS_OPTION = typer.Option(
    help="The borings of the section, by name; repeatable, or with commas. [default: all]", show_default=False
)
PART_OPTION = typer.Option(help="The scenario or the analysis of a model. [default: its first]", show_default=False)


def section(
    files: Annotated[
        list[Path],
        typer.Argument(
            help="Borings (.csv, .ags, .gef, .xml), a drawing (.dxf), a model (.stix, .gsz, .xlsx), or a section."
        ),
    ],
    to: Annotated[Path, typer.Option("--out", "-o", help="The section to write, .toml; or a drawing, .dxf.")],
    off: Annotated[float, typer.Option(help="Largest distance (m) of a boring from the line.")] = 20.0,
    layers: Annotated[str | None, LAYERS_OPTION] = None,
    columns: Annotated[list[str] | None, COLUMNS_OPTION] = None,
    borings: Annotated[list[str] | None, BORINGS_OPTION] = None,
    unit: Annotated[
        str | None,
        typer.Option(
            help="The unit of a drawing, such as mm. [default: the unit stated in the drawing]", show_default=False
        ),
    ] = None,
    part: Annotated[str | None, PART_OPTION] = None,
) -> None:
    """Make a section from borings, a drawing or a model of another program, or draw a section as DXF."""
    from workflow.cli.terminal import say
    from workflow.section_import.section_from_files import Reading, make_section

    for line in make_section(files, to, Reading.of(off, layers, columns or (), unit, part, borings or ())):
        say(line)
