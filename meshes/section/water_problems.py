"""Finds problems of the water and the loads of a section whose geometry is sound, one sentence each."""

from collections.abc import Iterator, Sequence

import numpy as np

from meshes.section.consolidation import Consolidation
from meshes.section.cutting import key_in_file
from meshes.section.layering import Layering
from meshes.section.polyline import Line
from meshes.section.stratum import Stratum
from meshes.section.surcharge import Surcharge
from meshes.section.water import Cutoff, Water


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
