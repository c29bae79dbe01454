"""Kernel: liquefied ground, borne by the pressure of its pore water and held together by its residual strength.

Two laws of pairs, for every pair with a liquefied disc that is nearer than the reach H; contacts have no part in it.

1. Pore pressure by volume. A disc stands for an area V with its voids; how densely these areas lie is
   rho_i = sum_j V_j W(r_ij), with its own share, W the kernel C2 of Wendland (1995). The pore pressure in excess of the
   hydrostatic one is u_i = max(0, u0 + K_w (rho/rho0 - 1)) share + zeta d rho/dt: the effective overburden that pore
   water took over when the ground liquefied, and what is lost of its volume. A pair is pushed apart along the line of
   centres by -V_i V_j (u_i/rho_i^2 + u_j/rho_j^2) dW/dr (Monaghan 1992), which bears any pressure and no shear.
2. Residual strength. An elastic-plastic bond between the centres resists both parts of their relative motion, no more
   together than c_ij = (pi/2) FITTED (s_i V_i/S_i + s_j V_j/S_j) w(r), S_i = sum_j w r. Then sum_j c_ij r_ij is the
   same whatever the packing, and so is the shear stress of ground that slips: s. Its stiffness is c_ij/(gamma r).

A disc that has not liquefied, or is fixed, takes the place of the other half: both sums are those of the liquefied
disc, twice. All is looked at every few steps, where discs will be in the middle of these, and held meanwhile. Sums over
the pairs of a disc are taken in the order of its partners, so that they hang on no number of threads.

Work is booked from look to look: that of the forces held, but for half of the last step, which has those of the new
look at its end (velocity Verlet).
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from dem.kernels.inner import inner
from dem.kernels.period import Period, image

# What a disc has, in a record of its own: how far it has liquefied (0 to 1), area with voids (m2); pressure u0 (Pa) and
# density rho0 (-) at that time, stiffness K_w (Pa) and viscosity zeta (Pa s) of the pore water; residual strength (Pa)
# and the shear strain at which it is reached. What was found when pairs were last looked at: place (m), density, push
# u/rho^2 (Pa) and the part of it by viscosity, V/S (1/m), force (N).
SHARE, AREA, PRESSURE, DENSITY, STIFFNESS, VISCOSITY, STRENGTH, STRAIN = range(8)
AT_X, AT_Z, NOW, PUSH, DRAG, BOND, FORCE_X, FORCE_Z = range(8, 16)
FIELDS = 16
GIVEN = 8  # the first of these are given, the others found

# What a pair remembers: how far its strength is mobilised, along and across (pull and slip positive, 1 together at
# most); the same of the spring behind its dashpot; twice the energy that the bond stores at its limit (J); force
# besides (N).
ALONG, ACROSS, LATE_ALONG, LATE_ACROSS, YIELD, DASH_ALONG, DASH_ACROSS = range(7)
MEMORY = 7

# What is worked out for a pair, then overwritten by the force on its second disc.
NX, NZ, APART, WIDTH, SLOPE, LEVER, RATE, SLIP, STRETCH, SPEED_T = range(10)
PAIR_X, PAIR_Z = 0, 1
WORKING = 10

RELAXES = 0.1  # s, in which the spring behind the dashpot of a bond gives way: ground at rest swings at 5 to 20 rad/s
BEHIND = 0.5  # stiffness of that spring over the bond's
FITTED = 1.0 / 0.93  # discs slip along surfaces that hold less than the mean of all directions
LESS = 1e-12  # of a reach: what S is at least


class Liquefied(NamedTuple):
    """Liquefied discs and their pairs as kernels want them; without pairs nothing has liquefied.

    Attributes
    ----------
    discs : (slots, FIELDS)
        Of every disc, in spatial order.
    first, second : (pairs,)
        Numbers of the two in spatial order, sorted by the first, then by the second.
    memory : (pairs, MEMORY)
        See `ALONG` and what follows.
    working : (pairs, WORKING)
        Scratch.
    start : (slices + 1,)
        First pair of each slice, by the first disc.
    member : (2 pairs,)
        Pairs of every disc: twice the number, and one more where it is the second.
    members : (slots + 1,)
        First of them of each disc.
    near : (discs with pairs,)
        Their numbers.
    near_start : (slices + 1,)
        First of them in each slice.
    reach : float
        H (m).
    every : int
        Steps for which forces are held.
    """

    discs: np.ndarray
    first: np.ndarray
    second: np.ndarray
    memory: np.ndarray
    working: np.ndarray
    start: np.ndarray
    member: np.ndarray
    members: np.ndarray
    near: np.ndarray
    near_start: np.ndarray
    reach: float
    every: int


@inner(forceinline=True)
def density_kernel(r: float, reach: float) -> tuple[float, float]:
    """W (1/m2) of Wendland's C2 at a distance r below the reach (m), and its slope (1/m3)."""
    q = r / reach
    scale = 7.0 / (math.pi * reach * reach)
    rest = 1.0 - q
    cube = rest * rest * rest
    return scale * cube * rest * (1.0 + 4.0 * q), -20.0 * scale * q * cube / reach


@inner(forceinline=True)
def bond_kernel(r: float, reach: float) -> float:
    """w: the share of strength that is left to a bond at a distance r below the reach (m)."""
    q = r / reach
    rest = 1.0 - q
    return rest * rest * (1.0 + 2.0 * q)


@inner(forceinline=True)
def water_pressure(share: float, pressure: float, stiffness: float, compressed: float) -> float:
    """Pore pressure (Pa) of ground that is denser by `compressed` than it was when it liquefied; never below zero."""
    u = share * (pressure + stiffness * compressed)
    return u if u > 0.0 else 0.0


@inner(forceinline=True)
def water_energy(share: float, area: float, pressure: float, stiffness: float, density: float, now: float) -> float:
    """Energy (J) stored in the pore water of a disc: area times the integral of u/rho^2 from where u is nothing on."""
    least = density * (1.0 - pressure / stiffness)
    if now <= least:
        return 0.0
    fixed, rising = share * (pressure - stiffness), share * stiffness / density
    return area * (fixed * (1.0 / least - 1.0 / now) + rising * math.log(now / least))


@inner(nogil=True, _nrt=False)
def look_at_pairs(
    begin: int, end: int, wet: Liquefied, shared: np.ndarray, ahead: float, period: Period, booked: bool
) -> float:
    """Where the discs of some pairs will be in `ahead` seconds and how they move; shared: records of all discs.

    Returns the work (J) of the half that stands in for discs which have not liquefied, since the last look.
    """
    discs, working, reach = wet.discs, wet.working, wet.reach
    work = 0.0
    for c in range(begin, end):
        i, j = np.int64(wet.first[c]), np.int64(wet.second[c])
        a, b = 8 * i, 8 * j
        ux, uz = shared[b + 2] - shared[a + 2], shared[b + 3] - shared[a + 3]
        dx, dz = image(shared[b] - shared[a] + ahead * ux, shared[b + 1] - shared[a + 1] + ahead * uz, period)
        square = dx * dx + dz * dz
        apart = math.sqrt(square)
        working[c, APART] = apart
        ox, oz = image(discs[j, AT_X] - discs[i, AT_X], discs[j, AT_Z] - discs[i, AT_Z], period)
        before = math.sqrt(ox * ox + oz * oz)
        if booked and before < reach and (discs[i, SHARE] > 0.0) != (discs[j, SHARE] > 0.0):
            pushed = discs[i, PUSH] + discs[j, PUSH]  # one of them is nothing
            push = -discs[i, AREA] * discs[j, AREA] * pushed * density_kernel(before, reach)[1]
            work += (1.0 - 0.5 / wet.every) * push * ((dx - ox) * ox + (dz - oz) * oz) / before
        if apart >= reach:
            continue
        inverse = 1.0 / apart
        nx, nz = dx * inverse, dz * inverse
        width, slope = density_kernel(apart, reach)
        working[c, NX], working[c, NZ] = nx, nz
        working[c, WIDTH], working[c, SLOPE] = width, slope
        working[c, LEVER] = bond_kernel(apart, reach)
        working[c, RATE] = ux * nx + uz * nz
        working[c, SPEED_T] = uz * nx - ux * nz
        working[c, STRETCH] = apart - before
        working[c, SLIP] = 2.0 * (ox * dz - oz * dx) / (apart + before)
    return work


@inner(nogil=True, _nrt=False)
def look_at_discs(begin: int, end: int, wet: Liquefied, shared: np.ndarray, ahead: float, booked: bool) -> float:
    """Density, pressure and share of strength of some discs near; what viscosity took since the last look (J)."""
    discs, working, reach = wet.discs, wet.working, wet.reach
    own = 7.0 / (math.pi * reach * reach)
    lost = 0.0
    for k in range(begin, end):
        i = np.int64(wet.near[k])
        at = 8 * i
        discs[i, AT_X] = shared[at] + ahead * shared[at + 2]
        discs[i, AT_Z] = shared[at + 1] + ahead * shared[at + 3]
        if discs[i, SHARE] == 0.0:
            continue
        density, rate, levers = discs[i, AREA] * own, 0.0, LESS * reach
        for m in range(wet.members[i], wet.members[i + 1]):
            c = np.int64(wet.member[m]) >> 1
            apart = working[c, APART]
            if apart >= reach:
                continue
            j = np.int64(wet.first[c]) + np.int64(wet.second[c]) - i
            area = discs[j, AREA]
            density += area * working[c, WIDTH]
            rate += area * working[c, SLOPE] * working[c, RATE]
            levers += working[c, LEVER] * apart
        share, area = discs[i, SHARE], discs[i, AREA]
        still = water_pressure(share, discs[i, PRESSURE], discs[i, STIFFNESS], density / discs[i, DENSITY] - 1.0)
        whole = still + share * discs[i, VISCOSITY] * rate
        whole = whole if whole > 0.0 else 0.0
        drag = (whole - still) / (density * density)
        if booked:
            held = discs[i, DRAG] + 0.5 / wet.every * (drag - discs[i, DRAG])
            lost += area * held * (density - discs[i, NOW])
        discs[i, NOW] = density
        discs[i, PUSH] = whole / (density * density)
        discs[i, DRAG] = drag
        discs[i, BOND] = share * discs[i, STRENGTH] * area / levers
    return lost


@inner(forceinline=True)
def mobilised(along: float, across: float) -> tuple[float, float]:
    """Both parts of what a bond holds, over its limit, brought back to the limit."""
    square = along * along + across * across
    scale = 1.0 / math.sqrt(square) if square > 1.0 else 1.0
    return along * scale, across * scale


@inner(nogil=True, _nrt=False)
def press_pairs(
    begin: int, end: int, wet: Liquefied, damping_time: float, kept: float, booked: bool
) -> tuple[float, float, float]:
    """Forces and memory of some pairs.

    Returns what their bonds took by slip and by dashpots since the last look, and the work of stand-ins at its end (J).

    damping_time: dashpot over stiffness of a bond (s); kept: what the spring behind its other dashpot
    keeps of itself from look to look.
    """
    discs, working, memory, reach = wet.discs, wet.working, wet.memory, wet.reach
    slid, damped, work = 0.0, 0.0, 0.0
    part = 0.5 / wet.every
    for c in range(begin, end):
        apart = working[c, APART]
        if apart >= reach:
            # its strength went to nothing on the way here
            working[c, PAIR_X], working[c, PAIR_Z] = 0.0, 0.0
            for k in range(MEMORY):
                memory[c, k] = 0.0
            continue
        i, j = np.int64(wet.first[c]), np.int64(wet.second[c])
        both = discs[i, SHARE] > 0.0 and discs[j, SHARE] > 0.0
        factor = 1.0 if both else 2.0
        # of a disc that has not liquefied both are nothing
        push = discs[i, PUSH] + discs[j, PUSH]
        strength = discs[i, BOND] + discs[j, BOND]
        strain = discs[i, STRAIN] + discs[j, STRAIN]
        push *= -factor * discs[i, AREA] * discs[j, AREA] * working[c, SLOPE]
        strength *= 0.5 * math.pi * FITTED * factor * working[c, LEVER]
        room = 0.5 * factor * strain * apart  # way (m) at which the bond slips
        stretch, slip = working[c, STRETCH], working[c, SLIP]
        along, across = memory[c, ALONG], memory[c, ACROSS]
        inverse = 1.0 / room
        tried_along, tried_across = along + stretch * inverse, across + slip * inverse
        new_along, new_across = mobilised(tried_along, tried_across)
        if booked:
            damped += (1.0 - part) * (memory[c, DASH_ALONG] * stretch + memory[c, DASH_ACROSS] * slip)
            work += 0.0 if both else 0.5 * part * push * stretch
            energy = strength * room
            weaker = 0.5 * (memory[c, YIELD] - energy) * (along * along + across * across)
            slid += weaker + 0.5 * energy * (
                (along + new_along) * (tried_along - new_along) + (across + new_across) * (tried_across - new_across)
            )
            memory[c, YIELD] = energy
        memory[c, ALONG], memory[c, ACROSS] = new_along, new_across
        rate, turn = working[c, RATE] * inverse, working[c, SPEED_T] * inverse
        late_along, late_across = mobilised(
            kept * (memory[c, LATE_ALONG] + BEHIND * stretch * inverse),
            kept * (memory[c, LATE_ACROSS] + BEHIND * slip * inverse),
        )
        memory[c, LATE_ALONG], memory[c, LATE_ACROSS] = late_along, late_across
        soon_along, soon_across = mobilised(
            new_along + late_along + rate * damping_time, new_across + late_across + turn * damping_time
        )
        pull, drag = strength * soon_along, strength * soon_across
        memory[c, DASH_ALONG] = pull - strength * new_along
        memory[c, DASH_ACROSS] = drag - strength * new_across
        if booked:
            damped += part * (memory[c, DASH_ALONG] * stretch + memory[c, DASH_ACROSS] * slip)
        nx, nz = working[c, NX], working[c, NZ]
        normal = push - pull
        working[c, PAIR_X] = normal * nx + drag * nz
        working[c, PAIR_Z] = normal * nz - drag * nx
    return slid, damped, work


@inner(nogil=True, _nrt=False)
def sum_pairs(begin: int, end: int, wet: Liquefied) -> None:
    """Forces on some of the discs near."""
    discs, working = wet.discs, wet.working
    for k in range(begin, end):
        i = np.int64(wet.near[k])
        fx, fz = 0.0, 0.0
        for m in range(wet.members[i], wet.members[i + 1]):
            c = np.int64(wet.member[m])
            sign = 2.0 * (c & 1) - 1.0
            fx += sign * working[c >> 1, PAIR_X]
            fz += sign * working[c >> 1, PAIR_Z]
        discs[i, FORCE_X], discs[i, FORCE_Z] = fx, fz


@njit(cache=True, nogil=True, error_model="numpy")
def members_of(first: np.ndarray, second: np.ndarray, slots: int) -> tuple[np.ndarray, np.ndarray]:
    """`member` and `members` of pairs: of every disc its pairs, in the order of the list."""
    members = np.zeros(slots + 1, np.int64)
    for c in range(len(first)):
        members[first[c] + 1] += 1
        members[second[c] + 1] += 1
    for i in range(slots):
        members[i + 1] += members[i]
    free = members[:-1].copy()
    member = np.empty(2 * len(first), np.int32)
    for c in range(len(first)):
        for second_one in range(2):
            i = second[c] if second_one else first[c]
            member[free[i]] = 2 * c + second_one
            free[i] += 1
    return member, members


@njit(cache=True, nogil=True, error_model="numpy")
def densities(
    x: np.ndarray, z: np.ndarray, area: np.ndarray, first: np.ndarray, second: np.ndarray, reach: float, period: Period
) -> np.ndarray:
    """How densely areas (m2) lie at all discs (n,), of the pairs that are listed."""
    out = area * (7.0 / (math.pi * reach * reach))
    for c in range(len(first)):
        i, j = first[c], second[c]
        dx, dz = image(x[j] - x[i], z[j] - z[i], period)
        apart = math.sqrt(dx * dx + dz * dz)
        if apart < reach:
            width = density_kernel(apart, reach)[0]
            out[i] += area[j] * width
            out[j] += area[i] * width
    return out


@inner(nogil=True)
def liquefied_energy(wet: Liquefied, shared: np.ndarray, force: np.ndarray) -> tuple[float, float]:
    """Energy (J) stored in pore water and in bonds, and forces of the last look added to those on discs (3, slots).

    What discs have moved since the places at which pairs were looked at is work of these forces that they still hold.
    """
    discs = wet.discs
    water, bonds = 0.0, 0.0
    for k in range(len(wet.near)):
        i = np.int64(wet.near[k])
        fx, fz = discs[i, FORCE_X], discs[i, FORCE_Z]
        force[0, i] += fx
        force[1, i] += fz
        water -= fx * (shared[8 * i] - discs[i, AT_X]) + fz * (shared[8 * i + 1] - discs[i, AT_Z])
        if discs[i, SHARE] > 0.0:
            water += water_energy(
                discs[i, SHARE], discs[i, AREA], discs[i, PRESSURE], discs[i, STIFFNESS], discs[i, DENSITY],
                discs[i, NOW],
            )  # fmt: skip
    for c in range(len(wet.first)):
        along, across = wet.memory[c, ALONG], wet.memory[c, ACROSS]
        bonds += 0.5 * wet.memory[c, YIELD] * (along * along + across * across)
    return water, bonds
