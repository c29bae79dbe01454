"""Makes the section from the outlines and lines of a drawing, as TOML for the user to complete."""

import json
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from meshes.drawings.shapes import Shape, Shapes
from meshes.drawings.water_line import is_pond, is_water, upper_edge, water_table
from meshes.errors import InputError
from meshes.section.columns import JOINED, SNAP, columns_of
from meshes.section.numbering import numbered_names
from meshes.section.simplified import needed

# Outlines that end within this share of the width of a side were drawn to it.
SIDE = 0.002
MOST_ALIKE = 3  # lines of one layer that are reported one by one
TOP = re.compile(r"(?<![^\W_])top(?![^\W_])", re.IGNORECASE)  # a word of the name of a layer
SOIL = ("density", "youngs_modulus", "poissons_ratio", "cohesion", "friction_angle")


class DrawnSection(NamedTuple):
    """Holds a section as TOML, and notices on how the drawing was read, one sentence each."""

    text: str
    notices: list[str]


def missing_soil(_: str) -> list[str]:
    """Return the keys of a soil, without values."""
    return [f"# {key} =" for key in SOIL]


def drawn_section(
    shapes: Shapes, path: Path, name: str, soil: Callable[[str], list[str]] = missing_soil
) -> DrawnSection:
    """Return the section of ``shapes`` drawn in ``path``, called ``name``, with the lines of ``soil`` for each stratum.

    Outlines are strata with the names of their drawing layers. Without outlines, or if lines continue beyond them, the
    highest line is the ground surface, every other line is the bottom of the stratum named by its drawing layer, and
    outlines are zones. Raises InputError with all problems.
    """
    outlines, pond_levels, notices = _without_water(shapes)
    lines_of_water = [*filter(is_water, shapes.lines), *pond_levels]
    lines = [line for line in shapes.lines if not is_water(line)]
    if not outlines or _go_past(lines, outlines):
        return _of_lines(lines, outlines, lines_of_water, [*shapes.notices, *notices], path, name, soil)
    points, trimmed = _with_one_side([outline.points for outline in outlines])
    columns = columns_of([outline.layer for outline in outlines], points)
    if columns.problems:
        raise InputError(str(path), columns.problems)
    ground, bottoms = columns.interfaces()
    table, remarks = water_table(lines_of_water, float(columns.x[0]), float(columns.x[-1]))
    notices = [*shapes.notices, *notices, *trimmed, *_questions(outlines), *columns.stack.notices,
               *columns.tally.sentences(), *remarks, *_unused(lines)]  # fmt: skip
    strata = [(stratum, columns.points(bottom))
              for stratum, bottom in zip(columns.stack.names, bottoms, strict=True)]  # fmt: skip
    base = strata[-1][1]
    return DrawnSection(_text(name, notices, columns.points(ground), base, table, strata, soil), notices)


def _without_water(shapes: Shapes) -> tuple[list[Shape], list[Shape], list[str]]:
    """Return the outlines that are ground, the upper edges of the outlines that are free water, and a sentence for each
    of the latter."""
    ponds = [outline for outline in shapes.outlines if is_pond(outline) and outline.layer not in shapes.strata]
    notices = [f'the outline on layer "{pond.layer}", {pond.span}, is water: its upper edge is a water table'
               for pond in ponds]  # fmt: skip
    ground = [outline for outline in shapes.outlines if not any(outline is pond for pond in ponds)]
    return ground, [upper_edge(pond) for pond in ponds], notices


def _go_past(lines: Sequence[Shape], outlines: Sequence[Shape]) -> bool:
    """Return whether at least two lines are wider than all outlines together. Such lines are the ground and bottoms of
    strata, and the outlines are lenses between them."""
    x = np.concatenate([outline.points[:, 0] for outline in outlines])
    beyond = [line for line in lines if line.points[:, 0].min() < x.min() - JOINED
              and line.points[:, 0].max() > x.max() + JOINED]  # fmt: skip
    return len(beyond) > 1


def _with_one_side(outlines: Sequence[np.ndarray]) -> tuple[list[np.ndarray], list[str]]:
    """Return outlines (n, 2) that end at one x at each side, and a sentence if some had to be cut. The section ends
    where the first outline that reaches the side ends.

    Corners within a centimetre of a side are moved to the side. Otherwise the ground would have a slit at the side, as
    deep as the outline that ends short of it.
    """
    ends = np.array([[points[:, 0].min(), points[:, 0].max()] for points in outlines])
    near = SIDE * float(np.ptp(ends))
    notices, sides = [], []
    for side, sign in ((0, 1.0), (1, -1.0)):
        outmost = float((sign * ends[:, side]).min())
        reach = (sign * ends[:, side] <= outmost + near) & (sign * ends[:, 1 - side] > outmost + 2.0 * near)
        sides.append(sign * float((sign * ends[reach, side]).max(initial=outmost)))
        if abs(sides[-1] - sign * outmost) > JOINED:
            notices.append(f"outlines end at different x at one side, {sign * outmost:.6g} and {sides[-1]:.6g} m: the "
                           "section ends with the narrower one")  # fmt: skip
    clipped = []
    for points in outlines:
        x = points[:, 0].copy()
        for end, is_near in ((sides[0], x < sides[0] + JOINED), (sides[1], x > sides[1] - JOINED)):
            x[is_near] = end
        clipped.append(np.column_stack([x, points[:, 1]]))
    return clipped, notices


def _questions(outlines: Sequence[Shape]) -> list[str]:
    """Return warnings of doubtful outlines: all outlines are on one layer, or one outline surrounds all others, like
    the frame of a sheet."""
    layers = {outline.layer for outline in outlines}
    questions = []
    if len(layers) == 1 < len(outlines):
        questions.append(f'all {len(outlines)} outlines are on layer "{outlines[0].layer}", and become one stratum')
    for outline in outlines:
        low, high = outline.points.min(axis=0), outline.points.max(axis=0)
        others = [other.points for other in outlines if other.layer != outline.layer]
        if others and all((points > low + JOINED).all() and (points < high - JOINED).all() for points in others):
            questions.append(f'the outline on layer "{outline.layer}" surrounds all others: if it is '
                          "the frame of the sheet, turn its layer off in the drawing")  # fmt: skip
    return questions


def _unused(lines: Sequence[Shape]) -> list[str]:
    """Return a sentence for each line that is neither ground nor water. Many such lines of one layer are reported in
    one sentence."""
    sentences = []
    for layer in dict.fromkeys(line.layer for line in lines):
        of_layer = [line for line in lines if line.layer == layer]
        if len(of_layer) > MOST_ALIKE:
            sentences.append(f'not used: {len(of_layer)} lines on layer "{layer}": these lines are neither '
                             "closed nor a water table")  # fmt: skip
        else:
            sentences += [f'not used: a {line.kind} on layer "{layer}", {line.span}: this line is neither '
                          "closed nor a water table" for line in of_layer]  # fmt: skip
    return sentences


def _of_lines(
    lines: Sequence[Shape],
    outlines: Sequence[Shape],
    lines_of_water: Sequence[Shape],
    notices: list[str],
    path: Path,
    name: str,
    soil: Callable[[str], list[str]],
) -> DrawnSection:
    if len(lines) < 2:
        expected = (
            "expected one for each stratum, on a layer of its name, or a line for the ground and one for each bottom"
        )
        raise InputError(str(path), [f"holds no closed polylines; {expected}", *notices])
    (top, ground), *below = _from_the_ground_down(lines, notices := list(notices))
    table, remarks = water_table(lines_of_water, float(ground[0, 0]), float(ground[-1, 0]))
    has = (
        "the drawing has no outlines"
        if not outlines
        else "lines of the drawing continue beyond its outlines, which are zones"
    )
    notices = [
        *notices,
        f'{has}: the highest line, on layer "{top}", is the ground surface, and each other line is the bottom of '
        "the stratum named by its drawing layer",
        *(
            f'the name of layer "{layer}" contains the word top, and its line is read as a bottom: if the line is '
            "the top of this soil, name its layer after the soil above"
            for layer in dict.fromkeys(layer for layer, _ in below if TOP.search(layer))
        ),
        *remarks,
    ]
    layers = [*(layer for layer, _ in below), *(outline.layer for outline in outlines)]
    names = numbered_names(layers)
    for layer in dict.fromkeys(layer for layer in layers if layers.count(layer) > 1):
        several = [f'"{new}"' for old, new in zip(layers, names, strict=True) if old == layer]
        notices.append(
            f'layer "{layer}" has several lines or outlines, which become the strata {" and ".join(several)}'
        )
    strata = [(stratum, _thinned_points(points)) for stratum, (_, points) in zip(names, below, strict=False)]
    zones = [(zone, outline.points) for zone, outline in zip(names[len(below) :], outlines, strict=True)]
    text = _text(name, notices, _thinned_points(ground), strata[-1][1], table, strata, soil, zones)
    return DrawnSection(text, notices)


def _from_the_ground_down(lines: Sequence[Shape], notices: list[str]) -> list[tuple[str, np.ndarray]]:
    """Return layers and points of lines from left to right, the highest line (the ground) first, then the lines below
    it.

    Lines that continue beyond the ground are cut off at its ends. Lines that end inside continue level, and a notice
    says so.
    """
    rising = [(line.layer, line.points if line.points[0, 0] <= line.points[-1, 0] else line.points[::-1])
              for line in lines]  # fmt: skip
    depth = [sum(_is_above(other, points) for _, other in rising) for _, points in rising]
    order = sorted(range(len(rising)), key=lambda k: (depth[k], -np.ptp(rising[k][1][:, 0])))
    (top, ground), *below = [rising[k] for k in order]
    left, right = float(ground[0, 0]), float(ground[-1, 0])
    result = [(top, ground)]
    for layer, points in below:
        first, last = max(left, points[0, 0]), min(right, points[-1, 0])
        if first >= last:
            notices.append(
                f'not used: the line on layer "{layer}", which lies outside the x of the ground surface on '
                f'layer "{top}"'
            )
            continue
        ends = np.array([(x, np.interp(x, *points.T)) for x in (left, right)])
        loose = [f"x = {x:.6g} m" for x in (first, last) if left + JOINED < x < right - JOINED
                 and abs(np.interp(x, *points.T) - np.interp(x, *ground.T)) > JOINED]  # fmt: skip
        if loose:
            notices.append(f'the line on layer "{layer}" ends inside the ground at {" and ".join(loose)}, and '
                           "continues level")  # fmt: skip
        inside = (points[:, 0] > left) & (points[:, 0] < right)
        result.append((layer, np.vstack([ends[:1], points[inside], ends[1:]])))
    return result


def _is_above(line: np.ndarray, other: np.ndarray) -> bool:
    """Return whether a line is on average higher than another, over the x that both have, or each over its own x if
    they have none in common."""
    start, end = max(line[0, 0], other[0, 0]), min(line[-1, 0], other[-1, 0])
    spans = [(start, end)] * 2 if end > start else [(points[0, 0], points[-1, 0]) for points in (line, other)]
    first, second = (np.interp(np.linspace(*span, 201), *points.T).mean()
                     for points, span in zip((line, other), spans, strict=True))  # fmt: skip
    return bool(first > second)


def _text(
    name: str,
    notices: Sequence[str],
    ground: np.ndarray,
    base: np.ndarray,
    table: np.ndarray | None,
    strata: Sequence[tuple[str, np.ndarray]],
    soil: Callable[[str], list[str]],
    zones: Sequence[tuple[str, np.ndarray]] = (),
) -> str:
    lines = ["# Section from a drawing: complete its soils.", *(f"# {text}." for text in notices), ""]
    lines += [f"name = {json.dumps(name)}", f"surface = {_written_points(ground)}"]
    lines += [f"base = {{ elevation = {_written_points(base)} }}", ""]
    if table is not None:
        lines += ["[water]", f"table = {_written_points(_thinned_points(table))}", ""]
    for k, (stratum, bottom) in enumerate(strata):
        lines += ["[[strata]]", f"name = {json.dumps(stratum, ensure_ascii=False)}"]
        if k + 1 < len(strata):
            lines.append(f"bottom = {{ elevation = {_written_points(bottom)} }}")
        lines += [*soil(stratum), ""]
    for zone, points in zones:
        lines += ["[[zones]]", f"name = {json.dumps(zone, ensure_ascii=False)}", f"points = {_written_points(points)}"]
        lines += [*soil(zone), ""]
    return "\n".join(lines)


def _thinned_points(points: np.ndarray) -> np.ndarray:
    return points[needed(points, SNAP)]


def _written_points(points: np.ndarray) -> str:
    return "[" + ", ".join(f"[{x:.12g}, {z:.12g}]" for x, z in points.round(6) + 0.0) + "]"
