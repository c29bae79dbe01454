"""Sections made from borings and drawings."""

from collections.abc import Callable, Sequence
from pathlib import Path

from meshes.borings.ags4_file import read_ags4
from meshes.borings.connect import OFF_LINE, Connected, connected
from meshes.borings.csv_file import read_csv
from meshes.borings.dxf_file import read_dxf, write_dxf
from meshes.borings.log import Log
from meshes.borings.section_text import text_of
from meshes.errors import InputError
from workflow.settings import Input
from workflow.terminal import say

READERS: dict[str, Callable[[Path], list[Log]]] = {".csv": read_csv, ".ags": read_ags4}
DRAWING = ".dxf"


def make_section(files: Sequence[Path], out: Path, off_line: float = OFF_LINE) -> None:
    """Write a section from files of borings or from a drawing, or a drawing of a section, and tell what was made.

    Raises InputError with every problem found.
    """
    for line in _made(files, out, off_line):
        say(line)


def _made(files: Sequence[Path], out: Path, off_line: float) -> list[str]:
    kinds = {file.suffix.lower() for file in files}
    unknown = sorted(kinds - set(READERS) - {DRAWING, ".toml"})
    if missing := [f"{file}: there is no such file" for file in files if not file.is_file()]:
        raise InputError("section", missing)
    if unknown or (kinds & {DRAWING, ".toml"} and len(files) > 1):
        told = "expected .csv and .ags files of borings, or one .dxf drawing, or one section .toml to be drawn as .dxf"
        raise InputError("section", [f"{', '.join(map(str, files))}: {told}"])
    if kinds == {".toml"}:
        if out.suffix.lower() != DRAWING:
            raise InputError("--out", [f"{out}: expected a .dxf file, to draw the section"])
        write_dxf(Input.load(files[0]), out)
        return [f"{out} has the strata as closed polylines on layers of their names."]
    if out.exists():
        raise InputError(str(out), ["is there already; expected the name of a new file"])
    if kinds == {DRAWING}:
        out.write_text(read_dxf(files[0], out.stem), encoding="utf-8")
        return [f"{out} has the strata of {files[0]}.", *to_be_given(out)]
    found = connected([log for file in files for log in READERS[file.suffix.lower()](file)], off_line)
    out.write_text(text_of(found, out.stem), encoding="utf-8")
    return [*_told(found), f"{out} is the section.", f"Picture: {draw_borings(found, out)}", *to_be_given(out)]


def draw_borings(found: Connected, out: Path) -> Path:
    """Draw the section with its borings beside the file; returns where."""
    from workflow.figures.borings import draw

    picture = out.with_suffix(".png")
    draw(found, out.stem, picture)
    return picture


def to_be_given(path: Path) -> list[str]:
    """What a person has to give before the section is sound."""
    try:
        Input.load(path)
    except InputError as error:
        return ["To be given before it can run:", *(f"  - {text}" for text in error.problems)]
    return ["It is sound; stiffness and strength are guesses from N: correct them."]


def _told(found: Connected) -> list[str]:
    everything = (*found.borings, *found.soundings)
    far = [f"{one.log.name} {abs(one.beside):.1f} m" for one in everything if abs(one.beside) > 0.05]
    beside = [f"Beside the line: {', '.join(far)}."] if far else []
    cones = sum(bool(one.log.cones) for one in everything)
    more = f", cones in {cones} of {len(everything)}" if cones else ""
    return [f"{len(found.borings)} borings with layers{more}, strata {', '.join(found.names)}.", *beside]
