"""Presses on the free-field sides of a ground of material points that slides.

The ground beyond a side presses with its pressure at rest on the ground that has not moved against it. Against motion
relative to the motion v_f that it has by itself (`meshes.section.free_field`), it resists as elastic ground that takes
waves away (Lysmer & Kuhlemeyer 1969, J. Eng. Mech. Div. ASCE 95, 859-877): the horizontal force on a point is

    F = F_0 - ρ V_p h (v - v_f),

with the force at rest F_0, the height h of the side that belongs to the point, and the velocity V_p of compression
waves. The pressure is at most the passive one (Rankine 1857), and ground does not pull. Ground beyond a side at which
no stratum liquefies does not move by itself. Where nothing liquefies at all, sides keep F_0. The pressure is updated
every batch of steps, by `RELIEF` of the difference. Forces are positive to the right, in N per metre out of plane.
"""

from collections.abc import Mapping

import numpy as np

from fem.kernels import grid_motion
from fem.kernels import point_stress as law
from fem.mpm.engine import MaterialPointEngine, ShakingHistory
from fem.mpm.ground import SMALLEST_FORCE, PointGround
from meshes.section.free_field import FreeField
from meshes.section.liquefies import RemainingStrength
from meshes.section.sides import lowest_liquefied

RELIEF = 0.5


class SidePressure:
    """Holds the points next to free-field sides, in the original order of the points.

    Parameters
    ----------
    ground : the ground at rest
    engine : engine that moves its points
    starts, remains, onset, end : times of liquefaction by stratum (s), strength that remains, time in which a stratum
        liquefies, and end of the slide (s)
    shaking : horizontal acceleration (m/s²) at times (n,) in s, positive to the right
    """

    def __init__(
        self,
        ground: PointGround,
        engine: MaterialPointEngine,
        starts: Mapping[int, float],
        remains: Mapping[int, RemainingStrength],
        onset: float,
        end: float,
        shaking: ShakingHistory,
    ) -> None:
        points, section = ground.points, ground.section
        self.engine, self.at_rest = engine, engine.original(points.side)
        places, state = engine.original(points.x) + ground.offset, engine.original(points.state)
        numbers, resistance, passive, speeds = [np.zeros(0, int)], [np.zeros(0)], [np.zeros(0)], []
        self.times = np.zeros(1)
        for right in (False, True):
            of_side = np.flatnonzero(self.at_rest < 0.0 if right else self.at_rest > 0.0)
            if not len(of_side) or not starts:
                continue
            height = state[of_side, law.VOLUME] / (0.5 * ground.grid.cell)
            density = state[of_side, law.MASS] / state[of_side, law.VOLUME]
            waves = _compression_waves(engine, of_side, density)
            numbers.append(of_side)
            resistance.append(density * waves * height)
            if lowest_liquefied(section, right, starts) is None:
                passive.append(np.full(len(of_side), np.inf))
                speeds += [np.zeros(1)] * len(of_side)
                continue
            field = FreeField(section, right, starts, remains, onset, by_stiffness=True)
            motion = field.velocities(shaking, end)
            self.times = motion.times
            passive.append(field.passive_pressure(places[of_side, 1]) * height)
            speeds += [motion.mean(places[number, 1:]) for number in of_side]
        self.numbers, self.resistance = np.concatenate(numbers), np.concatenate(resistance)
        self.passive = np.concatenate(passive)
        self.speeds = [np.broadcast_to(series, len(self.times)) for series in speeds]

    def change(self, where: np.ndarray, at_rest: np.ndarray) -> None:
        """Change the forces at rest of points as they liquefy.

        where (k,) : numbers of the points at present; at_rest (k,) : force at rest (N)
        """
        side, numbers = self.engine.points.side, self.engine.order[where]
        pressed = side[where] != 0.0  # ground that has come apart is pressed no more
        side[where] += np.where(pressed, at_rest - self.at_rest[numbers], 0.0)
        self.at_rest[numbers] = at_rest

    def follow(self) -> None:
        """Update the forces on the points by their present velocities."""
        if not len(self.numbers):
            return
        points, base = self.engine.points, float(self.engine.base[grid_motion.NEW_VELOCITY])
        now = np.empty(len(self.engine.order), int)
        now[self.engine.order] = np.arange(len(now))
        where = now[self.numbers]
        beyond = np.array([np.interp(self.engine.time, self.times, series) for series in self.speeds])
        at_rest, side = self.at_rest[self.numbers], points.side[where]
        wanted = at_rest - self.resistance * (points.v[where, 0] - base - beyond)
        inwards = np.sign(at_rest)
        most = np.maximum(self.passive, np.abs(at_rest))
        wanted = inwards * np.clip(inwards * wanted, SMALLEST_FORCE, most)
        points.side[where] = np.where(side != 0.0, side + RELIEF * (wanted - side), 0.0)


def _compression_waves(engine: MaterialPointEngine, numbers: np.ndarray, density: np.ndarray) -> np.ndarray:
    """Return the velocity (k,) of compression waves in the skeleton at points before liquefaction (m/s)."""
    properties = engine.original(engine.points.properties)[numbers]
    return np.asarray(np.sqrt((properties[:, law.BULK] + properties[:, law.SHEAR]) / density))
