"""Computes the cohesion at any point of a section: constant, growing with depth below a line, or growing with the
effective stress.

c = max(c_min, c0 + k max(0, z_from - z) + S σ'v OCR^m), where the last term is SHANSEP (Ladd & Foott 1974), or a table
of strengths over σ'v in its place. OCR = σ'p / σ'v is a number, or follows from a pre-overburden pressure: σ'p = σ'v +
POP. σ'v is the vertical effective stress before shaking to which the ground has consolidated: the weight of the ground
above, of the water on it and of the consolidated share of surcharges, not spread with depth, less the pore pressure. If
the table [consolidation] gives another state, σ'p follows from the stress σ'vc of that state, OCR σ'vc or σ'vc + POP,
and is at least σ'v. Points are (n, 2), x and elevation in m. Each has its stratum, and a neighbouring point ``near``
it, which decides on which side of a step of the ground or of a surcharge the point lies. Cohesions are in Pa.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np

from meshes.section.consolidation import ConsolidatedState, Consolidation
from meshes.section.layering import middles
from meshes.section.polyline import Line, crossings, level_at
from meshes.section.stratum import Stratum
from meshes.section.strength_table import linear_strength, table_strength
from meshes.section.surcharge import SurfaceLoads
from meshes.section.water_pressure import ON_GROUND, WaterPressure

ROUNDING = 1e-9
COLUMNS = 400  # vertical lines over which a cohesion is averaged
NO_STRENGTH = 1.0  # Pa: a cohesion of less is none
SHALLOW = 1e-3  # of a thickness: depth below the top of a layer at which its inside is evaluated


@dataclass(frozen=True, eq=False)
class CohesionField:
    """Gives the cohesion of the strata of a section at any point.

    Attributes
    ----------
    loads : the surcharges and the water of the section, with its layers and strata
    starts (n, 2) : the line (m) for each stratum below which its cohesion grows with depth
    consolidated (n, 2) : for each stratum the line (m) above which the ground has not consolidated the stratum; None if
        all ground above has
    state : the state to which the ground consolidated, if it is not the present one
    """

    loads: SurfaceLoads
    starts: tuple[np.ndarray | None, ...]
    consolidated: tuple[np.ndarray | None, ...]
    state: ConsolidatedState | None = None

    @classmethod
    def of(
        cls, loads: SurfaceLoads, elevations_of: Callable[[Line], np.ndarray], state: Consolidation | None = None
    ) -> Self:
        """Return the cohesions of the strata below ``loads``; ``elevations_of`` gives a line as (n, 2) from side to
        side (m). ``state``: the table [consolidation], if there is one."""

        def lines(key: str) -> tuple[np.ndarray | None, ...]:
            lines_of_strata = [getattr(soil, key) for soil in loads.water.strata]
            return tuple(None if line is None else elevations_of(line) for line in lines_of_strata)

        before = None if state is None else ConsolidatedState.of(loads.water, state, elevations_of)
        return cls(loads, lines("cohesion_from"), lines("consolidated_below"), before)

    @property
    def water(self) -> WaterPressure:
        """Return the water of the section, with its layers and strata."""
        return self.loads.water

    def effective_stress(
        self,
        points: np.ndarray,
        near: np.ndarray,
        stratum: np.ndarray,
        top: np.ndarray | None = None,
        pressure: np.ndarray | None = None,
    ) -> np.ndarray:
        """Return the vertical effective stress (n,) in Pa to which the ground has consolidated. Strength ratios are
        multiplied by this stress. Ground above the line ``top`` (k, 2) does not count. ``pressure`` (n,) in Pa: see
        ``WaterPressure.vertical_effective``. ``points``, ``near`` (n, 2) in m, ``stratum`` (n,): as in
        ``WaterPressure.at_rest``.
        """
        load = self.loads.consolidated(points[:, 0], near[:, 0])
        return self.water.vertical_effective(points, near, stratum, top, load, pressure)

    def consolidation_stress(self, points: np.ndarray, near: np.ndarray, stratum: np.ndarray, k: int) -> np.ndarray:
        """Return the vertical effective stress σ'vc (n,) in Pa to which OCR and POP of stratum ``k`` refer, by the
        table [consolidation] if there is one. ``points``, ``near``, ``stratum``: as in ``effective_stress``."""
        if self.state is None:
            return self.effective_stress(points, near, stratum, self.consolidated[k])
        return self.state.at(
            points, near, stratum, self.consolidated[k], self.loads.consolidated(points[:, 0], near[:, 0])
        )

    def mean_effective_stress(self, stratum: int) -> float:
        """Return the mean of the vertical effective stress (Pa) over the area of a stratum; 0 for a stratum without
        area."""
        thick, middle = self._columns(stratum)
        stress = self.effective_stress(middle, middle, np.full(len(middle), stratum))
        return float(np.average(stress, weights=thick)) if len(middle) else 0.0

    @cached_property
    def _verticals(self) -> tuple[np.ndarray, np.ndarray]:
        """Return x (m) of vertical lines over the section, and the elevations (n, k + 1) of its interfaces on them."""
        layers = self.water.layers
        x = middles(layers.x[0], layers.x[-1], COLUMNS)
        return x, layers.interfaces(x)

    def _columns(self, stratum: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the thickness (m) and middle (n, 2) of a stratum on the vertical lines that cross it."""
        x, levels = self._verticals
        top, bottom = levels[:, stratum : stratum + 2].T
        present = top > bottom
        return (top - bottom)[present], np.column_stack([x, 0.5 * (top + bottom)])[present]

    @property
    def notices(self) -> list[tuple[int, str]]:
        """Return notices on strengths that vary, as pairs of the number of the stratum and a sentence."""
        varying = [(int(k), "the cohesion varies; discs have its mean throughout") for k in np.flatnonzero(self.varies)]
        of_strata = (self._without_strength, self._with_friction)
        return varying + [(k, words) for k, _ in varying for phrase in of_strata if (words := phrase(k))]

    def _with_friction(self, stratum: int) -> str:
        """Return a phrase on undrained strength by stress in ground that has a friction angle as well; empty without
        one of them."""
        soil = self.water.strata[stratum]
        if not soil.by_stress or not soil.friction_angle:
            return ""
        key = "strength_ratio" if soil.strength_ratio else "strength_table"
        return (
            f"its friction angle of {math.degrees(soil.friction_angle):.3g} deg adds drained strength to the undrained "
            f'strength of its {key}; expected friction_angle = "0 deg" unless both are meant'
        )

    def _without_strength(self, stratum: int) -> str:
        """Return a phrase on ground without friction whose strength is zero at its top; empty if it has some strength
        there."""
        soil, layers = self.water.strata[stratum], self.water.layers
        if not soil.by_stress or soil.friction_angle > 0.0 or soil.pre_overburden_pressure is not None:
            return ""
        x, levels = self._verticals
        ground, top, bottom = levels[:, [0, stratum, stratum + 1]].T
        points, near = np.column_stack([x, top]), np.column_stack([x, top - SHALLOW * (top - bottom)])
        none = (top > bottom) & (self.at(points, near, np.full(len(x), stratum)) < NO_STRENGTH)
        below = none & (ground > top + layers.tolerance)
        if not none.any():
            return ""
        where, what = (below, "its top, below other ground,") if below.any() else (none, "the ground")
        return (
            f"the strength of the stratum is zero at {what} {_stretches(x, where)}, and the stratum slips there first; "
            "give cohesion_minimum, pre_overburden_pressure or a crust if it has more"
        )

    @cached_property
    def varies(self) -> np.ndarray:
        """Return a mask (k,) of the strata whose cohesion is not constant."""
        return np.array([soil.cohesion_varies for soil in self.water.strata])

    @cached_property
    def kinks(self) -> np.ndarray:
        """Return the x (n,) in m between which pore pressures, and cohesions except for their least values, follow one
        linear rule in every stratum."""
        if not self.varies.any():
            return self.water.kinks
        tops = [line for line in (*self.consolidated, *(self.state.lines if self.state else ())) if line is not None]
        lines = [self.water.kinks, *(line[:, 0] for line in (*self.starts, *tops) if line is not None)]
        passes = [self._passes(line) for line in tops]
        return self.water.layers.places_between(np.concatenate([self.water.layers.x, *lines, *passes]))

    def _passes(self, line: np.ndarray) -> np.ndarray:
        """Return the x (n,) in m where a line, above which ground does not count, crosses the ground surface, a layer
        or the water."""
        layers = self.water.layers
        tables = [table for table in (self.water.table_before, self.water.table_after) if table is not None]
        x = np.unique(np.concatenate([layers.x, line[:, 0], *(table[:, 0] for table in tables)]))
        x = x[(x >= layers.x[0]) & (x <= layers.x[-1])]
        middle, gaps = 0.5 * (x[1:] + x[:-1]), []
        for end in (x[:-1], x[1:]):
            others = layers.interfaces(end, near=middle)
            others = np.column_stack([others, *(level_at(table, end, middle) for table in tables)])
            gaps.append(level_at(line, end, middle)[:, None] - others)
        least = ON_GROUND * layers.tolerance
        return np.concatenate([crossings(x, *pair, least) for pair in zip(gaps[0].T, gaps[1].T, strict=True)])

    def at(self, points: np.ndarray, near: np.ndarray, stratum: np.ndarray) -> np.ndarray:
        """Return the cohesion (n,) in Pa at points."""

        def exact(soil: Stratum, depth: np.ndarray, stress: np.ndarray, base: np.ndarray | None) -> np.ndarray:
            return np.maximum(_grown(soil, depth, stress, base), soil.cohesion_minimum or 0.0)

        return self._of_strata(exact, points, near, stratum)

    def growing(self, points: np.ndarray, near: np.ndarray, stratum: np.ndarray) -> np.ndarray:
        """Return the cohesion (n,) at points without the least value of their strata."""
        return self._of_strata(_grown, points, near, stratum)

    def corners(self, corners: np.ndarray, stratum: np.ndarray, above: bool) -> np.ndarray:
        """Return cohesions (m, 3) at the ``corners`` (m, 3, 2) of triangles. The linear cohesion between the corners is
        nowhere above the true cohesion (`at`), or nowhere below it if ``above``.

        In a triangle, depth and stress are linear, since in the bounds the pore pressure is linear between corners,
        also where water flows. A convex function of depth and stress (growth below a line, a least value) lies below
        its chord and above its tangent; a concave one (σ'v to a power below 1) lies above its chord and below its
        tangent. The stress σ'vc of another state is replaced by a linear one (`_linear_base`).
        """

        def linear(soil: Stratum, depth: np.ndarray, stress: np.ndarray, base: np.ndarray | None) -> np.ndarray:
            depth, (stress, middle) = depth.reshape(-1, 4)[:, :3], np.split(stress.reshape(-1, 4), [3], axis=1)
            base = None if base is None else _linear_base(base.reshape(-1, 4), above)
            least = soil.cohesion_minimum or 0.0
            # A stress that water has brought down to zero in a part of the triangle is not linear there.
            is_linear = middle >= (1.0 - ROUNDING) * stress.mean(axis=1, keepdims=True)
            if above:
                grown = np.maximum(depth, 0.0)
                ratio = _tangent(soil, stress, base)
            else:
                grown = np.where(depth.mean(axis=1, keepdims=True) > 0.0, depth, 0.0)
                ratio = np.where(is_linear, _chord(soil, stress, base), 0.0)
            if soil.strength_table is not None:
                linear_stress = stress if above else np.where(is_linear, stress, 0.0)
                ratio = ratio + linear_strength(soil.strength_table, linear_stress, above)
            total = soil.cohesion + soil.cohesion_increase * grown + ratio
            if above:
                cohesion = np.maximum(total, least)
            else:
                # Where the strength begins at a corner, rounding leaves it a little below zero.
                small = (total.mean(axis=1) < least) | (total.min(axis=1) < -ROUNDING * total.max(axis=1))
                cohesion = np.where(small[:, None], least, np.maximum(total, 0.0))
            return np.column_stack([cohesion, cohesion.mean(axis=1)]).ravel()

        middle = corners.mean(axis=1, keepdims=True)
        points, near = np.concatenate([corners, middle], axis=1).reshape(-1, 2), np.repeat(middle[:, 0], 4, axis=0)
        stratum = np.repeat(stratum, 4)
        pressure = self.water.static(points, near, stratum).reshape(-1, 4)
        pressure[:, 3] = pressure[:, :3].mean(axis=1)
        for k, line in enumerate(self.consolidated):  # the water above it is linear between corners as well
            if line is not None and self.water.flow is not None and (stratum == k).any():
                load = self.water.seepage_at(line, points, near).reshape(-1, 4)
                of_stratum = stratum[::4] == k
                pressure[of_stratum, 3] += (load[:, 3] - load[:, :3].mean(axis=1))[of_stratum]
        return self._of_strata(linear, points, near, stratum, pressure.ravel()).reshape(-1, 4)[:, :3]

    def means(self) -> tuple[Stratum, ...]:
        """Return the strata with one cohesion each. A varying cohesion is replaced by its mean over the area of the
        stratum."""
        if not self.varies.any():
            return self.water.strata
        strata = list(self.water.strata)
        for k in np.flatnonzero(self.varies):
            thick, middle = self._columns(k)
            cohesion = self.at(middle, middle, np.full(len(middle), k))
            mean = float(np.average(cohesion, weights=thick)) if len(middle) else strata[k].cohesion
            strata[k] = strata[k].with_cohesion(mean)
        return tuple(strata)

    def _of_strata(
        self,
        law: Callable[[Stratum, np.ndarray, np.ndarray, np.ndarray | None], np.ndarray],
        points: np.ndarray,
        near: np.ndarray,
        stratum: np.ndarray,
        pressure: np.ndarray | None = None,
    ) -> np.ndarray:
        """Return the values (n,) of a ``law`` at points (n, 2); the law takes the soil, depths (m) below its line,
        stresses σ'v (Pa), and the stresses σ'vc of another state to which the ground consolidated, if there is one."""
        cohesion = np.empty(len(points))
        for k in np.unique(stratum):
            in_stratum, soil = stratum == k, self.water.strata[k]
            cohesion[in_stratum] = soil.cohesion
            if not soil.cohesion_varies:
                continue
            place, nearby, start = points[in_stratum], near[in_stratum], self.starts[k]
            depth = np.zeros(len(place)) if start is None else level_at(start, place[:, 0], nearby[:, 0]) - place[:, 1]
            stress, base = np.zeros(len(place)), None
            if soil.by_stress:
                pore, owner = None if pressure is None else pressure[in_stratum], np.full(len(place), k)
                stress = self.effective_stress(place, nearby, owner, self.consolidated[k], pore)
                base = None if self.state is None else self.consolidation_stress(place, nearby, owner, int(k))
            cohesion[in_stratum] = law(soil, depth, stress, base)
        return cohesion


def _stretches(x: np.ndarray, where: np.ndarray) -> str:
    """Return in words the stretches of neighbouring places ``x`` (n,) in m that are marked by the mask ``where``."""
    marked = np.flatnonzero(where)
    parts = np.split(x[marked], np.flatnonzero(np.diff(marked) > 1) + 1)
    words = [f"from x = {part[0]:.3g} to {part[-1]:.3g} m" for part in parts]
    return " and ".join(filter(None, (", ".join(words[:-1]), words[-1])))


def _grown(soil: Stratum, depth: np.ndarray, stress: np.ndarray, base: np.ndarray | None) -> np.ndarray:
    """Return the cohesion (Pa), without its least value, at depths (m) below the line of the stratum and at vertical
    effective stresses (Pa), present ones and those of another state to which the ground consolidated."""
    table = 0.0 if soil.strength_table is None else table_strength(soil.strength_table, stress)
    return soil.cohesion + soil.cohesion_increase * np.maximum(depth, 0.0) + _shansep(soil, stress, base) + table


def _shansep(soil: Stratum, stress: np.ndarray, base: np.ndarray | None) -> np.ndarray:
    """Return S σ'v OCR^m (Pa) at vertical effective stresses (Pa), present ones and those of another state."""
    ratio, power = soil.strength_ratio or 0.0, soil.exponent
    if base is None and soil.pre_overburden_pressure is None:
        return np.asarray(ratio * (soil.ocr or 1.0) ** power * stress)
    return np.asarray(ratio * stress ** (1.0 - power) * np.maximum(_past(soil, stress, base), stress) ** power)


def _past(soil: Stratum, stress: np.ndarray, base: np.ndarray | None) -> np.ndarray:
    """Return the preconsolidation stress σ'p (Pa) of a soil, which is nowhere put up to the present stress."""
    base = stress if base is None else base
    if soil.pre_overburden_pressure is None:
        return np.asarray((soil.ocr or 1.0) * base)
    return np.asarray(base + soil.pre_overburden_pressure)


def _linear_base(base: np.ndarray, above: bool) -> np.ndarray:
    """Return stresses σ'vc (m, 3) at the corners of triangles between which a linear stress is nowhere above the true
    one, or nowhere below it if ``above``; ``base`` (m, 4) are the true stresses at the corners and in the middle.

    Where a water table crosses a triangle, σ'vc is concave in it, and nowhere above the plane through its corners by
    more than three times its excess in the middle. Where the ground surface does, σ'vc begins at zero and is convex.
    """
    corners, middle = np.split(base, [3], axis=1)
    excess = middle - corners.mean(axis=1, keepdims=True)
    if above:
        return np.asarray(corners + 3.0 * np.maximum(excess, 0.0))
    convex = excess < -ROUNDING * np.maximum(middle, 1.0)
    return np.where(convex, 0.0, corners)


def _chord(soil: Stratum, stress: np.ndarray, base: np.ndarray | None) -> np.ndarray:
    """Return values (m, 3) of S σ'v OCR^m (Pa) at the corners of triangles, between which a linear strength is nowhere
    above the true one: σ'p counts as σ'v only in triangles that are normally consolidated throughout."""
    if base is None:
        return _shansep(soil, stress, None)
    past = _past(soil, stress, base)
    past = np.where((stress >= past).all(axis=1, keepdims=True), stress, past)
    return np.asarray((soil.strength_ratio or 0.0) * stress ** (1.0 - soil.exponent) * past**soil.exponent)


def _tangent(soil: Stratum, stress: np.ndarray, base: np.ndarray | None) -> np.ndarray:
    """Return the tangent (m, 3) of S σ'v^(1-m) σ'p^m at the mean of the stresses (m, 3) of each triangle, at its
    corners, or S σ'v where that is more (Pa)."""
    if (base is None and soil.pre_overburden_pressure is None) or not soil.strength_ratio:
        return _shansep(soil, stress, None)
    past, power = _past(soil, stress, base), soil.exponent
    mean, past_mean = (values.mean(axis=1, keepdims=True) for values in (stress, past))
    value = soil.strength_ratio * mean ** (1.0 - power) * past_mean**power
    slopes = [value * share / np.maximum(at, 1e-12) for share, at in ((1.0 - power, mean), (power, past_mean))]
    tangent = value + slopes[0] * (stress - mean) + slopes[1] * (past - past_mean)
    return np.maximum(np.where(mean > 0.0, tangent, value), soil.strength_ratio * stress)
