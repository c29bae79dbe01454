"""Defines the laws of liquefied ground for one distance and one disc, which `liquefied_pairs` combines (kernel)."""

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
