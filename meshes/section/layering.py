"""Holds the layers of a section between its breakpoints, where every interface is a straight line.

Interface 0 is the ground surface, interface k the bottom of stratum k - 1 (0-based), the last interface the base.
Between two neighbouring breakpoints all interfaces are straight; at a breakpoint they may have a vertical step. A
stratum without thickness is absent there.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from meshes.section.polyline import Line, crossings, limits, without_repeats
from meshes.section.sentences import coordinate
from meshes.section.snapping import snapped_x, snapped_z, snapping_length, snapping_notices

WIDEST = 5e3  # m of a section of a slope: a wider one is mostly one in feet or millimetres


@dataclass(frozen=True, eq=False)
class Layering:
    """Holds the interfaces of a section over the intervals between its breakpoints.

    Attributes
    ----------
    x (intervals + 1,) : the breakpoints (m)
    left, right (intervals, interfaces) : elevation (m) of every interface at the two ends of each interval
    strata : number of strata
    tolerance : distance (m) below which two points are one
    """

    x: np.ndarray
    left: np.ndarray
    right: np.ndarray
    strata: int
    tolerance: float

    @property
    def width(self) -> np.ndarray:
        """Return the width of each interval (m)."""
        return np.diff(self.x)

    def thickness(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the thickness (m) of every stratum at the left and right end of each interval, (intervals, strata)."""
        return self.left[:, :-1] - self.left[:, 1:], self.right[:, :-1] - self.right[:, 1:]

    def areas(self) -> np.ndarray:
        """Return the area (m²) of every stratum."""
        at_left, at_right = self.thickness()
        return 0.5 * (self.width[:, None] * (at_left + at_right)).sum(axis=0)

    def typical_thickness(self) -> np.ndarray:
        """Return the thickness (m) of every stratum, averaged over its area, so that the thin end of a wedge counts
        little; 0 for a stratum without an area."""
        left, right = self.thickness()
        squares = (self.width[:, None] * (left**2 + left * right + right**2)).sum(axis=0) / 3.0
        areas = self.areas()
        return np.divide(squares, areas, out=np.zeros_like(areas), where=areas > 0.0)

    def present(self) -> np.ndarray:
        """Return a mask of the intervals in which a stratum has an area, (intervals, strata)."""
        at_left, at_right = self.thickness()
        return (at_left > 0) | (at_right > 0)

    def interfaces(self, x: np.ndarray, near: np.ndarray | None = None) -> np.ndarray:
        """Return the elevation (m) of every interface at x, (len(x), interfaces); at a step, the elevation to the
        right.

        With ``near`` (len(x),) it is the elevation in the interval that contains ``near``, which may be on either side.
        """
        i, share = self._intervals(x, near)
        share = share[:, None]
        return (1.0 - share) * self.left[i] + share * self.right[i]

    def interface(self, number: int, x: np.ndarray, near: np.ndarray | None = None) -> np.ndarray:
        """Return the elevation (m) of one interface at x, (len(x),): ``number`` 0 is the ground, -1 the base.

        ``x``, ``near``: as for `interfaces`.
        """
        i, share = self._intervals(x, near)
        return (1.0 - share) * self.left[i, number] + share * self.right[i, number]

    def _intervals(self, x: np.ndarray, near: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
        """Return the interval of each x, or of each ``near``, and the place of x in it as a share of its width."""
        x = np.asarray(x, dtype=float)
        place = x if near is None else np.asarray(near, dtype=float)
        i = np.clip(np.searchsorted(self.x, place, side="right") - 1, 0, len(self.x) - 2)
        return i, (x - self.x[i]) / self.width[i]

    def places_between(self, x: np.ndarray) -> np.ndarray:
        """Return places x (m) between the sides, rising and each once; those at a breakpoint are moved to it."""
        at = np.unique(x)
        closest = self.x[np.abs(at[:, None] - self.x).argmin(axis=1)]
        at = np.unique(np.where(np.abs(at - closest) <= self.tolerance, closest, at))
        at = at[np.diff(at, prepend=-np.inf) > self.tolerance]
        return at[(at > self.x[0]) & (at < self.x[-1])]

    def stratum_at(self, x: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Return the index of the stratum at each point, -1 outside the section."""
        x, z = np.asarray(x, dtype=float), np.asarray(z, dtype=float)
        elevation = self.interfaces(x)
        inside = (x >= self.x[0]) & (x <= self.x[-1]) & (z <= elevation[:, 0]) & (z >= elevation[:, -1])
        below_tops = (z[:, None] <= elevation[:, :-1]) & (elevation[:, :-1] > elevation[:, 1:])
        deepest = below_tops.shape[1] - 1 - np.argmax(below_tops[:, ::-1], axis=1)
        return np.where(inside, deepest, -1)

    def polygons(self, stratum: int, cuts: Sequence[float] | np.ndarray = ()) -> list[np.ndarray]:
        """Return the outlines (n, 2) of a stratum, counter-clockwise, one for each connected piece; pieces also end at
        breakpoints that are ``cuts``."""
        pieces: list[list[int]] = []
        at_cuts = np.isin(self.x, cuts)
        for i in np.flatnonzero(self.present()[:, stratum]):
            if pieces and pieces[-1][-1] == i - 1 and not at_cuts[i] and self._joined(i, stratum):
                pieces[-1].append(i)
            else:
                pieces.append([i])
        return [self._chain(piece, stratum + 1, stratum) for piece in pieces]

    def outline(self) -> np.ndarray:
        """Return the outline (n, 2) of the whole section, counter-clockwise."""
        everything = list(range(len(self.width)))
        return self._chain(everything, self.strata, 0)

    def perimeter(self) -> float:
        """Return the length (m) of the border of the ground, without stretches where the base lies at the surface."""
        top, base = (np.stack([self.left[:, k], self.right[:, k]], axis=1) for k in (0, -1))
        is_ground = (top > base).any(axis=1)
        along = sum(float(np.hypot(self.width, line[:, 1] - line[:, 0])[is_ground].sum()) for line in (top, base))
        # At every breakpoint both sides are upright edges of the ground, but for what they have in common.
        common = np.minimum(top[:-1, 1], top[1:, 0]) - np.maximum(base[:-1, 1], base[1:, 0])
        return along + float((top - base).sum() - 2.0 * np.maximum(common, 0.0).sum())

    def _joined(self, i: int, stratum: int) -> bool:
        """Return whether the parts of the stratum left and right of breakpoint i have more than a point in common."""
        top = min(self.right[i - 1, stratum], self.left[i, stratum])
        bottom = max(self.right[i - 1, stratum + 1], self.left[i, stratum + 1])
        return bool(top > bottom)

    def _chain(self, piece: list[int], lower: int, upper: int) -> np.ndarray:
        def along(interface: int) -> list[tuple[float, float]]:
            ends = [((self.x[i], self.left[i, interface]), (self.x[i + 1], self.right[i, interface])) for i in piece]
            return [point for pair in ends for point in pair]

        points = np.array(along(lower) + along(upper)[::-1])
        distinct = np.any(points != np.roll(points, 1, axis=0), axis=1)
        return without_collinear(points[distinct], self.tolerance)


def middles(left: float, right: float, count: int) -> np.ndarray:
    """Return the middles of columns of equal width.

    Parameters
    ----------
    left, right : x of the outer sides (m)
    count : number of columns

    Returns
    -------
    x (count,) in m.
    """
    return left + (right - left) * (np.arange(count) + 0.5) / count


def without_collinear(polygon: np.ndarray, tolerance: float) -> np.ndarray:
    """Return a closed polygon (n, 2) without the points that lie on the straight line between their neighbours.

    A point is left out only if its distance from this line is a rounding error, a millionth of ``tolerance``.
    """
    keep = list(range(len(polygon)))
    k = 0
    while k < len(keep) and len(keep) > 3:
        before, here, after = (polygon[keep[(k + j) % len(keep)]] for j in (-1, 0, 1))
        chord, leg = after - before, here - before
        length = float(np.hypot(*chord))
        off = abs(float(chord[0] * leg[1] - chord[1] * leg[0]))
        between = 0.0 < float(chord @ leg) < length**2
        if between and off <= 1e-6 * tolerance * length:
            del keep[k]
        else:
            k += 1
    return polygon[keep]


class Layers(NamedTuple):
    """Holds the layers of a section, the faults found, and the changes made, one sentence each."""

    layering: Layering
    problems: list[str]
    notices: list[str]


def layering(
    surface: np.ndarray,
    base: Line,
    bottoms: Sequence[Line | None],
    also: Sequence[float] = (),
    names: Sequence[str] = (),
) -> Layers:
    """Compute the layers of a section between its surface and its base.

    A stratum ends where its bottom line ends (with a vertical face if it is still thick there), and where its bottom
    rises above the ground surface, which cuts it off. Points closer than `snapping_length` are merged.

    Parameters
    ----------
    surface (n, 2) : points of the ground surface (m)
    base : line below all strata
    bottoms : bottom line of each stratum from the top down; None for the base
    also : x of further breakpoints (m)
    names : names of the strata in messages, by default their numbers

    Returns
    -------
    The layers, and the faults found.
    """
    names = names or [f"stratum {number}" for number in range(1, len(bottoms) + 1)]
    x_left, x_right = float(surface[0, 0]), float(surface[-1, 0])
    raw = [(line or base).points(x_left, x_right) for line in bottoms]
    is_depth = [(line or base).elevation is None for line in bottoms]
    raw_base = base.points(x_left, x_right)
    snap = snapping_length(surface, raw_base, base.elevation is None)

    surface, *raw, raw_base = snapped_x([surface, *raw, raw_base], snap)
    x = np.unique(np.concatenate([points[:, 0] for points in (surface, *raw, raw_base)]))
    x = x[(x >= x_left) & (x <= x_right)]
    x = np.union1d(x, [at for at in also if x_left < at < x_right and np.abs(x - at).min() > snap])
    ground, lines, floor = _elevations(surface, raw, is_depth, raw_base, base.elevation is None, x)
    cuts = [crossings(x, *(ground - line).T, snap=snap) for line in lines]
    x = np.union1d(x, np.concatenate([np.empty(0), *cuts]))
    ground, lines, floor = _elevations(surface, raw, is_depth, raw_base, base.elevation is None, x)

    problems = []
    interfaces = [ground]
    reach = np.minimum(floor, ground)
    for k, (line, points) in enumerate(zip(lines, raw, strict=True)):
        top = interfaces[-1]
        spans = ((x[:-1] >= points[0, 0]) & (x[1:] <= points[-1, 0]))[:, None]
        bottom = np.where(spans, np.minimum(line, ground), top)
        problems += _crossing_problems(bottom, top, x, snap, f"the bottom of {names[k]} rises above its top")
        problems += _crossing_problems(reach, bottom, x, snap, f"the bottom of {names[k]} lies below the base")
        interfaces.append(np.minimum(np.maximum(bottom, reach), top))
    problems += _crossing_problems(interfaces[-1], floor, x, snap, "the lowest stratum does not reach the base")
    problems += _crossing_problems(floor, ground, x, snap, "the base rises above the ground surface")
    if not problems:
        problems += _disconnection_problems(ground, floor, x, snap)

    exact = np.stack(interfaces, axis=-1)
    stack = snapped_z(exact.copy(), snap)
    layers = Layering(x, stack[:, 0, :], stack[:, 1, :], len(lines), snap)
    if not problems:
        thin = f"has no thickness anywhere (less than {1000.0 * snap:.3g} mm is neglected)"
        problems = [f"{names[k]} {thin}" for k in np.flatnonzero(layers.areas() <= 0.0)]
    notices = snapping_notices(exact, stack, x, snap, names)
    if x_right - x_left > WIDEST:
        notices.append(f"the section is {x_right - x_left:,.0f} m wide; plain coordinates are metres")
    return Layers(layers, problems, notices)


def elevations_below(surface: np.ndarray, depth: Line) -> np.ndarray:
    """Return a line of depths below ``surface`` (n, 2) as elevations (m, 2), with two points where the ground steps."""
    layers = layering(surface, depth, [None]).layering
    chain = np.stack([layers.left[:, 1], layers.right[:, 1]], axis=1).ravel()
    points = np.column_stack([np.repeat(layers.x, 2)[1:-1], chain])
    return without_repeats(points)


def above_ground(surface: np.ndarray, line: Line, what: str) -> list[str]:
    """Return a sentence if ``line``, which crosses the whole section, rises above ``surface`` (n, 2)."""
    x_left, x_right = float(surface[0, 0]), float(surface[-1, 0])
    snap = snapping_length(surface, line.points(x_left, x_right), line.elevation is None)
    surface, points = snapped_x([surface, line.points(x_left, x_right)], snap)
    x = np.union1d(surface[:, 0], points[:, 0])
    ground, _, elevation = _elevations(surface, [], [], points, line.elevation is None, x)
    return _crossing_problems(elevation, ground, x, snap, f"{what} rises above the ground surface")


def at_ends(points: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return the values of a polyline at both ends of every interval between the x, (intervals, 2)."""
    before, after = limits(points, x)
    return np.stack([after[:-1], before[1:]], axis=1)


def _elevations(
    surface: np.ndarray,
    bottoms: list[np.ndarray],
    is_depth: list[bool],
    base: np.ndarray,
    base_is_depth: bool,
    x: np.ndarray,
) -> tuple[np.ndarray, list[np.ndarray], np.ndarray]:
    """Return the elevations of the ground, of every bottom and of the base over the intervals between the x."""
    ground = at_ends(surface, x)

    def elevation(points: np.ndarray, depth: bool) -> np.ndarray:
        value = at_ends(points, x)
        return ground - value if depth else value

    lines = [elevation(points, depth) for points, depth in zip(bottoms, is_depth, strict=True)]
    return ground, lines, elevation(base, base_is_depth)


def _crossing_problems(line: np.ndarray, other: np.ndarray, x: np.ndarray, snap: float, what: str) -> list[str]:
    """Return a sentence if ``line`` is above ``other`` anywhere, by more than a horizontal or vertical shift of
    ``snap`` can explain."""
    excess = line - other
    steep = np.maximum(*(np.abs(values[:, 1] - values[:, 0]) for values in (line, other))) / np.diff(x)
    too_much = excess > snap * (1.0 + steep[:, None])
    if not too_much.any():
        return []
    i, end = np.unravel_index(int(np.argmax(np.where(too_much, excess, 0.0))), excess.shape)
    worst = float(excess[i, end])
    wrong = np.flatnonzero(too_much.any(axis=1))
    first, last = (_where_it_ends(excess[k], x[k : k + 2], end) for k, end in ((wrong[0], 0), (wrong[-1], 1)))
    where = f"x = {x[i + end]:g} m (wrong between x = {coordinate(first)} and {coordinate(last)} m)"
    return [f"{what} by up to {worst:.3g} m, at {where}"]


def _where_it_ends(excess: np.ndarray, x: np.ndarray, end: int) -> float:
    """Return the x at which a linear excess (2,) between two x becomes zero, on the side of ``end``; the excess is
    positive in the interval."""
    if excess[end] >= 0.0:
        return float(x[end])
    return float(x[0] + (x[1] - x[0]) * excess[0] / (excess[0] - excess[1]))


def _disconnection_problems(ground: np.ndarray, floor: np.ndarray, x: np.ndarray, snap: float) -> list[str]:
    """Return a sentence if the section is not connected, because a step of the ground passes the base beside it.

    The base may reach the surface, as rock does; but then both sides of that place must meet there.
    """
    at = np.arange(1, len(x) - 1)
    over = np.maximum(floor[at - 1, 1] - ground[at, 0], floor[at, 0] - ground[at - 1, 1])
    wrong = at[over > snap]
    return [
        f"the section falls apart at x = {x[b]:g} m, where the base on one side lies above the ground on the other; "
        "expected the two sides to touch"
        for b in wrong[:1]
    ] + (["the section has no height anywhere"] if np.all(ground - floor <= snap) else [])
