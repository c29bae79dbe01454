"""Finds faults of the lines of a section, also in the readable part of a section with other faults, and problems of the
water and the loads of a section whose geometry is sound, one sentence each.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from pydantic import TypeAdapter, ValidationError

from meshes.section.consolidation import Consolidation
from meshes.section.cutting import key_in_file, named_strata
from meshes.section.layering import Layering, above_ground, layering
from meshes.section.naming import naming_problems
from meshes.section.plausibility import implausible_as_written
from meshes.section.polyline import Line, Polyline
from meshes.section.stratum import Stratum
from meshes.section.surcharge import Surcharge
from meshes.section.water import Cutoff, Water

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


def water_problems(
    water: Water | None, drawn: Line | None, strata: Sequence[Stratum], state: Consolidation | None
) -> Iterator[str]:
    """Return problems of the table [water] and of strata with water, one sentence each. ``drawn`` is a water table that
    is only drawn, ``state`` the table [consolidation]."""
    if state is not None and not any(s.strength_ratio for s in strata):
        yield "consolidation: no stratum has a strength_ratio; expected one, whose preconsolidation it determines"
    table = None if water is None else water.table
    if water is not None and drawn is not None:
        yield "water_table together with [water]: expected table in [water] alone; water_table is only drawn"
    lines: dict[str, Line | None] = {"water, table": table}
    lines["water, after_drawdown"] = None if water is None else water.after_drawdown
    lines |= {f"{key_in_file(strata, k)}, piezometric_level": s.piezometric_level for k, s in enumerate(strata)}
    flows_of = {key_in_file(strata, k): s.vertical_flow for k, s in enumerate(strata) if s.vertical_flow is not None}
    for name, flow in flows_of.items():
        lines |= {f"{name}, vertical_flow, {key}": getattr(flow, key) for key in ("upper_level", "lower_level")}
        if flow.upper_level is None:
            yield f"{name}, vertical_flow, upper_level: missing; expected it, or a water table in [water]"
    walls = {float(wall.x) for wall in water.cutoffs} if water is not None else set()
    for key, line in lines.items():
        if line is not None and (at := _step(line)) is not None and at not in walls:
            yield (
                f"{key}: a step at x = {at:g} m, where water would flow without end; expected a line without steps, "
                "and a piezometric_level where a stratum has a level of its own, or flow = true and a wall of "
                "[[water.cutoffs]] there"
            )
    flows = water is not None and water.flow
    for k, s in enumerate(strata):
        if flows and s.permeability is None:
            yield f'{key_in_file(strata, k)}, permeability: missing; expected one such as "1e-5 m/s" for flow'
        for key in ("piezometric_level", "vertical_flow"):
            if flows and getattr(s, key) is not None:
                yield f"{key_in_file(strata, k)}, {key}: expected none with flow = true, which computes it"
        ratio = s.pore_pressure_ratio
        pressed = table is not None if ratio is None else ratio > 0.0
        if s.buoyant and (pressed or s.confined):
            yield (
                f"{key_in_file(strata, k)}: density_ordinary below density_seismic is already reduced by "
                "uplift, and the pore pressure would reduce it again; expected density and density_saturated"
            )


def _step(line: Line) -> float | None:
    """Return x (m) of the first vertical step of a line."""
    x = line.points(0.0, 1.0)[:, 0]
    steps = np.flatnonzero(np.diff(x) == 0.0)
    return float(x[steps[0]]) if len(steps) else None


def cutoff_problems(walls: Sequence[Cutoff], layers: Layering) -> Iterator[str]:
    """Return problems of the cut-off walls, a sentence each."""
    for number, wall in enumerate(walls, start=1):
        x = np.array([wall.x])
        if not layers.x[0] < wall.x < layers.x[-1]:
            yield (
                f"water, cutoffs {number}: x = {wall.x:g} m is not between the sides of the section, "
                f"{layers.x[0]:g} and {layers.x[-1]:g} m"
            )
        elif wall.bottom >= (ground := float(layers.interfaces(x)[0, 0])):
            yield (
                f"water, cutoffs {number}: bottom = {wall.bottom:g} m is above the ground there, at {ground:g} m; "
                "expected the elevation of its foot, below the ground"
            )
        elif wall.bottom < (base := float(layers.interfaces(x)[0, -1])) - layers.tolerance:
            yield (
                f"water, cutoffs {number}: bottom = {wall.bottom:g} m is below the base there, at {base:g} m; expected "
                "the elevation of its foot, at least that of the base, where it closes the section"
            )


def surcharge_problems(surcharges: Sequence[Surcharge], left: float, right: float) -> Iterator[str]:
    """Return problems of surcharges on ground from ``left`` to ``right`` (m), a sentence each."""
    for number, load in enumerate(surcharges, start=1):
        if load.start < left or load.end > right:
            yield (
                f"surcharges {number}: from {load.start:g} to {load.end:g} m lies outside the section, which reaches "
                f"from {left:g} to {right:g} m"
            )
