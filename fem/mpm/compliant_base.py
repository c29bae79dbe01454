"""Compliant base of material points: the ground continues below the section, and waves that it sends down leave.

On a rigid base, ground vibrates undamped with its natural period, and cycles of Kh near that period build up. A
horizontal force F of the ground on its base moves the base at

    v = F / (ρ V_s L)                                (Lysmer & Kuhlemeyer 1969, J. Eng. Mech. Div. ASCE 95, 859-877)

relative to its motion without the ground; ρ V_s L is `meshes.section.base_impedance`. In the frame of the base the
additional acceleration -dv/dt acts on the points. F follows from their momentum, and v follows F with the time constant
`DELAY`. Positive is to the right.
"""

import numpy as np

from fem.kernels import material_points as kernel
from fem.mpm.engine import MaterialPointEngine, ShakingHistory

EVERY = 0.005  # s between two looks at the momentum: about one step
DELAY = 0.01  # s: with 0.04 a layer on a half-space of its own impedance resonates 1.3 times as much


class CompliantBase:
    """The motion of a base that gives way.

    Parameters
    ----------
    impedance : float
        ρ V_s L (kg/s per metre out of plane); 0 for a rigid base.

    Attributes
    ----------
    velocity, rate : float
        v (m/s) and dv/dt (m/s²).
    """

    def __init__(self, impedance: float) -> None:
        self.impedance, self.velocity, self.rate = impedance, 0.0, 0.0

    def run(self, engine: MaterialPointEngine, seconds: float, shaking: ShakingHistory) -> None:
        """Continue for some seconds; ``shaking`` as in `MaterialPointEngine.run`, positive to the right."""
        if self.impedance == 0.0:
            engine.run(seconds, shaking)
            return
        steps = int(np.ceil(seconds / EVERY - 1e-9))
        for _ in range(steps):
            self._step(engine, seconds / steps, shaking)

    def _step(self, engine: MaterialPointEngine, dt: float, shaking: ShakingHistory) -> None:
        rate, (before, mass) = self.rate, _momentum(engine)
        acceleration = float(shaking(np.array([engine.time + 0.5 * dt]))[0])
        engine.run(dt, lambda times: shaking(times) - rate)
        force = mass * (acceleration - rate) - (_momentum(engine)[0] - before) / dt
        self.velocity += dt * rate
        self.rate = (force / self.impedance - self.velocity) / DELAY


def _momentum(engine: MaterialPointEngine) -> tuple[float, float]:
    """Horizontal momentum (kg m/s) and mass (kg) of the ground above the base, per metre out of plane."""
    points = engine.points
    mass = points.state[:, kernel.MASS] * (points.stratum >= 0)
    return float(mass @ points.v[:, 0]), float(mass.sum())
