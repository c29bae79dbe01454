"""Reads the outlines and lines of a DXF drawing, in metres and in the plane of the section; curves become chords."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np

from meshes.section.columns import JOINED
from meshes.section.layering import WIDEST
from meshes.section.sentences import counted

# Chords leave a curve by at most this (m), or this share of the drawing's height if that is less.
SAGITTA, SHARE_OF_HEIGHT = 0.01, 1.0 / 2000.0
CURVES = {"LINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE", "LWPOLYLINE", "POLYLINE", "HELIX", "SOLID", "TRACE", "3DFACE"}
FILLED = {"HATCH", "MPOLYGON"}
CHORDS = 32  # of a span between knots of a spline without an end
# Length (m) of a unit by $INSUNITS; feet, inches, yards and miles of the US survey from 21.
METRE, UNITS = 6, {
    1: 0.0254, 2: 0.3048, 3: 1609.344, 4: 1e-3, 5: 0.01, 6: 1.0, 7: 1e3, 8: 2.54e-8, 9: 2.54e-5, 10: 0.9144, 13: 1e-6,
    14: 0.1, 15: 10.0, 16: 100.0, 21: 1200 / 3937, 22: 100 / 3937, 23: 3600 / 3937, 24: 6336000 / 3937,
}  # fmt: skip


@dataclass(frozen=True)
class Shape:
    """Holds one outline or line of a drawing.

    Attributes
    ----------
    layer : layer of the shape in the drawing
    points : ndarray (n, 2), x and elevation (m), or (n, 3) in the space of the drawing; of an outline without the first
        one again
    closed : whether the shape is an outline
    kind : kind of the entity in the drawing
    """

    layer: str
    points: np.ndarray
    closed: bool
    kind: str = ""

    @property
    def span(self) -> str:
        """Return the extent of the shape along x, in words."""
        return f"x = {self.points[:, 0].min():.6g} to {self.points[:, 0].max():.6g} m"


@dataclass(frozen=True)
class Shapes:
    """Holds the shapes of a drawing.

    Attributes
    ----------
    outlines, lines : closed and open shapes; lines of one layer that meet end to end are one line
    strata : drawing layers that are strata whatever their names, because this program wrote the drawing
    notices : notices for the user, one sentence each: units, shapes that were closed, shapes that are not used
    """

    outlines: list[Shape] = field(default_factory=list)
    lines: list[Shape] = field(default_factory=list)
    strata: frozenset[str] = frozenset()
    notices: list[str] = field(default_factory=list)


def shapes_of(drawing: Any, names: dict[str, str], unit: float | None) -> Shapes:
    """Return the shapes of a drawing.

    Parameters
    ----------
    drawing : the drawing as ezdxf reads it
    names : names in the section of drawing layers whose name differs from it
    unit : length (m) of one unit of the drawing; None for the unit by $INSUNITS
    """
    notices: list[str] = []
    size = _unit(drawing, notices) if unit is None else unit
    unused: Counter[str] = Counter()
    coarse = list(_flattened(drawing, 1.0 / size, Counter()))
    height = max((float(np.ptp(item.points, axis=0)[1:].max()) for item in coarse), default=1.0) * size
    sagitta = min(SAGITTA, SHARE_OF_HEIGHT * (height or 1.0)) / size
    items = [
        replace(item, points=item.points * size, layer=names.get(item.layer, item.layer))
        for item in _flattened(drawing, sagitta, unused)
    ]
    if any(item.closed and item.kind not in FILLED for item in items):
        unused.update(f"{item.kind} on layer {item.layer}" for item in items if item.kind in FILLED)
        items = [item for item in items if item.kind not in FILLED]
    if not items:
        notices += _in_paper_space(drawing)
    shapes = _in_plane(items, unused)
    notices += _of_unlikely_width(shapes, size)
    shapes = _once(shapes, unused)
    joined = [item for layer in dict.fromkeys(shape.layer for shape in shapes)
              for item in _joined([shape for shape in shapes if shape.layer == layer])]  # fmt: skip
    outlines, lines = _outlines_and_lines(_without_holes(joined, notices), unused, notices)
    notices += [f"not used: {count} × {what}" for what, count in sorted(unused.items())]
    return Shapes(outlines, lines, frozenset(names.values()), notices)


def _of_unlikely_width(shapes: Sequence[Shape], unit: float) -> list[str]:
    """Return a sentence if the shapes are so wide or narrow that the ``unit`` (m) is hardly that of the drawing."""
    x = [x for shape in shapes for x in shape.points[:, 0]]
    width = float(max(x) - min(x)) if x else 1.0
    if 1.0 <= width <= WIDEST:
        return []
    wide = f"{width:.3g}" if width < WIDEST else f"{width:,.0f}"
    return [f"the drawing is {wide} m wide, its unit {unit:g} m: --unit gives another unit"]


def _outlines_and_lines(
    shapes: Sequence[Shape], unused: Counter[str], notices: list[str]
) -> tuple[list[Shape], list[Shape]]:
    """Return the outlines, among them lines that turn back and are closed here, and the other lines that are not
    upright."""
    outlines: list[Shape] = []
    lines: list[Shape] = []
    for shape in shapes:
        if not shape.closed and np.ptp(shape.points[:, 0]) <= JOINED:
            unused[f"upright {shape.kind} on layer {shape.layer}"] += 1
            continue
        if not shape.closed and not _across(shape.points):
            gap = float(np.hypot(*(shape.points[0] - shape.points[-1])))
            notices.append(f'the {shape.kind} on layer "{shape.layer}", {shape.span}, is open, and is '
                           f"closed by a straight line of {gap:.3g} m")  # fmt: skip
            shape = replace(shape, closed=True)
        (outlines if shape.closed else lines).append(shape)
    return outlines, lines


def _in_paper_space(drawing: Any) -> list[str]:
    """Return a sentence for each sheet of a drawing (paper space) that has entities, which are not read."""
    sheets = [(layout.name, len(layout)) for layout in drawing.layouts if not layout.is_modelspace]
    return [f'not used: {counted(count, "entity", "entities")} on the sheet "{name}": '
            "expected the section in model space" for name, count in sheets if count]  # fmt: skip


def _unit(drawing: Any, notices: list[str]) -> float:
    """Return the length (m) of one unit of a drawing by its $INSUNITS, and a sentence if the unit is not the metre."""
    number = int(drawing.header.get("$INSUNITS", 0))
    if number not in UNITS:
        notices.append(
            "the drawing does not say its unit ($INSUNITS): 1 unit is read as 1 m; --unit gives another unit"
        )
        return 1.0
    size = UNITS[number]
    if number != METRE:
        notices.append(f"1 unit of the drawing is {size:.6g} m, by its $INSUNITS = {number}; --unit gives another unit")
    return size


def _flattened(drawing: Any, sagitta: float, unused: Counter[str]) -> Iterator[Shape]:
    """Yield all shapes of the model space (points (n, 3)), with the shapes in blocks. Entities that are no shapes
    are counted by kind and layer."""
    from ezdxf import path

    hidden = {layer.dxf.name.casefold() for layer in drawing.layers if layer.is_off() or layer.is_frozen()}
    for entity in _entities(drawing.modelspace(), unused):
        kind, layer = entity.dxftype(), str(entity.dxf.layer)
        if layer.casefold() in hidden:
            unused[f"{kind} on layer {layer}, which is off or frozen"] += 1
            continue
        try:
            if kind not in CURVES | FILLED:
                raise TypeError(kind)
            if kind == "SPLINE" and not entity.construction_tool().is_clamped:
                chains = [_unclamped(entity.construction_tool())]
            else:
                paths = [path.make_path(entity)] if kind in CURVES else path.from_hatch(entity)
                chains = [
                    (np.array([tuple(p) for p in chain_path.flattening(sagitta)]), chain_path.is_closed)
                    for chain_path in paths
                ]
        except (TypeError, ValueError, ArithmeticError):
            unused[f"{kind} on layer {layer}"] += 1
            continue
        for points, closed in chains:
            if len(points) > 1:
                yield Shape(layer, points, bool(closed), kind)


def _unclamped(spline: Any) -> tuple[np.ndarray, bool]:
    """Return the points (n, 3) of a spline whose knots are not repeated at its ends, as those of closed splines, and
    whether it is closed.

    The spline is defined between the knots t_p and t_n of n points and degree p. The chords that ezdxf computes
    continue beyond these knots.
    """
    knots, degree, count = spline.knots(), spline.degree, spline.count
    parameters = np.linspace(knots[degree], knots[count], CHORDS * (count - degree) + 1)
    points = np.array([tuple(point) for point in spline.points(parameters)])
    return points, bool(np.allclose(points[0], points[-1]))


def _entities(space: Any, unused: Counter[str]) -> Iterator[Any]:
    """Yield the entities of a space, and the entities of blocks in their places. Entities on layer 0 of a block are on
    the layer of the block."""
    for entity in space:
        if entity.dxftype() != "INSERT":
            yield entity
            continue
        try:
            for insert in entity.multi_insert() if entity.mcount > 1 else [entity]:
                parts = list(insert.virtual_entities())
                for part in parts:
                    if part.dxf.layer == "0":
                        part.dxf.layer = entity.dxf.layer
                yield from _entities(parts, unused)
        except (ValueError, AttributeError, TypeError):
            unused[f'INSERT of block "{entity.dxf.name}"'] += 1


def _in_plane(drawn: Sequence[Shape], unused: Counter[str]) -> list[Shape]:
    """Return the shapes in x and elevation.

    The plane of the section is the xy plane of the drawing. If all shapes stand in one vertical plane instead,
    elevations are z.
    """
    if not drawn:
        return []
    every = np.vstack([shape.points for shape in drawn])
    upright = _upright(every)
    shapes = []
    for shape in drawn:
        if upright is not None:
            (origin, direction) = upright
            plane = np.column_stack([(shape.points[:, :2] - origin) @ direction, shape.points[:, 2]])
        elif np.ptp(shape.points[:, 2]) > JOINED:
            unused[f"{shape.kind} on layer {shape.layer}, which does not lie in the plane of the drawing"] += 1
            continue
        else:
            plane = shape.points[:, :2]
        plane = plane[np.concatenate([[True], np.hypot(*np.diff(plane, axis=0).T) > 1e-9])]
        closed = shape.closed or (len(plane) > 3 and bool(np.hypot(*(plane[0] - plane[-1])) <= JOINED))
        if closed and np.hypot(*(plane[0] - plane[-1])) <= JOINED:
            plane = plane[:-1]
        if len(plane) > (2 if closed else 1):
            shapes.append(Shape(shape.layer, plane, closed, shape.kind))
        else:
            unused[f"{shape.kind} without length or area on layer {shape.layer}"] += 1
    return shapes


def _upright(points: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """Return the origin and direction (2,) in plan of a vertical plane in which all points (n, 3) lie; None if there is
    none."""
    if np.ptp(points[:, 2]) <= JOINED:
        return None
    plan = points[:, :2]
    for axis, direction in ((1, [1.0, 0.0]), (0, [0.0, 1.0])):
        if np.ptp(plan[:, axis]) <= JOINED:
            return np.zeros(2), np.array(direction)
    first = plan[np.lexsort((plan[:, 1], plan[:, 0]))[0]]
    far = plan[int(np.argmax(np.hypot(*(plan - first).T)))] - first
    direction = far / np.hypot(*far)
    across = np.abs((plan - first) @ np.array([-direction[1], direction[0]]))
    return (first, direction) if across.max() <= JOINED else None


def _once(shapes: Sequence[Shape], unused: Counter[str]) -> list[Shape]:
    """Return the shapes without lines that lie on another line of their layer. Two such lines would meet at both ends
    and make an outline."""
    seen: set[tuple[str, bytes]] = set()
    joined = []
    for shape in shapes:
        ways = [(shape.layer, (points.round(6) + 0.0).tobytes()) for points in (shape.points, shape.points[::-1])]
        if not shape.closed and ways[0] in seen:
            unused[f"{shape.kind} on layer {shape.layer} that lies on another one"] += 1
            continue
        seen.update(ways)
        joined.append(shape)
    return joined


def _joined(shapes: Sequence[Shape]) -> list[Shape]:
    """Return the shapes of one layer, in which open shapes that meet end to end are joined."""
    done = [shape for shape in shapes if shape.closed]
    waiting = [shape for shape in shapes if not shape.closed]
    while waiting:
        shape = waiting.pop(0)
        met = [(k, end) for k, other in enumerate(waiting) for end in (0, -1) for own_end in (0, -1)
               if np.hypot(*(shape.points[own_end] - other.points[end])) <= JOINED]  # fmt: skip
        if not met:
            done.append(shape)
            continue
        other = waiting.pop(met[0][0])
        points = _end_to_end(shape.points, other.points)
        closed = len(points) > 3 and bool(np.hypot(*(points[0] - points[-1])) <= JOINED)
        joined_shape = Shape(shape.layer, points[:-1] if closed else points, closed, shape.kind)
        (done if closed else waiting).append(joined_shape)
    return done


def _end_to_end(chain: np.ndarray, next_chain: np.ndarray) -> np.ndarray:
    """Return two lines (n, 2) that meet, joined to one line."""
    ways = [(a, b) for a in (chain, chain[::-1]) for b in (next_chain, next_chain[::-1])]
    first, second = min(ways, key=lambda way: float(np.hypot(*(way[0][-1] - way[1][0]))))
    return np.vstack([first, second[1:]])


def _without_holes(shapes: Sequence[Shape], notices: list[str]) -> list[Shape]:
    """Return shapes without the outlines of holes in hatches. The ground in a hole is that of other shapes drawn there,
    or that of the hatch.
    """
    filled = [shape for shape in shapes if shape.kind in FILLED]
    holes = [
        shape
        for shape in filled
        if any(other.layer == shape.layer and _lies_in(shape.points[0], other.points) for other in filled)
    ]
    notices += [
        f'the {hole.kind} on layer "{hole.layer}" has a hole, {hole.span}: ground there that is in no other outline is '
        f'"{hole.layer}"'
        for hole in holes
    ]
    return [shape for shape in shapes if not any(shape is hole for hole in holes)]


def _lies_in(point: np.ndarray, outline: np.ndarray) -> bool:
    """Return whether a point (2,) lies in an outline (n, 2), by counting the edges above it. No corner of an outline
    lies in the outline."""
    start, end = outline, np.roll(outline, -1, axis=0)
    if np.any(np.all(np.abs(outline - point) <= JOINED, axis=1)):
        return False
    over = (start[:, 0] <= point[0]) != (end[:, 0] <= point[0])
    (x, z), run = start[over].T, end[over] - start[over]
    return bool(np.sum(z + run[:, 1] / run[:, 0] * (point[0] - x) > point[1]) % 2)


def _across(points: np.ndarray) -> bool:
    """Return whether a line goes from left to right, or from right to left, without turning back. Steps may be
    vertical."""
    runs = [b - a for a, b in pairwise(points[:, 0])]
    return all(run >= -JOINED for run in runs) or all(run <= JOINED for run in runs)
