"""Cone penetration tests of an AGS4 file: SCPT, the readings, and SCPG, what stands for all of a test."""

from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from meshes.borings.boring import Cone
from meshes.borings.table import with_unit
from meshes.section.quantity import STRENGTH

# What a file without a row of units means: those of the AGS4 data dictionary.
UNITS = {"SCPT_DPTH": "m", "SCPT_RES": "MPa", "SCPT_QT": "MPa", "SCPT_FRES": "kPa", "SCPT_PWP2": "kPa"}
Rows = Sequence[Mapping[str, str]]


def cones_of(name: str, groups: Mapping[str, Rows], problems: list[str]) -> tuple[Cone, ...]:
    """The readings of all tests at a boring, from the top down; of two at one depth the first counts.

    The resistance is SCPT_QT; where that was not reported it is SCPT_RES + (1 - a) SCPT_PWP2 with the area ratio a of
    the cone, SCPG_CAR, or SCPT_RES alone, which in sand is nearly the same. Sleeve friction below zero, noise, is zero.
    Readings without a resistance or a sleeve friction are left out, as files have them where a push begins.
    """
    units = dict(UNITS) | {key: unit for row in groups.get("SCPT UNIT", []) for key, unit in row.items() if unit}
    ratios = {one.get("SCPG_TESN", ""): one.get("SCPG_CAR", "") for one in groups.get("SCPG", [])
              if one.get("LOCA_ID") == name}  # fmt: skip
    found: dict[float, Cone] = {}
    for row in groups.get("SCPT", []):
        if row.get("LOCA_ID") != name or not (row.get("SCPT_RES") or row.get("SCPT_QT")) or not row.get("SCPT_FRES"):
            continue
        depth = row.get("SCPT_DPTH", "")
        if not depth:
            problems.append(f"boring {name}: a cone resistance without a depth, SCPT_DPTH")
            continue
        try:
            cone = _cone(row, units, ratios.get(row.get("SCPG_TESN", ""), ""))
        except ValidationError as error:
            told = [f"{one['loc'][0]} = {one['input']!r}: {one['msg']}" for one in error.errors()]
            problems += [f"boring {name}, SCPT at {depth} m, {text}" for text in told]
            continue
        except ValueError as error:
            problems.append(f"boring {name}, SCPT at {depth} m: {error}")
            continue
        if cone is not None:
            found.setdefault(float(cone.depth), cone)
    return tuple(found[depth] for depth in sorted(found))


def _cone(row: Mapping[str, str], units: Mapping[str, str], ratio: str) -> Cone | None:
    """One reading; None at the ground itself, or where the cone met nothing."""
    if row.get("SCPT_QT"):
        resistance = _stress(row, "SCPT_QT", units)
    else:
        resistance = _stress(row, "SCPT_RES", units)
        if ratio and row.get("SCPT_PWP2"):
            resistance += (1.0 - float(ratio)) * _stress(row, "SCPT_PWP2", units)
    if resistance <= 0.0 or row["SCPT_DPTH"].strip("0.") == "":
        return None
    data: dict[str, Any] = {
        "depth": with_unit(row["SCPT_DPTH"], units["SCPT_DPTH"]),
        "qc": resistance,
        "fs": max(0.0, _stress(row, "SCPT_FRES", units)),
    }
    return Cone.model_validate(data)


def _stress(row: Mapping[str, str], key: str, units: Mapping[str, str]) -> float:
    """A stress (Pa), which may be below zero."""
    text = row[key]
    try:
        size = float(STRENGTH.read(with_unit(text.removeprefix("-"), units[key])))
    except ValueError as error:
        raise ValueError(f"{key} = {text!r}: {error}") from None
    return -size if text.startswith("-") else size
