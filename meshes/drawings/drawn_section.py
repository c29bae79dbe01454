"""The section that outlines and lines of a drawing make, as TOML for a person to complete."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from meshes.drawings.shapes import Shape, Shapes
from meshes.drawings.water_line import is_water, water_table
from meshes.errors import InputError
from meshes.section.columns import SNAP, columns_of
from meshes.section.simplified import needed

SOIL = ("density", "youngs_modulus", "poissons_ratio", "cohesion", "friction_angle")


class Drawn(NamedTuple):
    """A section as TOML, and what a person has to know of how the drawing was read, one sentence each."""

    text: str
    notices: list[str]


def drawn_section(shapes: Shapes, path: Path, name: str) -> Drawn:
    """The section of a drawing, its soils still to be given.

    Outlines are strata, of the names of their layers. Without outlines the highest line is the ground, and each other
    one the bottom of the stratum of its layer. Raises InputError with all problems.
    """
    others = [line for line in shapes.lines if not is_water(line)]
    if not shapes.outlines:
        return _of_lines(others, shapes, path, name)
    columns = columns_of(
        [outline.layer for outline in shapes.outlines], [outline.points for outline in shapes.outlines]
    )
    if columns.problems:
        raise InputError(str(path), columns.problems)
    ground, bottoms = columns.interfaces()
    table, remarks = water_table(shapes.lines, float(columns.x[0]), float(columns.x[-1]))
    unused = [f'not used: a {line.kind} on layer "{line.layer}", {line.span}: it closes no outline, and is no water '
              "table" for line in others]  # fmt: skip
    notices = [*shapes.notices, *columns.stack.notices, *columns.tally.sentences(), *remarks, *unused]
    strata = [(stratum, columns.points(bottom))
              for stratum, bottom in zip(columns.stack.names, bottoms, strict=True)]  # fmt: skip
    base = strata[-1][1]
    return Drawn(_text(name, notices, columns.points(ground), base, table, strata), notices)


def _of_lines(lines: Sequence[Shape], shapes: Shapes, path: Path, name: str) -> Drawn:
    if len(lines) < 2:
        expected = (
            "expected one for each stratum, on a layer of its name, or a line for the ground and one for each bottom"
        )
        raise InputError(str(path), [f"holds no closed polylines; {expected}", *shapes.notices])
    ordered = [(line.layer, line.points if line.points[0, 0] <= line.points[-1, 0] else line.points[::-1])
               for line in sorted(lines, key=lambda line: -float(_mean(line.points)))]  # fmt: skip
    (top, ground), *strata = ordered
    left, right = float(ground[0, 0]), float(ground[-1, 0])
    table, remarks = water_table(shapes.lines, left, right)
    notices = [
        *shapes.notices,
        f'the drawing has no outlines: the highest line, on layer "{top}", is the ground, and each other one the '
        "bottom of the stratum of its layer",
        *remarks,
    ]
    below = [(layer, _thinned(points)) for layer, points in strata]
    return Drawn(_text(name, notices, _thinned(ground), below[-1][1], table, below), notices)


def _mean(points: np.ndarray) -> float:
    """Mean elevation (m) of a line."""
    width = np.abs(np.diff(points[:, 0]))
    return float((0.5 * (points[1:, 1] + points[:-1, 1]) * width).sum() / max(float(width.sum()), 1e-12))


def _text(
    name: str,
    notices: Sequence[str],
    ground: np.ndarray,
    base: np.ndarray,
    table: np.ndarray | None,
    strata: Sequence[tuple[str, np.ndarray]],
) -> str:
    lines = ["# Section from a drawing: the soils have to be added.", *(f"# {text}." for text in notices), ""]
    lines += [f"name = {json.dumps(name)}", f"surface = {_written(ground)}"]
    lines += [f"base = {{ elevation = {_written(base)} }}", ""]
    if table is not None:
        lines += ["[water]", f"table = {_written(_thinned(table))}", ""]
    for k, (stratum, bottom) in enumerate(strata):
        lines += ["[[strata]]", f"name = {json.dumps(stratum, ensure_ascii=False)}"]
        if k + 1 < len(strata):
            lines.append(f"bottom = {{ elevation = {_written(bottom)} }}")
        lines += [f"# {key} =" for key in SOIL] + [""]
    return "\n".join(lines)


def _thinned(points: np.ndarray) -> np.ndarray:
    return points[needed(points, SNAP)]


def _written(points: np.ndarray) -> str:
    return "[" + ", ".join(f"[{x:.10g}, {z:.10g}]" for x, z in points) + "]"
