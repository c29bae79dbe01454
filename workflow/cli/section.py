"""Defines the commands that write section files: `noshiro init` writes an example, `noshiro section` makes one from
other files, `noshiro migrate` renews its names."""

from importlib import resources
from json import dumps
from pathlib import Path
from typing import Annotated

import typer

from meshes import shipped
from meshes.errors import InputError
from workflow.cli.options import Json, SectionFile

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
PART_OPTION = typer.Option(help="The scenario or the analysis of a model. [default: the first]", show_default=False)


def init(
    file: Annotated[Path, typer.Argument(help="The file to write.")] = Path("section.toml"),
    start: Annotated[
        str | None,
        typer.Option(
            "--from", show_default=False,
            help=f"A section that comes with noshiro: {', '.join(shipped.names())}. [default: a commented example]",
        ),
    ] = None,
    json: Json = False,
) -> None:  # fmt: skip
    """Write a section to start from: a commented example, or one of those that come with noshiro."""
    write_example(file, start)
    sentence = f"{file} is a section that runs as it is. Change it to yours, then: noshiro run {file}"
    typer.echo(dumps({"section": str(file)}) if json else sentence)


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


def migrate(
    section: SectionFile,
    to: Annotated[
        Path | None, typer.Option("--out", "-o", help="Write the new form into this file.", show_default=False)
    ] = None,
    write: Annotated[bool, typer.Option("--write", help="Write the new form over the file itself.")] = False,
) -> None:
    """Rewrite a section file that has old names of settings; comments and layout stay unchanged."""
    from meshes.section.toml_file import read_toml
    from workflow.cli.terminal import say
    from workflow.config.renamed import rewritten

    if to is not None and write:
        raise InputError("noshiro migrate", ["give either --out FILE or --write, not both"])
    if to is not None and to.exists():
        raise InputError(str(to), ["exists already; expected the name of a new file, or --write to change the old one"])
    if to is not None and not to.parent.is_dir():
        raise InputError("--out", [f"{to}: there is no folder {to.parent}"])
    read_toml(section)  # raises InputError for an invalid file
    with section.open(encoding="utf-8-sig", newline="") as file:  # ends of lines stay as they are
        text, changes = rewritten(file.read(), str(section))
    for change in changes:
        say(change)
    target = to or (section if write and changes else None)
    if target is not None:
        with target.open("w", encoding="utf-8", newline="") as file:
            file.write(text)
        return say(f"Written: {target}")
    if not changes:
        return say(f"{section} has no old names of settings.")
    return say("Nothing is written: --write changes the file, --out FILE writes another one.")


def example(name: str | None = None) -> str:
    """Return the text of the commented example, or of a section that comes with the program; raise InputError if there
    is no section of this name."""
    if name is None:
        return resources.files("workflow.cli").joinpath("example.toml").read_text(encoding="utf-8")
    if name not in shipped.names():
        raise InputError("--from", [f"{name!r}: expected one of {', '.join(shipped.names())}"])
    return shipped.file_of(name).read_text(encoding="utf-8")


def write_example(path: Path, name: str | None = None) -> None:
    """Write an example. Raises InputError if the file exists already or cannot be written."""
    text = example(name)
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError:
        raise InputError(str(path), ["exists already; expected the name of a new file"]) from None
    except OSError as error:
        raise InputError(str(path), [f"cannot be written: {error.strerror or error}"]) from None
