"""The groups of an AGS4 file as python-ags4 reads them, with their units, and what that package says of its rules."""

import importlib.util
import io
import logging
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from meshes.borings.table import DECIMAL_COMMA, with_unit
from meshes.borings.text_file import read_text
from meshes.errors import InputError
from meshes.section.quantity import COORDINATE, STRENGTH, Kind

# What a file without a unit means: those of the AGS4 data dictionary; all others are lengths in metres, or plain.
UNITS = {"SCPT_RES": "MPa", "SCPT_QT": "MPa", "SCPT_FRES": "kPa", "SCPT_PWP2": "kPa"}
LENGTHS = (
    "LOCA_NATE", "LOCA_NATN", "LOCA_GL", "LOCA_LOCX", "LOCA_LOCY", "LOCA_LOCZ", "GEOL_TOP", "GEOL_BASE", "ISPT_TOP",
    "SCPT_DPTH", "WSTG_DPTH", "WSTD_POST",
)  # fmt: skip
KINDS: dict[str, Kind] = {**dict.fromkeys(LENGTHS, COORDINATE), **dict.fromkeys(UNITS, STRENGTH)}
AGS3 = re.compile(r'^\s*"?(\*\*\??\w+)', re.MULTILINE)

Row = Mapping[str, str]


@dataclass(frozen=True)
class Groups:
    """The data of a file.

    Attributes
    ----------
    rows : of each group, by heading
    units : by heading, only of those that have a kind
    problems : what is wrong, filled as the file is read
    notices : what a person has to know, one sentence each
    """

    rows: Mapping[str, Sequence[Row]]
    headings: Mapping[str, Sequence[str]]
    units: Mapping[str, str]
    problems: list[str] = field(default_factory=list)
    notices: list[str] = field(default_factory=list)

    def of(self, group: str, boring: str) -> list[Row]:
        """The rows of a group that belong to a boring."""
        return [row for row in self.rows.get(group, ()) if row.get("LOCA_ID") == boring]

    def read(self, row: Row, key: str) -> float:
        """A length (m) or stress (Pa) by the unit of its heading; a stress may be below zero. Raises ValueError."""
        text, kind = DECIMAL_COMMA.sub(r"\1.\2\3", row.get(key, "")), KINDS[key]
        below = kind is STRENGTH and text.startswith("-")
        size = float(kind.read(with_unit(text.removeprefix("-") if below else text, self.units.get(key, ""))))
        return -size if below else size


def read_groups(path: Path) -> Groups:
    """The groups of a file. Raises InputError where it is no AGS4, or has units that are not understood."""
    ags4 = _python_ags4(path)
    text, notice = read_text(path)
    if not re.search(r'^\s*"?GROUP', text, re.MULTILINE):
        if line := AGS3.search(text):
            fault = f'is AGS3, whose groups begin with a line such as "{line[1]}"; expected AGS4'
            raise InputError(str(path), [f"{fault}, into which other programs convert it"])
        raise InputError(str(path), ["holds no GROUP; expected AGS4, with a group LOCA of the borings"])
    lines = "".join(line + "\n" for line in text.splitlines() if line.strip(' ,"'))  # a blank line ends no group
    try:
        tables, headings = ags4.AGS4_to_dict(io.StringIO(lines))
    except (ags4.AGS4Error, IndexError, KeyError) as error:
        raise InputError(str(path), [f"cannot be read as AGS4: {_reason(error)} (blank lines not counted)"]) from None
    rows: dict[str, list[Row]] = {}
    units: dict[str, str] = {}
    for group, columns in tables.items():
        names = [name.strip() for name in columns]
        every = [dict(zip(names, map(str.strip, cells), strict=True)) for cells in zip(*columns.values(), strict=True)]
        rows[group] = [row for row in every if row.get("HEADING") == "DATA"]
        units |= {key: unit for row in every if row.get("HEADING") == "UNIT" for key, unit in row.items()}
    known = {key: units.get(key) or UNITS.get(key, "m") for key in KINDS}
    for key, unit in known.items():  # "M" and "FT" are no molars
        if _unit_problem(KINDS[key], unit) and not _unit_problem(KINDS[key], unit.lower()):
            known[key] = unit.lower()
    problems = [f"group {key.partition('_')[0]}, unit {unit!r} of {key}: {wrong}" for key, unit in known.items()
                if (wrong := _unit_problem(KINDS[key], unit))]  # fmt: skip
    if problems:
        raise InputError(str(path), problems)
    result = Groups(rows, {group: list(names) for group, names in headings.items()}, known)
    result.notices.extend([*([notice] if notice else []), *_departures(ags4, path, lines)])
    return result


def _python_ags4(path: Path) -> Any:
    if importlib.util.find_spec("python_ags4") is None:
        raise InputError(str(path), ["AGS4 files need the package python-ags4: pip install noshiro[borings]"])
    from python_ags4 import AGS4

    logging.getLogger("python_ags4").setLevel(logging.CRITICAL + 1)  # what it has to say is told here
    return AGS4


def _reason(error: Exception) -> str:
    return str(error) if not isinstance(error, IndexError | KeyError) else "a row stands outside of a group"


def _unit_problem(kind: Kind, unit: str) -> str:
    try:
        kind.read(with_unit("1", unit))
    except ValueError as error:
        return str(error)
    return ""


def _departures(ags4: Any, path: Path, lines: str) -> list[str]:
    """A sentence with what python-ags4 finds against the rules of AGS4; nothing of that keeps a file from being read.

    Whether a file ends its lines with CR LF, and which groups it may not lack, is of no account here.
    """
    report = ags4.check_file(io.StringIO(lines.replace("\n", "\r\n")))
    rules = {
        rule.removeprefix("AGS Format Rule "): faults for rule, faults in report.items() if rule.startswith("AGS For")
    }
    if not rules:
        return []
    rule, faults = next(iter(rules.items()))
    first = f"line {faults[0]['line']}, {faults[0]['desc']}" if str(faults[0]["line"]).isdigit() else faults[0]["desc"]
    counts = ", ".join(f"{rule} ({len(faults)})" for rule, faults in rules.items())
    first = first.rstrip(".")
    return [f"{path.name} departs from rules of AGS4, as python-ags4 counts: {counts}; the first: rule {rule}, {first}"]
