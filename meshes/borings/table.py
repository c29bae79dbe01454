"""Reads a CSV file with a heading: its columns with their units, and its lines by boring."""

import csv
import math
import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from meshes.borings.complaints import folded
from meshes.borings.headings import HEADINGS, compact, guessed_columns, without_datum
from meshes.borings.text_file import read_text
from meshes.errors import InputError
from meshes.section.quantity import COORDINATE, DENSITY, LENGTH, STRENGTH, Kind

HEADING = re.compile(r"^\s*([^(\[]+?)\s*(?:[(\[]\s*([^)\]]*?)\s*[)\]])?\s*$")
PLACE = ("x", "easting", "northing")
SEPARATORS = ";\t,"
FIRST_LINES = 20  # among which the heading stands, below the title of a sheet
NOT_MEASURED = {"", "-", "--", "n/a", "na", "nan", "none"}
# A number with a decimal comma, and perhaps a unit, in a file whose cells are not parted by commas.
DECIMAL_COMMA = re.compile(r"([-+]?\d+),(\d+)(\s*[^\d,]\S*)?")
KINDS: dict[str, Kind] = {
    **dict.fromkeys((*PLACE, "ground_level", "water_level", "water_depth", "top", "bottom", "depth"), COORDINATE),
    "d50": LENGTH, "unit_weight": DENSITY, "qc": STRENGTH, "fs": STRENGTH,
}  # fmt: skip
# What a column without a dimension may say of its unit; blows for a foot are those for 30 cm.
PERCENT = ("", "%", "percent")
BLOWS = (
    "",
    "-",
    "blows",
    "bpf",
    "blows/ft",
    "blows/foot",
    "blows/30cm",
    "blows/300mm",
    "blows/0.3m",
    "blows/12in",
    "回",
    "schläge",
)
PLAIN = {"N": BLOWS, "fines": PERCENT, "plasticity": PERCENT}


@dataclass(frozen=True)
class BoringTable:
    """Holds the lines of a file by boring, each with its number and its cells by column. Also holds the units by
    column, problems, blow counts that cannot be read, and notices.
    """

    lines: Mapping[str, Sequence[tuple[int, Mapping[str, str]]]]
    units: Mapping[str, str]
    problems: list[str] = field(default_factory=list)
    notices: list[str] = field(default_factory=list)
    unread: list[str] = field(default_factory=list)

    def length(self, number: int, cells: Mapping[str, str], key: str) -> float:
        """Return a coordinate in m. If it cannot be read, return NaN and record a problem."""
        try:
            return float(COORDINATE.read(with_unit(cells.get(key, ""), self.units.get(key, ""))))
        except ValueError as error:
            problem = f" = {cells[key]!r}: {error}" if cells.get(key) else f": missing; {COORDINATE.expected}"
            self.problems.append(f"line {number}, {key}{problem}")
            return math.nan

    def location(self, number: int, cells: Mapping[str, str]) -> tuple[float, float]:
        """Return the place as (easting, northing), or as (x, NaN)."""
        if cells.get("x"):
            return self.length(number, cells, "x"), math.nan
        return self.length(number, cells, "easting"), self.length(number, cells, "northing")


@dataclass(frozen=True)
class _Sheet:
    """Holds the cells of a file, the heading first, each row with the number of its line. Columns have the names that
    this program uses."""

    rows: list[tuple[int, list[str]]]
    heads: list[tuple[str, str]]
    notices: list[str]


def has_column(path: Path, name: str, columns: Mapping[str, str]) -> bool:
    """Return whether a file has a column of that name. Raises InputError if the file cannot be read."""
    return name in [head for head, _ in _sheet(path, columns, (name,)).heads]


def named_columns(path: Path, columns: Mapping[str, str], known: Sequence[str]) -> dict[str, str]:
    """Return those of the named ``columns`` that the file has and that a table of its kind may have.

    Parameters
    ----------
    path : path of the file
    columns : names of columns in the file by the expected names
    known : names of columns that the table may have

    Returns
    -------
    Names of columns by the expected names.
    """
    cells = [cell for _, row in _sheet(path, columns, known).rows[:1] for cell in row]
    headings = {text for cell in cells for text in (_plain(cell), _plain(_split(cell)[0]))}
    return {key: name for key, name in columns.items() if key in known and _plain(name) in headings}


def read_table(path: Path, needed: Sequence[str], known: Sequence[str], columns: Mapping[str, str]) -> BoringTable:
    """Read the lines of a file; every line names a boring.

    Parameters
    ----------
    path : path of the file, whose cells are separated by commas, semicolons or tabs
    needed, known : names of columns that the file must have, and of those that it may have
    columns : names of columns in the file by the expected names, where they differ; other columns are then left out

    Raises
    ------
    InputError : if columns are missing or unknown, or have units that cannot be read
    """
    sheet = _sheet(path, columns, known)
    if len(sheet.rows) < 2:
        raise InputError(str(path), [f"holds no lines; expected a heading with {', '.join(needed)}, and lines below"])
    names = [name for name, _ in sheet.heads]
    units = dict(sheet.heads)
    others = [name for name in names if name and name not in known]
    problems = _unknown(sheet, columns, known, needed)
    problems += [text for name, unit in sheet.heads if (text := _unit_problem(name, unit))]
    problems += [f"line {number}: has {len(row)} cells where the heading has {len(names)}; expected numbers with a "
                 "decimal point, or cells separated by semicolons"
                 for number, row in sheet.rows[1:] if any(row[len(names):])]  # fmt: skip
    if problems:
        raise InputError(str(path), folded(problems))
    if others:
        sheet.notices.append(f"{path.name}: not used: {', '.join(others)}")
    by_boring: dict[str, list[tuple[int, dict[str, str]]]] = {}
    for number, row in sheet.rows[1:]:
        cells = {name: cell for name, cell in zip(names, row, strict=False) if name in known}
        by_boring.setdefault(cells.get("boring", ""), []).append((number, cells))
    missing = [
        f"line {rows[0][0]}, boring: missing; expected the name of the boring"
        for name, rows in by_boring.items()
        if not name
    ]
    return BoringTable(by_boring, units, missing, sheet.notices)


def _unknown(sheet: _Sheet, columns: Mapping[str, str], known: Sequence[str], needed: Sequence[str]) -> list[str]:
    """Return problems of columns: columns that are missing, that are unknown, or that were named by the user and are
    not in the file."""
    names = [name for name, _ in sheet.heads]
    written = [_split(cell)[0] for cell in sheet.rows[0][1]]
    problems = [f"--columns {key}={name}: expected a column name of noshiro, one of {', '.join(known)}"
                for key, name in columns.items() if key not in known]  # fmt: skip
    problems += [f"--columns {key}={name}: there is no column {name!r}; expected one of {', '.join(written)}"
                 for key, name in columns.items() if key in known and key not in names]  # fmt: skip
    lacking = [name for name in needed if name not in names]
    placeless = "x" not in names and not {"easting", "northing"} <= set(names)
    unread = [] if columns or not (lacking or placeless) else [repr(name) for name in names if name not in known]
    if others := unread:
        message = (
            f"expected {'some' if len(others) > 1 else 'one'} of {', '.join(known)}; --columns layer=Stratum names the "
            "column in the file, and columns that it does not name are left out"
        )
        problems.append(f"column{'s' * (len(others) > 1)} {', '.join(others)}: {message}")
    problems += [f"column {name}: missing" for name in lacking]
    problems += [f"column {name}: there are {names.count(name)}" for name in dict.fromkeys(names)
                 if name in known and names.count(name) > 1]  # fmt: skip
    if placeless:
        problems.append("column x: missing; expected column x, or easting and northing")
    return problems


def _unit_problem(name: str, unit: str) -> str:
    """Return the problem of the unit in the heading of a column; empty if there is none."""
    if name in PLAIN and re.sub(r"\s|_", "", unit.lower()).replace("per", "/") not in PLAIN[name]:
        expected = "blows for 30 cm or for a foot" if name == "N" else "percent"
        return f"column {name} ({unit}): expected {expected}"
    try:
        if unit and name in KINDS:
            KINDS[name].read(written("1", unit))
    except ValueError as error:
        return f"column {name} ({unit}): {error}"
    return ""


def _sheet(path: Path, columns: Mapping[str, str], known: Sequence[str]) -> _Sheet:
    text, notice = read_text(path)
    lines = text.splitlines(keepends=True)
    separator = ""
    if lines and (directive := re.fullmatch(r"\s*\"?sep=(.)\"?\s*", lines[0])):  # Excel's way to say it
        separator, lines[0] = directive[1], "\n"
    wanted = {_plain(name): key for key, name in columns.items()}
    ours = {_plain(name): name for name in known}
    first = _heading_line(lines, {*wanted, *ours, *(word for name in known for word in HEADINGS.get(name, ()))})
    heading = re.sub(r'"[^"]*"|\([^)]*\)', "", lines[first]) if lines else ""
    separator = separator or max(SEPARATORS, key=heading.count)
    reader = csv.reader(lines[first:], delimiter=separator)
    rows = [(first + reader.line_num, row) for row in reader if any(map(str.strip, row)) and not _is_comment(row)]
    rows = [(number, [_decimal(cell.strip(), separator) for cell in row]) for number, row in rows]
    width = max((k for _, row in rows for k, cell in enumerate(row, start=1) if cell), default=0)
    rows = rows and [(rows[0][0], rows[0][1][:width]), *rows[1:]]
    heads = []
    for cell in rows[0][1] if rows else ():
        name, unit = _split(cell)
        key = wanted.get(_plain(cell)) or wanted.get(_plain(name))  # --columns may name the unit, too
        free = _plain(name) in ours and ours[_plain(name)] not in columns
        heads.append((key or (ours[_plain(name)] if free else name), unit))
    taken = {*columns, *(name for name, _ in heads if name in known)}
    usual = guessed_columns([name for name, _ in heads], known, taken)
    heads = [(usual.get(name, name), unit) for name, unit in heads]
    if len(rows) > 1 and _are_units(heads, rows[1][1]):
        below = map(without_datum, rows.pop(1)[1])
        heads = [(name, unit or unit_below) for (name, unit), unit_below in zip(heads, below, strict=False)]
    notices = [notice] if notice else []
    if usual:
        meanings = ", ".join(f"{name!r} as {key}" for name, key in usual.items())
        notices.append(f"{path.name}: columns are read by their usual meaning, {meanings}; --columns names others")
    if any(line.strip(" \t\r\n,;") for line in lines[:first]):
        notices.append(f"{path.name}: the heading is read from line {first + 1}; the lines above it are not read")
    return _Sheet(rows, heads, notices)


def _is_comment(row: Sequence[str]) -> bool:
    """Return whether a row contains a comment alone, such as "# site A"; "#1" before other cells names a boring."""
    cells = [cell for cell in map(str.strip, row) if cell]
    return len(cells) == 1 and cells[0].startswith("#")


def _heading_line(lines: Sequence[str], names: set[str]) -> int:
    """Return the index of the line with the heading. Among the first lines it is the one with most of the ``names``, or
    else the first line."""
    filled = [k for k, line in enumerate(lines) if line.strip(" \t\r\n,;")][:FIRST_LINES]
    met = {k: sum(not names.isdisjoint({_plain(cell), _plain(_split(cell)[0]), compact(_split(cell)[0])})
                  for cell in (cell.strip(' "\r\n') for cell in re.split(r"[;\t,]", lines[k])))
           for k in filled}  # fmt: skip
    return max(filled, key=lambda k: met[k] if met[k] > 1 else 0, default=0)


def _are_units(heads: Sequence[tuple[str, str]], row: Sequence[str]) -> bool:
    """Return whether a row below the heading contains only units of the columns, and at least one."""
    cells = [(name, cell) for (name, _), cell in zip(heads, row, strict=False) if cell]
    return any(name in KINDS for name, _ in cells) and not any(
        name not in (*KINDS, *PLAIN) or re.search(r"^[-+.]?\d", cell) or _unit_problem(name, without_datum(cell))
        for name, cell in cells
    )


def _plain(name: str) -> str:
    return re.sub(r"[\s_]+", "_", unicodedata.normalize("NFKC", name).strip()).casefold()


def _decimal(cell: str, separator: str) -> str:
    """Return a cell, with a decimal point in place of a decimal comma."""
    return DECIMAL_COMMA.sub(r"\1.\2\3", cell) if separator != "," and DECIMAL_COMMA.fullmatch(cell) else cell


def _split(cell: str) -> tuple[str, str]:
    head = HEADING.match(unicodedata.normalize("NFKC", cell))
    return (head[1], without_datum(head[2] or "")) if head else (cell, "")


def written(value: str, unit: str) -> str:
    """Return a value with the unit of its column heading, unless the value has a unit itself."""
    return f"{value} {unit}" if unit and re.fullmatch(r"[-+.\deE]+", value) else value


def with_unit(value: str, unit: str) -> str | float:
    """Return a value with its unit in the form of a section file: a plain number is a number."""
    text = written(value, unit)
    try:
        return float(text)
    except ValueError:
        return text
