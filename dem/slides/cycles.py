"""Defines a cyclic seismic coefficient: uniform cycles that are equivalent to the irregular cycles of an earthquake."""

import numpy as np

from meshes.section.quantity import GRAVITY

PER_CYCLE = 64  # points in time
EDGE = 1.0  # cycles in which the motion comes, and in which it goes: half of each counts


def cyclic_acceleration(kh: float, cycles: float, period: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the acceleration Kh g cos(2 π t / T), whose amplitude rises in the first cycle and fades in the last
    cycle.

    The acceleration is the derivative of a velocity Kh g T/(2 π) w(t) sin(2 π t / T) with w a half cosine at either
    end, so that the base has no mean velocity: without the half cosines it would drift away from liquefied ground.

    Parameters
    ----------
    kh
        Amplitude of the seismic coefficient (-).
    cycles
        Equivalent number of cycles with this amplitude: the first and the last count as half a cycle each.
    period
        Period T of a cycle (s).

    Returns
    -------
    time, acceleration : (n,) arrays
        Times from 0 (s), and acceleration of the mass of the ground (m/s²), which begins and ends with 0.

    Raises
    ------
    ValueError
        If cycles or period are not positive.
    """
    if not (cycles > 0.0 and period > 0.0):
        raise ValueError(f"expected positive cycles and a positive period, not {cycles} and {period} s")
    last = max(cycles, EDGE) + EDGE  # in cycles; a whole one at least comes and goes
    phase = np.linspace(0.0, last, int(np.ceil(PER_CYCLE * last)) + 1)
    inside = np.clip(np.minimum(phase, last - phase) / EDGE, 0.0, 1.0)
    window = 0.5 - 0.5 * np.cos(np.pi * inside)
    rises = np.where(phase < 0.5 * last, 1.0, -1.0) * 0.5 * np.pi * np.sin(np.pi * inside) / EDGE  # a cycle
    acceleration = window * np.cos(2.0 * np.pi * phase) + rises * np.sin(2.0 * np.pi * phase) / (2.0 * np.pi)
    return period * phase, kh * GRAVITY * acceleration
