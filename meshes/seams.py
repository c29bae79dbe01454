"""Meshes thin layers in a free mesh by seams: rows of quadrilaterals from the top of a layer to its bottom.

In a layer thinner than the triangles around it, triangles have angles of a few degrees, and so have quadrilaterals made
from them. Ground often fails in such a layer first. So the layer gets columns of the required length, each between a
point of the top line and a point of the bottom line, and rows of the required height.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from meshes.quality import corner_angles
from meshes.section.layering import Layering

# A layer with more rows than this, where its cells are smallest, is none: it has room for a free mesh.
MOST_ROWS = 4
# Columns are at most this many times as long as the layer is thick, but no shorter than this share of the cells there:
# along a seam that is thinner than that ground slips as a whole, and shorter columns would only be many.
MOST_ASPECT, SHORTEST = 8.0, 0.5
# Corners of the two lines closer than this share of the length of a column become the ends of one column.
JOINING_DISTANCE = 0.5
# Number of runs of a leaning end over which columns change from vertical to parallel to the end, by equal steps.
BLEND = 3.0
# A layer whose columns would have an angle (deg) below this is not a seam.
NARROW_ANGLE = 20.0
# A stratum is not divided where it is thinner than this share of the length of cells.
LOWEST = 0.05
# Places along a layer that differ by less than this share of its length are one.
ROUNDING = 1e-9

# A stratum and a piece of it, by number.
Place = tuple[int, int]


@dataclass(frozen=True, eq=False)
class Seam:
    """Describes a thin layer between two ends, each an edge of its outline.

    Attributes
    ----------
    top, bottom (columns + 1, 2) : points (m) of the top and the bottom line, from left to right; point k of one line is
        connected to point k of the other
    rows : number of rows of cells
    """

    top: np.ndarray
    bottom: np.ndarray
    rows: int

    @property
    def thickness(self) -> float:
        """Return the mean length (m) of the lines between top and bottom."""
        return float(np.hypot(*(self.top - self.bottom).T).mean())

    def narrowest(self) -> float:
        """Return the smallest angle (deg) in the corners of the columns; negative if a column is folded."""
        start = np.arange(len(self.bottom) - 1)
        cells = np.stack([start, start + 1, start + 1 + len(self.bottom), start + len(self.bottom)], axis=1)
        return float(corner_angles(np.vstack([self.bottom, self.top]), cells).min())

    def points(self) -> np.ndarray:
        """Return all points of the seam (n, 2), in m."""
        return np.vstack([self.top, self.bottom])

    def corners(self) -> np.ndarray:
        """Return the four corners of the seam (4, 2), in m."""
        return np.array([self.bottom[0], self.bottom[-1], self.top[-1], self.top[0]])


def seams_of(
    pieces: Mapping[Place, np.ndarray],
    corners: np.ndarray,
    size: Callable[[int, np.ndarray], np.ndarray],
    tolerance: float,
) -> dict[Place, Seam]:
    """Return the thin layers among ``pieces``, which are outlines (n, 2) of strata by the numbers of the stratum and of
    the piece.

    ``corners`` (n, 2) are the points (m) at which lines are cut; ``size`` returns the length (m) of cells in a stratum
    at points (k, 2). If two seams touch, the thinner one comes first, and the other one takes its points on the common
    line. Points nearer than ``tolerance`` (m) to a line lie on it.
    """

    def seam_at(place: Place, points: np.ndarray) -> Seam | None:
        return _seam(pieces[place], points, partial(size, place[0]), tolerance)

    seams = {place: single for place in pieces if (single := seam_at(place, corners)) is not None}
    taken: dict[Place, Seam] = {}
    for place, alone in sorted(seams.items(), key=lambda item: item[1].thickness):
        seam: Seam | None = alone
        if any(_touch(other, alone, tolerance) for other in taken.values()):
            others = [_common(other, alone, tolerance) for other in taken.values()]
            seam = seam_at(place, np.unique(np.vstack([corners, *others]), axis=0))
        if seam is not None and all(_fit(other, seam, tolerance) for other in taken.values()):
            taken[place] = seam
    return taken


def seam_ends(layers: Layering, k: int, size: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """Return the x (n,) in m at which stratum k is divided because it is thinner than a cell (``size``) on one side and
    thicker on the other side. The thin part then ends in one edge, as a seam requires.
    """
    at = np.column_stack([layers.x[:-1], layers.x[1:]])
    top, bottom = (np.column_stack([layers.left[:, j], layers.right[:, j]]) for j in (k, k + 1))
    thick, wanted = top - bottom, size(np.column_stack([at.ravel(), top.ravel()])).reshape(at.shape)
    thin = (thick.max(axis=1) > 0.0) & (thick < wanted).all(axis=1)
    thickness = np.minimum(thick[:-1, 1], thick[1:, 0])
    moved = np.maximum(np.abs(top[1:, 0] - top[:-1, 1]), np.abs(bottom[1:, 0] - bottom[:-1, 1]))
    divided = np.where(moved > layers.tolerance, thin[:-1] | thin[1:], thin[:-1] != thin[1:])
    room = LOWEST * np.minimum(wanted[:-1, 1], wanted[1:, 0])
    return layers.x[1:-1][divided & (thickness > np.maximum(room, layers.tolerance))]


def _touch(first: Seam, second: Seam, tolerance: float) -> bool:
    """Return whether two seams have points in common."""
    return len(_common(first, second, tolerance)) + len(_common(second, first, tolerance)) > 0


def _common(first: Seam, second: Seam, tolerance: float) -> np.ndarray:
    """Return the points (n, 2) of one seam that lie on a line of the other."""
    edges = [edge for line in (second.top, second.bottom) for edge in pairwise(line)]
    return np.unique(np.vstack([_points_on_edge(*edge, first.points(), tolerance) for edge in edges]), axis=0)


def _fit(first: Seam, second: Seam, tolerance: float) -> bool:
    """Return whether two seams that touch have exactly the same points there, and as many rows at a common end."""
    own_part, other_part = _common(first, second, tolerance), _common(second, first, tolerance)
    same = np.array_equal(own_part, other_part)
    ends = [{tuple(seam.top[end]), tuple(seam.bottom[end])} for seam in (first, second) for end in (0, -1)]
    return same and (first.rows == second.rows or not any(a == b for a in ends[:2] for b in ends[2:]))


@dataclass(frozen=True, eq=False)
class _Line:
    """Holds the top or bottom line of a layer, and the places of its points along the layer.

    Attributes
    ----------
    corners (n, 2) : corners of the line from left to right (m)
    x, along (k,) : values of x (m) of the line, and places along the layer (m); both are linear in between
    """

    corners: np.ndarray
    x: np.ndarray
    along: np.ndarray

    def cut_at(self, points: np.ndarray, tolerance: float) -> np.ndarray:
        """Return the corners of the line, and those of the points (n, 2) that lie on it, from left to right."""
        cuts = [_points_on_edge(start, end, points, tolerance) for start, end in pairwise(self.corners)]
        return np.unique(np.vstack([self.corners, *cuts]), axis=0)

    def places(self, points: np.ndarray) -> np.ndarray:
        """Return the places along the layer (m) of points (n, 2) on the line."""
        return np.interp(points[:, 0], self.x, self.along)

    def elevation(self, along: np.ndarray) -> np.ndarray:
        """Return the elevation (m) of the line at places along the layer."""
        return np.interp(np.interp(along, self.along, self.x), *self.corners.T)

    def points(self, along: np.ndarray, fixed: np.ndarray) -> np.ndarray:
        """Return the points (n, 2) at places along the layer. If a point coincides with one of the ``fixed`` points,
        that point is returned exactly.
        """
        x = np.interp(along, self.along, self.x)
        points = np.column_stack([x, np.interp(x, *self.corners.T)])
        nearest = np.abs(x[:, None] - fixed[:, 0]).argmin(axis=1)
        same = np.abs(x - fixed[nearest, 0]) <= ROUNDING * np.ptp(self.x)
        points[same] = fixed[nearest[same]]
        return points


def _seam(
    polygon: np.ndarray, corners: np.ndarray, size: Callable[[np.ndarray], np.ndarray], tolerance: float
) -> Seam | None:
    """Return the outline of a layer as a seam; None if the outline is no seam."""
    lines = _lines(polygon)
    if lines is None:
        return None
    top, bottom = lines
    at = np.unique(np.concatenate([line.places(line.corners) for line in lines]))
    at = np.unique(np.concatenate([np.linspace(a, b, 9) for a, b in pairwise(at)]))
    low, high = bottom.elevation(at), top.elevation(at)
    thick = high - low
    wanted = np.min(
        [size(np.column_stack([np.interp(at, line.along, line.x), line.elevation(at)])) for line in lines], 0
    )
    rows = max(1, round(float(thick.max() / wanted.min())))
    if thick.min() <= tolerance or thick.max() >= wanted.max() or rows > MOST_ROWS:
        return None
    if any(len(_points_on_edge(bottom.corners[end], top.corners[end], corners, tolerance)) > 2 for end in (0, -1)):
        return None  # something ends at its end
    length = np.clip(MOST_ASPECT * thick, SHORTEST * wanted, wanted)
    on_top, on_bottom = (line.cut_at(corners, tolerance) for line in lines)
    pairs = _paired(
        top.places(on_top),
        bottom.places(on_bottom),
        lambda place: JOINING_DISTANCE * float(np.interp(place, at, length)),
    )
    ends = _divided(pairs, lambda place: np.interp(place, at, length))
    seam = Seam(top.points(ends[:, 0], on_top), bottom.points(ends[:, 1], on_bottom), rows)
    return seam if seam.narrowest() > NARROW_ANGLE else None


def _lines(polygon: np.ndarray) -> tuple[_Line, _Line] | None:
    """Return the top and bottom line, between the ends, of an outline that goes counter-clockwise; None if it has no
    such lines.

    An end of the layer is the edge at the outermost corner. If the layer ends in a single corner, as at the face of a
    slope, the end is the steeper one of the two edges there. Places along the layer are x; but towards an inclined end
    the columns are inclined as well.
    """
    ring = np.roll(polygon, -int(np.lexsort((polygon[:, 1], polygon[:, 0]))[0]), axis=0)
    if _steepness(ring[0], ring[-1]) < _steepness(ring[0], ring[1]):  # the left end comes first, from top to bottom
        ring = np.roll(ring, -1, axis=0)
    far = int(np.lexsort((-ring[:, 1], -ring[:, 0]))[0]) % len(ring)
    after = (far + 1) % len(ring)
    if _steepness(ring[far], ring[after]) < _steepness(ring[far], ring[far - 1]):
        far -= 1
    bottom, top = ring[: far + 1], ring[far + 1 :][::-1]
    if not all(len(line) > 1 and np.all(np.diff(line[:, 0]) > 0.0) for line in (bottom, top)):
        return None
    middle = 0.5 * (top[[0, -1], 0] + bottom[[0, -1], 0])
    lean = BLEND * np.abs(top[[0, -1], 0] - bottom[[0, -1], 0])
    interior = middle + lean * [1.0, -1.0]
    interior = interior[(lean > 0.0)] if interior[0] < interior[1] else interior[:0]
    along = np.array([middle[0], *interior, middle[1]])
    return _Line(top, np.array([top[0, 0], *interior, top[-1, 0]]), along), _Line(
        bottom, np.array([bottom[0, 0], *interior, bottom[-1, 0]]), along
    )


def _steepness(first: np.ndarray, second: np.ndarray) -> float:
    """Return the height over the width of the line from one corner to another."""
    width, height = np.abs(second - first)
    return math.inf if width == 0.0 else float(height / width)


def _points_on_edge(start: np.ndarray, end: np.ndarray, points: np.ndarray, tolerance: float) -> np.ndarray:
    """Return those of the points (n, 2) that lie on an edge, its ends included."""
    at, off = along_and_above(start, end, points)
    return points[(off <= tolerance) & (at >= -tolerance) & (at <= np.hypot(*(end - start)) + tolerance)]


def along_and_above(start: np.ndarray, end: np.ndarray, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the distance (m) of points (n, 2) along the line of an edge, and their distance above or below it, or
    beside a vertical edge.

    Lines of a section that are nearer to each other than the tolerance at one x count as one line. If the distance were
    measured perpendicular to a steep face, lines below the face would count as one with it much earlier.
    """
    direction, offset = end - start, points - start
    cross = np.abs(offset[:, 0] * direction[1] - offset[:, 1] * direction[0])
    length = float(np.hypot(*direction))
    return offset @ direction / length, cross / (abs(float(direction[0])) or length)


def _paired(top: np.ndarray, bottom: np.ndarray, length: Callable[[float], float]) -> np.ndarray:
    """Return, for every corner place (m) of one line, the place on the other line to which it is connected, (n, 2)."""
    ends = sorted([(float(place), 0) for place in top[1:-1]] + [(float(place), 1) for place in bottom[1:-1]])
    pairs = [(float(top[0]), float(bottom[0]))]
    k = 0
    while k < len(ends):
        place, side = ends[k]
        other = place
        k += 1
        if k < len(ends) and ends[k][1] != side and ends[k][0] - place < JOINING_DISTANCE * length(place):
            other = ends[k][0]
            k += 1
        pairs.append((place, other) if side == 0 else (other, place))
    pairs.append((float(top[-1]), float(bottom[-1])))
    return np.array(pairs)


def _divided(pairs: np.ndarray, length: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """Return the pairs (n, [top, bottom]) with further columns between them, so that columns have about the wanted
    length (m)."""
    parts = []
    for start, end in pairwise(pairs):
        share = np.linspace(0.0, 1.0, 201)
        at = 0.5 * (start + share[:, None] * (end - start)).sum(axis=1)
        count = np.concatenate([[0.0], np.cumsum(np.diff(at) / length(0.5 * (at[1:] + at[:-1])))])
        columns = max(1, round(float(count[-1])))
        split = np.interp(np.linspace(0.0, count[-1], columns + 1), count, share)
        parts.append(start + split[:-1, None] * (end - start))
    return np.vstack([*parts, pairs[-1:]])
