"""Computes the energy losses of a contact since the last step, for the energy balance (kernel). Losses do not affect
the motion.

The compiler may therefore reorder and fuse the sums and products of the losses. Losses are doubled by these functions,
and halved after they are summed.
"""

import math

from dem.kernels.device_function import device_function

ANY_ORDER = {"reassoc", "contract"}


@device_function(forceinline=True, fastmath=ANY_ORDER)
def along(ax: float, az: float, bx: float, bz: float) -> float:
    """Return the scalar product of the vectors (ax, az) and (bx, bz), for the energy balance alone."""
    return ax * bx + az * bz


@device_function(forceinline=True, fastmath=ANY_ORDER)
def damping_loss(way: float, dashpot: float, dashpot_before: float) -> float:
    """Return twice the work of a dashpot in one step (J), from its forces at the beginning and at the end of the step
    (N).

    The work in a step is the displacement times the mean of the forces at both ends of the step. The scheme reduces the
    kinetic energy v(n-1/2) v(n+1/2) m/2 by this work, so that the balance of linear springs and dashpots closes to
    rounding for any step.
    """
    return (dashpot + dashpot_before) * way


@device_function(forceinline=True, fastmath=ANY_ORDER)
def damping_losses(
    nx: float,
    nz: float,
    slip: float,
    stretch: float,
    fx: float,
    fz: float,
    dashpot_t: float,
    dashpot_n: float,
    springs_t: float,
    springs_n: float,
) -> float:
    """Return twice the energy (J) that the dashpots along and across a contact dissipated since the last step.

    nx, nz, slip, stretch: see `interaction.Motion`; fx, fz: force of springs and dashpots in the last step (N);
    springs_t, springs_n: force of the springs alone; dashpot_t, dashpot_n: force of the dashpots now (N).
    """
    before_n = fx * nx + fz * nz - springs_n
    before_t = fx * nz - fz * nx - springs_t
    return (dashpot_t + before_t) * slip - (dashpot_n + before_n) * stretch


@device_function(forceinline=True, fastmath=ANY_ORDER)
def sliding_loss(before: float, trial: float, limited: float, flexibility: float) -> float:
    """Return twice the work (J) dissipated in one step by a spring whose force was reduced from `trial` to `limited`
    (N).

    before: force of the spring in the last step (N); flexibility: one over the stiffness of the spring (m/N).
    """
    return (before + limited) * (trial - limited) * flexibility


@device_function(forceinline=True, fastmath=ANY_ORDER)
def crack_loss(kpn: float, length: float, distance: float, stretch: float) -> float:
    """Return twice the elastic energy (J) that a pore spring loses as it cracks.

    kpn: normal stiffness (N/m); length: length of the spring (m); distance: distance of the centres (m); stretch:
    separation since the last step (m).
    """
    pressed = abs(length) - distance
    before = pressed + stretch
    return kpn * pressed * before if (pressed < 0.0) & (before < 0.0) else 0.0


@device_function(forceinline=True, fastmath=ANY_ORDER)
def both(first: float, second: float) -> float:
    """Return the sum of two losses."""
    return first + second


@device_function(forceinline=True, fastmath=ANY_ORDER)
def spring_before(over: float, stretch: float, kn: float, gap: float) -> float:
    """Return the force (N) of a spring in the last step, positive in compression.

    over: overlap now (m); stretch: decrease of the overlap since the last step (m); kn: stiffness (N/m); gap: see
    `contact.spring`.
    """
    over_then = over + stretch
    return kn * over_then if over_then > -gap else 0.0


@device_function(forceinline=True, fastmath=ANY_ORDER)
def pore_before(length: float, distance: float, stretch: float, kpn: float) -> float:
    """Return the normal force (N) of a pore spring in the last step; length, distance, kpn: see `contact.pore`.

    stretch: separation since the last step (m).
    """
    pressed = abs(length) - distance + stretch
    least = -math.inf if length > 0.0 else 0.0
    return kpn * (pressed if pressed > least else least)
