"""Reorders lines drawn from right to left, lines whose points step back a little, and lines with three or more points
on a wall, as scanners and drawings produce them."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from meshes.section.dense_lines import CELL, DENSE_DISTANCE, Place, mean_height
from meshes.section.polyline import Line, pairs_of, without_repeats
from meshes.section.sentences import counted
from meshes.section.vertical_flow import LINES as FLOW_LINES

# Keys of lines in a stratum, and in tables of a section.
STRATUM_LINES = ("bottom", "piezometric_level", "cohesion_from", "consolidated_below")
TABLE_LINES = {"water": ("table", "after_drawdown"), "consolidation": ("table", "surface")}


def in_order(data: Mapping[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """Return the contents of a file with the points of its lines from left to right, at most two of them at one x.

    Lines drawn from right to left are reversed. Otherwise a point is moved only by distances that cells cannot resolve.
    A line with larger faults is unchanged, and the section reader refuses it.

    Parameters
    ----------
    data : the tables of a section, not validated

    Returns
    -------
    data : the same data with other points
    notices : one sentence for each line whose points were moved, and one for all lines that were reversed
    """
    data = dict(data)
    notices = _reversed_lines(data)
    try:
        surface = tuple(pairs_of(data["surface"]))
        if surface[0][0] == surface[-1][0]:
            return data, notices
        reach = DENSE_DISTANCE * CELL * mean_height(surface, Line.model_validate(data["base"]))
    except (KeyError, TypeError, ValueError, IndexError):
        return data, notices
    for place, table, points in _lines(data):
        if (ordered := _ordered(points, reach)) is None:
            continue
        table[place[-1]] = ordered[0].tolist()
        if ordered[1] > 0.0:
            back = int(np.count_nonzero(np.diff(points[:, 0]) < 0.0))
            notices.append(
                f"geometry: {_key(place)}: {counted(back, 'point', 'points')} stood left of the point before; the "
                f"points were put in order, and moved by at most {ordered[1]:.2g} m"
            )
    return data, notices


def _reversed_lines(data: dict[str, Any]) -> list[str]:
    """Reverse the lines that go from right to left, and return a sentence on them, if there are any."""
    reversed_lines = []
    for place, table, points in _lines(data):
        steps = np.diff(points[:, 0])
        if points[0, 0] > points[-1, 0] and np.sum(steps < 0.0) > np.sum(steps > 0.0):
            table[place[-1]] = list(table[place[-1]])[::-1]
            reversed_lines.append(_key(place))
    return (
        [f"geometry: lines that ran from right to left in the file were reversed: {'; '.join(reversed_lines)}"]
        if reversed_lines
        else []
    )


def _lines(data: dict[str, Any]) -> Iterator[tuple[Place, Any, np.ndarray]]:
    """Yield every list of points with its place, the table that contains it (a copy within ``data``), and its
    points."""
    for place in _written_lines(data):
        table: Any = data
        for step in place[:-1]:
            table[step] = list(table[step]) if isinstance(table[step], list | tuple) else dict(table[step])
            table = table[step]
        try:
            points = np.array(pairs_of(table[place[-1]]), dtype=float)
        except (TypeError, ValueError):
            continue
        if len(points):
            yield place, table, points


def _key(place: Place) -> str:
    """Return a place in words, strata counted from 1."""
    return ", ".join(str(step + 1) if isinstance(step, int) else step for step in place)


def _ordered(points: np.ndarray, reach: float) -> tuple[np.ndarray, float] | None:
    """Return points (n, 2) in order, and the largest move (m); None if no move is needed, or if a move would exceed the
    reach."""
    count = len(points)
    points = without_repeats(points)
    if len(points) < 2:
        return None
    x, z = points.T
    within = np.clip(x, x[0], x[-1])
    rising = 0.5 * (np.maximum.accumulate(within) + np.minimum.accumulate(within[::-1])[::-1])
    moved = float(np.abs(rising - x).max())
    starts = np.flatnonzero(np.concatenate([[True], np.diff(rising) > 0.0]))  # of points at one x
    sizes = np.diff(np.append(starts, len(x)))
    if moved > reach or not (moved or sizes.max() > 2 or len(points) < count):
        return None
    ordered: list[tuple[float, float]] = []
    for start, size in zip(starts.tolist(), sizes.tolist(), strict=True):
        heights = z[start : start + size]
        before, after = max(start - 1, 0), min(start + size, len(x) - 1)
        if size == 1 or (np.ptp(heights) <= reach and rising[after] - rising[before] <= reach):
            ordered.append((rising[start], float(np.median(heights))))
        elif (step := _step(heights, z[before], z[after], reach)) is not None:
            ordered += [(rising[start], step[0]), (rising[start], step[1])]
        else:
            return None
    return np.array(ordered), moved


def _step(heights: np.ndarray, before: float, after: float, reach: float) -> tuple[float, float] | None:
    """Return foot and top, or top and foot, of a wall on which points stand; None if the points stand on more than one
    wall."""
    first, last = float(heights[0]), float(heights[-1])
    if heights.min() >= min(first, last) - reach and heights.max() <= max(first, last) + reach:
        return first, last
    foot, top = float(heights.min()), float(heights.max())  # a scanner may see a wall in any order
    left, right = (foot if abs(foot - neighbour) < abs(top - neighbour) else top for neighbour in (before, after))
    return None if left == right else (left, right)


def _written_lines(data: Mapping[str, Any]) -> list[Place]:
    """Return the places of lists of points in the contents of a file."""
    tables: list[tuple[Place, Any]] = [(("surface",), data.get("surface"))]
    tables += [((key,), data.get(key)) for key in ("base", "water_table")]
    strata = data.get("strata")
    for k, stratum in enumerate(strata if isinstance(strata, list | tuple) else []):
        if isinstance(stratum, Mapping):
            tables += [(("strata", k, key), stratum.get(key)) for key in STRATUM_LINES]
            if isinstance(flow := stratum.get("vertical_flow"), Mapping):
                tables += [(("strata", k, "vertical_flow", key), flow.get(key)) for key in FLOW_LINES]
    for name, keys in TABLE_LINES.items():
        if isinstance(table := data.get(name), Mapping):
            tables += [((name, key), table.get(key)) for key in keys]
    places: list[Place] = []
    for place, line in tables:
        if isinstance(line, list | tuple):
            places.append(place)
        elif isinstance(line, Mapping):
            places += [(*place, kind) for kind in ("elevation", "depth") if isinstance(line.get(kind), list | tuple)]
    return places
