"""Compliant base: the ground continues below the discs, and waves that they send down leave through it.

On a rigid base, ground vibrates undamped with its natural period, and cycles of Kh of that period build up to several
times Kh. Below the base of a section the ground continues. A horizontal force F of the discs on the base moves it at

    v = F / (ρ V_s L)                                (Lysmer & Kuhlemeyer 1969, J. Eng. Mech. Div. ASCE 95, 859-877)

relative to its motion without the discs; ρ V_s is the impedance and L the length of the base. In its frame
the additional acceleration -dv/dt acts on the discs. F follows from the momentum of the discs, and v follows F with the
time constant `DELAY`. Positive is to the right, perpendicular to gravity. A constant Kh moves the base at a constant
speed, which has no effect on the discs.
"""

from dataclasses import replace

import numpy as np

from dem.acceleration import Acceleration, right_of
from dem.state import DiscState

EVERY = 0.004  # s between two looks at the momentum of the discs
DELAY = 0.04  # s; with less than ten looks the lowest row of discs resonates with the base


def felt(model: DiscState) -> Acceleration:
    """Acceleration of the discs now, with that of a compliant base."""
    here = model.acceleration.at(model.time)
    if model.base_impedance == 0.0:
        return here
    x, z = right_of(model.gravity)
    return replace(here, x=here.x - model.base_rate * x, z=here.z - model.base_rate * z)


def felt_until(model: DiscState, end: float) -> Acceleration:
    """Acceleration of the discs from now to a time (s), up to which that of a compliant base changes linearly."""
    if model.base_impedance == 0.0:
        return model.acceleration
    begin = model.time
    frame = model.acceleration.between(begin, end)
    rate = np.interp(frame.times, [begin, end], [model.base_rate, model.base_next])
    x, z = right_of(model.gravity)
    return replace(frame, x=frame.x - rate * x, z=frame.z - rate * z)


def momentum(model: DiscState) -> float:
    """Horizontal momentum of the discs that can move (kg m/s per metre)."""
    x, z = right_of(model.gravity)
    free = ~model.fixed
    return float(np.sum(model.mass[free] * (x * model.vx[free] + z * model.vz[free])))


def follow(model: DiscState, before: float, began: float, planned: float) -> None:
    """Update the motion of the base after some steps of the discs.

    Parameters
    ----------
    model
        The discs after these steps.
    before
        Their momentum before them (kg m/s per metre).
    began
        Time before them (s).
    planned
        Time at which they were to end (s); a new neighbour list ends them sooner.
    """
    over = model.time - began
    if over <= 0.0:
        return
    rate = model.base_rate + (model.base_next - model.base_rate) * over / (planned - began)
    speed = model.base_velocity + 0.5 * over * (model.base_rate + rate)
    free = ~model.fixed
    moved_mass = float(np.sum((model.mass * (1.0 + _added_mass(model)))[free]))
    x, z = right_of(model.gravity)
    acceleration = (model.acceleration.mean(began, model.time) @ np.array([x, z])) - 0.5 * (model.base_rate + rate)
    force = moved_mass * acceleration - (momentum(model) - before) / over
    model.base_velocity, model.base_rate = speed, rate
    model.base_next = (force / model.base_impedance - speed) / DELAY


def _added_mass(model: DiscState) -> np.ndarray:
    """Horizontal added mass (n,) of the discs over their mass."""
    x, z = right_of(model.gravity)
    return np.asarray(x * model.added_mass_x + z * model.added_mass_z)
