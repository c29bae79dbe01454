"""Reads the waternets of D-Stability: a phreatic line, and reference lines at which the levels of head lines hold.

Above the phreatic line there is no pore pressure. Between two lines, of which the uppermost is the phreatic line, or
the ground where it is under water, the pore pressure is linear in the elevation, between that of the head line below
the upper line and that of the head line above the lower line. Below all lines it is hydrostatic. A line reaches no
further than its ends. This is the pore pressure that D-Stability stores with the slices of its results.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple, Self

import numpy as np

from meshes.models.foreign_model import line_of
from meshes.section.layering import middles
from meshes.section.polyline import lower_line, without_repeats
from meshes.section.vertical_flow import LinearHead

Json = Mapping[str, Any]
INSIDE = 0.02  # of the way from a corner of a layer to its middle: a place inside, where its pressure is compared
COLUMNS = 41  # places along a reference line at which its distance from the edges of a layer is taken
READING_DISTANCE = 0.02  # m: distance from a line of the points above and below it whose water is read
LEAST_ROOM = 0.05  # m: lines nearer to the edges of a layer do not divide it
STEP_WIDTH = 0.05  # m: over which a vertical step of a head line is drawn
NOTABLE_HEAD = 0.1  # m: differences of the pressure head that are reported


class WaterPart(NamedTuple):
    """Holds the part of a layer above a line (its ``bottom``, None for the lowest part), and the keys of its water."""

    keys: dict[str, Any]
    bottom: list[list[float]] | None


@dataclass(frozen=True, eq=False)
class ReferenceLine:
    """Holds a line (n, 2) in m, and the names of the head lines that hold just above and just below it, if any."""

    course: np.ndarray
    above: str | None
    below: str | None

    def at(self, x: float) -> float:
        """Return the elevation (m) of the line; NaN beyond its ends."""
        inside = self.course[0, 0] <= x <= self.course[-1, 0]
        return float(np.interp(x, *self.course.T)) if inside else np.nan


@dataclass(frozen=True, eq=False)
class Waternet:
    """Holds the water of a stage.

    Attributes
    ----------
    unit_weight : unit weight of water (kN/m³)
    heads (n, 2) : head lines (m) by their names
    phreatic : name of the head line that is the phreatic line, if there is one
    lines : reference lines
    ground (n, 2) : ground surface (m)
    """

    unit_weight: float
    heads: Mapping[str, np.ndarray]
    phreatic: str | None
    lines: Sequence[ReferenceLine]
    ground: np.ndarray

    @classmethod
    def read(cls, content: Json, ground: np.ndarray) -> Self:
        """Return the waternet of a document of a model with a ``ground`` surface (n, 2) in m."""
        heads = {line["Id"]: _without_steps(line_of(xz(line["Points"]))) for line in content["HeadLines"]}
        phreatic = content["PhreaticLineId"] if content["PhreaticLineId"] in heads else None
        lines = [
            ReferenceLine(line_of(xz(line["Points"])), line["TopHeadLineId"], line["BottomHeadLineId"])
            for line in content["ReferenceLines"]
        ]
        return cls(float(content["UnitWeightWater"]), heads, phreatic, lines, ground)

    @property
    def table(self) -> np.ndarray | None:
        """Return the phreatic line (n, 2) in m, if there is one."""
        return None if self.phreatic is None else self.heads[self.phreatic]

    @cached_property
    def wet_ground(self) -> ReferenceLine:
        """Return the line below which the ground is wet, the phreatic line or the ground where it is under water, as a
        line with the phreatic level below it."""
        line = lower_line(self.heads[str(self.phreatic)], self.ground)
        return ReferenceLine(line, self.phreatic, self.phreatic)

    def keys_of(self, points: np.ndarray) -> tuple[list[WaterPart], list[str]]:
        """Return the parts of a layer with an outline (n, 2) between reference lines, from the top down, each with the
        keys of its pore pressure, and notices on pressure that they do not give."""
        if self.table is None:
            return [WaterPart({}, None)], []
        cuts = self._lines_within(points)
        places = [np.array([x, z + side]) for _, z, x in cuts for side in (READING_DISTANCE, -READING_DISTANCE)] or [
            middle_of(points)
        ]
        keys = [self._keys_at(point, points) for point in (*places[::2], places[-1])][-len(cuts) - 1 :]
        bottoms = [*(line.course.tolist() for line, _, _ in cuts), None]
        parts = [
            WaterPart(keys[k], bottom) for k, bottom in enumerate(bottoms) if bottom is None or keys[k] != keys[k + 1]
        ]
        middle = middle_of(points)
        return parts, self._not_given(parts, middle + (1.0 - INSIDE) * (points - middle))

    def _lines_within(self, points: np.ndarray) -> list[tuple[ReferenceLine, float, float]]:
        """Return the reference lines that pass through a layer with an outline (n, 2), from the top down, each with its
        elevation (m) at the x where it is farthest from the edges of the layer, and this x."""
        within = []
        for line in self.lines:
            left = max(line.course[0, 0], points[:, 0].min())
            right = min(line.course[-1, 0], points[:, 0].max())
            if left >= right or (line.above is None and line.below is None):
                continue
            x = middles(left, right, COLUMNS)
            z = np.interp(x, *line.course.T)
            edges = [edges_at(points, place) for place in x]
            room = [min(at - low, high - at) for at, (low, high) in zip(z, edges, strict=True)]
            best = int(np.argmax(room))
            if room[best] > LEAST_ROOM:
                within.append((line, float(z[best]), float(x[best])))
        return sorted(within, key=lambda cut: -cut[1])

    def _keys_at(self, point: np.ndarray, points: np.ndarray) -> dict[str, Any]:
        """Return the keys of the pore pressure around a point (2,) of a layer with an outline (n, 2)."""
        above, below = self._around(point)
        if above is self.wet_ground:
            above = self._phreatic_line_above(points)
        upper, under = above.below, None if below is None else below.above
        keys: dict[str, Any] = {}
        if under is not None and below is not None and under != upper:
            keys["vertical_flow"] = {
                "upper_level": self.heads[str(upper)].tolist(), "lower_level": self.heads[under].tolist(),
                "top": self._to_the_sides(above).tolist(), "bottom": below.course.tolist(),
            }  # fmt: skip
        elif upper != self.phreatic:
            keys["piezometric_level"] = self.heads[str(upper)].tolist()
        return keys

    def _around(self, point: np.ndarray) -> tuple[ReferenceLine, ReferenceLine | None]:
        """Return the line above a point (2,), by default the phreatic line, and the line below it, if there is one."""
        x, z = point.tolist()
        over = [line for line in self.lines if line.below is not None and line.at(x) >= z]
        under = [line for line in self.lines if line.above is not None and line.at(x) < z]
        above = min(over, key=lambda line: line.at(x), default=self.wet_ground)
        return above, max(under, key=lambda line: line.at(x), default=None)

    def _levels(self, keys: Mapping[str, Any], places: np.ndarray) -> np.ndarray:
        """Return the piezometric levels (n,) in m at places (n, 2) in a stratum with ``keys``."""
        if flow := keys.get("vertical_flow"):
            head = LinearHead(*(np.array(flow[key]) for key in ("upper_level", "lower_level", "top", "bottom")))
            return head.at(places, places)
        level = np.array(keys.get("piezometric_level", self.table))
        return np.asarray(np.interp(places[:, 0], *level.T))

    def _phreatic_line_above(self, points: np.ndarray) -> ReferenceLine:
        """Return the lowest reference line over a part of a layer with an outline (n, 2) below which the level is the
        phreatic one, by default the top of the wet ground."""
        candidates = []
        for line in self.lines:
            left = max(line.course[0, 0], points[:, 0].min())
            right = min(line.course[-1, 0], points[:, 0].max())
            if line.below == self.phreatic and left < right:
                x, z = middle_of(points, 0.5 * (left + right))
                candidates += [(line.at(x) - z, line)] if line.at(x) >= z else []
        return min(candidates, key=lambda pair: pair[0], default=(0.0, self.wet_ground))[1]

    def _to_the_sides(self, line: ReferenceLine) -> np.ndarray:
        """Return the course (n, 2) in m of a line below which the level is the phreatic one, and of the wet ground
        beyond its ends; any other line continues level."""
        if line.below != self.phreatic or line is self.wet_ground:
            return line.course
        wet, (left, right) = self.wet_ground.course, line.course[[0, -1], 0]
        parts = [line.course]
        for side, end in ((wet[:, 0] < left, left), (wet[:, 0] > right, right)):
            if side.any():
                joined = np.array([[end, float(np.interp(end, *wet.T))]])
                parts = [wet[side], joined, *parts] if end == left else [*parts, joined, wet[side]]
        return without_repeats(np.vstack(parts))

    def _head(self, point: np.ndarray) -> float:
        """Return the pressure head (m) at a point (2,)."""
        x, z = point.tolist()
        above, below = self._around(point)
        upper = float(np.interp(x, *self.heads[str(above.below)].T)) - above.at(x)
        if below is None or below.at(x) >= above.at(x):
            return max(upper + above.at(x) - z, 0.0)
        lower = float(np.interp(x, *self.heads[str(below.above)].T)) - below.at(x)
        return max(upper + (lower - upper) * (above.at(x) - z) / (above.at(x) - below.at(x)), 0.0)

    def _not_given(self, parts: Sequence[WaterPart], places: np.ndarray) -> list[str]:
        """Return a notice if the ``parts`` of a layer have another pore pressure at places (n, 2) of the layer."""
        off = np.zeros(len(places))
        done = np.zeros(len(places), dtype=bool)
        for part in parts:
            inside = ~done
            if part.bottom is not None:
                inside &= places[:, 1] >= np.interp(places[:, 0], *np.array(part.bottom).T)
            at = places[inside]
            off[inside] = np.maximum(self._levels(part.keys, at) - at[:, 1], 0.0) - [self._head(place) for place in at]
            done |= inside
        most = float(off[np.argmax(np.abs(off))])
        if abs(most) <= NOTABLE_HEAD:
            return []
        more = "more" if most > 0.0 else "less"
        text = (
            f"not read: a reference line within the layer; at its edge the pore pressure has up to {abs(most):.2g} m "
        )
        return [f"{text}{more} head than in the model"]


def xz(points: Sequence[Json]) -> list[tuple[float, float]]:
    """Return the coordinates of points of a document."""
    return [(point["X"], point["Z"]) for point in points]


def _without_steps(line: np.ndarray) -> np.ndarray:
    """Return a line (n, 2) in m whose vertical steps are steep slopes, since water in the ground has no steps."""
    moved = line.copy()
    for i in np.flatnonzero(np.diff(line[:, 0]) == 0.0):
        room = line[i + 2, 0] - line[i, 0] if i + 2 < len(line) else np.inf
        moved[i + 1, 0] += min(STEP_WIDTH, 0.5 * room)
    return moved


def middle_of(outline: np.ndarray, x: float | None = None) -> np.ndarray:
    """Return a point (2,) in a layer with an outline (n, 2), half-way between its edges at ``x``, by default at the
    middle of its width (m)."""
    x = float(0.5 * (outline[:, 0].min() + outline[:, 0].max())) + 1e-6 if x is None else x
    return np.array([x, 0.5 * sum(edges_at(outline, x))])


def edges_at(outline: np.ndarray, x: float) -> tuple[float, float]:
    """Return the lower edge of a layer with an outline (n, 2) at ``x``, and the edge above it (m)."""
    start, end = outline, np.roll(outline, -1, axis=0)
    cut = (start[:, 0] < x) != (end[:, 0] < x)
    share = (x - start[cut, 0]) / (end[cut, 0] - start[cut, 0])
    z = np.sort(start[cut, 1] + share * (end[cut, 1] - start[cut, 1]))
    return float(z[0]), float(z[1])
