"""Sections as DXF drawings: every stratum a closed polyline on a layer of its name, and the water an open one."""

import importlib.util
import json
from collections.abc import Sequence
from graphlib import CycleError, TopologicalSorter
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from meshes.errors import InputError
from meshes.section.section import Section

WATER = "WATER"
# Lines of a drawing that are closer (m) are one: what draughtsmen snap to.
SNAP = 1e-4
SOIL = ("density", "youngs_modulus", "poissons_ratio", "cohesion", "friction_angle")


def _ezdxf(path: Path) -> Any:
    if importlib.util.find_spec("ezdxf") is None:
        raise InputError(str(path), ["drawings need the package ezdxf: pip install noshiro[drawings]"])
    import ezdxf

    return ezdxf


def write_dxf(section: Section, path: Path) -> None:
    """Draw the strata and the water table, 1 unit = 1 m."""
    drawing = _ezdxf(path).new(setup=True, units=6)
    space = drawing.modelspace()
    for k, stratum in enumerate(section.strata):
        drawing.layers.add(stratum.name, color=k % 7 + 1)
        for polygon in section.layering.polygons(k):
            space.add_lwpolyline(
                [(float(x), float(z)) for x, z in polygon], close=True, dxfattribs={"layer": stratum.name}
            )
    water = section.water_points()
    if water is not None:
        drawing.layers.add(WATER, color=5)
        space.add_lwpolyline([(float(x), float(z)) for x, z in water], dxfattribs={"layer": WATER})
    drawing.saveas(path)


def read_dxf(path: Path, name: str) -> str:
    """The section of a drawing as TOML, its soils still to be given. Raises InputError with all problems."""
    ezdxf = _ezdxf(path)
    try:
        space = ezdxf.readfile(path).modelspace()
    except (OSError, ezdxf.DXFError) as error:
        raise InputError(str(path), [f"is no DXF drawing: {error}"]) from None
    outlines: dict[str, list[np.ndarray]] = {}
    water: list[np.ndarray] = []
    for shape in space.query("LWPOLYLINE POLYLINE"):
        points = np.array(
            [(p[0], p[1]) for p in (shape.get_points() if shape.dxftype() == "LWPOLYLINE" else shape.points())]
        )
        layer = str(shape.dxf.layer)
        closed = bool(shape.closed if shape.dxftype() == "LWPOLYLINE" else shape.is_closed)
        if layer.upper() == WATER and not closed:
            water.append(points)
        elif closed or (len(points) > 3 and np.allclose(points[0], points[-1], atol=SNAP)):
            outlines.setdefault(layer, []).append(points)
    if not outlines:
        raise InputError(
            str(path), ["holds no closed polylines; expected one for each stratum, on a layer of its name"]
        )
    return _text(_columns(outlines, path), name, water)


class _Columns:
    """Strata between breakpoints x: their tops and bottoms at the left and right end of each column; nan where none."""

    def __init__(self, names: Sequence[str], x: np.ndarray, top: np.ndarray, bottom: np.ndarray) -> None:
        self.names, self.x, self.top, self.bottom = names, x, top, bottom


def _columns(outlines: dict[str, list[np.ndarray]], path: Path) -> _Columns:
    """Every outline cut at all corners of all of them, and the strata put in their order from the top down."""
    every = np.sort(np.concatenate([points[:, 0] for its in outlines.values() for points in its]))
    x = every[np.concatenate([[True], np.diff(every) > SNAP])]
    names = list(outlines)
    top, bottom = (np.full((len(names), len(x) - 1, 2), np.nan) for _ in range(2))
    for k, its in enumerate(outlines.values()):
        for points in its:
            for column in range(len(x) - 1):
                crossed = _crossed(points, x[column], x[column + 1])
                if crossed is not None:
                    bottom[k, column], top[k, column] = crossed
    below: dict[int, set[int]] = {k: set() for k in range(len(names))}
    middle = 0.5 * (top + bottom).mean(axis=2)
    for column in range(len(x) - 1):
        there = [k for k in np.argsort(-middle[:, column]) if not np.isnan(middle[k, column])]
        for above, k in pairwise(there):
            below[int(k)].add(int(above))
    try:
        order = list(TopologicalSorter(below).static_order())
    except CycleError as error:
        circle = " over ".join(f'"{names[k]}"' for k in error.args[1])
        raise InputError(str(path), [f"the strata do not lie in one order: {circle}"]) from None
    return _Columns([names[k] for k in order], x, top[order], bottom[order])


def _crossed(points: np.ndarray, left: float, right: float) -> tuple[np.ndarray, np.ndarray] | None:
    """Lower and upper elevations (at left, at right) of a polygon in a column that none of its corners lies in."""
    middle = 0.5 * (left + right)
    ends = np.roll(points, -1, axis=0)
    found = []
    for (x0, z0), (x1, z1) in zip(points, ends, strict=True):
        if (x0 - middle) * (x1 - middle) < 0.0:
            slope = (z1 - z0) / (x1 - x0)
            found.append(z0 + slope * (np.array([left, right]) - x0))
    if len(found) < 2:
        return None
    found.sort(key=lambda line: float(line.sum()))
    return found[0], found[-1]


def _text(columns: _Columns, name: str, water: list[np.ndarray]) -> str:
    ground = np.nanmax(columns.top, axis=0)
    lowest = np.nanmin(columns.bottom, axis=0)
    lines = ["# Made from a drawing: soils are still to be given.", "", f"name = {json.dumps(name)}"]
    lines.append(f"surface = {_points(columns.x, ground)}")
    lines += [f"base = {{ elevation = {_points(columns.x, lowest)} }}", ""]
    if water:
        table = ", ".join(f"[{x:.10g}, {z:.10g}]" for x, z in water[0])
        lines += ["[water]", f"table = [{table}]", ""]
    above = ground
    for k, stratum in enumerate(columns.names):
        here = np.where(np.isnan(columns.bottom[k]), above, columns.bottom[k])
        lines += ["[[strata]]", f"name = {json.dumps(stratum, ensure_ascii=False)}"]
        if k + 1 < len(columns.names):
            lines.append(f"bottom = {{ elevation = {_points(columns.x, here)} }}")
        lines += [f"# {key} =" for key in SOIL] + [""]
        above = here
    return "\n".join(lines)


def _points(x: np.ndarray, line: np.ndarray) -> str:
    """A line given at both ends of every column, as points; two where it steps, none where it runs straight on."""
    points = [(x[0], line[0, 0])]
    for column in range(len(x) - 1):
        end = (x[column + 1], line[column, 1])
        if len(points) > 1 and column and abs(line[column, 0] - line[column - 1, 1]) < SNAP:
            (xa, za), (xb, zb) = points[-2], points[-1]
            if xb > xa and abs(za + (zb - za) * (end[0] - xa) / (xb - xa) - end[1]) < SNAP:
                points.pop()
        points.append(end)
        if column + 2 < len(x) and abs(line[column + 1, 0] - line[column, 1]) > SNAP:
            points.append((x[column + 1], line[column + 1, 0]))
    return "[" + ", ".join(f"[{px:.10g}, {pz:.10g}]" for px, pz in points) + "]"
