"""Models a compliant base: the ground continues below the discs, and waves that the discs send down leave through it.

On a rigid base, ground vibrates undamped with its natural period, and cycles of Kh of that period build up to several
times Kh. Below the base of a section the ground continues. A horizontal force F of the discs on the base moves it at

    v = F / (ρ V_s L)                                (Lysmer & Kuhlemeyer 1969, J. Eng. Mech. Div. ASCE 95, 859-877)

relative to the motion that the base would have without the discs; ρ V_s is the impedance and L the length of the base.
In the frame of the base, the additional acceleration -dv/dt acts on the discs. F follows from the momentum of the
discs, and v follows F with the time constant `DELAY`. Forces and velocities are positive to the right, perpendicular to
gravity. A constant Kh moves the base at a constant speed, which has no effect on the discs.
"""

import numpy as np

from dem.acceleration import Acceleration, right_of
from dem.state import DiscState

UPDATE_INTERVAL = 0.004  # s between two evaluations of the momentum of the discs
FEWEST_STEPS = 2  # between two evaluations, since forces of liquefied ground are constant over several steps
DELAY = 0.04  # s; below ten update intervals the lowest row of discs resonates with the base


def acceleration_on_discs(model: DiscState) -> Acceleration:
    """Return the present acceleration that acts on the discs, including the acceleration of a compliant base."""
    acceleration = model.acceleration.at(model.time)
    if model.base_impedance == 0.0:
        return acceleration
    x, z = right_of(model.gravity)
    return acceleration.plus(-model.base_rate * x, -model.base_rate * z)


def felt_until(model: DiscState, end: float, look: "MeasurementInterval | None") -> Acceleration:
    """Return the acceleration that acts on the discs from now to a time (s), including the acceleration of a compliant
    base."""
    if look is None:
        return model.acceleration
    begin = model.time
    frame = model.acceleration.between(begin, end)
    rate = np.interp(frame.times, [begin, end], [model.base_rate, look.rate_at(model, end)])
    x, z = right_of(model.gravity)
    return frame.plus(-rate * x, -rate * z)


class FreeDiscs:
    """Holds the masses of the discs that can move; they do not change during a run.

    Attributes
    ----------
    moved_mass : float
        Mass with the horizontal added mass (kg per metre).
    momentum : float
        Horizontal momentum (kg m/s per metre) in the middle of the last step before the last `measure`.
    """

    def __init__(self, model: DiscState) -> None:
        self.free, self.right = np.flatnonzero(~model.fixed), right_of(model.gravity)
        self.mass = model.mass[self.free]
        x, z = self.right
        added = x * model.added_mass_x + z * model.added_mass_z
        self.moved_mass = float(np.sum((model.mass * (1.0 + added))[self.free]))
        self.momentum = 0.0
        self.measure(model)

    def measure(self, model: DiscState) -> None:
        """Compute the momentum from the present velocities of the model."""
        x, z = self.right
        self.momentum = float(np.sum(self.mass * (x * model.vx_half[self.free] + z * model.vz_half[self.free])))


class MeasurementInterval:
    """Holds the interval of steps from one measurement of the force on the base to the next. A new neighbour list may
    end the interval early.

    Attributes
    ----------
    began, end : float
        Times at which these steps begin, and are to end (s).
    momentum_before, rate : float
        Momentum of the discs (kg m/s per metre) and acceleration of the base (m/s2) at the beginning of the interval.
    """

    def __init__(self, model: DiscState, dt: float, discs: FreeDiscs) -> None:
        steps = max(FEWEST_STEPS, round(UPDATE_INTERVAL / dt))
        self.began, self.end = model.time, model.time + steps * dt
        self.discs, self.momentum_before, self.rate = discs, discs.momentum, model.base_rate

    def steps_left(self, model: DiscState, dt: float) -> int:
        """Return the number of steps of dt (s) to the end of the interval; 0 or less if steps have become much
        longer."""
        return round((self.end - model.time) / dt)

    def end_now(self, model: DiscState, dt: float) -> None:
        """End the interval, with a measurement of the force if enough steps of dt (s) have passed."""
        self.discs.measure(model)
        if round((model.time - self.began) / dt) >= FEWEST_STEPS:
            self.measure(model, dt)

    def rate_at(self, model: DiscState, time: float) -> float:
        """Return the acceleration of the base (m/s2) at a time (s) in the interval, over which it changes linearly."""
        share = (time - self.began) / (self.end - self.began)
        return self.rate + (model.base_next - self.rate) * share

    def follow(self, model: DiscState, since: float) -> None:
        """Update the motion of the base after some steps of the interval; since: time before these steps (s)."""
        before, model.base_rate = model.base_rate, self.rate_at(model, model.time)
        model.base_velocity += 0.5 * (model.time - since) * (before + model.base_rate)

    def measure(self, model: DiscState, dt: float) -> None:
        """Compute the force on the base over the interval of steps of dt (s). The force determines the next
        acceleration of the base.

        Between the middle of the step before the interval and the middle of its last step, the velocities change by the
        accelerations at the beginnings of the steps in between. If momentum and acceleration were taken half a step
        apart, stiff clay would rock the base ever further.
        """
        over, discs = model.time - self.began, self.discs
        acceleration = model.acceleration.mean(self.began - 0.5 * dt, model.time - 0.5 * dt) @ np.array(discs.right)
        acceleration -= self.rate_at(model, 0.5 * (self.began + model.time - dt))
        force = discs.moved_mass * acceleration - (discs.momentum - self.momentum_before) / over
        model.base_next = (force / model.base_impedance - model.base_velocity) / DELAY
