"""Describes steady vertical flow through strata between two bodies of water of different level: a clay that lies under
a water table and over a confined aquifer.

The flow through a layer of one permeability loses the same head over every metre, so that the piezometric level h is
linear in the elevation z between the levels at both ends: h = h_top + (h_bottom - h_top) (z_top - z) / (z_top -
z_bottom). The pore pressure is u = γ_w (h - z), and 0 where this is negative (Verruijt 2001, Soil Mechanics, sec. 7;
D-Stability between two reference lines of a waternet). Above the top the level is h_top, below the bottom it is
h_bottom. Lines are (n, 2), x and elevation in m.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Self, TypeVar

import numpy as np
from pydantic import Field

from meshes.section.layering import Layering, elevations_below, layering
from meshes.section.model import Model
from meshes.section.polyline import ElevationOrLine, Line, Points, crossings, level_at, without_repeats

LINES = ("upper_level", "lower_level", "top", "bottom")
THINNEST = 1e-6  # m: the flow has a lower end of its own from this thickness on
Soil = TypeVar("Soil")


class VerticalFlow(Model):
    """Holds the piezometric levels at both ends of a vertical flow, and the lines at which they hold."""

    upper_level: ElevationOrLine | None = Field(
        default=None, description="piezometric level at the top of the flow, a line or an elevation (m); by default "
        "the water table"
    )  # fmt: skip
    lower_level: ElevationOrLine = Field(
        description="piezometric level at the bottom of the flow, such as that of a confined aquifer"
    )
    top: ElevationOrLine | None = Field(
        default=None, description="top of the flow, a line or an elevation (m); by default the top of the stratum"
    )
    bottom: ElevationOrLine | None = Field(
        default=None, description="bottom of the flow, a line or an elevation (m); by default that of the stratum"
    )

    def with_lines(self, **lines: Line | None) -> Self:
        """Return a copy with ``lines`` in place of those that are not given."""
        missing = {key: line for key, line in lines.items() if getattr(self, key) is None}
        return self.model_copy(update=missing)

    def after_drawdown(self, table: Line | None, lowered: Line | None) -> Self:
        """Return the steady flow after a drawdown of the water ``table``: its upper level is the ``lowered`` table if
        it was the table; a level of its own stays."""
        follows = lowered is not None and self.upper_level == table
        return self.model_copy(update={"upper_level": lowered}) if follows else self

    def as_elevations(self, ground: np.ndarray) -> Self:
        """Return a copy whose lines are elevations in place of depths below the ``ground`` (n, 2)."""
        lines = {key: getattr(self, key) for key in LINES}
        depths = {key: line for key, line in lines.items() if line is not None and line.depth is not None}
        return self.model_copy(
            update={key: Line(elevation=elevations_below(ground, line).tolist()) for key, line in depths.items()}
        )


def with_ends(surface: Points, base: Line, strata: Sequence[Soil], table: Line | None) -> tuple[Soil, ...]:
    """Return the strata, from the top down, whose vertical flow has all of its lines: the top and the bottom of the
    stratum, and the water ``table``, where the file gives none. ``surface``: points of the ground (m); ``base``: lower
    boundary of the lowest of the ``strata``."""
    flows = [getattr(stratum, "vertical_flow", None) for stratum in strata]
    if not any(flows):
        return tuple(strata)
    ground = np.array(surface, dtype=float)
    layers = layering(ground, base, [getattr(stratum, "bottom", None) for stratum in strata]).layering
    whole: list[Soil] = []
    for k, (stratum, flow) in enumerate(zip(strata, flows, strict=True)):
        if flow is not None:
            ends = {"top": _edge(layers, k), "bottom": _edge(layers, k + 1)}
            flow = flow.with_lines(upper_level=table, **ends).as_elevations(ground)
            stratum = stratum.model_copy(update={"vertical_flow": flow})  # type: ignore[attr-defined]
        whole.append(stratum)
    return tuple(whole)


def _edge(layers: Layering, k: int) -> Line:
    """Return interface k as a line."""
    z = np.column_stack([layers.left[:, k], layers.right[:, k]])
    points = np.column_stack([np.repeat(layers.x, 2)[1:-1], z.ravel()])
    return Line(elevation=without_repeats(points).tolist())


def heads_of(
    strata: Sequence[Soil], table: Line | None, lowered: Line | None, elevations_of: Callable[[Line], np.ndarray]
) -> "list[LinearHead | None]":
    """Return for each of the ``strata`` the levels of its vertical flow, after a drawdown of the ``table`` to
    ``lowered`` if the stratum drains; None without such flow. ``elevations_of`` gives a line as (n, 2) from side to
    side (m)."""
    flows: list[VerticalFlow | None] = [getattr(stratum, "vertical_flow", None) for stratum in strata]
    return [
        LinearHead.of(
            flow.after_drawdown(table, lowered) if flow is not None and getattr(stratum, "drains", False) else flow,
            elevations_of,
        )
        for stratum, flow in zip(strata, flows, strict=True)
    ]


@dataclass(frozen=True, eq=False)
class LinearHead:
    """Gives the piezometric level of a vertical flow at any point.

    Attributes
    ----------
    upper_level, lower_level (n, 2) : piezometric levels (m) at the top and at the bottom of the flow
    top, bottom (n, 2) : top and bottom of the flow (m)
    """

    upper_level: np.ndarray
    lower_level: np.ndarray
    top: np.ndarray
    bottom: np.ndarray

    @classmethod
    def of(cls, flow: VerticalFlow | None, elevations_of: Callable[[Line], np.ndarray]) -> Self | None:
        """Return the levels of a ``flow`` with all of its lines; ``elevations_of`` gives a line as (n, 2) from side to
        side (m)."""
        return None if flow is None else cls(*(elevations_of(getattr(flow, key)) for key in LINES))

    def at(self, points: np.ndarray, near: np.ndarray) -> np.ndarray:
        """Return the piezometric level (n,) in m at points (n, 2). A point ``near`` (n, 2) each point decides on which
        side of a step of a line the point lies."""
        upper, lower, top, bottom = (level_at(line, points[:, 0], near[:, 0]) for line in self._lines)
        share = np.clip((top - points[:, 1]) / np.maximum(top - bottom, THINNEST), 0.0, 1.0)
        return np.asarray(upper + share * (lower - upper))

    @property
    def _lines(self) -> tuple[np.ndarray, ...]:
        return self.upper_level, self.lower_level, self.top, self.bottom

    @cached_property
    def water_level(self) -> np.ndarray:
        """Return the line (k, 2) in m below which pores are full: the highest at which the pore pressure rises from 0.

        It is the upper level where that is above the top of the flow, as in ground under a water table, and the lower
        level where both levels lie below their ends. In between it lies in the flow, where h = z.
        """
        x = np.unique(np.concatenate([line[:, 0] for line in self._lines]))
        for level, end in ((self.upper_level, self.top), (self.lower_level, self.bottom)):
            middle = 0.5 * (x[1:] + x[:-1])
            first, last = (level_at(level, at, middle) - level_at(end, at, middle) for at in (x[:-1], x[1:]))
            x = np.union1d(x, crossings(x, first, last))
        middle = 0.5 * (x[1:] + x[:-1])
        sides = [self._zero(at, middle) for at in (x[:-1], x[1:])]
        return without_repeats(np.column_stack([np.repeat(x, 2)[1:-1], np.column_stack(sides).ravel()]))

    def _zero(self, at: np.ndarray, near: np.ndarray) -> np.ndarray:
        upper, lower, top, bottom = (level_at(line, at, near) for line in self._lines)
        over, under = upper - top, lower - bottom  # pressure heads at both ends (m)
        within = top - (top - bottom) * over / np.where(under > over, over - under, -1.0)
        return np.where(over >= 0.0, upper, np.where(under > 0.0, within, lower))
