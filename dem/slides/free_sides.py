"""Moves the free-field sides of a slide of discs. The ground continues beyond them, and the pressure at rest acts on
them.

Walls that do not move would hold a slope that continues beyond the section: discs on S-13 moved by 1 m in the uphill
half of the section and not at all at its downhill end. So the wall discs above the lowest stratum that liquefies at a
side move horizontally, in strips two diameters high. The velocity of a strip is the mean velocity v of the discs near
the side, increased where the ground pushes against the wall with a larger force N than the force at rest N_0:

    v_wall = v + RELIEF (D / EVERY) (N - N_0) / (M h),   N_0 = σ'_v h K_0,   K_0 = ν / (1 - ν),

Here h is the height of a strip, D the mean diameter, M = ρ V_p² the P-wave modulus. As a stratum liquefies, its K_0
becomes 1. If the nearest discs alone were compressed, the excess of force would fall by its share RELIEF in a time
EVERY; in continuous ground it falls more slowly. Walls move by `ROOM` diameters at most, since the floor ends there.
Positive is outwards.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dem.engine.engine import Engine, largest_step
from dem.engine.forces import contact_forces
from dem.ground import Ground
from dem.model import DiscModel
from dem.overburden import effective_overburden
from meshes.section.section import Stratum

EVERY = 0.04  # s between two updates of the velocities of the walls
RELIEF = 0.25
STRIP, NEAR, CLOSE, ROOM = 2.0, 6.0, 2.0, 2.5  # mean diameters
SETTLING = 4.0  # s in which the sides are released before a slide
DAMPED = 0.9  # of the velocities, left after each time EVERY of that


@dataclass(frozen=True, eq=False)
class _Strip:
    """Holds a part of a wall that has one velocity.

    Attributes
    ----------
    side, outwards : str, int
        "left" and -1, or "right" and 1.
    wall, near : (k,), (m,) int
        Numbers of the discs of the wall, and of the discs of the ground whose velocity the wall has.
    at_rest, liquefied : float
        Force at rest, and increase of it once all strata that liquefy have (N per metre out of plane).
    stiffness : float
        P-wave modulus times height (N per metre out of plane).
    """

    side: str
    outwards: int
    wall: np.ndarray
    near: np.ndarray
    at_rest: float
    liquefied: float
    stiffness: float


class FreeSides:
    """Moves the walls of a slide whose ground continues beyond the sides.

    Parameters
    ----------
    start
        Discs at rest in a box.
    ground
        Place of the discs in a section.
    strata
        Numbers of the strata that liquefy; a side at which none of them lies remains a wall that does not move.
    """

    def __init__(self, start: DiscModel, ground: Ground, strata: Sequence[int]) -> None:
        self.ground, self.places = ground, start.x.copy()
        self.diameter = 2.0 * ground.radius
        self.strips: list[_Strip] = []
        section = ground.section
        if section is None or start.period is not None or ground.tilt != 0.0:
            return
        for side, outwards, levels in (
            ("left", -1, section.layering.left[0]),
            ("right", 1, section.layering.right[-1]),
        ):
            wet = [k for k in strata if levels[k] - levels[k + 1] > section.layering.tolerance]
            if wet:
                self.strips += self._strips(start, side, outwards, levels, wet)

    def _strips(
        self, start: DiscModel, side: str, outwards: int, levels: np.ndarray, wet: Sequence[int]
    ) -> list[_Strip]:
        """Return the strips of a side; levels: elevations of the interfaces at the side (m); wet: strata at the side
        that liquefy."""
        section, diameter = self.ground.section, self.diameter
        assert section is not None
        x, z = self.ground.to_section(start.x, start.z)
        beyond = outwards * (x - section.extent[1 if outwards > 0 else 0])
        foot, pressure = min(levels[k + 1] for k in wet), effective_overburden(start)
        count = max(1, round((levels[0] - foot) / (STRIP * diameter)))
        height, strips = (levels[0] - foot) / count, []
        for number in range(count):
            low = foot + number * height
            high = low + height if number < count - 1 else np.inf
            here = (z >= low) & (z < high)
            wall = np.flatnonzero(start.fixed & here & (beyond > 0.0))
            near = np.flatnonzero(~start.fixed & here & (beyond > -NEAR * diameter))
            adjacent = np.flatnonzero(~start.fixed & here & (beyond > -CLOSE * diameter))
            if len(wall) and len(adjacent):
                soils = [section.strata[k] for k in start.layer[adjacent]]
                share = sum(max(0.0, min(levels[k], low + height) - max(levels[k + 1], low)) for k in wet) / height
                force = float(pressure[adjacent].mean()) * height
                at_rest = force * float(np.mean([s.poissons_ratio / (1.0 - s.poissons_ratio) for s in soils]))
                stiffness = height * float(np.mean([_p_wave_modulus(soil) for soil in soils]))
                strips.append(_Strip(side, outwards, wall, near, at_rest, share * (force - at_rest), stiffness))
        return strips

    def release(self, model: DiscModel) -> DiscModel:
        """Return the discs at rest after the walls are released, so that they carry the pressure at rest. Discs of a
        packing press harder against walls that do not move."""
        out = model.copy()
        self.open(out)
        out.set_velocity(0.0, 0.0)
        for _ in range(round(SETTLING / EVERY)):
            self.follow(out, 0.0)
            Engine(dt=0.5 * largest_step(out).seconds, energies=False).run(out, EVERY)
            out.set_velocity(DAMPED * out.vx, DAMPED * out.vz)
        out.set_velocity(0.0, 0.0)
        self.places = out.x.copy()
        return out

    def open(self, model: DiscModel) -> None:
        """Move the rigid lines behind the walls outwards, where the walls cannot reach them."""
        lines = model.lines.copy()
        upright = np.abs(lines[:, 2]) > np.abs(lines[:, 3])
        for outwards in {strip.outwards for strip in self.strips}:
            lines[upright & (np.sign(lines[:, 2]) == -outwards), 0] += 2.0 * outwards * ROOM * self.diameter
        model.lines = lines

    def follow(self, model: DiscModel, share: float) -> None:
        """Set the velocities of the walls; share: degree of liquefaction (0 to 1)."""
        forces, n = contact_forces(model), len(model)
        force_x = model.liquefied_forces[0] + np.bincount(model.pair_j, forces.fx, n)
        force_x -= np.bincount(model.pair_i, forces.fx, n)
        vx = model.vx.copy()
        for strip in self.strips:
            excess = strip.outwards * float(force_x[strip.wall].sum()) - strip.at_rest - share * strip.liquefied
            speed = strip.outwards * float(model.vx[strip.near].mean())
            speed += RELIEF * self.diameter / EVERY * excess / strip.stiffness
            moved = self._moved(model, strip)
            if abs(moved) >= ROOM * self.diameter and speed * moved > 0.0:
                speed = 0.0
            vx[strip.wall] = strip.outwards * speed
        model.vx, model.vx_half = vx, np.where(model.fixed, vx, model.vx_half)

    def stopped(self, model: DiscModel) -> set[str]:
        """Return the sides ("left", "right") that can move no further outwards, or that are walls which do not move."""
        limit = (ROOM - 0.1) * self.diameter
        free = {strip.side for strip in self.strips}
        at_end = {strip.side for strip in self.strips if abs(self._moved(model, strip)) >= limit}
        return {"left", "right"} - free | at_end

    def _moved(self, model: DiscModel, strip: _Strip) -> float:
        """Return the displacement (m) of the wall of a strip, outwards positive."""
        return strip.outwards * float((model.x - self.places)[strip.wall].mean())


def _p_wave_modulus(soil: Stratum) -> float:
    """Return the P-wave modulus (Pa) of a soil."""
    nu = soil.poissons_ratio
    return soil.youngs_modulus * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu))
