"""Kernel: energy losses of a contact since the last step, for the energy balance; they do not affect the motion.

So the compiler may take its sums and products in any order, and join them. Losses are given twice, and halved once they
are summed.
"""

import math

from dem.kernels.inner import inner

ANY_ORDER = {"reassoc", "contract"}


@inner(forceinline=True, fastmath=ANY_ORDER)
def along(ax: float, az: float, bx: float, bz: float) -> float:
    """Scalar product of two vectors, for the energy balance alone."""
    return ax * bx + az * bz


@inner(forceinline=True, fastmath=ANY_ORDER)
def damping_loss(way: float, dashpot: float, dashpot_before: float) -> float:
    """Work of a dashpot since the last step, twice (J), from its forces (N) now and then.

    The work of a step is its displacement times the mean of the forces at its ends: that is what the scheme takes from
    the kinetic energy v(n-1/2) v(n+1/2) m/2, so the balance of linear springs and dashpots closes to rounding, whatever
    the step.
    """
    return (dashpot + dashpot_before) * way


@inner(forceinline=True, fastmath=ANY_ORDER)
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
    """The same along and across a contact (see `interaction.Motion`), whose springs and dashpots held fx, fz (N) in the
    last step, springs alone springs_t and springs_n."""
    before_n = fx * nx + fz * nz - springs_n
    before_t = fx * nz - fz * nx - springs_t
    return (dashpot_t + before_t) * slip - (dashpot_n + before_n) * stretch


@inner(forceinline=True, fastmath=ANY_ORDER)
def sliding_loss(before: float, trial: float, kept: float, flexibility: float) -> float:
    """Work that a spring whose force was cut from `trial` to `kept` (N) has lost since the last step, twice (J)."""
    return (before + kept) * (trial - kept) * flexibility


@inner(forceinline=True, fastmath=ANY_ORDER)
def crack_loss(kpn: float, length: float, distance: float, stretch: float) -> float:
    """Energy of its stretch that a pore spring sets free as it cracks, twice (J)."""
    pressed = abs(length) - distance
    before = pressed + stretch
    return kpn * pressed * before if (pressed < 0.0) & (before < 0.0) else 0.0


@inner(forceinline=True, fastmath=ANY_ORDER)
def both(first: float, second: float) -> float:
    """The sum of two losses."""
    return first + second


@inner(forceinline=True, fastmath=ANY_ORDER)
def spring_before(over: float, stretch: float, kn: float, gap: float) -> float:
    """Push (N) of a spring in the last step, from its overlap and the decrease of the overlap since (m); gap: see
    `spring`.
    """
    over_then = over + stretch
    return kn * over_then if over_then > -gap else 0.0


@inner(forceinline=True, fastmath=ANY_ORDER)
def pore_before(length: float, distance: float, stretch: float, kpn: float) -> float:
    """Normal force (N) of a pore spring in the last step, see `contact.pore`."""
    pressed = abs(length) - distance + stretch
    least = -math.inf if length > 0.0 else 0.0
    return kpn * (pressed if pressed > least else least)
