"""Describes loads on the ground, each a table [[surcharges]], vertical and per metre of horizontal distance."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Self

import numpy as np
from pydantic import ConfigDict, Field, PlainSerializer, PlainValidator, model_validator

from meshes.section.model import Model
from meshes.section.quantity import STRENGTH, Coordinate, Quantity
from meshes.section.sentences import coordinate
from meshes.section.water_pressure import WaterPressure


def _read_pressure(value: Any) -> tuple[Quantity, Quantity]:
    ends = value if isinstance(value, list | tuple) else (value, value)
    if len(ends) != 2:
        raise ValueError("expected one pressure, or two, at the left and the right end")
    first, last = (STRENGTH.read(end) for end in ends)
    return first, last


def _write_pressure(ends: tuple[Quantity, Quantity]) -> Any:
    first, last = (getattr(end, "written", end) for end in ends)
    return first if first == last else [first, last]


Pressures = Annotated[tuple[float, float], PlainValidator(_read_pressure), PlainSerializer(_write_pressure)]


class Surcharge(Model):
    """Holds a vertical load (Pa of horizontal area) on the ground, linear between its ends."""

    model_config = ConfigDict(populate_by_name=True)

    start: Coordinate = Field(alias="from", description="x of the left end of the load, such as 20.0")
    end: Coordinate = Field(alias="to", description="x of the right end of the load, such as 28.0")
    pressure: Pressures = Field(
        description='pressure of the load, such as "20 kPa", or a list of two pressures, one for each end'
    )
    seismic_share: float = Field(
        default=1.0,
        ge=0.0,
        le=1.0,
        description="the share of the mass of the load that shakes with the ground, from 0 to 1",
    )
    consolidated: float = Field(
        default=0.0,
        ge=0.0,
        le=1.0,
        description=(
            "the share of the load under which the ground has consolidated, from 0 (traffic, a new load) to 1 (a load "
            "of years); this share counts in the vertical effective stress by which strength ratios are multiplied"
        ),
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if not self.end > self.start:
            raise ValueError(f"from = {self.start:g} m, to = {self.end:g} m: expected the left end, then the right end")
        return self

    def at(self, x: np.ndarray, near: np.ndarray) -> np.ndarray:
        """Return the load (Pa) at x (n,), which are ends or inner points of a stretch whose middle is at ``near``
        (n,)."""
        share = (x - self.start) / (self.end - self.start)
        first, last = self.pressure
        return np.where((near > self.start) & (near < self.end), first + share * (last - first), 0.0)

    def below(self, x: float, depth: float) -> float:
        """Return the vertical stress (Pa) that the load adds at x (m), ``depth`` (m) below the level of the load.

        The load is a strip load on an elastic half-plane (Flamant's line load 2 p z³/(π r⁴), integrated; Poulos & Davis
        1974, section 3.1): Δσ = (p(x) [θ + sin θ cos θ] + p' z [sin² θ])/π between the angles θ to either end, measured
        from the vertical. Above the level of the load the stress is zero.
        """
        if depth <= 0.0:
            return 0.0
        first, last = self.pressure
        slope = (last - first) / (self.end - self.start)
        a, b = (np.arctan2(end - x, depth) for end in (self.start, self.end))
        even = b - a + 0.5 * (np.sin(2.0 * b) - np.sin(2.0 * a))
        uneven = np.sin(b) ** 2 - np.sin(a) ** 2
        return float(((first + slope * (x - self.start)) * even + slope * depth * uneven) / np.pi)


# Of the pressure of moving water on a wall, Westergaard 1933, Trans. ASCE 98, eq. 24 in its rounded form.
WESTERGAARD = 7.0 / 8.0
LEVEL_SLOPE = 0.02  # up to which ground is level, and moving water draws on it no more than on the bed of a river


@dataclass(frozen=True)
class SurfaceLoads:
    """Computes the tractions on the ground surface by loads other than static water.

    ``points`` (n, 2) in m lie on the ground surface, whose outward unit normal is ``normal`` (n, 2); ``near`` (n, 2)
    are points on the same straight stretch of the ground, such as the middle of an edge of a mesh. Tractions are (n, 2)
    in Pa.
    """

    surcharges: Sequence[Surcharge]
    water: WaterPressure

    @property
    def present(self) -> bool:
        """Return whether there is any load other than static water."""
        return bool(self.surcharges) or self.water.moves

    def dead(self, points: np.ndarray, near: np.ndarray, normal: np.ndarray) -> np.ndarray:
        """Return the weight of the surcharges, per horizontal area of the ground (Pa)."""
        load = self.pressure(points[:, 0], near[:, 0])
        return np.column_stack([np.zeros(len(points)), -load * np.abs(normal[:, 1])])

    def pressure(self, x: np.ndarray, near: np.ndarray) -> np.ndarray:
        """Return the surcharges (n,) in Pa of horizontal area at ``x`` (n,), on the stretch that contains ``near``
        (n,)."""
        return sum((s.at(x, near) for s in self.surcharges), np.zeros(len(x)))

    def vertical_effective(self, points: np.ndarray, stratum: np.ndarray) -> np.ndarray:
        """Return the vertical effective stress (n,) in Pa under all surcharges, at points (n, 2) in m inside the
        ground; ``stratum`` (n,): their strata."""
        load = self.pressure(points[:, 0], points[:, 0])
        return self.water.vertical_effective(points, points, stratum, load=load)

    def consolidated(self, x: np.ndarray, near: np.ndarray) -> np.ndarray:
        """Return the shares (n,) of the surcharges, in Pa, under which the ground has consolidated before shaking."""
        return sum((s.consolidated * s.at(x, near) for s in self.surcharges), np.zeros(len(x)))

    def seismic(self, sign: int, points: np.ndarray, near: np.ndarray, normal: np.ndarray) -> np.ndarray:
        """Return the tractions by Kh = 1; the inertia force on the ground acts to the right (``sign`` 1) or to the left
        (-1).

        Surcharges act with the share of their mass that shakes. Ground that moves away from water reduces the pressure
        of the water on it, and ground that moves towards water increases it, by 7/8 γw sqrt(H y) Kh on a wall at a
        depth y in water of depth H (Westergaard 1933). On an inclined face this pressure is multiplied by the
        horizontal component of the unit normal. ``points``, ``near`` (n, 2): points on the ground, and points inside
        the ground beside them (m); ``normal`` (n, 2): outward unit normal of the ground. Returns tractions (n, 2) in
        Pa.
        """
        load = sum((s.seismic_share * s.at(points[:, 0], near[:, 0]) for s in self.surcharges), np.zeros(len(points)))
        traction = np.column_stack([sign * load * np.abs(normal[:, 1]), np.zeros(len(points))])
        if self.water.moves:
            depth = self.water.on_ground(points, near) / self.water.unit_weight
            drawn = WESTERGAARD * self.water.unit_weight * np.sqrt(self.water.deepest * depth)
            traction = traction + (sign * drawn * normal[:, 0])[:, None] * normal
        return traction

    @property
    def notices(self) -> list[str]:
        """Return a notice on moving water that draws on ground without cohesion, and one on the ends of all surcharges
        on such ground, for every stratum."""
        places: dict[str, list[float]] = {}
        for _, x, name in self.bare_ends():
            places.setdefault(name, []).append(x)
        drawn = [self._drawn_notice()] if self.water.moves else []
        return [*filter(None, drawn)] + [
            f'surcharges: their ends at x = {", ".join(map(coordinate, sorted(set(ends))))} m lie on "{name}", '
            "which has no cohesion, and no bearing capacity next to bare ground; elements and bounds give the ground "
            "within fem.least_depth of these ends a cohesion of half of the pressure"
            for name, ends in places.items()
        ]

    def _drawn_notice(self) -> str:
        """Return a notice if moving water draws on inclined ground that has no cohesion, or ends on such ground; else
        an empty string.

        The pressure drawn from the ground, 7/8 γw sqrt(H y) Kh times the horizontal component of the normal, is
        tension at a surface without effective stress: bare sand there fails at any Kh, however strong the slope is.
        """
        layers, water = self.water.layers, self.water
        places: dict[str, list[float]] = {}
        for k in np.flatnonzero(np.abs(layers.right - layers.left)[:, 0] > LEVEL_SLOPE * layers.width):
            ends = np.array([[layers.x[k], layers.left[k, 0]], [layers.x[k + 1], layers.right[k, 0]]])
            wet = water.on_ground(ends, np.repeat(ends.mean(axis=0)[None], 2, axis=0)) > 0.0
            for place, levels in ((0, layers.left[k]), (1, layers.right[k])):
                top = int(np.argmax(levels[:-1] - levels[1:] > layers.tolerance))
                if wet[place] and not water.strata[top].has_cohesion:
                    places.setdefault(water.strata[top].name, []).append(float(ends[place, 0]))
        if not places:
            return ""
        where = "; ".join(
            f'"{name}" at x = {", ".join(map(coordinate, sorted(set(ends))))} m' for name, ends in places.items()
        )
        return (
            f"water, westergaard: moving water draws on inclined ground that meets ground without cohesion, {where}, a "
            "little of which fails at a small Kh before the slope does: give this ground a cohesion of some kPa within "
            "fem.least_depth of there, as a zone, or leave out westergaard"
        )

    def bare_ends(self) -> Iterator[tuple[int, float, str]]:
        """Return number, x (m) and stratum of every end of a surcharge with a pressure on ground without cohesion.

        Such sand has no bearing capacity next to bare ground, since the overburden term of its bearing capacity is zero
        there.
        """
        layers = self.water.layers
        for number, load in enumerate(self.surcharges, start=1):
            for x, pressure in zip((load.start, load.end), load.pressure, strict=True):
                if not (pressure > 0.0 and layers.x[0] < x < layers.x[-1]):
                    continue
                bounds = layers.interfaces(np.array([x]))[0]
                top = int(np.argmax(bounds[:-1] - bounds[1:] > layers.tolerance))
                overlapping = [
                    other for other in self.surcharges if other is not load and other.start <= x <= other.end
                ]
                if not self.water.strata[top].has_cohesion and not overlapping:
                    yield number, x, self.water.strata[top].name
