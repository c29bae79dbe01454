"""Borings from a CSV file: a line for each layer of each boring, with units in the values or in the heading."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from pydantic import ValidationError

from meshes.borings.boring import Sample
from meshes.borings.cone_file import read_cones
from meshes.borings.log import Log, LogLayer, joined, layer_problems
from meshes.borings.table import PLACE, Table, columns_of, read_table, with_unit, written
from meshes.errors import InputError
from meshes.section.quantity import DENSITY

NEEDED = ("boring", "ground_level", "top", "bottom", "layer")
KNOWN = (*NEEDED, *PLACE, "N", "fines", "d50", "plasticity", "unit_weight", "water_level")


def read_csv(path: Path) -> list[Log]:
    """The borings of a file, in its order. Raises InputError with all problems.

    A layer may have several lines, one for each of its tests; N stands in the middle of its line.

    A file with a column qc holds cone penetration tests.
    """
    if "qc" in columns_of(path):
        return read_cones(path)
    table = read_table(path, NEEDED, KNOWN)
    logs = [_log(name, lines, table) for name, lines in table.lines.items()]
    if table.problems:
        raise InputError(str(path), table.problems)
    return [log for log in logs if log is not None]


def _log(name: str, lines: Sequence[tuple[int, Mapping[str, str]]], table: Table) -> Log | None:
    before = len(table.problems)
    layers, samples = [], []
    for number, cells in lines:
        top, bottom = table.length(number, cells, "top"), table.length(number, cells, "bottom")
        if not cells.get("layer"):
            table.problems.append(f"line {number}, layer: missing; expected the name of the stratum")
        weight = written(cells.get("unit_weight", ""), table.units.get("unit_weight", ""))
        try:
            if weight:
                DENSITY.read(weight)
        except ValueError as error:
            table.problems.append(f"line {number}, unit_weight = {weight!r}: {error}")
        layers.append(LogLayer(cells.get("layer", ""), top, bottom, weight))
        middle = 0.5 * (top + bottom)
        if cells.get("N") and math.isfinite(middle):  # else it has been told
            sample = _sample(number, cells, middle, table)
            samples += [sample] if sample is not None else []
    number, first = lines[0]
    place = table.place(number, first)
    ground = table.length(number, first, "ground_level")
    water = table.length(number, first, "water_level") if first.get("water_level") else None
    if len(table.problems) == before:
        table.problems.extend(layer_problems(name, layers))
    if len(table.problems) > before:
        return None
    return Log(name, place, ground, tuple(joined(layers)), tuple(samples), water)


def _sample(number: int, cells: Mapping[str, str], depth: float, table: Table) -> Sample | None:
    data: dict[str, object] = {"depth": depth, "N": cells["N"]}
    for key in ("fines", "plasticity"):
        if cells.get(key):
            data[key] = cells[key].removesuffix("%")
    if cells.get("d50"):
        data["d50"] = with_unit(cells["d50"], table.units.get("d50", ""))
    try:
        return Sample.model_validate(data)
    except ValidationError as error:
        table.problems.extend(
            [f"line {number}, {one['loc'][0]} = {one['input']!r}: {one['msg']}" for one in error.errors()]
        )
        return None
