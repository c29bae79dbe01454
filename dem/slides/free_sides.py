"""Moves the free-field sides of a slide of discs. The ground continues beyond free-field sides, and its pressure at
rest acts on the sides.

Walls that do not move would hold a slope that continues beyond the section. Therefore the wall discs of a side move
horizontally, in strips two diameters high, above the lowest stratum that liquefies there. Each strip is a plate between
the ground in the section, which pushes with a force N, and the ground beyond, which pushes with its force at rest N_0
and takes waves away (Lysmer & Kuhlemeyer 1969, J. Eng. Mech. Div. ASCE 95, 859-877), relative to the motion v_f that it
has without the section (`meshes.section.free_field`). In each time interval `UPDATE_INTERVAL` the velocity v of a strip
increases by

    Δv = `RELIEF` ((N - N_0) / (ρ V_p h) - (v - v_f)),   N_0 = σ'_v h K_0,   K_0 = ν / (1 - ν).

Here h is the height of a strip and V_p the velocity of P-waves. The ground beyond bears no pull, and no more than its
passive pressure: v - v_f counts up to the value at which it would. In strata that liquefy K_0 is 1 from the beginning
(`before_liquefaction`), and the ground settles by the water that drains. The stress σ'_v is the vertical effective
stress of the section at the side, times the ratio of the weight of all discs to the weight of the section. Both sides
of level ground therefore carry the same force. The discs nearest to each side are heavier or lighter by a few per cent;
under such a difference liquefied ground would drift without end. Walls move by `WALL_DISTANCE` diameters at most, since
walls and floor end there (`dem.slides.thick_walls`). Positive velocities are outwards.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from dem.case import Case
from dem.ground import Ground
from dem.model import DiscModel
from dem.overburden import effective_overburden
from dem.search.deposit import RIM
from dem.slides.before_liquefaction import replace_contacts_of_sand
from dem.slides.drive import BaseMotion
from dem.slides.thick_walls import with_copies
from dem.slides.until_rest import come_to_rest
from dem.springs import wave_speeds
from meshes.section.free_field import FreeField
from meshes.section.section import Section, Stratum
from meshes.section.sides import interfaces_at

RELIEF = 0.5
STRIP_WIDTH, WALL_DISTANCE = 2.0, 9.0  # mean diameters
COPIES = 8  # of the walls, beyond them
POINTS = 20  # of a strip, over which stresses are averaged


@dataclass(eq=False)
class _Strip:
    """Holds a part of a wall that has one velocity.

    Attributes
    ----------
    side, outwards : "left" and -1, or "right" and 1
    wall (k,) : numbers of the discs of the wall
    at_rest, liquefied : force at rest, and force after all strata that liquefy have liquefied (N per metre out of
        plane)
    impedance : ρ V_p times height (N s/m per metre out of plane)
    points (n,) : elevations over which quantities of the strip are averaged (m)
    height : height of the strip (m)
    passive : largest force that the ground beyond bears (N per metre out of plane)
    """

    side: str
    outwards: int
    wall: np.ndarray
    at_rest: float
    liquefied: float
    impedance: float
    points: np.ndarray
    height: float
    passive: float = np.inf


class FreeSides:
    """Moves the walls of a slide whose ground continues beyond the sides.

    Parameters
    ----------
    start : discs at rest in a box
    ground : packing of the discs, and its place in a section
    strata : numbers of the strata that liquefy; a side at which none of them lies remains a wall that does not move
    drained : volumetric strain of these strata by drainage; None if they do not liquefy after all
    """

    def __init__(self, start: DiscModel, ground: Ground, strata: Sequence[int], drained: float | None = 0.0) -> None:
        self.drained = drained
        self.ground, self.places = ground, start.x.copy()
        self.diameter = 2.0 * ground.radius
        self.strips: list[_Strip] = []
        self.began = start.time
        self.beyond: list[tuple[np.ndarray, np.ndarray]] = []  # time and outward velocity of the ground beyond strips
        section = ground.section
        if section is None or start.period is not None or ground.tilt != 0.0:
            return
        self.heavier = _weight_ratio(start, ground, section)
        for side, outwards in (("left", -1), ("right", 1)):
            levels = interfaces_at(section, outwards > 0)
            wet = [k for k in strata if levels[k] - levels[k + 1] > section.layering.tolerance]
            if wet:
                self.strips += self._strips(start, side, outwards, levels, wet)
        self.beyond = [(np.zeros(1), np.zeros(1))] * len(self.strips)

    def _strips(
        self, start: DiscModel, side: str, outwards: int, levels: np.ndarray, wet: Sequence[int]
    ) -> list[_Strip]:
        """Return the strips of a side; levels: elevations of the interfaces at the side (m); wet: strata at the side
        that liquefy."""
        section, diameter = self.ground.section, self.diameter
        assert section is not None
        z, beyond = self.ground.to_local(start.x, start.z)[1], self._beyond(start, outwards)
        foot = min(levels[k + 1] for k in wet)
        count = max(1, round((levels[0] - foot) / (STRIP_WIDTH * diameter)))
        height, strips = (levels[0] - foot) / count, []
        for number in range(count):
            low = foot + number * height
            high = low + height if number < count - 1 else np.inf
            wall = np.flatnonzero(start.fixed & (z >= low) & (z < high) & (beyond > 0.0))
            if len(wall):
                middles = low + height * (np.arange(POINTS) + 0.5) / POINTS
                soils = np.clip(np.searchsorted(-levels, -middles) - 1, 0, len(section.strata) - 1)
                impedance = float(np.mean([_p_wave_impedance(section.strata[k]) for k in soils]))
                at_rest, after = height * self._pressures(outwards, levels, wet, middles, soils).mean(axis=1)
                strips.append(
                    _Strip(side, outwards, wall, float(at_rest), float(after), height * impedance, middles, height)
                )
        return strips

    def _pressures(
        self, outwards: int, levels: np.ndarray, wet: Sequence[int], z: np.ndarray, soils: np.ndarray
    ) -> np.ndarray:
        """Return the pressure at a side before its strata ``wet`` liquefy, and the pressure after they have liquefied
        and settled (2, n), in Pa.

        outwards, levels: as in `_strips`; z (n,): elevations (m); soils (n,): strata at these elevations.
        """
        section = self.ground.section
        assert section is not None
        at_side = np.full(len(z), section.extent[1 if outwards > 0 else 0])
        ratio = np.array([soil.poissons_ratio / (1.0 - soil.poissons_ratio) for soil in section.strata])[soils]
        if self.drained is not None:  # the pressure of liquefied ground is the same in all directions
            ratio[np.isin(soils, wet)] = 1.0
        at_rest, drained = ratio * _vertical_stress(section, at_side, z, soils), self.drained or 0.0
        # what lies at z after settlement was higher by the settlement of all that has liquefied below it
        thick = sum(np.clip(z - levels[k + 1], 0.0, levels[k] - levels[k + 1]) for k in wet)
        return self.heavier * np.array(
            [at_rest, ratio * _vertical_stress(section, at_side, z + drained * thick, soils)]
        )

    def with_thick_walls(self, start: DiscModel) -> DiscModel:
        """Return the discs of the start with thicker walls, which belong to the strips of these walls. Discs that have
        thick walls are returned unchanged."""
        width = RIM * self.ground.radius
        for strips in self._by_side().values():
            outwards = strips[0].outwards
            beyond, count = self._beyond(start, outwards), len(start)
            walls = np.flatnonzero(start.fixed & (beyond > 0.0))
            if beyond[walls].max() > 2.0 * width:
                continue
            start, source = with_copies(start, walls, outwards * width, COPIES)
            for strip in strips:
                strip.wall = np.concatenate([strip.wall, count + np.flatnonzero(np.isin(source, strip.wall))])
        self.places = start.x.copy()
        return start

    def follow_free_field(self, motion: BaseMotion, began: float, strata: Sequence[int], case: Case | None) -> None:
        """Compute the motion of the ground beyond the walls during a slide.

        motion: loading of the slide; began: time of the discs at its beginning (s); strata: numbers of the strata that
        liquefy; case: what remains after liquefaction, None if nothing liquefies.
        """
        section, felt = self.ground.section, motion.acceleration

        def shaking(time: np.ndarray) -> np.ndarray:
            return np.interp(began + time, felt.times, felt.x)

        self.began, self.beyond = began, []
        for side, strips in self._by_side().items():
            assert section is not None
            remains = {} if case is None else {k: case.remains_of(section, k) for k in strata}
            starts, stiffness = {k: motion.starts[k] for k in strata}, 1.0 if case is None else case.stiffness
            field = FreeField(section, side == "right", starts, remains, motion.onset, stiffness)
            moves = field.velocities(shaking, motion.end)
            for strip in strips:
                strip.passive = strip.height * self.heavier * float(field.passive_pressure(strip.points).mean())
            self.beyond += [(moves.times, strip.outwards * moves.mean(strip.points)) for strip in strips]

    def _by_side(self) -> dict[str, list[_Strip]]:
        sides = dict.fromkeys(strip.side for strip in self.strips)
        return {side: [strip for strip in self.strips if strip.side == side] for side in sides}

    def _beyond(self, model: DiscModel, outwards: int) -> np.ndarray:
        """Return the distance (n,) of the discs beyond a side (m), negative inside the section; outwards: -1 for the
        left side, 1 for the right one."""
        section = self.ground.section
        assert section is not None
        x = self.ground.to_local(model.x, model.z)[0]
        return outwards * (x - section.extent[1 if outwards > 0 else 0])

    def before_shaking(self, start: DiscModel, strata: Sequence[int], case: Case | None) -> DiscModel:
        """Return the discs at rest before the shaking.

        Sand that liquefies has the laws of liquefied ground then (`before_liquefaction`), and the walls bear the
        pressure of the ground. start: discs at rest in a box; strata: numbers of the strata that liquefy; case: what
        remains after liquefaction, None if nothing liquefies.
        """
        ready = start
        if case is not None and start.law == "soil":
            ready = replace_contacts_of_sand(start, self.ground, strata, case)
        if self.strips:
            return self.release(ready)
        if ready is not start:
            come_to_rest(ready)
        return ready

    def release(self, model: DiscModel) -> DiscModel:
        """Release the walls, so that they bear the earth pressure at rest, and return the discs when they are at rest
        again. Against walls that do not move, the discs of a packing press with more than the pressure at rest."""
        out = model.copy()
        self.open(out)
        come_to_rest(out, partial(self.follow, 0.0))
        self.places = out.x.copy()
        return out

    def open(self, model: DiscModel) -> None:
        """Move the rigid lines behind the walls outwards, where the walls cannot reach them."""
        lines = model.lines.copy()
        upright = np.abs(lines[:, 2]) > np.abs(lines[:, 3])
        for outwards in {strip.outwards for strip in self.strips}:
            lines[upright & (np.sign(lines[:, 2]) == -outwards), 0] += 2.0 * outwards * WALL_DISTANCE * self.diameter
        model.lines = lines

    def follow(self, share: float, model: DiscModel, force_x: np.ndarray) -> None:
        """Set the velocities of the walls.

        share: degree of liquefaction (0 to 1); model: the discs; force_x (n,): horizontal force on every disc from
        contacts, rigid lines and liquefied ground (N per metre).
        """
        vx = model.vx.copy()
        for strip, series in zip(self.strips, self.beyond, strict=True):
            free = float(np.interp(model.time - self.began, *series))
            wanted = strip.at_rest + share * (strip.liquefied - strip.at_rest)
            excess = strip.outwards * float(force_x[strip.wall].sum()) - wanted
            speed = strip.outwards * float(model.vx[strip.wall].mean())
            bears = np.array([-wanted, max(strip.passive - wanted, 0.0)]) / strip.impedance
            speed += RELIEF * (excess / strip.impedance - float(np.clip(speed - free, *bears)))
            moved = self._moved(model, strip)
            if abs(moved) >= WALL_DISTANCE * self.diameter and speed * moved > 0.0:
                speed = 0.0
            vx[strip.wall] = strip.outwards * speed
        model.vx, model.vx_half = vx, np.where(model.fixed, vx, model.vx_half)

    def stopped(self, model: DiscModel) -> set[str]:
        """Return the sides ("left", "right") that can move no further, or that are walls which do not move."""
        free = {strip.side for strip in self.strips}
        at_end = {strip.side for strip in self.strips if abs(self._moved(model, strip)) >= self._limit}
        return {"left", "right"} - free | at_end

    def left_through(self, model: DiscModel) -> str | None:
        """Return the side whose wall the ground has pushed outwards as far as it can move, None if there is none."""
        at_end = (strip.side for strip in self.strips if self._moved(model, strip) >= self._limit)
        return next(at_end, None)

    @property
    def _limit(self) -> float:
        """Return the displacement (m) from which a wall counts as one that can move no further."""
        return (WALL_DISTANCE - 0.1) * self.diameter

    def _moved(self, model: DiscModel, strip: _Strip) -> float:
        """Return the displacement (m) of the wall of a strip, outwards positive."""
        return strip.outwards * float((model.x - self.places)[strip.wall].mean())


def _vertical_stress(section: Section, x: np.ndarray, z: np.ndarray, strata: np.ndarray) -> np.ndarray:
    """Return the vertical effective stress (n,) of the section with its surcharges (Pa) at points of some strata."""
    left, right = section.extent
    tiny = 1e-9 * (right - left)
    points = np.column_stack([np.clip(x, left + tiny, right - tiny), z])
    return section.surface_loads.vertical_effective(points, strata)


def _weight_ratio(start: DiscModel, ground: Ground, section: Section) -> float:
    """Return the ratio of the overburden of all discs to the overburden of the section."""
    free = ~start.fixed
    x, z = ground.to_local(start.x[free], start.z[free])
    design = _vertical_stress(section, x, z, start.layer[free])
    return float(effective_overburden(start)[free].sum() / design.sum())


def _p_wave_impedance(soil: Stratum) -> float:
    """Return ρ V_p (Pa s/m) of a soil, with V_p of its skeleton."""
    return soil.density_seismic * wave_speeds(soil.youngs_modulus, soil.poissons_ratio, soil.density_seismic)[0]
