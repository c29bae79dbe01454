"""Closed outlines in a section: points [[x, z], ...] in turn, that neither cross nor touch themselves."""

from typing import Annotated, Any

import numpy as np
from pydantic import PlainSerializer, PlainValidator

from meshes.section.columns import polygon_area
from meshes.section.polyline import Points, pairs_of, written


def read_outline(value: Any) -> Points:
    """The corners of a closed outline in order, without the first one repeated at the end.

    Raises ValueError with every problem of the outline, one on each line of the message.
    """
    if not isinstance(value, list | tuple) or len(value) < 3:
        raise ValueError("expected three or more points [[x, z], ...], the corners in order")
    points = pairs_of(value)
    again = [point for point, before in zip(points, [points[-1], *points[:-1]], strict=True) if point != before]
    crossing = _crossing(np.array(again, dtype=float)) if len(again) > 2 else None
    if crossing is not None:
        at = f"x = {crossing[0]:.6g}, z = {crossing[1]:.6g} m"
        raise ValueError(
            f"its edges meet at {at}; expected corners in order along an outline that does not cross itself"
        )
    if len(again) < 3 or polygon_area(np.array(again, dtype=float)) <= 0.0:
        raise ValueError("has no area; expected corners that do not lie on one line")
    return tuple(again)


def _crossing(points: np.ndarray) -> np.ndarray | None:
    """Where an edge of a closed polygon (n, 2) meets one that is not its neighbour, or turns back on its neighbour."""
    start, run = points, np.roll(points, -1, axis=0) - points
    count, along = len(points), np.roll(run, -1, axis=0)
    back = (np.abs(_cross(run, along)) <= 1e-12 * np.abs(run * along).sum(axis=1)) & ((run * along).sum(axis=1) < 0.0)
    if back.any():
        return np.asarray(points[(int(np.argmax(back)) + 1) % count])
    for i in range(count):
        others = np.array([j for j in range(i + 2, count) if (j + 1) % count != i], dtype=int)
        between, across = start[others] - start[i], _cross(run[i], run[others])
        with np.errstate(divide="ignore", invalid="ignore"):
            here, there = _cross(between, run[others]) / across, _cross(between, run[i]) / across
        met = (across != 0.0) & (here >= 0.0) & (here <= 1.0) & (there >= 0.0) & (there <= 1.0)
        if met.any():
            return np.asarray(start[i] + here[np.argmax(met)] * run[i])
    return None


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def within(points: np.ndarray, left: float, right: float) -> np.ndarray:
    """What of a closed polygon (n, 2) lies from ``left`` to ``right`` (m): Sutherland & Hodgman (1974).

    Edges that run back and forth on either side are left in it; they are vertical and hold no area.
    """
    for limit, sign in ((left, 1.0), (right, -1.0)):
        corners = []
        for start, end in zip(points, np.roll(points, -1, axis=0), strict=True):
            inside = [sign * (end_x - limit) >= 0.0 for end_x in (start[0], end[0])]
            if inside[0]:
                corners.append(start)
            if inside[0] != inside[1]:
                share = (limit - start[0]) / (end[0] - start[0])
                corners.append(np.array([limit, start[1] + share * (end[1] - start[1])]))
        points = np.array(corners, dtype=float).reshape(-1, 2)
    return points


Outline = Annotated[Points, PlainValidator(read_outline), PlainSerializer(written)]
