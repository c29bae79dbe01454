"""Reads the groups of an AGS3 file under the names that AGS4 gave them: HOLE is LOCA, WSTK is WSTG, STCN is SCPT."""

import csv
import re
from dataclasses import dataclass, field

GROUPS = {"HOLE": "LOCA", "WSTK": "WSTG", "STCN": "SCPT"}
HEADINGS = {"WSTK_DEP": "WSTG_DPTH", "WSTK_POST": "WSTD_POST"}
FIRST_GROUP = re.compile(r'\s*"?\*\*\??\w+')


@dataclass
class Ags3:
    """Holds the data of an AGS3 file: rows and headings by group, and units by heading."""

    rows: dict[str, list[dict[str, str]]] = field(default_factory=dict)
    headings: dict[str, list[str]] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)


def is_ags3(text: str) -> bool:
    """Return whether a file begins with a group of AGS3, such as "**PROJ"; an AGS4 file may mention groups further
    down."""
    return FIRST_GROUP.match(text) is not None


def read_ags3(text: str) -> Ags3:
    """Read the groups of a file; a line that begins with <CONT> continues the cells of the row above it."""
    groups, group = Ags3(), ""
    row: dict[str, str] = {}
    reader = csv.reader(text.splitlines(keepends=True))
    for cells in reader:
        first, heads = cells[0].strip() if cells else "", groups.headings.get(group, [])
        if first.startswith("**"):
            group, row = GROUPS.get(name := first.strip("*?"), name), {}
            groups.headings[group], groups.rows[group] = [], []
        elif first.startswith("*"):
            heads += [_heading(cell.strip(" *?")) for cell in cells if cell]
        elif first.upper() == "<UNITS>":
            groups.units |= {key: unit.strip() for key, unit in zip(heads[1:], cells[1:], strict=False) if unit.strip()}
        elif first.upper() == "<CONT>":
            for key, cell in zip(heads[1:], cells[1:], strict=False):
                row[key] = row.get(key, "") + cell
        elif "".join(cells).strip() and group:
            row = {**dict(zip(heads, cells, strict=False)), "line_number": str(reader.line_num)}
            groups.rows[group].append(row)
    return groups


def _heading(name: str) -> str:
    group, _, rest = name.partition("_")
    return HEADINGS.get(name, f"{GROUPS.get(group, group)}_{rest}")
