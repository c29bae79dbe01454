"""Reads cone penetration tests from a CSV file: a line for each depth, with units in the values or in the heading."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from pydantic import ValidationError

from meshes.borings.boring import Cone
from meshes.borings.complaints import folded
from meshes.borings.log import BoringFile, Log, cone_problems
from meshes.borings.plausible import implausible_cones
from meshes.borings.table import PLACE, BoringTable, read_table, with_unit
from meshes.errors import InputError
from meshes.section.sentences import sentences

NEEDED = ("boring", "depth", "qc", "fs")
KNOWN = (*NEEDED, *PLACE, "fines")


def read_cones(path: Path, columns: Mapping[str, str]) -> BoringFile:
    """Read the soundings of a file, in the order of the file, without layers.

    Parameters
    ----------
    path : path of the file
    columns : names of columns in the file by the expected names, where they differ

    Raises
    ------
    InputError : if the file cannot be read; the error contains all problems
    """
    table = read_table(path, NEEDED, KNOWN, columns)
    logs = [_log(name, lines, table) for name, lines in table.lines.items()]
    if table.problems:
        raise InputError(str(path), folded(table.problems))
    return BoringFile(logs, table.notices)


def _log(name: str, lines: Sequence[tuple[int, Mapping[str, str]]], table: BoringTable) -> Log:
    place = table.location(*lines[0])
    cones = [cone for number, cells in lines for cone in _cone(number, cells, table)]
    table.problems.extend(cone_problems(name, cones))
    table.problems.extend(implausible_cones(f"sounding {name}, ", cones))
    return Log(name, place, math.nan, (), cones=tuple(cones))


def _cone(number: int, cells: Mapping[str, str], table: BoringTable) -> list[Cone]:
    data = {
        key: with_unit(cells.get(key, ""), table.units.get(key, "")) for key in ("depth", "qc", "fs") if cells.get(key)
    }
    if cells.get("fines"):
        data["fines"] = cells["fines"].removesuffix("%").strip()
    try:
        return [Cone.model_validate(data)]
    except ValidationError as error:
        table.problems.extend(f"line {number}, {text}" for text in sentences(error, data, Cone))
        return []
