"""Cone penetration tests of an AGS4 file: SCPT, the readings, and SCPG, what stands for all of a test."""

import re

from pydantic import ValidationError

from meshes.borings.ags4_groups import Groups, Row
from meshes.borings.boring import Cone
from meshes.section.sentences import sentences

NO_READING = re.compile(r"-9{3,}(\.\d*)?")  # what loggers write for a reading that is missing


def cones_of(name: str, groups: Groups) -> tuple[Cone, ...]:
    """The readings of all tests at a boring, from the top down; of two at one depth the first counts.

    The resistance is SCPT_QT; where that was not reported it is SCPT_RES + (1 - a) SCPT_PWP2 with the area ratio a of
    the cone, SCPG_CAR, or SCPT_RES alone, which in sand is nearly the same. Sleeve friction below zero, noise, is zero.
    Readings without a resistance or a sleeve friction, or with -999 for it, are left out, as files have them where a
    push begins.
    """
    ratios = {location.get("SCPG_TESN", ""): location.get("SCPG_CAR", "") for location in groups.of("SCPG", name)}
    cones: dict[float, Cone] = {}
    for row in groups.of("SCPT", name):
        if not (row.get("SCPT_RES") or row.get("SCPT_QT")) or not row.get("SCPT_FRES"):
            continue
        if any(NO_READING.fullmatch(row.get(key, "")) for key in ("SCPT_QT", "SCPT_RES", "SCPT_FRES")):
            continue
        depth = row.get("SCPT_DPTH", "")
        if not depth:
            groups.problems.append(f"boring {name}: a cone resistance without a depth, SCPT_DPTH")
            continue
        try:
            cone = _cone(row, groups, ratios.get(row.get("SCPG_TESN", ""), ""))
        except ValueError as error:
            groups.problems.append(f"boring {name}, SCPT at {depth} {groups.units['SCPT_DPTH']}, {error}")
            continue
        if cone is not None:
            cones.setdefault(float(cone.depth), cone)
    return tuple(cones[depth] for depth in sorted(cones))


def _cone(row: Row, groups: Groups, ratio: str) -> Cone | None:
    """One reading; None at the ground itself, or where the cone met nothing. Raises ValueError that names the key."""
    if row.get("SCPT_QT"):
        resistance = _value(row, "SCPT_QT", groups)
    else:
        resistance = _value(row, "SCPT_RES", groups)
        if ratio and row.get("SCPT_PWP2"):
            resistance += (1.0 - float(ratio)) * _value(row, "SCPT_PWP2", groups)
    depth = _value(row, "SCPT_DPTH", groups)
    if resistance <= 0.0 or depth == 0.0:
        return None
    data = {"depth": depth, "qc": resistance, "fs": max(0.0, _value(row, "SCPT_FRES", groups))}
    try:
        return Cone.model_validate(data)
    except ValidationError as error:
        raise ValueError("; ".join(sentences(error, data, Cone))) from None


def _value(row: Row, key: str, groups: Groups) -> float:
    try:
        return groups.read(row, key)
    except ValueError as error:
        raise ValueError(f"{key} = {row[key]!r}: {error}") from None
