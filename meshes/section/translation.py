"""Moves a section to other axes: all of its lines, loads, walls and structures."""

from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel

from meshes.section.polyline import Line, Points
from meshes.section.section import Section

DIGITS = 7  # after the point of coordinates in m: two places of one section give the same numbers

# Keys of single coordinates in parts of a section: horizontal and vertical ones.
HORIZONTAL = {"Surcharge": ("start", "end"), "Structure": ("start", "end"), "Cutoff": ("x",)}
VERTICAL = {"Cutoff": ("bottom",)}


def with_origin(section: Section, x: float, z: float) -> Section:
    """Return a section in axes with another origin. It is not validated again.

    Parameters
    ----------
    section : the section
    x, z : place of the new origin in the axes of ``section`` (m)

    Returns
    -------
    The section, its coordinates rounded to `DIGITS` and without the units in which they were written.
    """
    parts = {key: _translated(value, -x, -z) for key, value in _fields(section) if key != "surface"}
    moved = Section.model_construct(**{**parts, "surface": _points(section.surface, -x, -z)})
    return moved.after_shaking() if section.water_pressure.after_shaking else moved


def _translated(part: Any, dx: float, dz: float) -> Any:
    """Return a part of a section, such as a stratum, a line, or a tuple of parts, moved by dx and dz (m); anything
    without coordinates is returned as it is."""
    if isinstance(part, tuple):
        return tuple(_translated(entry, dx, dz) for entry in part)
    if not isinstance(part, BaseModel):
        return part
    name = type(part).__name__
    values = {key: _translated(value, dx, dz) for key, value in _fields(part) if isinstance(value, tuple | BaseModel)}
    if isinstance(part, Line):
        values = {"elevation": _moved(part.elevation, dx, dz), "depth": _moved(part.depth, dx, 0.0)}
    for keys, change in ((HORIZONTAL.get(name, ()), dx), (VERTICAL.get(name, ()), dz)):
        values |= {key: round(getattr(part, key) + change, DIGITS) for key in keys}
    return part.model_copy(update=values)


def _fields(part: BaseModel) -> Iterator[tuple[str, Any]]:
    """Yield the fields of a part with their values; pydantic's own iteration includes what was computed from them."""
    return ((key, getattr(part, key)) for key in type(part).model_fields)


def _points(points: Points, dx: float, dz: float) -> Points:
    """Return points of a line, moved by dx and dz (m)."""
    return tuple((round(x + dx, DIGITS), round(z + dz, DIGITS)) for x, z in points)


def _moved(line: Any, dx: float, dz: float) -> Any:
    """Return elevations or depths, which are points, one number or None, moved by dx and dz (m)."""
    if line is None:
        return None
    return _points(line, dx, dz) if isinstance(line, tuple) else round(line + dz, DIGITS)
