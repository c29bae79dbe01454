"""Reads workbooks of xslope (`.xlsx`): sheets of profile lines, materials, piezometric lines and distributed loads."""

import importlib.util
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from meshes.errors import InputError
from meshes.models.foreign_model import (
    ForeignLayer,
    ForeignModel,
    ImportedSection,
    as_input_errors,
    corners,
    line_of,
    section_of,
)

EXPECTED = "expected a workbook of xslope, with sheets main, profile, mat, piezo and dloads"
FEET, POUNDS = 0.3048, 0.04788026  # m of a foot, kPa of a lbf/ft²
IMPERIAL = 30.0  # unit weights of water above this are in lbf/ft³
TOUCHING_DISTANCE = 1e-6  # of the width of a section: distance at which two lines touch
INTERVAL_MARGIN = 1e-6  # of an interval: distance from its ends at which lines are evaluated
OPTIONS = ("mc", "cp")  # Mohr-Coulomb, and c that grows with depth
Rows = list[tuple[Any, ...]]
Points = list[tuple[float, float]]


class XslopeUnits(NamedTuple):
    """Holds the length (m) and the stress (kPa) of a unit, and the unit weight of water (kN/m³)."""

    length: float
    stress: float
    water: float


def read_xslope(path: Path, name: str, part: str | None = None) -> ImportedSection:
    """Read the section of a workbook of xslope.

    Parameters
    ----------
    path : path of the file
    name : name of the section
    part : always None, since a workbook has no parts

    Returns
    -------
    The section as TOML, and notices.

    Raises
    ------
    InputError
        If the file is no such workbook, a part is given, or the package that reads workbooks is missing.
    """
    if part is not None:
        raise InputError("--part", [f'"{part}": expected none, since a workbook of xslope holds one model'])
    if importlib.util.find_spec("openpyxl") is None:
        raise InputError(str(path), ["a workbook needs the package openpyxl: pip install noshiro[xslope]"])
    import openpyxl

    with as_input_errors(path, EXPECTED):
        workbook = openpyxl.load_workbook(path, data_only=True, read_only=True)
        sheets = {
            sheet: [tuple(row) for row in workbook[sheet].iter_rows(values_only=True)] for sheet in workbook.sheetnames
        }
        return section_of(_model({key.strip().lower(): _whole(rows) for key, rows in sheets.items()}), path, name)


def _whole(rows: Rows) -> Rows:
    """Return the rows, filled up to equal length."""
    width = max((len(row) for row in rows), default=0)
    return [row + (None,) * (width - len(row)) for row in rows]


def _model(sheets: dict[str, Rows]) -> ForeignModel:
    water = _cell_after(sheets["main"], "unit weight of water")
    imperial = water > IMPERIAL
    units = XslopeUnits(FEET, POUNDS, water * POUNDS / FEET) if imperial else XslopeUnits(1.0, 1.0, water)
    notices = ["feet and pounds are converted"] if imperial else []
    lines = [line_of(points) * units.length for points in _tables(sheets["profile"], "profile line", "x", "y")]
    rows = _materials(sheets["mat"])
    if not lines or len(rows) < len(lines):
        raise ValueError(f"{len(lines)} profile lines and {len(rows)} materials; expected a material for each line")
    tables = [line_of(points) * units.length for points in _tables(sheets["piezo"], "piezometric line", "x", "y")]
    base = _cell_after(sheets["profile"], "max depth") * units.length
    layers = []
    for k, row in enumerate(rows[: len(lines)]):
        keys = _soil(row, units, bool(tables), notices)
        called = str(row.get("name") or f"material {k + 1}")
        layers += [ForeignLayer(called, outline, keys, {}, {}) for outline in _outlines(lines, k, base)]
    surcharges = list(_loads(sheets["dloads"], units, tables[:1], notices))
    notices += _not_taken(sheets, len(tables) > 1)
    table = {"table": tables[0].tolist(), "unit_weight": f"{units.water:.6g} kN/m^3"} if tables else {}
    return ForeignModel(layers, table, surcharges, list(dict.fromkeys(notices)))


def _cell_after(rows: Rows, words: str) -> float:
    """Return the number in the cell to the right of a cell with ``words``. Raises LookupError without such a cell."""
    for row in rows:
        for cell, value in pairwise(row):
            if isinstance(cell, str) and words in cell.lower():
                return float(value or 0.0)
    raise LookupError(f"no {words}")


def _tables(rows: Rows, title: str, *heads: str) -> Iterator[Points]:
    """Yield the numbers below every row of ``heads`` that has a ``title`` above it, a list of tuples for each; nothing
    if there is none."""
    for i, j in ((i, j) for i, row in enumerate(rows[1:], start=1) for j in range(len(row) - len(heads) + 1)):
        row_of_heads = tuple(str(cell or "").strip().lower() for cell in rows[i][j : j + len(heads)])
        if row_of_heads != heads or title not in str(rows[i - 1][j] or "").lower():
            continue
        numbers: list[Any] = []
        for row in rows[i + 1 :]:
            cells = row[j : j + len(heads)]
            if not all(isinstance(cell, int | float) for cell in cells):
                break
            numbers.append(tuple(float(cell) for cell in cells))
        if numbers:
            yield numbers


def _materials(rows: Rows) -> list[dict[str, Any]]:
    """Return the materials by the headings of their columns."""
    top = next(i for i, row in enumerate(rows) if "option" in row)
    heads = [str(cell or "").strip() for cell in rows[top]]
    filled = [row for row in rows[top + 1 :] if isinstance(row[0], int | float) and row[heads.index("g")] is not None]
    return [dict(zip(heads, row, strict=True)) for row in filled]


def _soil(row: dict[str, Any], units: XslopeUnits, water: bool, notices: list[str]) -> dict[str, Any]:
    """Return the keys of a stratum. Properties of the material that a stratum cannot have are reported in a notice."""
    name, option = row.get("name"), str(row.get("option") or "").strip().lower()
    if option not in OPTIONS:
        raise ValueError(f'material "{name}" has the strength option "{option}"; expected one of {", ".join(OPTIONS)}')
    weight = f"{float(row['g']) * units.stress / units.length:.5g} kN/m^3"
    keys: dict[str, Any] = {"density": weight, "density_saturated": weight}
    if option == "cp":
        growth = float(row.get("c/p") or 0.0) * units.stress / units.length
        keys |= {"cohesion": "0 kPa", "friction_angle": "0 deg", "cohesion_increase": f"{growth:.5g} kPa/m"}
        keys["cohesion_from"] = float(row.get("r-elev") or 0.0) * units.length
    else:
        keys["cohesion"] = f"{float(row.get('c') or 0.0) * units.stress:.5g} kPa"
        keys["friction_angle"] = f"{float(row.get('f') or 0.0):g} deg"
    pore = str(row.get("u") or "none").strip().lower()
    if pore == "none" and water:
        keys["pore_pressure_ratio"] = 0.0
    elif pore == "seep":
        notices.append(f'not read: the seepage solution of "{name}"; the piezometric line is used; see [water], flow')
    if row.get("d") or row.get("ψ"):
        notices.append(f'not read: the undrained strength of "{name}" after drawdown (d, ψ)')
    return keys


def _outlines(lines: Sequence[np.ndarray], k: int, base: float) -> Iterator[np.ndarray]:
    """Yield the outlines (n, 2) in m of the ground below profile line k: down to the next line below it, or to the
    base."""
    line = lines[k]
    near = TOUCHING_DISTANCE * (max(each[-1, 0] for each in lines) - min(each[0, 0] for each in lines))
    tops: Points = []
    bottoms: Points = []
    for start, end in pairwise(_breaks(lines, k)):
        if end - start <= near:
            continue
        at = _inside(start, end)
        top, middle = np.interp(at, *line.T), float(np.interp(at, *line.T).mean())
        below = [(float(low.mean()), low) for j, other in enumerate(lines)
                 if j != k and other[0, 0] <= at[0] and at[1] <= other[-1, 0]
                 and ((low := np.interp(at, *other.T)).mean() < middle - near
                      or (j > k and abs(low.mean() - middle) <= near))]  # fmt: skip
        bottom = max(below, key=lambda pair: pair[0])[1] if below else np.full(2, base)
        if middle - float(bottom.mean()) <= near:
            if tops:
                yield corners([*tops, *bottoms[::-1]])
            tops, bottoms = [], []
            continue
        for x, upper, lower in zip((start, end), _to_ends(top), _to_ends(bottom), strict=True):
            tops.append((float(x), round(float(upper), 6)))
            bottoms.append((float(x), round(float(lower), 6)))
    if tops:
        yield corners([*tops, *bottoms[::-1]])


def _inside(start: float, end: float) -> np.ndarray:
    """Return two places just inside the ends of an interval, so that a step of a line at an end counts on its inner
    side."""
    return np.array([start, end]) + INTERVAL_MARGIN * (end - start) * np.array([1.0, -1.0])


def _to_ends(values: np.ndarray) -> np.ndarray:
    """Return the values (2,) of a straight line at the ends of an interval, from the values at the places of
    `_inside`."""
    rise = INTERVAL_MARGIN * (values[1] - values[0]) / (1.0 - 2.0 * INTERVAL_MARGIN)
    return values + rise * np.array([-1.0, 1.0])


def _breaks(lines: Sequence[np.ndarray], k: int) -> np.ndarray:
    """Return the x (n,) in m of profile line k between which no line has a corner or crosses another line."""
    left, right = lines[k][[0, -1], 0]
    x = np.unique(np.concatenate([line[:, 0] for line in lines]).clip(left, right))
    crossings = []
    for start, end in pairwise(x):
        at = _inside(start, end)
        for other in lines:
            over = np.interp(at, *lines[k].T) - np.interp(at, *other.T)
            if other[0, 0] <= at[0] and at[1] <= other[-1, 0] and over[0] * over[1] < 0.0:
                crossings.append(start + (end - start) * over[0] / (over[0] - over[1]))
    return np.unique(np.append(x, crossings))


def _loads(
    rows: Rows, units: XslopeUnits, tables: Sequence[np.ndarray], notices: list[str]
) -> Iterator[dict[str, Any]]:
    """Yield the distributed loads as surcharges. Loads of free water are left to the water table, and loads after
    drawdown are reported in a notice."""
    for title, taken in (("a", True), ("b", False)):
        for points in _tables_of_loads(rows, title):
            x, z, normal = points.T * np.array([units.length, units.length, units.stress])[:, None]
            depth = np.interp(x, *tables[0].T) - z if tables else np.zeros(len(x))
            if not taken:
                notices.append("not read: distributed loads after drawdown")
            elif tables and np.allclose(normal, units.water * depth, rtol=0.02, atol=0.5):
                notices.append("distributed loads of free water are not read, since the piezometric line gives them")
            else:
                notices.append("distributed loads act vertically, not along the normal of the ground")
                for i in range(len(x) - 1):
                    pressure = [f"{value:.5g} kPa" for value in normal[i : i + 2]]
                    yield {"from": float(x[i]), "to": float(x[i + 1]), "pressure": pressure}


def _tables_of_loads(rows: Rows, case: str) -> Iterator[np.ndarray]:
    """Yield loads (n, 3), x, y and normal stress, of set "a", which is in use, or of set "b", which applies after
    drawdown."""
    titles = [str(cell or "").strip().lower() for row in rows for cell in row]
    for title in titles:
        if title.startswith("distributed load #") and title.endswith(case):
            yield from (np.array(points) for points in _tables(rows, title, "x", "y", "n"))


def _not_taken(sheets: dict[str, Rows], second: bool) -> Iterator[str]:
    main = sheets["main"]
    if (crack := _cell_after(main, "tension crack depth")) > 0.0:
        yield f"not read: a tension crack {crack:g} deep; see [tension_crack]"
    if (kh := _cell_after(main, "seismic coefficient")) != 0.0:
        yield f"not read: a seismic coefficient of {kh:g}; fem.safety_factor_at = [{kh:g}] has its factor of safety"
    if second:
        yield "not read: the piezometric line after drawdown; see after_drawdown in [water]"
    lines = sheets.get("reinforce", [])
    if any(sum(isinstance(cell, int | float) for cell in row[1:]) >= 5 for row in lines):
        yield "not taken: reinforcement"
