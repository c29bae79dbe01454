"""A CSV file with a heading: its columns with their units, and its lines by boring."""

import csv
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from meshes.errors import InputError
from meshes.section.quantity import COORDINATE

HEADING = re.compile(r"^\s*(\w+)\s*(?:[(\[]\s*([^)\]]*?)\s*[)\]])?\s*$")
PLACE = ("x", "easting", "northing")


@dataclass(frozen=True)
class Table:
    """Lines of a file by boring, each with its number and its cells by column; units by column; what is wrong."""

    lines: Mapping[str, Sequence[tuple[int, Mapping[str, str]]]]
    units: Mapping[str, str]
    problems: list[str] = field(default_factory=list)

    def length(self, number: int, cells: Mapping[str, str], key: str) -> float:
        """A coordinate in m; not a number, and a problem, where it cannot be read."""
        try:
            return float(COORDINATE.read(with_unit(cells.get(key, ""), self.units.get(key, ""))))
        except ValueError as error:
            self.problems.append(f"line {number}, {key} = {cells.get(key, '')!r}: {error}")
            return math.nan

    def place(self, number: int, cells: Mapping[str, str]) -> tuple[float, float]:
        """(easting, northing), or (x, nan)."""
        if cells.get("x"):
            return self.length(number, cells, "x"), math.nan
        return self.length(number, cells, "easting"), self.length(number, cells, "northing")


def columns_of(path: Path) -> list[str]:
    """The names of the columns, without their units. Raises InputError."""
    return [_split(cell)[0] for cell in _rows(path)[0]]


def read_table(path: Path, needed: Sequence[str], known: Sequence[str]) -> Table:
    """The lines of a file that has a boring in each. Raises InputError where columns are missing or not known."""
    rows = _rows(path)
    if len(rows) < 2:
        raise InputError(str(path), [f"holds no lines; expected a heading with {', '.join(needed)}, and lines below"])
    heads = [_split(cell) for cell in rows[0]]
    names = [name for name, _ in heads]
    problems = [f"column {name!r}: expected one of {', '.join(known)}" for name in names if name not in known]
    problems += [f"column {name}: missing" for name in needed if name not in names]
    if "x" not in names and not {"easting", "northing"} <= set(names):
        problems.append("column x: missing; expected it, or easting and northing")
    if problems:
        raise InputError(str(path), problems)
    by_boring: dict[str, list[tuple[int, dict[str, str]]]] = {}
    for number, row in enumerate(rows[1:], start=2):
        cells = {name: cell.strip() for name, cell in zip(names, row, strict=False)}
        by_boring.setdefault(cells.get("boring", ""), []).append((number, cells))
    missing = [f"line {its[0][0]}, boring: missing; expected the name of the boring" for name, its in by_boring.items()
               if not name]  # fmt: skip
    return Table(by_boring, dict(heads), missing)


def _rows(path: Path) -> list[list[str]]:
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            rows = [row for row in csv.reader(file) if any(cell.strip() for cell in row)]
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(str(path), [f"cannot be read: {getattr(error, 'strerror', None) or error}"]) from None
    return rows or [[]]


def _split(cell: str) -> tuple[str, str]:
    head = HEADING.match(cell)
    return (head[1], head[2] or "") if head else (cell, "")


def written(value: str, unit: str) -> str:
    """A value with the unit of its heading, if it has none of its own; m3 is m^3."""
    text = f"{value} {unit}" if unit and re.fullmatch(r"[-+.\deE]+", value) else value
    return re.sub(r"(?<=[a-z])([23])\b", r"^\1", text).replace("m²", "m^2").replace("m³", "m^3")


def with_unit(value: str, unit: str) -> str | float:
    """The same as a person would write it in a section: a plain number is a number."""
    text = written(value, unit)
    try:
        return float(text)
    except ValueError:
        return text
