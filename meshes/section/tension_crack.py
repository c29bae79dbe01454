"""Describes the table [tension_crack] of an input: vertical cracks down to a line, and the water in them.

Slip circles end at a crack that exists beforehand (Terzaghi 1943, art. 57). In elements, strict bounds and material
points, the ground above the line has no tensile strength, and cracks where a mechanism opens it (the truncated envelope
of Michalowski 2013, Géotechnique 63, 1187). The ground that shears beside an opening crack still resists, so that steep
slopes resist more than beside a crack that exists beforehand. The water in a crack that opens presses on its faces with
u: the total major stress is at most -u. This is a cut-off of the effective stress at zero with u as the pore pressure,
which in ground without friction has no other effect. In ground with friction the pore pressure would reduce the
strength, and is left out.
"""

from collections.abc import Callable, Iterator
from functools import partial
from typing import Annotated, Any, Self

import numpy as np
from pydantic import Field, PlainSerializer, PlainValidator, model_validator

from meshes.section.cutting import cut_at_cracks
from meshes.section.model import Model
from meshes.section.polyline import ElevationOrLine, Line, crossings, level_at, written
from meshes.section.quantity import HEIGHT
from meshes.section.section import Section
from meshes.section.stratum import PORE_PRESSURES

STEEP_SLOPE = 10.0  # rise over run
SLICE_SHARE = 0.1  # of their depth: width of the ground beside faces steeper than this that has no cracks
# Water runs out of cracks only where the ground beside them is lower by more than this share of their depth. A crest
# with a crossfall of 2 % would otherwise have a dry film along all of its length, which no mesh needs.
SPILL_SHARE = 0.05


def _read_water(value: Any) -> str | float:
    if isinstance(value, str) and value in ("dry", "full"):
        return value
    try:
        return HEIGHT.read(value)
    except ValueError:
        raise ValueError('expected "dry", "full", or the depth of the water in it, such as "1.5 m"') from None


class TensionCrack(Model):
    """Holds a tension crack, at whose bottom slip circles end.

    Above the bottom the ground has no tensile strength. The water in the crack presses on the sliding ground.
    """

    bottom: ElevationOrLine | None = Field(
        default=None,
        description=(
            "bottom of the cracks: { depth = 2.0 } below the ground (m), an elevation (m) or a line; "
            "there is no crack where it lies above the ground"
        ),
    )
    water: Annotated[str | float, PlainValidator(_read_water), PlainSerializer(written)] = Field(
        default="dry",
        description=(
            'water in the cracks: "dry", "full", or its depth, such as "1.5 m"; a crack that is less deep is full'
        ),
    )

    @model_validator(mode="after")
    def _has_bottom(self) -> Self:
        if self.bottom is None and self.water != "dry":
            raise ValueError(
                "water without bottom: expected the lower end of the cracks, such as bottom = { depth = 2.0 }"
            )
        return self

    def notices(self, section: Section) -> Iterator[str]:
        """Return how the methods treat tension cracks of a section, one sentence each."""
        if self.bottom is None:
            return
        if not self.depth(section, section.layering.x).any():
            yield "tension_crack, bottom: lies above all of the ground, so that there are no cracks"
            return
        yield (
            "tension_crack: slip circles end at cracks that exist before failure; in finite elements, strict bounds "
            "and material points the ground above the bottom of cracks has no tensile strength, and resists more "
            "where it shears while it opens; discs have no cracks"
        )
        yield from self._below_the_slope(section, self.bottom)
        torn = [s for s in section.strata if s.tension == 0.0 and s.has_cohesion]
        if self.water != "dry" and (any(s.friction_angle for s in torn) or section.water_pressure.flow is not None):
            yield (
                "tension_crack, water: in ground with a friction angle, and where water flows, water in cracks acts on "
                "slip circles only; in finite elements, strict bounds and material points cracks have the pore "
                "pressure of the ground"
            )

    def _below_the_slope(self, section: Section, bottom: Line) -> Iterator[str]:
        """Yield a sentence if a crack is deeper than the highest slope of the section, so that the toe of the slope
        lies above the bottom of the crack."""
        line = section.ground
        x = np.unique(np.concatenate([line[:, 0], section.elevations_of(bottom)[:, 0]]))
        depth, height = self.depth(section, x[(x >= line[0, 0]) & (x <= line[-1, 0])]), np.ptp(line[:, 1])
        if 0.0 < height < depth.max() * (1.0 - 1e-9):
            yield (
                f"tension_crack: cracks are {depth.max():.4g} m deep, and the ground rises by {height:.4g} m: they "
                "end below the toe; expected cracks shallower than the slope is high, mostly at most half of it"
            )

    @property
    def description(self) -> str:
        """Return a sentence on the cracks; empty if there are none."""
        if self.bottom is None:
            return ""
        words = {"dry": "dry", "full": "full of water"}
        filled = words[self.water] if isinstance(self.water, str) else f"with {self.water:g} m of water in them"
        return f"Slip circles end at tension cracks, {filled}."

    def depth(self, section: Section, x: np.ndarray) -> np.ndarray:
        """Return the depth (m) of a crack in the ground at every ``x`` (m), 0 if there is none."""
        if self.bottom is None:
            return np.zeros(np.shape(x))
        bottom = np.interp(x, *section.elevations_of(self.bottom).T)
        ground = section.layering.interface(0, np.ravel(x)).reshape(np.shape(x))
        return np.maximum(ground - bottom, 0.0)

    def water_depth(self, depth: np.ndarray) -> np.ndarray:
        """Return the depth (m) of the water in cracks of a ``depth`` (m)."""
        return depth if self.water == "full" else np.minimum(0.0 if self.water == "dry" else float(self.water), depth)

    def cut(self, section: Section) -> Section:
        """Return the section with strata divided at the bottom of the cracks. The parts above have no tensile strength
        and, if they have no friction, the pressure of the water in the cracks."""
        if self.bottom is None:
            return section
        bottom = _without_faces(section.elevations_of(self.bottom))
        bottom = _without_slices(bottom, section.ground)
        pressure = section.water_pressure
        filled = self.water != "dry" and pressure.flow is None

        def of_crack(k: int) -> dict[str, object]:
            stratum = section.strata[k]
            if not filled or stratum.friction_angle or stratum.pore_pressure_ratio:
                return {}
            ground_level = None if stratum.pore_pressure_ratio is not None else _level_in(section, k)
            level = self._water_level(section, bottom, ground_level)
            weight = {"density_saturated": stratum.density_ordinary}  # the water of cracks does not soak the ground
            apart = dict.fromkeys(PORE_PRESSURES)
            return {**apart, "piezometric_level": Line(elevation=level.tolist()), **weight}

        strata = cut_at_cracks(section.strata, section.layering, bottom, section.given_extent, of_crack)
        return section.with_strata(strata)

    def _water_level(self, section: Section, bottom: np.ndarray, ground_level: np.ndarray | None) -> np.ndarray:
        """Return the level (n, 2) of the water in cracks, or the level ``ground_level`` of the water in the ground
        where that is higher.

        Water in a crack stands no higher than the lowest ground within the depth of the deepest crack to either side,
        since it would run out there, unless that is lower by no more than ``SPILL_SHARE`` of this depth.
        """
        ground, depth = section.ground, float(self.depth(section, np.unique(bottom[:, 0])).max())
        bends = np.concatenate([ground[:, 0], bottom[:, 0], *([] if ground_level is None else [ground_level[:, 0]])])
        x = np.unique(np.concatenate([bends, ground[:, 0] - depth, ground[:, 0] + depth]))
        x = x[(x >= ground[0, 0]) & (x <= ground[-1, 0])]

        def of_crack(at: np.ndarray, middle: np.ndarray) -> np.ndarray:
            top, end = (level_at(line, at, middle) for line in (ground, bottom))
            deep = np.maximum(top - end, 0.0)
            neighbours = [level_at(ground, at + step, middle + step) for step in (-depth, depth)]
            lowest = np.where(np.abs(ground[:, 0] - middle[:, None]) < depth, ground[:, 1], np.inf).min(axis=1)
            outlet = np.minimum.reduce([*neighbours, lowest])
            level = np.where(top - outlet <= SPILL_SHARE * depth, top, outlet)
            return np.minimum(top - deep + self.water_depth(deep), level)

        def over_ground(at: np.ndarray, middle: np.ndarray) -> np.ndarray:
            in_crack = of_crack(at, middle)
            return in_crack if ground_level is None else in_crack - level_at(ground_level, at, middle)

        x = _with_crossings(x, over_ground)  # the higher of two levels bends where they cross
        middle = 0.5 * (x[1:] + x[:-1])
        ends = [of_crack(at, middle) for at in (x[:-1], x[1:])]
        if ground_level is not None:
            in_ground = [level_at(ground_level, at, middle) for at in (x[:-1], x[1:])]
            ends = [np.maximum(in_crack, table) for in_crack, table in zip(ends, in_ground, strict=True)]
        points = np.column_stack([np.repeat(x, 2)[1:-1], np.column_stack(ends).ravel()])
        return _without_steps(points)


def _with_crossings(x: np.ndarray, height: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> np.ndarray:
    """Return the breakpoints ``x`` (n,), and the places between them where a ``height`` is zero, such as that of one
    line over another. The height follows from places and, for each, the middle of its interval."""
    middle = 0.5 * (x[1:] + x[:-1])
    first, last = (height(at, middle) for at in (x[:-1], x[1:]))
    return np.unique(np.append(x, crossings(x, first, last)))


def _height_over(lower: np.ndarray, line: np.ndarray, at: np.ndarray, near: np.ndarray) -> np.ndarray:
    """Return the height (m) of one line (k, 2) over another line at places, on the sides of other places ``near``."""
    return np.asarray(level_at(line, at, near) - level_at(lower, at, near))


def _level_in(section: Section, k: int) -> np.ndarray | None:
    """Return the level (n, 2) of the water in the ground of stratum k, after a drawdown if there is one; None without
    water.

    Ground that does not drain keeps its pore pressure, less the load of the water that was removed from the ground
    above: its level falls by the depth of that water.
    """
    pressure, ground = section.water_pressure, section.ground
    level, after = pressure.levels[k], pressure.table_after
    if level is None or after is None or after is level or level is not pressure.table_before:
        return level
    if section.strata[k].drains:
        return after
    x = np.unique(np.concatenate([ground[:, 0], level[:, 0], after[:, 0]]))
    x = x[(x >= ground[0, 0]) & (x <= ground[-1, 0])]
    for line in (level, after):
        x = _with_crossings(x, partial(_height_over, ground, line))
    middle = 0.5 * (x[1:] + x[:-1])

    def lowered(at: np.ndarray) -> np.ndarray:
        top, before, now = (level_at(line, at, middle) for line in (ground, level, after))
        return before - np.maximum(before - top, 0.0) + np.maximum(now - top, 0.0)

    return np.column_stack([np.repeat(x, 2)[1:-1], np.column_stack([lowered(x[:-1]), lowered(x[1:])]).ravel()])


def _without_faces(line: np.ndarray) -> np.ndarray:
    """Return a line (n, 2) that steps, at the lower end, where it is steeper than ``STEEP_SLOPE``. Cracks beside a
    nearly vertical face reach down from the ground above the face, not from the face."""
    width, rise = np.diff(line, axis=0).T
    steep = upright_faces(line)
    steep = steep[width[steep] > 0.0]
    lower = steep + (rise[steep] < 0.0)
    new = np.column_stack([line[lower, 0], np.maximum(line[steep, 1], line[steep + 1, 1])])
    return np.insert(line, steep + 1, new, axis=0)


def upright_faces(line: np.ndarray) -> np.ndarray:
    """Return which stretches of a line are steeper than `STEEP_SLOPE`.

    Parameters
    ----------
    line (n, 2) : points of a line, such as the ground, from left to right (m)

    Returns
    -------
    Numbers (k,) of the stretches; stretch i lies between the points i and i + 1.
    """
    run, rise = np.diff(line, axis=0).T
    return np.flatnonzero(np.abs(rise) > STEEP_SLOPE * run)


def _without_slices(bottom: np.ndarray, ground: np.ndarray) -> np.ndarray:
    """Return the bottom (n, 2) of cracks without cracks beside faces of the ``ground`` that are steeper than
    ``STEEP_SLOPE``: there it lies on the ground.

    Ground without tensile strength breaks off an upright face in slices, and a slice of the width b and the height h
    topples at Kh = b/h, which is any Kh. ``SLICE_SHARE`` gives the width of intact ground.
    """
    for i in upright_faces(ground):
        falls = ground[i + 1, 1] < ground[i, 1]
        edge, foot = (ground[i], ground[i + 1]) if falls else (ground[i + 1], ground[i])
        inward = -1.0 if falls else 1.0
        [depth] = edge[1] - level_at(bottom, edge[:1], edge[:1] + inward)
        if depth <= 0.0:
            continue
        inner = edge[0] + inward * SLICE_SHARE * depth
        left, right = sorted((min(max(inner, ground[0, 0]), ground[-1, 0]), foot[0]))
        top = ground[(ground[:, 0] >= left) & (ground[:, 0] <= right), 1].max()
        x = np.array([left, right])
        ends = level_at(bottom, x, x + np.array([-1.0, 1.0]))
        step = np.array([[left, ends[0]], [left, top], [right, top], [right, ends[1]]])
        bottom = np.vstack([bottom[bottom[:, 0] < left], step, bottom[bottom[:, 0] > right]])
    return bottom


def _without_steps(level: np.ndarray) -> np.ndarray:
    """Return the highest level (k, 2) that is nowhere above ``level`` (n, 2) and nowhere steeper than ``STEEP_SLOPE``,
    since a level of water may not step."""
    rise = np.diff(level[:, 1])
    steep = upright_faces(level)
    foot = level[steep + (rise[steep] < 0.0), 0] + rise[steep] / STEEP_SLOPE
    x = np.unique(np.concatenate([level[:, 0], foot]))
    x = x[(x >= level[0, 0]) & (x <= level[-1, 0])]
    z = np.minimum.reduce([level_at(level, x, x + 1.0), level_at(level, x, x - 1.0)])
    return np.column_stack(
        [x, np.minimum(z, (level[:, 1] + STEEP_SLOPE * np.abs(x[:, None] - level[:, 0])).min(axis=1))]
    )
