"""Computes the pressure of water in the pores of a section and on its ground, the one field that all analyses use.

Total stress is σ = σ' - u (tension positive, u a pressure). So the total weight and -grad u (buoyancy and seepage
together) act on the skeleton, and on the ground surface u less the pressure of the water on the ground. Points are (n,
2), x and elevation in m; pressures are in Pa. The fields are linear between breakpoints within a stratum, and may jump
from one stratum to the next. So a point is given with its stratum, and with another point ``near`` it, such as the
middle of its cell, which decides on which side of a jump it lies.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from meshes.section.layering import Layering
from meshes.section.polyline import crossings, level_at
from meshes.section.quantity import GRAVITY
from meshes.section.seepage import Seepage
from meshes.section.stratum import Stratum
from meshes.section.vertical_flow import LinearHead

# A level this near to the ground, as a share of what makes two points one, does not go through it there.
ON_GROUND = 1e-3


@dataclass(frozen=True, eq=False)
class WaterPressure:
    """Computes pressures of the water of a section.

    Attributes
    ----------
    layers : the layers, cut at the water
    strata : the strata with their soils
    unit_weight : unit weight of water (N/m³)
    levels (n, 2) : level (m) to which water rises from each stratum before a drawdown
    table_before, table_after (n, 2) : water table on the ground before and after a drawdown; both are the same without
        a drawdown
    normal : whether the head is measured perpendicular to the flow: times cos² of the slope of the level
    moves : whether the inertia of water on the ground acts on the ground when it shakes
    heads (k,) : for each stratum the piezometric level of the vertical flow through it, after a drawdown if the stratum
        drains; None without such flow
    flow : steady seepage whose pore pressure replaces the hydrostatic pressure below levels
    after_shaking : whether the excess pore pressure by shaking is part of the pore pressure at rest
    """

    layers: Layering
    strata: tuple[Stratum, ...]
    unit_weight: float
    levels: tuple[np.ndarray | None, ...]
    heads: tuple[LinearHead | None, ...]
    table_before: np.ndarray | None
    table_after: np.ndarray | None
    normal: bool
    moves: bool
    flow: Seepage | None = None
    after_shaking: bool = False

    @cached_property
    def present(self) -> bool:
        """Return whether there is any pore pressure, or any water on the ground."""
        return self.still or self.rises_by_shaking

    @cached_property
    def rises_by_shaking(self) -> bool:
        """Return whether shaking raises the pore pressure in any stratum."""
        return any(s.excess_pore_pressure_ratio for s in self.strata)

    @cached_property
    def still(self) -> bool:
        """Return the water pressure without the excess pore pressure by shaking."""
        levels = any(level is not None for level in self.levels)
        return levels or self.table_after is not None or any(s.pore_pressure_ratio for s in self.strata)

    @property
    def saturation_levels(self) -> list[np.ndarray | None]:
        """Return the level (n, 2) below which each stratum is saturated, after a drawdown if the stratum drains; None
        for strata that are not divided."""
        undivided = [s.density_saturated is None and s.pore_pressure_ratio is not None for s in self.strata]
        drained = [level is self.table_before and s.drains for s, level in zip(self.strata, self.levels, strict=True)]
        return [
            None if is_undivided else self.table_after if is_drained else level
            for is_undivided, is_drained, level in zip(undivided, drained, self.levels, strict=True)
        ]

    def at_rest(self, points: np.ndarray, near: np.ndarray, stratum: np.ndarray) -> np.ndarray:
        """Return the pore pressure (n,) without a seismic force: the static one, or with the excess pore pressure that
        shaking left behind if the water is that ``after_shaking``."""
        pressure = self.static(points, near, stratum)
        return pressure + self._excess(points, near, stratum) if self.after_shaking else pressure

    def static(self, points: np.ndarray, near: np.ndarray, stratum: np.ndarray) -> np.ndarray:
        """Return the static pore pressure (n,), without any shaking."""
        pressure = np.zeros(len(points))
        for k in np.unique(stratum):
            in_stratum = stratum == k
            pressure[in_stratum] = self._of_stratum(int(k), points[in_stratum], near[in_stratum])
        return pressure

    def _of_stratum(self, k: int, points: np.ndarray, near: np.ndarray) -> np.ndarray:
        ratio, level = self.strata[k].pore_pressure_ratio, self.levels[k]
        if ratio is not None:
            return ratio * self.overburden(points, near) if ratio > 0.0 else np.zeros(len(points))
        if self.flow is not None:
            return self.unit_weight * self.flow.pressure_head(points, near)
        if (head := self.heads[k]) is not None:
            pressure = self.unit_weight * np.maximum(head.at(points, near) - points[:, 1], 0.0)
        elif level is None:
            return np.zeros(len(points))
        else:
            pressure = self.hydrostatic(level, points, near)
        if self._keeps_pressure(k):
            return np.maximum(pressure - self._taken_off(points, near), 0.0)
        if self._is_drawn_down(k) and head is None and self.table_after is not None:
            return self.hydrostatic(self.table_after, points, near)
        return pressure

    def _is_drawn_down(self, k: int) -> bool:
        """Return whether a drawdown changes the water of a stratum."""
        drawn_down = self.table_after is not None and self.table_after is not self.table_before
        return drawn_down and (self.heads[k] is not None or self.levels[k] is self.table_before)

    def _keeps_pressure(self, k: int) -> bool:
        """Return whether the pore pressure of a stratum falls in a drawdown only by the load of the water removed."""
        return self._is_drawn_down(k) and not self.strata[k].drains

    def excess(self, points: np.ndarray, near: np.ndarray, stratum: np.ndarray) -> np.ndarray:
        """Return the excess pore pressure (n,) by shaking that is not part of the pore pressure ``at_rest``: the excess
        ratio times the vertical effective stress before shaking.

        The vertical effective stress is the weight of the column of soil above, and of the water on it, less the pore
        pressure.
        """
        return np.zeros(len(points)) if self.after_shaking else self._excess(points, near, stratum)

    def _excess(self, points: np.ndarray, near: np.ndarray, stratum: np.ndarray) -> np.ndarray:
        ratio = np.array([s.excess_pore_pressure_ratio for s in self.strata])[stratum]
        if not ratio.any():
            return np.zeros(len(points))
        return ratio * self.vertical_effective(points, near, stratum)

    def vertical_effective(
        self,
        points: np.ndarray,
        near: np.ndarray,
        stratum: np.ndarray,
        top: np.ndarray | None = None,
        load: np.ndarray | float = 0.0,
        pressure: np.ndarray | None = None,
    ) -> np.ndarray:
        """Return the vertical effective stress (n,) without shaking, never negative. It is the weight of the soil
        above, of the water on it and of a ``load`` (n,) in Pa on the ground, less the static pore pressure, or less the
        ``pressure`` (n,) in Pa if that is given. Ground above the line ``top`` (k, 2) does not count. ``points``,
        ``near``, ``stratum``: as in ``at_rest``.
        """
        ground = self._top(points, near, top)
        if top is not None:
            lowered = self._top(near, near, top)[:, 1] < self._top(near, near)[:, 1] - self.layers.tolerance
            load = np.where(lowered, 0.0, load)
        free = 0.0 if self.table_after is None else self.hydrostatic(self.table_after, ground, near)
        if top is not None and self.flow is not None:
            free = self.seepage_at(top, points, near)
        elif top is not None and self.table_before is not None:
            # The pore pressure of ground that does not drain is that below the table before, less what was taken off.
            keeps = np.array([self._keeps_pressure(k) for k in range(len(self.strata))])[stratum]
            before = self.hydrostatic(self.table_before, ground, near) - self._taken_off(points, near)
            free = np.where(keeps, np.maximum(before, 0.0), free)
        total = self.overburden(points, near, top) + free + load
        pressure = self.static(points, near, stratum) if pressure is None else pressure
        return np.maximum(total - pressure, 0.0)

    def seepage_at(self, line: np.ndarray, points: np.ndarray, near: np.ndarray) -> np.ndarray:
        """Return the pressure (n,) of flowing water on a ``line`` (k, 2), or on the ground where it is lower, above or
        below points; zero where no water flows. ``points``, ``near``: as in ``at_rest``."""
        if self.flow is None:
            return np.zeros(len(points))
        return self.unit_weight * self.flow.pressure_head(self._top(points, near, line), near)

    def inside(self, points: np.ndarray, near: np.ndarray, stratum: np.ndarray, excess_pressure: bool) -> np.ndarray:
        """Return the pore pressure (n,), with the excess pore pressure by shaking if ``excess_pressure``.

        ``points``, ``near``, ``stratum``: as in ``at_rest``.
        """
        pressure = self.at_rest(points, near, stratum)
        return pressure + self.excess(points, near, stratum) if excess_pressure else pressure

    def slope(self, point: tuple[float, float], stratum: int, step: float, excess_pressure: bool) -> np.ndarray:
        """Return the slope (2,) of the pore pressure at a point, over a ``step`` (m) to either side of the point
        (Pa/m).

        ``stratum``: number of the stratum; ``excess_pressure``: whether to add the excess pore pressure by shaking.
        """
        around = np.array(point) + step * np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
        pressure = self.inside(around, np.array([point] * 4), np.array([stratum] * 4), excess_pressure)
        return (pressure[:2] - pressure[2:]) / (2.0 * step)

    @cached_property
    def kinks(self) -> np.ndarray:
        """Return the x (m), inside the section, between which all pressures just below the ground, and along any
        vertical line, follow one linear rule in every stratum.

        At these x water levels bend or cross the ground. If a pore pressure follows from the weight of the ground
        above, or a drawdown removes water from the ground, all breakpoints of the layers are among them. Where water
        flows, they include the ends of seepage faces and of free water, and walls that no water crosses.
        """
        levels = self.levels if self.flow is None else ()
        lines = [level for level in (*levels, self.table_before, self.table_after) if level is not None]
        ends, near = self.layers.x, self.layers.tolerance
        x = np.unique(np.concatenate([ends, *(line[:, 0] for line in lines)]))
        x = x[(x >= ends[0]) & (x <= ends[-1])]
        middle = 0.5 * (x[1:] + x[:-1])
        ground = [self.layers.interface(0, end, near=middle) for end in (x[:-1], x[1:])]
        kinks = [line[:, 0] for line in lines]
        for line in lines:
            first, last = (level_at(line, end, middle) - z for end, z in zip((x[:-1], x[1:]), ground, strict=True))
            kinks.append(crossings(x, first, last, ON_GROUND * near))
        kinks += [] if self.flow is None else [self.flow.marks]
        by_weight = any(s.pore_pressure_ratio or s.excess_pore_pressure_ratio or s.by_stress for s in self.strata)
        if by_weight or self.table_after is not self.table_before:
            kinks.append(ends)
        return self.layers.places_between(np.concatenate(kinks) if kinks else np.empty(0))

    def overburden(self, points: np.ndarray, near: np.ndarray, top: np.ndarray | None = None) -> np.ndarray:
        """Return the weight (n,) of the column of soil above each point, up to the line ``top`` (k, 2), per area
        (Pa)."""
        elevation = self.layers.interfaces(points[:, 0], near=near[:, 0])
        if top is not None:
            elevation = np.minimum(elevation, self._top(points, near, top)[:, 1:])
        thickness = elevation[:, :-1] - np.maximum(elevation[:, 1:], points[:, 1:])
        weight = GRAVITY * np.array([s.density_ordinary for s in self.strata])
        return np.maximum(thickness, 0.0) @ weight

    def on_ground(self, points: np.ndarray, near: np.ndarray) -> np.ndarray:
        """Return the pressure (n,) of the water that stands on the ground, at points of the ground."""
        if self.table_after is None:
            return np.zeros(len(points))
        return self.hydrostatic(self.table_after, points, near)

    @cached_property
    def deepest(self) -> float:
        """Return the largest depth (m) of water on the ground."""
        x = np.union1d(self.layers.x, [] if self.table_after is None else self.table_after[:, 0])
        near = 0.5 * (x[1:] + x[:-1])
        depths = [
            self.ponded(self.table_after, np.column_stack([end, end]), np.column_stack([near, near])) / self.unit_weight
            for end in (x[:-1], x[1:])
        ]
        return float(np.max(depths))

    def ponded(self, level: np.ndarray | None, points: np.ndarray, near: np.ndarray) -> np.ndarray:
        """Return the pressure (n,) of the water that stands on the ground above each point."""
        if level is None:
            return np.zeros(len(points))
        return self.hydrostatic(level, self._top(points, near), near)

    def _top(self, points: np.ndarray, near: np.ndarray, line: np.ndarray | None = None) -> np.ndarray:
        """Return the ground surface (n, 2) above points, or the ``line`` (k, 2) where the line is lower."""
        ground = self.layers.interface(0, points[:, 0], near=near[:, 0])
        if line is not None:
            ground = np.minimum(ground, level_at(line, points[:, 0], near[:, 0]))
        return np.column_stack([points[:, 0], ground])

    def _taken_off(self, points: np.ndarray, near: np.ndarray) -> np.ndarray:
        """Return the reduction of the pore pressure, by a drawdown, in ground that does not drain, which is the
        reduction of the water pressure on the ground above.

        The effective mean stress of saturated ground that cannot drain does not change (Skempton's B of 1), and the
        water above has the same effect on the stress on the ground and in it (Morgenstern 1963).
        """
        return self.ponded(self.table_before, points, near) - self.ponded(self.table_after, points, near)

    def hydrostatic(self, level: np.ndarray, points: np.ndarray, near: np.ndarray) -> np.ndarray:
        """Return the pressure (n,) below a water level (k, 2), by the rule in which its head is measured."""
        head = np.maximum(level_at(level, points[:, 0], near[:, 0]) - points[:, 1], 0.0)
        if self.normal:
            stretch = np.clip(np.searchsorted(level[:, 0], near[:, 0]) - 1, 0, len(level) - 2)
            width, rise = (level[stretch + 1] - level[stretch]).T
            head = head / (1.0 + (rise / width) ** 2)
        return self.unit_weight * head
