"""Makes sections from files of borings and from drawings, and draws sections as DXF."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from meshes.borings.added_borings import DrawnSoils, with_borings
from meshes.borings.ags4_file import read_ags4
from meshes.borings.bro_file import read_bro
from meshes.borings.connect import OFF_LINE, ConnectedBorings, connected
from meshes.borings.csv_file import read_csv
from meshes.borings.gef_file import read_gef
from meshes.borings.log import BoringFile, Log
from meshes.borings.section_text import text_of
from meshes.drawings.dxf_file import read_dxf, write_dxf
from meshes.errors import InputError
from meshes.models.foreign_model import ImportedSection
from meshes.models.gsz_file import read_gsz
from meshes.models.stix_file import read_stix
from meshes.models.xslope_file import read_xslope
from meshes.section.quantity import LENGTH
from workflow.config import Config
from workflow.config.after_triggering import load_config
from workflow.figures.borings import draw
from workflow.section_import.columns_of_files import columns_of_files

READERS: dict[str, Callable[[Path, Mapping[str, str]], BoringFile]] = {
    ".csv": read_csv,
    ".ags": read_ags4,
    ".gef": read_gef,
    ".xml": read_bro,
}
DRAWING, SECTION = ".dxf", ".toml"
MODELS: dict[str, Callable[[Path, str, str | None], ImportedSection]] = {
    ".stix": read_stix,
    ".gsz": read_gsz,
    ".xlsx": read_xslope,
}


@dataclass(frozen=True)
class Reading:
    """Holds the options of reading files.

    Attributes
    ----------
    off_line : largest distance (m) of a boring from the line of the section
    columns : names of columns in the file by the expected names, if they differ, such as {"layer": "GEOL_LEG"}
    unit : length (m) of one unit of a drawing; None for the unit in the drawing
    part : the scenario or analysis of a model of another program; None for the first one of the model
    borings : names of the borings of the section; none for all
    """

    off_line: float = OFF_LINE
    columns: Mapping[str, str] = field(default_factory=dict)
    unit: float | None = None
    part: str | None = None
    borings: tuple[str, ...] = ()

    @classmethod
    def of(
        cls,
        off_line: float,
        layers: str | None,
        columns: Sequence[str],
        unit: str | None,
        part: str | None = None,
        borings: Sequence[str] = (),
    ) -> "Reading":
        """Make the options from those of the command line. Raises InputError with every option that is not understood.

        ``off_line``: largest distance of a boring from the line (m); ``layers``: DXF attribute or layer names;
        ``columns``: pairs expected=actual; ``unit``: unit of a drawing; ``part``: part of a file that has several;
        ``borings``: names of the borings to use.
        """
        pairs = [text.partition("=") for item in columns for text in item.split(",")]
        messages = [f"{key}{equals}{name}: expected ours=theirs, such as layer=Stratum" for key, equals, name in pairs
                if not key.strip() or not name.strip()]  # fmt: skip
        named = {key.strip(): name.strip() for key, _, name in pairs} | ({"layer": layers} if layers else {})
        size = None
        try:
            size = None if unit is None else float(LENGTH.read(f"1 {unit}"))
        except ValueError as error:
            messages.append(f"--unit {unit}: {error}")
        if messages:
            raise InputError("--columns" if size is not None or unit is None else "--unit", messages)
        names = tuple(name.strip() for text in borings for name in text.split(",") if name.strip())
        return cls(off_line, named, size, part, names)


def make_section(files: Sequence[Path], out: Path, reading: Reading) -> list[str]:
    """Write a section file from files of borings, a drawing or a foreign model, or a drawing from a section file.

    Parameters
    ----------
    files : files of borings; one .dxf drawing, one model of another program or one section .toml; or both
    out : file to write: a new section, or the .dxf drawing of a section
    reading : options of reading

    Returns
    -------
    Sentences on what was done, warnings first, and on what the section still lacks.

    Raises
    ------
    InputError : A file is missing, of another kind, or cannot be read, or ``out`` exists already. The error has every
        problem of the files.
    """
    kinds = {file.suffix.lower() for file in files}
    grounds = [file for file in files if file.suffix.lower() not in READERS]
    if missing := [f"{file}: there is no such file" for file in files if not file.is_file()]:
        raise InputError("section", missing)
    if not out.parent.is_dir():
        raise InputError("--out", [f"{out}: there is no folder {out.parent}"])
    if kinds - {*READERS, DRAWING, SECTION, *MODELS} or len(grounds) > 1:
        messages = (
            f"expected files of borings, {', '.join(READERS)}, or their ground, one .dxf drawing, one model "
            f"{' or '.join(MODELS)} or one section .toml, or both; a section .toml without borings is drawn as .dxf"
        )
        raise InputError("section", [f"{', '.join(map(str, files))}: {messages}"])
    if kinds == {SECTION}:
        if out.suffix.lower() != DRAWING:
            raise InputError("--out", [f"{out}: expected the name of a .dxf file for the drawing of the section"])
        return [
            *_minded(write_dxf(Config.load(files[0]).section, out)),
            f"{out} has the strata as closed polylines on layers of their names.",
        ]
    if out.exists():
        raise InputError(str(out), ["exists already; expected the name of a new file"])
    name = re.sub(r"\W+", "_", out.stem, flags=re.ASCII).strip("_")[:80] or "section"
    borings = [file for file in files if file not in grounds]
    read = [READERS[file.suffix.lower()](file, columns)
            for file, columns in zip(borings, columns_of_files(borings, reading.columns), strict=True)]  # fmt: skip
    logs = _requested_borings([log for item in read for log in item.logs], reading.borings) if read else []
    notices = [text for item in read for text in item.notices]
    if grounds:
        ground = _ground(grounds[0], name, reading, logs)
        out.write_text(ground.text, encoding="utf-8")
        return [*_minded([*notices, *ground.notices]), f"Section of {', '.join(map(str, files))}: {out}",
                *to_be_given(out, ground.sound)]  # fmt: skip
    connection = connected(logs, reading.off_line)
    out.write_text(text_of(connection, name), encoding="utf-8")
    picture = out.with_suffix(".png")
    draw(connection, out.stem).save(picture)
    minded = _minded([*notices, *connection.notices])
    return [*minded, *_summary(connection), f"Section: {out}", f"Picture: {picture}", *to_be_given(out)]


class _Ground(NamedTuple):
    """Holds the text of a section whose ground a drawing, a model or a section gives, notices, and what is said of it
    if nothing is missing."""

    text: str
    notices: list[str]
    sound: str


def _ground(path: Path, name: str, reading: Reading, logs: Sequence[Log]) -> _Ground:
    """Return the section of a drawing, a model or a section file, with the tests of borings that stand in it."""
    kind = path.suffix.lower()
    if kind == DRAWING:
        soils = DrawnSoils(logs)
        text, notices = read_dxf(path, name, reading.unit, *([soils.lines] if logs else []))
        made = _Ground(text, [*notices, *soils.notices()], GUESSED)
    elif kind == SECTION:
        Config.load(path)  # raises InputError for an invalid file
        made = _Ground(path.read_text(encoding="utf-8-sig"), [], SOUND)
    else:
        model = MODELS[kind](path, name, reading.part)
        made = _Ground(model.text, list(model.notices), SOUND)
    if not logs:
        return made
    text, notices = with_borings(made.text, path, logs, water=kind == DRAWING)
    return made._replace(text=text, notices=[*made.notices, *notices])


def _requested_borings(logs: Sequence[Log], names: Sequence[str]) -> list[Log]:
    """Return the named borings, or all. Raises InputError for an unknown name."""
    unknown = [name for name in names if name not in {log.name for log in logs}]
    if unknown:
        known_names = ", ".join(log.name for log in logs)
        raise InputError(
            "--borings", [f"there is no boring {', '.join(unknown)} that can be used; there are {known_names}"]
        )
    return [log for log in logs if not names or log.name in names]


def _minded(notices: Sequence[str]) -> list[str]:
    return [f"Warning: {text}." for text in dict.fromkeys(notices)]


# What a section lacks of one stratum.
MISSING = re.compile(
    r'(?P<stratum>strata (?P<number>\d+) ".*")[,:] (?P<key>\w+): missing; expected (?P<expected>.*)', re.DOTALL
)
SOUND = "It is sound."
GUESSED = "The section is complete; stiffness and strength are estimated from N: correct them."


def to_be_given(path: Path, sound: str = GUESSED) -> list[str]:
    """Return missing input of the new section, one sentence each; or a sentence that the section is ``sound``, or that
    its pore pressure lifts the ground."""
    try:
        lifted = load_config(path).section.uplift
    except InputError as error:
        return [
            "Required before the section can be analysed:",
            *(f"  - {text}" for text in _by_stratum(error.problems)),
        ]
    if lifted is not None:
        return [*_minded([lifted.description]), "It can be computed, but its pore pressure lifts the ground."]
    return [sound]


def _by_stratum(problems: Sequence[str]) -> list[str]:
    """Return the problems in short: one line on missing keys for each stratum, and one line for each other key with the
    expected value."""
    missing: dict[int, tuple[str, list[str]]] = {}
    expected, others = dict[str, str](), list[str]()
    for text in problems:
        if (match := MISSING.fullmatch(text)) is None:
            others.append(text)
            continue
        missing.setdefault(int(match["number"]), (match["stratum"], []))[1].append(match["key"])
        expected.setdefault(match["key"], match["expected"])
    strata = [f"{stratum}: {', '.join(keys)}" for _, (stratum, keys) in sorted(missing.items())]
    return [*strata, *(f"{key}: expected {text}" for key, text in expected.items()), *others]


def _summary(connection: ConnectedBorings) -> list[str]:
    everything = (*connection.borings, *connection.soundings)
    distant = [f"{item.log.name} {abs(item.off_line):.1f} m" for item in everything if abs(item.off_line) > 0.05]
    notice = [f"Not on the line of the section: {', '.join(distant)}."] if distant else []
    cones = sum(bool(item.log.cones) for item in everything)
    cone_words = f", cones in {cones} of {len(everything)}" if cones else ""
    return [
        f"{len(connection.borings)} borings with layers{cone_words}, strata {', '.join(connection.names)}.",
        *notice,
    ]
