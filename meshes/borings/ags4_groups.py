"""Reads the groups of an AGS4 file by python-ags4, or of an AGS3 file, with units and departures from the rules."""

import importlib.util
import io
import logging
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from meshes.borings.ags3_file import is_ags3, read_ags3
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
LINE = "line_number"  # key of a row: the number of its line in the file

Row = Mapping[str, str]


@dataclass(frozen=True)
class Groups:
    """Holds the groups of an AGS file.

    Attributes
    ----------
    rows : rows of each group, by heading
    units : units by heading, only those of a known kind
    problems : problems of the file, collected as it is read
    notices : notices for the user, one sentence each
    unread : blow counts that cannot be read, one sentence each
    """

    rows: Mapping[str, Sequence[Row]]
    headings: Mapping[str, Sequence[str]]
    units: Mapping[str, str]
    problems: list[str] = field(default_factory=list)
    notices: list[str] = field(default_factory=list)
    unread: list[str] = field(default_factory=list)

    def of(self, group: str, boring: str) -> list[Row]:
        """Return the rows of a group that belong to a boring."""
        return [row for row in self.rows.get(group, ()) if row.get("LOCA_ID") == boring]

    def meaning(self, code: str) -> str:
        """Return the meaning that group ABBR gives to a numerical code, as the codes of GEOL_LEG are. Other codes are
        returned unchanged."""
        named = (row.get("ABBR_DESC", "") for row in self.rows.get("ABBR", ()) if row.get("ABBR_CODE") == code)
        return (next(named, "") if code.isdecimal() else "") or code

    def read(self, row: Row, key: str) -> float:
        """Read a length (m) or stress (Pa) in the unit of its heading. A stress may be negative. Raises ValueError."""
        text, kind = DECIMAL_COMMA.sub(r"\1.\2\3", row.get(key, "")), KINDS[key]
        below = kind is STRENGTH and text.startswith("-")
        size = float(kind.read(with_unit(text.removeprefix("-") if below else text, self.units.get(key, ""))))
        return -size if below else size


def read_groups(path: Path) -> Groups:
    """Read the groups of a file. Raises InputError if it is no AGS file, or has units that cannot be read."""
    text, notice = read_text(path)
    notices = [notice] if notice else []
    if is_ags3(text):
        ags3 = read_ags3(text)
        rows = {group: [{key: _stripped(cell) for key, cell in row.items()} for row in lines]
                for group, lines in ags3.rows.items()}  # fmt: skip
        headings, units = ags3.headings, ags3.units
        notices.append(f"{path.name} is AGS3, and is read as AGS4: HOLE as LOCA, WSTK as WSTG, STCN as SCPT")
    elif re.search(r'^\s*"?GROUP', text, re.MULTILINE):
        ags4 = _python_ags4(path)
        numbered = [(number, line) for number, line in enumerate(text.splitlines(), start=1) if line.strip(' ,"')]
        lines = "".join(line + "\n" for _, line in numbered)  # a blank line ends no group
        try:
            tables, headings, _ = ags4.AGS4_to_dict(io.StringIO(lines), get_line_numbers=True)
        except (ags4.AGS4Error, IndexError, KeyError) as error:
            reason = _reason(error, [number for number, _ in numbered])
            raise InputError(str(path), [f"cannot be read as AGS4: {reason}"]) from None
        rows, units = _rows(tables, [number for number, _ in numbered])
        notices += _departures(ags4, path, lines)
    else:
        raise InputError(str(path), ["holds no GROUP; expected AGS4, with a group LOCA of the borings, or AGS3"])
    known = {key: units.get(key) or UNITS.get(key, "m") for key in KINDS}
    for key, unit in known.items():  # "M" and "FT" are no molars
        if _unit_problem(KINDS[key], unit) and not _unit_problem(KINDS[key], unit.lower()):
            known[key] = unit.lower()
    problems = [f"group {key.partition('_')[0]}, unit {unit!r} of {key}: {wrong}" for key, unit in known.items()
                if (wrong := _unit_problem(KINDS[key], unit))]  # fmt: skip
    if problems:
        raise InputError(str(path), problems)
    return Groups(rows, {group: list(names) for group, names in headings.items()}, known, notices=notices)


def _rows(
    tables: Mapping[str, Mapping[str, Sequence[Any]]], numbers: Sequence[int]
) -> tuple[dict[str, list[dict[str, str]]], dict[str, str]]:
    """Return the rows of data by group, and the units by heading, as python-ags4 reads them from lines of these
    numbers."""
    rows: dict[str, list[dict[str, str]]] = {}
    units: dict[str, str] = {}
    for group, columns in tables.items():
        lines = [str(numbers[line - 1]) for line in columns[LINE]]
        columns = {name.strip(): lines if name == LINE else cells for name, cells in columns.items()}
        every = [
            dict(zip(columns, map(_stripped, cells), strict=True)) for cells in zip(*columns.values(), strict=True)
        ]
        rows[group] = [row for row in every if row.get("HEADING") == "DATA"]
        units |= {key: unit for row in every if row.get("HEADING") == "UNIT" for key, unit in row.items()}
    return rows, units


def _stripped(cell: str) -> str:
    return "" if cell.strip().casefold() == "null" else cell.strip()


def _python_ags4(path: Path) -> Any:
    if importlib.util.find_spec("python_ags4") is None:
        raise InputError(str(path), ["AGS4 files need the package python-ags4: pip install noshiro[borings]"])
    from python_ags4 import AGS4

    logging.getLogger("python_ags4").setLevel(logging.CRITICAL + 1)  # what it has to say is reported here
    return AGS4


def _reason(error: Exception, numbers: Sequence[int]) -> str:
    """Return the errors that python-ags4 finds in a file, with line numbers of this file."""
    if isinstance(error, IndexError | KeyError):
        return "a row stands outside of a group"
    return re.sub(r"(?<=Line )\d+", lambda line: str(numbers[int(line[0]) - 1]), str(error)).rstrip(". ")


def _unit_problem(kind: Kind, unit: str) -> str:
    try:
        kind.read(with_unit("1", unit))
    except ValueError as error:
        return str(error)
    return ""


def _departures(ags4: Any, path: Path, lines: str) -> list[str]:
    """Return a sentence on departures from the rules of AGS4 that python-ags4 finds. No such departure prevents that a
    file is read.

    Line ends (CR LF), and missing groups that the rules require, are not reported.
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
