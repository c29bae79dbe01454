"""Makes triangles for seepage: vertical lines from the base to the ground, joined from one line to the next.

Vertical lines stand at all breakpoints of the layers, and between breakpoints at most a given size apart. The points on
a line are those where interfaces cross it, and points between these at the same spacing. A strip between two lines is
filled from the base upwards with triangles that follow the interfaces, so that a point is found by its strip and its
height alone. If no water crosses a line (a cut-off wall), the two sides of the line have separate points.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from meshes.section.layering import Layering

# A level gets no point on a line if another point is closer than this share of the cell size.
LEVEL_DISTANCE = 0.2


class Wall(NamedTuple):
    """Holds a vertical line at ``x`` that no water crosses, from the ground down to the elevation ``bottom`` (m)."""

    x: float
    bottom: float


@dataclass(frozen=True, eq=False)
class FlowGrid:
    """Holds the triangles of a section for seepage.

    Attributes
    ----------
    x (lines,) : positions of the vertical lines (m), rising
    points (n, 2) : points (m)
    cells (m, 3) : numbers of the points of each triangle
    stratum (m,) : number of the stratum of each triangle
    rungs (r, 2) : for every strip, the pairs of points, left and right, between which its triangles lie, from the base
        upwards; none if the strip has no height
    ground (g,) : numbers of the points on the ground surface, including walls of steps
    sides : numbers of the points of the left and of the right side, upwards
    walls : positions (m) of lines that no water crosses
    """

    x: np.ndarray
    points: np.ndarray
    cells: np.ndarray
    stratum: np.ndarray
    rungs: tuple[np.ndarray, ...]
    ground: np.ndarray
    sides: tuple[np.ndarray, np.ndarray]
    walls: tuple[float, ...] = ()

    def chains(self) -> Iterator[tuple[int, int, np.ndarray]]:
        """Yield every strip, its sides 0 and 1, and the points there from the base upwards."""
        for strip, rungs in enumerate(self.rungs):
            for side in (0, 1):
                chain = rungs[:, side]
                yield strip, side, chain[np.append(True, chain[1:] != chain[:-1])] if len(chain) else chain

    def strip_at(self, points: np.ndarray, near: np.ndarray, tolerance: float) -> np.ndarray:
        """Return the strips (k,) in which points (k, 2) lie. A point on the line between two strips belongs to the
        strip that contains ``near`` (k, 2).
        """
        x = points[:, 0]
        strip = np.searchsorted(self.x, x, side="right") - 1
        after = np.clip(np.searchsorted(self.x, x), 1, len(self.x) - 1)
        line = np.where(x - self.x[after - 1] <= self.x[after] - x, after - 1, after)  # the nearest one
        strip_of_near = np.where(near[:, 0] > self.x[line], line, line - 1)
        strip = np.where(np.abs(x - self.x[line]) <= tolerance, strip_of_near, strip)
        return np.clip(strip, 0, len(self.rungs) - 1)

    def interpolated(self, values: np.ndarray, points: np.ndarray, near: np.ndarray, tolerance: float) -> np.ndarray:
        """Interpolate values (n,) at the grid points to points (k, 2). Above and below the grid the nearest value is
        used; outside the ground the result is NaN. ``near`` (k, 2): points inside the cells to which ``points`` belong;
        ``tolerance``: tolerance of places (m).
        """
        result = np.full(len(points), np.nan)
        strip = self.strip_at(points, near, tolerance)
        for j in np.unique(strip):
            rungs = self.rungs[j]
            if not len(rungs):
                continue
            in_strip = np.flatnonzero(strip == j)
            share = ((points[in_strip, 0] - self.x[j]) / (self.x[j + 1] - self.x[j]))[:, None]
            heights, there = (
                (1.0 - share) * field[rungs[:, 0]] + share * field[rungs[:, 1]] for field in (self.points[:, 1], values)
            )
            z = points[in_strip, 1]
            below = np.clip((heights <= z[:, None]).sum(axis=1) - 1, 0, len(rungs) - 2)
            row = np.arange(len(in_strip))
            low, high = heights[row, below], heights[row, below + 1]
            # Beside its strip, by less than the tolerance, the upper one of two edges that cross counts: the ground.
            part = np.clip(np.divide(z - low, high - low, out=np.ones(len(z)), where=high > low), 0.0, 1.0)
            result[in_strip] = (1.0 - part) * there[row, below] + part * there[row, below + 1]
        return result


def flow_grid(
    layers: Layering, size: float, walls: Sequence[Wall] = (), levels: Sequence[float] = (), stretch: float = 1.0
) -> FlowGrid:
    """Make the grid of layers with breakpoints at all ``walls``. Edges are about ``size`` (m) long, and along x
    ``stretch`` times as long as vertically.

    Every line has a point at the elevation (m) of each of the ``levels``, such as those of free water.
    """
    x, ends = _lines(layers, size * np.sqrt(stretch))
    size = float(size / np.sqrt(stretch))
    z = [_heights(ends, line, size,
                  [*(wall.bottom for wall in walls if abs(wall.x - x[line]) <= layers.tolerance), *levels],
                  layers.tolerance)
         for line in range(len(x))]  # fmt: skip
    points, left_numbers, right_numbers = _numbered(x, z, walls, layers.tolerance)
    cells, stratum, rungs = [], [], []
    for strip in range(len(x) - 1):
        numbers, heights = (right_numbers[strip], left_numbers[strip + 1]), (z[strip], z[strip + 1])
        pairs: list[tuple[int, int]] = []
        for k in range(layers.strata - 1, -1, -1):
            lower, upper = ends[strip, :, k + 1], ends[strip, :, k]
            if not (upper > lower).any():
                continue
            chains = [
                numbers[side][(heights[side] >= lower[side]) & (heights[side] <= upper[side])].tolist()
                for side in (0, 1)
            ]
            for triangle, rung in _zipped(chains, points):
                cells.append(triangle)
                stratum.append(k)
                pairs += [rung[0], rung[1]] if not pairs else [rung[1]]
        rungs.append(np.array(pairs, dtype=int).reshape(-1, 2))
    triangles = np.array(cells, dtype=int)
    used = np.unique(triangles)
    new = np.full(len(points), -1)
    new[used] = np.arange(len(used))
    ground = _on_ground(ends, z, left_numbers, right_numbers)
    sides = (right_numbers[0], left_numbers[-1])
    return FlowGrid(
        x, points[used], new[triangles], np.array(stratum), tuple(new[pairs] for pairs in rungs),
        np.unique([new[i] for i in ground if new[i] >= 0]), (_remaining(new, sides[0]), _remaining(new, sides[1])),
        tuple(wall.x for wall in walls),
    )  # fmt: skip


def _remaining(new: np.ndarray, numbers: np.ndarray) -> np.ndarray:
    remaining = new[numbers]
    return np.asarray(remaining[remaining >= 0])


def _lines(layers: Layering, size: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the positions of the lines (m), and the elevations (strips, 2 ends, interfaces) of the interfaces between
    them."""
    x, ends = [layers.x[:1]], []
    for i, width in enumerate(layers.width):
        count = max(1, int(np.ceil(width / size - 1e-9)))
        share = (np.arange(count + 1) / count)[:, None]
        between = (1.0 - share) * layers.left[i] + share * layers.right[i]
        between[0], between[-1] = layers.left[i], layers.right[i]
        ends.append(np.stack([between[:-1], between[1:]], axis=1))
        x.append(layers.x[i] + width * share[1:, 0])
        x[-1][-1] = layers.x[i + 1]
    return np.concatenate(x), np.concatenate(ends)


def _heights(ends: np.ndarray, line: int, size: float, levels: list[float], tolerance: float) -> np.ndarray:
    """Return the elevations (m) of the points of a line, rising: where interfaces meet the line from either side, and
    between them at no larger spacing than the size."""
    sides = ([ends[line - 1, 1]] if line else []) + ([ends[line, 0]] if line < len(ends) else [])
    fixed = np.unique(np.concatenate(sides))
    for at in levels:
        if fixed[0] < at < fixed[-1] and np.abs(fixed - at).min() > max(tolerance, LEVEL_DISTANCE * size):
            fixed = np.union1d(fixed, at)
    heights = [fixed[:1]]
    for low, high in pairwise(fixed.tolist()):
        count = max(1, int(np.ceil((high - low) / size - 1e-9)))
        between = low + (high - low) * np.arange(1, count + 1) / count
        between[-1] = high
        heights.append(between)
    return np.concatenate(heights)


def _numbered(
    x: np.ndarray, z: list[np.ndarray], walls: Sequence[Wall], tolerance: float
) -> tuple[np.ndarray, list[np.ndarray], list[np.ndarray]]:
    """Return the points (n, 2) of all lines, and for each line the numbers of its points as seen from the strip to the
    left and from the strip to the right. The numbers differ above the foot of a wall, and everywhere if the wall
    reaches the base."""
    points, to_left, to_right, count = [], [], [], 0
    for at, heights in zip(x, z, strict=True):
        numbers = count + np.arange(len(heights))
        points.append(np.column_stack([np.full(len(heights), at), heights]))
        count += len(heights)
        to_left.append(numbers)
        feet = [wall.bottom for wall in walls if abs(wall.x - at) <= tolerance]
        if feet and at not in (x[0], x[-1]):
            apart = heights > min(feet) + 0.5 * tolerance
            apart |= min(feet) <= heights[0] + tolerance  # a wall down to the base closes the section
            numbers = numbers.copy()
            numbers[apart] = count + np.arange(int(apart.sum()))
            points.append(np.column_stack([np.full(int(apart.sum()), at), heights[apart]]))
            count += int(apart.sum())
        to_right.append(numbers)
    return np.concatenate(points), to_left, to_right


def _zipped(
    chains: list[list[int]], points: np.ndarray
) -> list[tuple[tuple[int, int, int], tuple[tuple[int, int], tuple[int, int]]]]:
    """Return counter-clockwise triangles between two adjacent chains of points that rise side by side, each with the
    pair of points below and the pair above it."""
    left, right = chains
    i = j = 0
    triangles = []
    while i + 1 < len(left) or j + 1 < len(right):
        rung = (left[i], right[j])
        # The next one is that whose new rung is the shorter one, by height.
        on_left = j + 1 == len(right) or (
            i + 1 < len(left)
            and abs(points[left[i + 1], 1] - points[right[j], 1]) <= abs(points[left[i], 1] - points[right[j + 1], 1])
        )
        if on_left:
            triangle = (left[i], right[j], left[i + 1])
            i += 1
        else:
            triangle = (left[i], right[j], right[j + 1])
            j += 1
        triangles.append((triangle, (rung, (left[i], right[j]))))
    return triangles


def _on_ground(
    ends: np.ndarray, z: list[np.ndarray], to_left: list[np.ndarray], to_right: list[np.ndarray]
) -> list[int]:
    """Return the grid points on the ground surface: tops of the strips, and points on a vertical step of the
    surface."""
    points: list[int] = []
    for line, heights in enumerate(z):
        tops = ([ends[line - 1, 1, 0]] if line else []) + ([ends[line, 0, 0]] if line < len(ends) else [])
        bare = heights >= min(tops)
        points += [*to_left[line][bare].tolist(), *to_right[line][bare].tolist()]
    return points
