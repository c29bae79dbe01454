"""Reads borings from a CSV file: a line for each layer of each boring, with units in the values or in the heading."""

import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from pydantic import ValidationError

from meshes.borings.boring import Sample
from meshes.borings.complaints import folded, unread_counts
from meshes.borings.cone_file import KNOWN as CONE_COLUMNS
from meshes.borings.cone_file import read_cones
from meshes.borings.log import (
    DEPTHS_EXPECTED,
    BoringFile,
    Log,
    LogLayer,
    depth_problems,
    layer_problems,
    merged_layers,
    refusal_notices,
)
from meshes.borings.plausible import implausible_sample, shares_for_percent
from meshes.borings.table import (
    NOT_MEASURED,
    PLACE,
    BoringTable,
    has_column,
    named_columns,
    read_table,
    with_unit,
    written,
)
from meshes.errors import InputError
from meshes.section.quantity import DENSITY
from meshes.section.sentences import sentences

NEEDED = ("boring", "ground_level", "top", "bottom", "layer")
WATER = ("water_level", "water_depth")
KNOWN = (*NEEDED, *PLACE, "N", "fines", "d50", "plasticity", "unit_weight", *WATER, "energy_ratio")
OF_A_BORING = (*PLACE, "ground_level", *WATER)


def columns_of_csv(path: Path, columns: Mapping[str, str]) -> dict[str, str]:
    """Return those of the named columns that a file has, of borings or of cones.

    Parameters
    ----------
    path : path of the file
    columns : names of columns by the expected names, of this file and of other files

    Returns
    -------
    Names of columns of this file by the expected names.
    """
    return named_columns(path, columns, CONE_COLUMNS if has_column(path, "qc", columns) else KNOWN)


def read_csv(path: Path, columns: Mapping[str, str] | None = None) -> BoringFile:
    """Read the borings of a file, in the order of the file.

    A layer may have several lines, one for each test; N is the blow count at the middle of its line. A file with a
    column qc contains cone penetration tests. A blow count that cannot be read is left out, with a notice.

    Parameters
    ----------
    path : path of the file. Its cells are separated by commas, or by semicolons or tabs; in the latter case numbers may
        have decimal commas
    columns : names of columns in the file by the expected names, where they differ, such as {"layer": "Stratum"}

    Returns
    -------
    The borings, and notices.

    Raises
    ------
    InputError
        If the file has problems, or if more than half of the blow counts cannot be read. The error contains all
        problems.
    """
    columns = columns or {}
    if has_column(path, "qc", columns):
        return read_cones(path, columns)
    table = read_table(path, NEEDED, KNOWN, columns)
    logs = [_log(name, lines, table) for name, lines in table.lines.items()]
    valid = [log for log in logs if log is not None]
    left_out, too_many = unread_counts(table.unread, sum(len(log.samples) for log in valid))
    if table.problems or too_many:
        raise InputError(str(path), folded([*table.problems, *(too_many or table.unread)]))
    shares = shares_for_percent([sample for log in valid for sample in log.samples])
    left_out = [f"{path.name}, {text}" for text in left_out]
    return BoringFile(valid, [*table.notices, *left_out, *shares, *refusal_notices(valid)])


def _unit_meant(weight: str) -> str:
    """Return advice on the unit of a unit weight that was given without one, from its size; empty if the size does not
    suggest a unit."""
    number = float(weight) if re.fullmatch(r"\d+(?:\.\d+)?", weight) else math.nan
    for unit, (least, most) in {"kN/m3": (10.0, 30.0), "t/m3": (1.0, 3.0)}.items():
        if least <= number < most:
            return f'; if it is in {unit}, call the column "unit_weight ({unit})"'
    return ""


def _log(name: str, lines: Sequence[tuple[int, Mapping[str, str]]], table: BoringTable) -> Log | None:
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
            table.problems.append(f"line {number}, unit_weight = {weight!r}: {error}{_unit_meant(weight)}")
        layers.append(LogLayer(cells.get("layer", ""), top, bottom, weight))
        middle = 0.5 * (top + bottom)
        if min(top, bottom) < 0.0:
            depths = f"top = {cells['top']}, bottom = {cells['bottom']}"
            table.problems.append(f"line {number}, {depths}: {DEPTHS_EXPECTED}")
        elif cells.get("N", "").lower() not in NOT_MEASURED and math.isfinite(middle):  # else it has been reported
            sample = _sample(number, cells, middle, table)
            samples += [sample] if sample is not None else []
    number, first = lines[0]
    place = table.location(number, first)
    ground = table.length(number, first, "ground_level")
    water = table.length(number, first, "water_level") if first.get("water_level") else None
    if water is None and first.get("water_depth", "").lower() not in NOT_MEASURED:
        water = ground - table.length(number, first, "water_depth")
    table.problems.extend(_contradictions(name, lines))
    layers.sort(key=lambda layer: layer.top)
    samples.sort(key=lambda sample: sample.depth)
    if len(table.problems) == before:
        table.problems.extend(layer_problems(name, layers))
    log = Log(name, place, ground, tuple(merged_layers(layers)), tuple(samples), water)
    if len(table.problems) == before:
        table.problems.extend(depth_problems(log))
    return log if len(table.problems) == before else None


def _contradictions(name: str, lines: Sequence[tuple[int, Mapping[str, str]]]) -> list[str]:
    """Return lines that give a boring another place, ground level or water level than the first line of the boring
    does."""
    number, first = lines[0]
    return [f"line {other}, {key} = {cells[key]!r}: line {number} gives {first[key]!r} for the same boring {name}"
            for other, cells in lines[1:] for key in OF_A_BORING
            if cells.get(key) and first.get(key) and not _same(cells[key], first[key])]  # fmt: skip


def _same(first: str, second: str) -> bool:
    try:
        return first == second or float(first) == float(second)
    except ValueError:
        return False


def _sample(number: int, cells: Mapping[str, str], depth: float, table: BoringTable) -> Sample | None:
    data: dict[str, object] = {"depth": depth, "N": cells["N"]}
    for key in ("fines", "plasticity", "energy_ratio"):
        if cells.get(key, "").lower() not in NOT_MEASURED:
            data[key] = cells[key].removesuffix("%").strip()
    if cells.get("d50", "").lower() not in NOT_MEASURED:
        data["d50"] = with_unit(cells["d50"], table.units.get("d50", ""))
    try:
        sample = Sample.model_validate(data)
    except ValidationError as error:
        of_count = all(entry["loc"][:1] == ("N",) for entry in error.errors())
        messages = table.unread if of_count else table.problems
        messages.extend(f"line {number}, {text}" for text in sentences(error, data, Sample))
        return None
    # A grain size with a unit is taken as written; [triggering] checks it again.
    checked = sample.model_copy(update={"d50": None}) if isinstance(data.get("d50"), str) else sample
    table.problems.extend(implausible_sample(f"line {number}, ", checked))
    return sample
