"""Finds faults of the lines of a section, also in the readable part of a section with other faults."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from pydantic import TypeAdapter, ValidationError

from meshes.section.cutting import named_strata
from meshes.section.layering import above_ground, layering
from meshes.section.naming import naming_problems
from meshes.section.plausibility import implausible_as_written
from meshes.section.polyline import Line, Polyline

# The narrowest section (m), and how much wider than high or higher than wide one may be: beyond that it is a slip of
# the pen, and neither a mesh nor a picture comes of it.
NARROWEST, LONGEST = 1e-3, 1000.0


def geometry_problems(
    surface: Any,
    base: Line,
    across: Mapping[str, Line | None],
    bottoms: Sequence[Line | None],
    names: Sequence[str] = (),
) -> list[str]:
    """Return one sentence for each fault of the surface, the base, lines ``across`` the section by their keys, and
    bottoms of strata.

    ``surface``: points [x, elevation] in m; ``bottoms``: a line for each stratum, None for the base;
    ``names``: the names of the strata, if all are known.
    """
    ground = np.array(surface, dtype=float)
    left, right = float(ground[0, 0]), float(ground[-1, 0])
    width = right - left
    if width < NARROWEST:
        return [f"surface: the section is {width:g} m wide; expected at least {NARROWEST:g} m"]
    problems = []
    lines = [(f"strata {k}, bottom", line) for k, line in enumerate(bottoms, start=1)]
    for key, line in [("base", base), *across.items(), *lines]:
        if line is None:
            continue
        points = line.points(left, right)
        outside = points[(points[:, 0] < left) | (points[:, 0] > right)]
        if len(outside):
            problems.append(
                f"{key}: the point at x = {outside[0, 0]:g} m lies outside the section, which reaches from "
                f"{left:g} to {right:g} m"
            )
        elif not key.startswith("strata") and (points[0, 0] > left or points[-1, 0] < right):
            problems.append(f"{key}: expected a line across the whole section, from x = {left:g} to {right:g} m")
    for k, bottom in enumerate(bottoms[:-1], start=1):
        if bottom is None:
            problems.append(f"strata {k}, bottom: missing; only the lowest stratum may leave it to the base")
    if problems:
        return problems
    layers, faults, _ = layering(ground, base, bottoms, names=named_strata(names))
    outline = layers.outline()
    height = float(np.ptp(outline[:, 1]))
    if not width / LONGEST <= height <= width * LONGEST:
        faults.append(
            f"the section is {width:g} m wide and {height:g} m high; expected one to be no more than {LONGEST:g} "
            "times the other"
        )
    if (drawn := across.get("water_table")) is not None:
        # Usually another datum; and water that is only drawn has no weight.
        faults += above_ground(ground, drawn, "the water table")
    return [f"geometry: {text}" for text in faults]


def problems_of_the_rest(data: Mapping[str, Any]) -> list[str]:
    """Return faults of names, soils and geometry in input that has other faults, as far as it can be read."""
    strata = data.get("strata")
    if not isinstance(strata, list) or not all(isinstance(stratum, dict) for stratum in strata) or not strata:
        return []
    names = [name for stratum in strata if isinstance(name := stratum.get("name"), str)]
    problems = list(naming_problems(names))
    if data.get("unusual") is not True:
        problems += implausible_as_written(strata)
    try:
        surface = TypeAdapter(Polyline).validate_python(data["surface"])
        base = Line.model_validate(data["base"])
        across = {"water_table": Line.model_validate(data["water_table"]) if "water_table" in data else None}
        bottoms = [Line.model_validate(stratum["bottom"]) if "bottom" in stratum else None for stratum in strata]
    except (KeyError, ValidationError):
        return problems
    known = names if len(names) == len(strata) else ()
    return problems + geometry_problems(surface, base, across, bottoms, known)
