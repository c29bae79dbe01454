"""Borings from an AGS4 file: its groups LOCA, GEOL, ISPT, SCPG and SCPT."""

import csv
import math
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from meshes.borings.ags4_cone import cones_of
from meshes.borings.boring import Sample
from meshes.borings.log import Log, LogLayer, cone_problems, joined, layer_problems
from meshes.errors import InputError


def read_ags4(path: Path) -> list[Log]:
    """The borings of a file that have layers or a cone, in its order. Raises InputError with all problems."""
    try:
        text = path.read_text(encoding="utf-8-sig", errors="replace")
    except OSError as error:
        raise InputError(str(path), [f"cannot be read: {error.strerror}"]) from None
    groups = groups_of(text)
    if not groups.get("LOCA"):
        raise InputError(str(path), ["group LOCA: missing; expected the borings"])
    if not groups.get("GEOL") and not groups.get("SCPT"):
        raise InputError(str(path), ["group GEOL: missing; expected the layers of the borings, or SCPT, their cones"])
    problems: list[str] = []
    found = [_log(row, groups, problems) for row in groups["LOCA"]]
    logs = [log for log in found if log is not None]
    if not logs and not problems:
        problems.append("no boring of LOCA has layers in GEOL, or a cone in SCPT")
    if problems:
        raise InputError(str(path), problems)
    return logs


def groups_of(text: str) -> dict[str, list[dict[str, str]]]:
    """The rows of data of every group, each by its headings (AGS4, rules 3-4: GROUP, HEADING, UNIT, TYPE, DATA).

    The units stand in a group of their own, "SCPT UNIT" of SCPT.
    """
    groups: dict[str, list[dict[str, str]]] = {}
    group = ""
    heads: list[str] = []
    for row in csv.reader(text.splitlines()):
        kind, cells = (row[0].strip(), [cell.strip() for cell in row[1:]]) if row else ("", [])
        if kind == "GROUP" and cells:
            group, heads = cells[0], []
            groups.setdefault(group, [])
        elif kind == "HEADING":
            heads = cells
        elif kind == "UNIT" and group:
            groups[f"{group} UNIT"] = [dict(zip(heads, cells, strict=False))]
        elif kind == "DATA" and group:
            groups[group].append(dict(zip(heads, cells, strict=False)))
    return groups


def _log(row: dict[str, str], groups: dict[str, list[dict[str, str]]], problems: list[str]) -> Log | None:
    name = row.get("LOCA_ID", "")
    mine = [one for one in groups.get("GEOL", []) if one.get("LOCA_ID") == name]
    before = len(problems)
    cones = cones_of(name, groups, problems)
    problems += cone_problems(name, cones)
    if not mine and not cones:
        return None
    place = (_number(row, "LOCA_NATE", name, problems), _number(row, "LOCA_NATN", name, problems))
    ground = _number(row, "LOCA_GL", name, problems) if mine else math.nan
    layers = []
    for one in mine:
        label = one.get("GEOL_GEOL") or one.get("GEOL_LEG") or ""
        if not label:
            problems.append(f"boring {name}: the layer at {one.get('GEOL_TOP', '?')} m has no GEOL_GEOL, no name")
        top, bottom = _number(one, "GEOL_TOP", name, problems), _number(one, "GEOL_BASE", name, problems)
        layers.append(LogLayer(label, top, bottom, "", one.get("GEOL_DESC", "")))
    layers = joined(sorted(layers, key=lambda layer: layer.top))
    samples = _samples(name, groups.get("ISPT", []), problems)
    if len(problems) == before and mine:
        problems += layer_problems(name, layers)
    if len(problems) > before:
        return None
    return Log(name, place, ground, tuple(layers), samples, cones=cones)


def _samples(name: str, rows: list[dict[str, str]], problems: list[str]) -> tuple[Sample, ...]:
    """The blow counts of a boring, at the middle of the 30 cm below the seating of 15 cm."""
    found: dict[float, Sample] = {}
    for one in rows:
        if one.get("LOCA_ID") != name or not one.get("ISPT_NVAL"):
            continue
        if not one.get("ISPT_TOP"):
            problems.append(f"boring {name}: a blow count N = {one['ISPT_NVAL']} without a depth, ISPT_TOP")
            continue
        depth = _number(one, "ISPT_TOP", name, problems) + 0.30
        data: dict[str, Any] = {"depth": depth, "N": one["ISPT_NVAL"]}
        try:
            found[depth] = Sample.model_validate(data)
        except ValidationError as error:
            problems.append(f"boring {name}, ISPT_NVAL = {one['ISPT_NVAL']!r}: {error.errors()[0]['msg']}")
    return tuple(found[depth] for depth in sorted(found))


def _number(row: dict[str, str], key: str, name: str, problems: list[str]) -> float:
    try:
        return float(row.get(key, ""))
    except ValueError:
        problems.append(f"boring {name}, {key} = {row.get(key, '')!r}: expected a number")
        return math.nan
