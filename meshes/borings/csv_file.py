"""Borings from a CSV file: a line for each layer of each boring, with units in the values or in the heading."""

import csv
import math
import re
from collections.abc import Mapping
from pathlib import Path

from pydantic import ValidationError

from meshes.borings.boring import Sample
from meshes.borings.log import Log, LogLayer, layer_problems
from meshes.errors import InputError
from meshes.section.quantity import COORDINATE, DENSITY

NEEDED = ("boring", "ground_level", "top", "bottom", "layer")
KNOWN = (*NEEDED, "x", "easting", "northing", "N", "fines", "d50", "unit_weight", "water_level")
HEADING = re.compile(r"^\s*(\w+)\s*(?:[(\[]\s*([^)\]]*?)\s*[)\]])?\s*$")


def read_csv(path: Path) -> list[Log]:
    """The borings of a file, in its order; N stands in the middle of its layer. Raises InputError with all problems."""
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            rows = [row for row in csv.reader(file) if any(cell.strip() for cell in row)]
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(str(path), [f"cannot be read: {getattr(error, 'strerror', None) or error}"]) from None
    if len(rows) < 2:
        raise InputError(str(path), [f"holds no layers; expected a heading with {', '.join(NEEDED)}, and lines below"])
    heads = [HEADING.match(cell) for cell in rows[0]]
    names = [head[1] if head else cell for head, cell in zip(heads, rows[0], strict=True)]
    problems = [f"column {name!r}: expected one of {', '.join(KNOWN)}" for name in names if name not in KNOWN]
    problems += [f"column {name}: missing" for name in NEEDED if name not in names]
    if "x" not in names and not {"easting", "northing"} <= set(names):
        problems.append("column x: missing; expected it, or easting and northing")
    if problems:
        raise InputError(str(path), problems)
    units = {name: (head[2] or "") for name, head in zip(names, heads, strict=True) if head}
    by_boring: dict[str, list[tuple[int, dict[str, str]]]] = {}
    for number, row in enumerate(rows[1:], start=2):
        cells = {name: cell.strip() for name, cell in zip(names, row, strict=False)}
        by_boring.setdefault(cells.get("boring", ""), []).append((number, cells))
    logs = [_log(name, lines, units, problems) for name, lines in by_boring.items()]
    if problems:
        raise InputError(str(path), problems)
    return [log for log in logs if log is not None]


def _log(
    name: str, lines: list[tuple[int, dict[str, str]]], units: Mapping[str, str], problems: list[str]
) -> Log | None:
    before = len(problems)

    def length(number: int, cells: Mapping[str, str], key: str) -> float:
        try:
            return float(COORDINATE.read(_with_unit(cells.get(key, ""), units.get(key, ""))))
        except ValueError as error:
            problems.append(f"line {number}, {key} = {cells.get(key, '')!r}: {error}")
            return math.nan

    layers, samples = [], []
    for number, cells in lines:
        top, bottom = length(number, cells, "top"), length(number, cells, "bottom")
        if not cells.get("layer"):
            problems.append(f"line {number}, layer: missing; expected the name of the stratum")
        weight = _written(cells.get("unit_weight", ""), units.get("unit_weight", ""))
        try:
            if weight:
                DENSITY.read(weight)
        except ValueError as error:
            problems.append(f"line {number}, unit_weight = {weight!r}: {error}")
        layers.append(LogLayer(cells.get("layer", ""), top, bottom, weight))
        if cells.get("N"):
            sample = _sample(number, cells, 0.5 * (top + bottom), units, problems)
            samples += [sample] if sample is not None else []
    number, first = lines[0]
    if not name:
        problems.append(f"line {number}, boring: missing; expected the name of the boring")
    if first.get("x"):
        place = (length(number, first, "x"), math.nan)
    else:
        place = (length(number, first, "easting"), length(number, first, "northing"))
    ground = length(number, first, "ground_level")
    water = length(number, first, "water_level") if first.get("water_level") else None
    if len(problems) == before:
        problems += layer_problems(name, layers)
    if len(problems) > before:
        return None
    return Log(name, place, ground, tuple(layers), tuple(samples), water)


def _sample(
    number: int, cells: Mapping[str, str], depth: float, units: Mapping[str, str], problems: list[str]
) -> Sample | None:
    data: dict[str, object] = {"depth": depth, "N": cells["N"]}
    if cells.get("fines"):
        data["fines"] = cells["fines"].removesuffix("%")
    if cells.get("d50"):
        data["d50"] = _with_unit(cells["d50"], units.get("d50", ""))
    try:
        return Sample.model_validate(data)
    except ValidationError as error:
        problems += [f"line {number}, {one['loc'][0]} = {one['input']!r}: {one['msg']}" for one in error.errors()]
        return None


def _written(value: str, unit: str) -> str:
    """A value with the unit of its heading, if it has none of its own; m3 is m^3."""
    text = f"{value} {unit}" if unit and re.fullmatch(r"[-+.\deE]+", value) else value
    return re.sub(r"(?<=[a-z])([23])\b", r"^\1", text).replace("m²", "m^2").replace("m³", "m^3")


def _with_unit(value: str, unit: str) -> str | float:
    """The same as a person would write it in a section: a plain number is a number."""
    text = _written(value, unit)
    try:
        return float(text)
    except ValueError:
        return text
