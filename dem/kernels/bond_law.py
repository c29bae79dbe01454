"""Computes the force of a bond between liquefied discs from its displacement (kernel). Force and displacement are given
as shares of their values at the limit of the bond.

The law is bilinear: soft up to the strain potential, then steep up to the limit. If the ground has no strain potential,
the law of the bond is linear.
"""

import math

from dem.kernels.device_function import device_function

# s: dashpot over stiffness of bonds below their strain potential. With this dashpot ground comes to rest where it would
# if its stiffness were lost slowly, and does not oscillate for minutes; in sand hysteresis dissipates this energy.
SOFT_CREEP_TIME = 5.0
SMALLEST_DISPLACEMENT = 1e-12  # of the displacement at the limit


@device_function(forceinline=True)
def mobilised(along: float, across: float) -> tuple[float, float]:
    """Return both components of the force of a bond over its limit, scaled so that their resultant is at most 1."""
    square = along * along + across * across
    scale = 1.0 / math.sqrt(square if square > 1.0 else 1.0)
    return along * scale, across * scale


@device_function(forceinline=True)
def slopes(knee: float, soft_to: float) -> tuple[float, float]:
    """Return the slopes of both lines of a bond: force over the limiting force, divided by displacement over the
    limiting displacement (-)."""
    return knee / (soft_to + SMALLEST_DISPLACEMENT), (1.0 - knee) / (1.0 - soft_to)


@device_function(forceinline=True)
def force_share(along: float, across: float, soft: float, steep: float) -> float:
    """Return the secant stiffness of a bond: force over the limiting force, divided by displacement over the limiting
    displacement; 1 without a strain potential.

    along, across: displacement along and across the bond, over the limiting displacement (-); soft, steep: see
    `slopes`.
    """
    way = math.sqrt(along * along + across * across) + SMALLEST_DISPLACEMENT
    second = steep - (steep - 1.0) / way
    return second if second > soft else soft


@device_function(forceinline=True)
def energy_share(along: float, across: float, soft: float, steep: float, soft_to: float, linear: bool = False) -> float:
    """Return the energy that a bond stores, over its energy at the limit without a strain potential (in that case the
    square of its displacement).

    along, across: displacement along and across the bond, over the limiting displacement (-); soft, steep: see
    `slopes`; soft_to: displacement at which the steep line begins, over the limiting displacement (-); linear: whether
    the bond has no strain potential.
    """
    square = along * along + across * across
    if linear:
        return square
    way = math.sqrt(square)
    past = way - soft_to
    first = soft * square
    second = soft * soft_to * soft_to + 2.0 * (1.0 - steep) * past + steep * (square - soft_to * soft_to)
    return second if past > 0.0 else first


@device_function(forceinline=True)
def decay(way: float) -> float:
    """Return exp(-way) for a small way, as (1 + way/64)^-64, which is exact to way^2/128 and needs no call."""
    left = 1.0 / (1.0 + way * (1.0 / 64.0))
    left *= left
    left *= left
    left *= left
    left *= left
    left *= left
    return left * left
