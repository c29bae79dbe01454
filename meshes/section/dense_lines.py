"""Thins lines that were surveyed more densely than a mesh can resolve, such as a scanned surface, by removing points
that make no difference.

Cells cannot be larger than the distance between the points of a line that they follow. All lines of a section are
thinned together. First, noise is removed by a running median over a quarter of a cell. Then, of all places where any
line has a point, those are left out between which all lines stay within a tolerance (Douglas & Peucker 1973). So lines
that lie on each other still do, and no lines cross.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from meshes.section.layering import layering
from meshes.section.polyline import Line, Points, limits, without_repeats
from meshes.section.simplified import needed, with_farthest
from meshes.section.stratum import Stratum
from meshes.section.vertical_flow import LINES as FLOW_LINES
from meshes.section.water import Water

# The default size of cells, as a share of the mean height of a section.
CELL = 1.0 / 12.0
# Points closer than this share of a cell are dense; a section with this number of dense points is thinned.
DENSE_DISTANCE, MANY_DENSE_POINTS = 0.25, 30
# At an end of a line, the value at this point from the end is used if the point is near.
POINT_FROM_END = 4
# Smallest and largest shift of a line (cells), and the growth of the shift until no points are close to each other.
SMALLEST_SHIFT, LARGEST_SHIFT, SHIFT_GROWTH = 1.0 / 40.0, 0.5, 1.5
ROUNDING = 1e-9
# Parts of a line steeper than this (rise over run), and narrower than a cell, are walls.
WALL_SLOPE = 3.0


Place = tuple[str | int, ...]


def thinned_lines(lines: Mapping[Place, np.ndarray], cell: float) -> tuple[dict[Place, np.ndarray], float]:
    """Return lines without the points that cells cannot resolve.

    Parameters
    ----------
    lines (n, 2) : points (m) from left to right, as elevations or depths, by their places in the file; ("surface",) is
        one of them
    cell : size of cells (m)

    Returns
    -------
    lines : the thinned lines. If only few points are dense, all lines are unchanged.
    tolerance : largest distance (m) of a line from its running median; 0 if no line was changed
    """
    x = np.unique(np.concatenate([points[:, 0] for points in lines.values()]))
    gaps = np.diff(x)
    near = DENSE_DISTANCE * cell
    if np.count_nonzero(gaps < near) <= MANY_DENSE_POINTS:
        return dict(lines), 0.0
    sides = {place: _sides(points, x) for place, points in lines.items()}
    hard = np.zeros(len(x), dtype=bool)
    hard[[0, -1]] = True
    for left, right in sides.values():
        step = np.where(np.isfinite(left) & np.isfinite(right), np.abs(right - left), 0.0)
        noisy = np.count_nonzero(step > ROUNDING) > MANY_DENSE_POINTS  # points of a scan that happen to share their x
        hard |= (np.isfinite(left) != np.isfinite(right)) | (step > (near if noisy else ROUNDING))
    reach = _reach(x, hard, 0.5 * near)
    sides = {place: (_median(left, reach), _median(right, reach)) for place, (left, right) in sides.items()}
    for left, right in sides.values():  # at the ends there is no median: that of a neighbour is nearer to the ground
        if x[POINT_FROM_END] - x[0] <= near / 3.0 and not hard[1 : POINT_FROM_END + 1].any():
            right[0] = right[POINT_FROM_END]
        if x[-1] - x[-1 - POINT_FROM_END] <= near / 3.0 and not hard[-1 - POINT_FROM_END : -1].any():
            left[-1] = left[-1 - POINT_FROM_END]
    fixed = hard | np.concatenate([[True], (gaps[:-1] >= near) & (gaps[1:] >= near), [True]])
    tolerance = SMALLEST_SHIFT * cell
    while True:
        keep = needed_x(x, list(sides.values()), fixed, tolerance)
        places, of_places = with_walls_upright(
            x[keep],
            [(left[keep], right[keep]) for left, right in sides.values()],
            list(sides).index(("surface",)),
            near,
        )
        thinned = {place: _rebuilt(places, *pair) for place, pair in zip(sides, of_places, strict=True)}
        short = np.hypot(*np.diff(thinned[("surface",)][1:-1], axis=0).T) < near
        if not short.any() or tolerance * SHIFT_GROWTH > LARGEST_SHIFT * cell:
            break
        tolerance *= SHIFT_GROWTH
    moved = {place: len(points) != len(lines[place]) or not np.allclose(points, lines[place], atol=1e-6)
             for place, points in thinned.items()}  # fmt: skip
    return {place: points if moved[place] else lines[place] for place, points in thinned.items()}, tolerance


def lines_by_place(
    surface: Points, base: Line, drawn: Line | None, strata: Sequence[Stratum], water: Water | None
) -> dict[Place, np.ndarray]:
    """Return the lines of a section that have several points, by their places in the contents of the file.

    ``surface``, ``base``: surface and base of the section; ``drawn``: water table that is only drawn; ``strata``,
    ``water``: tables that contain lines.
    """
    lines: dict[Place, Line | None] = {("base",): base, ("water_table",): drawn}
    for k, stratum in enumerate(strata):
        lines[("strata", k, "bottom")] = stratum.bottom
        lines[("strata", k, "piezometric_level")] = stratum.piezometric_level
        if (flow := stratum.vertical_flow) is not None:
            lines |= {("strata", k, "vertical_flow", key): getattr(flow, key) for key in FLOW_LINES}
    if water is not None:
        lines |= {("water", "table"): water.table, ("water", "after_drawdown"): water.after_drawdown}
    by_place: dict[Place, np.ndarray] = {("surface",): np.array(surface, dtype=float)}
    for place, line in lines.items():
        kind = "elevation" if line is not None and line.depth is None else "depth"
        if line is not None and isinstance(getattr(line, kind), tuple):
            by_place[(*place, kind)] = np.array(getattr(line, kind), dtype=float)
    return by_place


def with_lines(data: dict[str, Any], lines: Mapping[Place, np.ndarray]) -> dict[str, Any]:
    """Return the contents of a file with other lines in their places."""
    for place, points in lines.items():
        inside: Any = data
        for step in place[:-1]:
            inside = inside[step]
        inside[place[-1]] = points.tolist()
    return data


def without_films(data: dict[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """Return the contents of a file with thinned lines without the strata of which nothing is left, and their names."""
    ground, strata = np.array(data["surface"], dtype=float), data["strata"]
    base, *bottoms = (
        None if line is None else Line(**line) for line in (data["base"], *(item.get("bottom") for item in strata))
    )
    if base is None:
        return data, []
    areas = layering(ground, base, bottoms).layering.areas()
    gone = [item["name"] for item, area in zip(strata[:-1], areas[:-1], strict=True) if area <= 0.0]
    return {**data, "strata": [item for item in strata if item["name"] not in gone]}, gone


def mean_height(surface: Points, base: Line) -> float:
    """Return the mean height (m) of a section."""
    ground = np.array(surface, dtype=float)
    low = base.points(float(ground[0, 0]), float(ground[-1, 0]))
    means = [float(0.5 * (z[1:] + z[:-1]) @ np.diff(x) / (x[-1] - x[0])) for x, z in (ground.T, low.T)]
    return means[1] if base.elevation is None else means[0] - means[1]


def _reach(x: np.ndarray, hard: np.ndarray, half: float) -> np.ndarray:
    """Return the number of neighbours (n,) on either side within half a window (m), counted up to the next ``hard``
    place; 0 at a hard place."""
    number = np.arange(len(x))
    ends = np.flatnonzero(hard)
    before = ends[np.searchsorted(ends, number, side="right") - 1]
    after = ends[np.searchsorted(ends, number, side="left")]
    left = number - np.maximum(np.searchsorted(x, x - half), before + 1)
    right = np.minimum(np.searchsorted(x, x + half, side="right") - 1, after - 1) - number
    return np.maximum(np.minimum(left, right), 0)


def _median(values: np.ndarray, reach: np.ndarray) -> np.ndarray:
    """Return the running median of values (n,) over the same number of neighbours on both sides, so that a line of
    constant slope is unchanged."""
    medians = values.copy()
    for i in np.flatnonzero(reach > 0):
        medians[i] = np.median(values[i - reach[i] : i + reach[i] + 1])
    return medians


def _sides(points: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the values of a line just left and just right of each x; NaN outside the line."""
    left, right = limits(points, x)
    start, end = points[0, 0], points[-1, 0]
    return np.where((x <= start) | (x > end), np.nan, left), np.where((x < start) | (x >= end), np.nan, right)


def needed_x(
    x: np.ndarray, sides: list[tuple[np.ndarray, np.ndarray]], fixed: np.ndarray, tolerance: float
) -> np.ndarray:
    """Find the x whose points keep all lines within a tolerance.

    Parameters
    ----------
    x (n,) : places (m), rising
    sides : values (n,) of each line just left and just right of each x; NaN outside the line
    fixed (n,) : mask of the places that stay: the first and the last place, and all places where a line steps or ends
    tolerance : largest difference (m) between a line and the chord between places that stay

    Returns
    -------
    Mask (n,) of the places that stay, the fixed ones included.
    """
    left, right = (np.array([pair[side] for pair in sides]) for side in (0, 1))

    def off(first: int, last: int) -> np.ndarray:
        share = (x[first + 1 : last] - x[first]) / (x[last] - x[first])
        straight = right[:, first, None] + share * (left[:, last] - right[:, first])[:, None]
        away = np.abs(left[:, first + 1 : last] - straight)
        return np.asarray(np.where(np.isfinite(away), away, 0.0).max(axis=0))

    return with_farthest(fixed, off, tolerance)


def with_walls_upright(
    x: np.ndarray, sides: list[tuple[np.ndarray, np.ndarray]], surface: int, near: float
) -> tuple[np.ndarray, list[tuple[np.ndarray, np.ndarray]]]:
    """Return lines in which each steep stretch of the surface that is too short for a cell is replaced by one vertical
    step.

    Parameters
    ----------
    x (n,) : places (m), rising
    sides (n,) : values of each line just left and just right of each x
    surface : number of the line that is the ground surface
    near : distance (m) below which places are too close to each other for cells. A wall is higher than this distance,
        and a stretch that becomes one step is not wider.

    Returns
    -------
    x (m,) : places (m), rising
    sides (m,) : values of the lines there
    """
    left, right = (np.array([pair[side] for pair in sides]) for side in (0, 1))
    keep = np.ones(len(x), dtype=bool)
    first, upright = 0, x.copy()
    walls: list[int] = []
    while first < len(x):
        last = int(np.searchsorted(x, x[first] + near)) - 1
        change = np.nan_to_num(np.abs(right[:, last] - left[:, first]))
        high = change > max(near, WALL_SLOPE * (x[last] - x[first]))
        if last > first > 0 and last < len(x) - 1 and high[surface]:
            at = np.repeat(x[first : last + 1], 2)
            values = np.column_stack([left[surface], right[surface]])[first : last + 1].ravel()
            biggest = int(np.argmax(np.abs(np.diff(values))))
            upright[first] = 0.5 * (at[biggest] + at[biggest + 1])
            keep[first + 1 : last + 1] = False
            level = np.fmin(left[:, first], right[:, last])
            left[:, first] = np.where(high | np.isnan(left[:, first]), left[:, first], level)
            right[:, first] = np.where(high | np.isnan(right[:, last]), right[:, last], level)
            walls.append(first)
            first = last
        first += 1
    for wall in walls:
        for way in (-1, 1):
            nearest, second = [*np.flatnonzero(keep & (way * (upright - upright[wall]) > 0.0))[::way], 0, 0][:2]
            if 0 < nearest < len(x) - 1 and nearest not in walls and abs(upright[nearest] - upright[wall]) < near:
                keep[nearest] = not _is_straight(upright, left, right, sorted((wall, nearest, second)), 0.5 * near)
    return upright[keep], [(left[k, keep], right[k, keep]) for k in range(len(sides))]


def _is_straight(x: np.ndarray, left: np.ndarray, right: np.ndarray, three: list[int], tolerance: float) -> bool:
    """Return whether all lines, given by values left and right of each x, run straight past the middle of three
    places."""
    first, middle, last = three
    share = (x[middle] - x[first]) / (x[last] - x[first])
    straight = (1.0 - share) * right[:, first] + share * left[:, last]
    none_ends = np.array_equal(np.isnan(left[:, middle]), np.isnan(right[:, middle]))
    return none_ends and not (np.abs([left[:, middle] - straight, right[:, middle] - straight]) >= tolerance).any()


def _rebuilt(x: np.ndarray, left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return a line (n, 2) from its elevations left and right of each x, which are NaN beyond its ends."""
    known = np.flatnonzero(np.isfinite(left) | np.isfinite(right))
    x, left, right = x[known], left[known], right[known]
    left[0], right[-1] = right[0], left[-1]
    chain = np.column_stack([np.repeat(x, 2), np.column_stack([left, right]).ravel()])
    chain = without_repeats(chain)
    return chain[needed(chain, ROUNDING * max(1.0, float(np.abs(chain[:, 1]).max())))]
