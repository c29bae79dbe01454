"""Computes the forces of liquefied ground, whose pore pressure carries its weight and whose bonds provide its residual
strength (kernel).

Two laws act between every two discs that are nearer than the reach H if one of them has liquefied. Both laws of
liquefied ground are independent of contacts.

1. Pore pressure by volume. A disc represents an area V with its voids. The density of these areas is rho_i = sum_j V_j
W(r_ij), the disc itself included, with the kernel C2 of Wendland (1995) as W. The pore pressure in excess of the
   hydrostatic one is u_i = max(0, u0 + K_w (rho/rho0 - 1)) share + zeta d rho/dt: the effective overburden that pore
   water took over when the ground liquefied, and a term of its compression. The two discs of a pair repel each other
   along the line of centres with -V_i V_j (u_i/rho_i^2 + u_j/rho_j^2) dW/dr (Monaghan 1992), which resists pressure but
   not shear.
2. Residual strength. An elastic-plastic bond between the centres resists both components of their relative motion; its
resultant is at most c_ij = (pi/2) FITTED (s_i V_i/S_i + s_j V_j/S_j) w(r), S_i = sum_j w r. With this limit sum_j c_ij
r_ij does not depend on the packing, and ground that slips has the shear stress s. The stiffness of the bond is
c_ij/(gamma r).
   Ground with a strain potential is soft at first: the force-displacement law is a straight line up to the potential,
   with a dashpot in parallel, and a steep one from there to the limit (`kernels.bond_law`). A part of a bond between
   liquefied and other ground lies in the other ground, which does not strain: the displacements of such a bond are
   multiplied by `STRAINED`. Bonds that exist from the onset have 1 + FIRST times this limit until they have slipped:
   discs that lose their contacts rearrange, and until slip has aligned all bonds, those at their limit give only 0.77
   s.

Pressure and strength of a pair are sums of two terms, one for each disc. A partner that is fixed or has not liquefied
has no term; the term of the liquefied disc then has the weight 2. If the partner has liquefied to a smaller degree, the
pressure term of the disc has the weight 2 less the degree of the partner over that of the disc (`stand_in_shares`). In
a bond between two strata the term of the weaker disc has the weight 2, since the ground slips where it is weakest.
Forces are evaluated every few steps, for the positions in the middle of these steps, and are constant in between. Sums
over the pairs of a disc are in the order of its partners, so that they do not depend on the number of threads.

Work is summed from one evaluation to the next with the constant forces, except that half of the last step has the new
forces (velocity Verlet).
"""

import math
from typing import NamedTuple

import numpy as np

from dem.kernels.device_function import device_function
from dem.kernels.liquefied_laws import bond_kernel, density_kernel, stand_in_shares, water_pressure
from dem.kernels.losses import both
from dem.kernels.period import Period, image
from dem.kernels.prefetch import wide_vectors

# What a disc has, in a record of its own: how far it has liquefied (0 to 1), area with voids (m2); pressure u0 (Pa) and
# density rho0 (-) at that time, stiffness K_w (Pa) and viscosity zeta (Pa s) of the pore water; residual strength (Pa)
# and the shear strain at which it is reached. What was found when pairs were last looked at: place (m), density, push
# u/rho^2 (Pa) and the part of it by viscosity, V/S (1/m), force (N). What is left of strength, and of the strain
# at which it is reached, at the strain potential (-); both 0 without one. Number of its stratum.
SHARE, AREA, PRESSURE, DENSITY, STIFFNESS, VISCOSITY, STRENGTH, STRAIN = range(8)
AT_X, AT_Z, NOW, PRESSURE_TERM, DRAG, BOND, FORCE_X, FORCE_Z = range(8, 16)
KNEE, SOFT_TO, STRATUM = 16, 17, 18
FIELDS = 19
ONE, TWO, THREE = (np.uint64(k) for k in (1, 2, 3))  # z, vx, vz in the record of a disc that all share

# Pairs lie in blocks of 64 lanes, as contacts do; a field of a block is 64 doubles in a row. What a pair remembers: how
# far its strength is mobilised, along and across (pull and slip positive, 1 together at most); the same of the spring
# behind its dashpot; twice the energy that the bond stores at its limit (J); force besides (N); what is left of the
# strength beyond its limit (1 to 0); force that takes back what shear its pressure bears (N), see `pressure_shear`.
LANES = 64
MEMORY = 10
FRESH, TAKEN_ALONG_AT, TAKEN_ACROSS_AT = 7, 8, 9
ALONG, ACROSS, LATE_ALONG, LATE_ACROSS, YIELD, DASH_ALONG, DASH_ACROSS, LEFT, TAKEN_ALONG, TAKEN_ACROSS = (
    np.uint64(k * LANES) for k in range(MEMORY)
)
REMEMBERED = np.uint64(MEMORY * LANES)

# What is worked out for a pair: where the second disc is from the first and how it moves (m, m/s), where it was at the
# last look (m); what stands in between them (N m), areas (m2). The first seven give way to direction, speeds along and
# across (m/s), stretch and slip (m), distance (m). Then what it adds to sums of its first and of its second disc:
# density, rate of density, lever (m), which give way to strength and force. Last the time of the dashpot of soft ground
# (s).
WORKING = 17
DX, DZ, UX, UZ, OX, OZ, EDGE, AREA_1, AREA_2, SLOPE, WIDTH_1, WIDTH_2, RATE_1, RATE_2, LEVER_1, LEVER_2, CREEPS = (
    np.uint64(k * LANES) for k in range(WORKING)
)
NX, NZ, SPEED, TURN, STRETCH, SLIP, APART = DX, DZ, UX, UZ, OX, OZ, EDGE
PAIR_PRESSURE, BOND_SUM, ROOM, STANDS_IN, KNEES, ENDS = WIDTH_1, WIDTH_2, RATE_1, RATE_2, LEVER_1, LEVER_2
FORCE_X1, FORCE_X2, FORCE_Z1, FORCE_Z2 = WIDTH_1, WIDTH_2, RATE_1, RATE_2
WORKED = np.uint64(WORKING * LANES)
TO_RATE, TO_LEVER = RATE_1 - WIDTH_1, LEVER_1 - WIDTH_1  # from where a member's density lies; its forces, likewise

FAR = 1e6  # reaches: how far apart lanes without a pair count

LESS = 1e-12  # of a reach: what S is at least


class Liquefied(NamedTuple):
    """Holds liquefied discs and their pairs as arguments of kernels; without liquefaction there are no pairs.

    Attributes
    ----------
    discs (slots, FIELDS) : fields of every disc, in spatial order
    first, second (lanes,) : numbers of the two discs in spatial order, sorted by the first, then by the second; equal
        in lanes without a pair
    memory (blocks * REMEMBERED,) : history variables, see `ALONG` and the names after it
    working (blocks * WORKED,) : work arrays, see `DX` and the names after it
    start (slices + 1,) : first block of each slice, by the first discs
    member (2 pairs,) : places in `working` of the contributions of pairs to the density of every disc
    members (slots + 1,) : first entry of `member` of each disc
    near (discs with pairs,) : numbers of the discs that have pairs
    near_start (slices + 1,) : first entry of `near` of each slice
    reach : reach H of the kernels (m)
    every : number of steps for which forces are constant
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


@device_function(nogil=True, _nrt=False)
def fetch_motion(block: int, wet: Liquefied, shared: np.ndarray, later: float, with_losses: bool) -> None:
    """Compute the relative positions after `later` seconds, and the velocities, of the discs of a block of pairs.

    wet: liquefied pairs; shared: records of all discs; with_losses: whether work is summed.
    """
    discs, w = wet.discs, wet.working
    at = np.uint64(block) * WORKED
    for lane in range(LANES):
        q = at + np.uint64(lane)
        c = block * LANES + lane
        i, j = np.int64(wet.first[c]), np.int64(wet.second[c])
        a, b = np.uint64(8 * i), np.uint64(8 * j)
        ux, uz = shared[b + TWO] - shared[a + TWO], shared[b + THREE] - shared[a + THREE]
        w[q + UX], w[q + UZ] = ux, uz
        w[q + DX] = shared[b] - shared[a] + later * ux
        w[q + DZ] = shared[b + ONE] - shared[a + ONE] + later * uz
        w[q + OX] = discs[j, AT_X] - discs[i, AT_X]
        w[q + OZ] = discs[j, AT_Z] - discs[i, AT_Z]
        area_i, area_j = discs[i, AREA], discs[j, AREA]
        w[q + AREA_1], w[q + AREA_2] = area_i, area_j
        if with_losses:
            more_i, more_j = stand_in_shares(discs[i, SHARE], discs[j, SHARE])
            w[q + EDGE] = area_i * area_j * (more_i * discs[i, PRESSURE_TERM] + more_j * discs[j, PRESSURE_TERM])


@device_function(nogil=True, _nrt=False)
def look_at_pairs(block: int, wet: Liquefied, period: Period, with_losses: bool) -> float:
    """Compute densities, relative positions and relative speeds of a block of pairs, after `fetch_motion`; `wet`:
    liquefied pairs; `period`: period of the ground.

    With `with_losses` the function returns the work (J), since the last evaluation, of the pressures that stand in for
    partners that have liquefied less.
    """
    wide_vectors()
    w, reach = wet.working, wet.reach
    work = 0.0
    for lane in range(LANES):
        q = np.uint64(block) * WORKED + np.uint64(lane)
        ux, uz = w[q + UX], w[q + UZ]
        dx, dz = image(w[q + DX], w[q + DZ], period)
        ox, oz = image(w[q + OX], w[q + OZ], period)
        square = dx * dx + dz * dz
        apart = math.sqrt(square if square > 0.0 else FAR * reach * reach)
        before = math.sqrt(ox * ox + oz * oz)
        inverse = 1.0 / apart
        nx, nz = dx * inverse, dz * inverse
        inside = apart if apart < reach else reach
        width, slope = density_kernel(inside, reach)
        area_i, area_j, edge = w[q + AREA_1], w[q + AREA_2], w[q + EDGE]
        if with_losses:
            was = before if before < reach else reach
            pressure_force = -edge * density_kernel(was, reach)[1]
            way = ((dx - ox) * ox + (dz - oz) * oz) / (before + LESS * reach)
            work = both(work, pressure_force * way)
        speed = ux * nx + uz * nz
        lever = bond_kernel(inside, reach) * inside
        w[q + NX], w[q + NZ], w[q + SPEED], w[q + TURN] = nx, nz, speed, uz * nx - ux * nz
        w[q + STRETCH], w[q + SLIP] = apart - before, 2.0 * (ox * dz - oz * dx) / (apart + before)
        w[q + APART], w[q + SLOPE] = apart, slope
        w[q + WIDTH_1], w[q + WIDTH_2] = area_j * width, area_i * width
        w[q + RATE_1], w[q + RATE_2] = area_j * slope * speed, area_i * slope * speed
        w[q + LEVER_1], w[q + LEVER_2] = lever, lever
    return (1.0 - 0.5 / wet.every) * work


@device_function(nogil=True, _nrt=False)
def look_at_discs(begin: int, end: int, wet: Liquefied, shared: np.ndarray, later: float, with_losses: bool) -> float:
    """Compute density, pressure and share of strength of the discs near[begin:end]; return the losses (J) by viscosity.

    wet: liquefied pairs; shared: records of all discs; later: see `fetch_motion`; with_losses: whether work is summed.
    """
    discs, w, reach = wet.discs, wet.working, wet.reach
    self_kernel = 7.0 / (math.pi * reach * reach)
    lost = 0.0
    for k in range(begin, end):
        i = np.int64(wet.near[k])
        at = np.uint64(8 * i)
        discs[i, AT_X] = shared[at] + later * shared[at + TWO]
        discs[i, AT_Z] = shared[at + ONE] + later * shared[at + THREE]
        share, area = discs[i, SHARE], discs[i, AREA]
        if share == 0.0:
            continue
        density, rate, levers = area * self_kernel, 0.0, LESS * reach
        for m in range(wet.members[i], wet.members[i + 1]):
            q = np.uint64(wet.member[m])
            density += w[q]
            rate += w[q + TO_RATE]
            levers += w[q + TO_LEVER]
        still = water_pressure(share, discs[i, PRESSURE], discs[i, STIFFNESS], density / discs[i, DENSITY] - 1.0)
        whole = still + share * discs[i, VISCOSITY] * rate
        whole = whole if whole > 0.0 else 0.0
        drag = (whole - still) / (density * density)
        if with_losses:
            viscous_mean = discs[i, DRAG] + 0.5 / wet.every * (drag - discs[i, DRAG])
            lost += area * viscous_mean * (density - discs[i, NOW])
        discs[i, NOW] = density
        discs[i, PRESSURE_TERM] = whole / (density * density)
        discs[i, DRAG] = drag
        discs[i, BOND] = share * discs[i, STRENGTH] * area / levers
    return lost
