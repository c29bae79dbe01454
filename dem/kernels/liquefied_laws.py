"""Defines the laws of liquefied ground for one distance and one disc, which `liquefied_pairs` combines (kernel).

The force of a bond follows from its displacement; both are shares of their values at the limit of the bond. The law is
bilinear: soft up to the strain potential, then steep up to the limit. If the ground has no strain potential, the law of
the bond is linear.
"""

import math

from dem.kernels.device_function import device_function


@device_function(forceinline=True)
def density_kernel(r: float, reach: float) -> tuple[float, float]:
    """Return the kernel W (1/m2) of Wendland's C2 at a distance r below the reach (m), and its slope (1/m3)."""
    q = r / reach
    scale = 7.0 / (math.pi * reach * reach)
    rest = 1.0 - q
    cube = rest * rest * rest
    return scale * cube * rest * (1.0 + 4.0 * q), -20.0 * scale * q * cube / reach


@device_function(forceinline=True)
def bond_kernel(r: float, reach: float) -> float:
    """Return the share w of the strength of a bond at a distance r below the reach (m)."""
    q = r / reach
    rest = 1.0 - q
    return rest * rest * (1.0 + 2.0 * q)


@device_function(forceinline=True)
def water_pressure(share: float, pressure: float, stiffness: float, compressed: float) -> float:
    """Return the pore pressure (Pa) of ground whose volume has been `compressed` since liquefaction, never below zero;
    share: degree of liquefaction; stiffness: K_w (Pa).
    """
    u = share * (pressure + stiffness * compressed)
    return u if u > 0.0 else 0.0


@device_function(forceinline=True)
def water_energy(share: float, area: float, pressure: float, stiffness: float, density: float, now: float) -> float:
    """Return the energy (J) stored in the pore water of a disc: area times the integral of u/rho^2 from the density at
    which u is zero to `now`.

    share: degree of liquefaction; area (m2); pressure u0, stiffness K_w (Pa); density: rho0.
    """
    least = density * (1.0 - pressure / stiffness)
    if now <= least:
        return 0.0
    fixed, rising = share * (pressure - stiffness), share * stiffness / density
    return area * (fixed * (1.0 / least - 1.0 / now) + rising * math.log(now / least))


@device_function(forceinline=True)
def stand_in_shares(share_i: float, share_j: float) -> tuple[float, float]:
    """Return the shares of the pressures of both discs of a pair that are added in place of what the partner lacks; for
    each disc one less the ratio of the degrees of liquefaction of the partner and of the disc itself, at least zero.

    As one stratum liquefies beside another that has liquefied, the pressure between them therefore changes gradually.
    """
    more_i = 1.0 - share_j / share_i if share_i > share_j else 0.0
    more_j = 1.0 - share_i / share_j if share_j > share_i else 0.0
    return more_i, more_j


@device_function(forceinline=True)
def dashpot_share(soft: tuple[float, float], bond: tuple[float, float]) -> float:
    """Return the share of the dashpot of soft ground in a bond with a disc that is not soft, at most 1.

    The dashpot is that of the soft disc, and no stiffer where the partner is still far stronger: with the strength and
    the strain of the partner it would be hundreds of times as stiff, and unstable. soft, bond: strength (N/m), and
    strain at which it is reached, of the soft disc, and their sums over both discs of the bond.
    """
    of_soft, of_bond = soft[0] * bond[1], bond[0] * soft[1]
    return of_soft / of_bond if of_soft < of_bond else 1.0


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
