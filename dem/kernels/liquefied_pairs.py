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
2. Residual strength. An elastic-plastic bond between the centres resists both components of their relative motion, less
the rotation of the ground about them; its resultant is at most c_ij = 2 f (s_i V_i/S_i + s_j V_j/S_j) w(r), S_i =
sum_j w r, f = `FITTED_STRENGTH`. With this limit sum_j c_ij r_ij does not depend on the packing, and ground that slips
has the shear stress s, in simple and in pure shear. The stiffness of the bond is c_ij/(gamma r).
   The ground about a disc rotates by omega_i = sum_j w d_ij / S_i, with the motion d_ij of the partner across the line
of centres; the slip of a bond is d_ij - r (omega_i + omega_j) / 2. Ground that rotates as a block is not resisted. The
forces follow by virtual work: each pair has in addition the force -w (M_i/S_i + M_j/S_j) across the line of centres,
with the moments M_i = sum_j r t_ij / 2 of the forces t_ij of the bonds across. The moments of all forces about a disc
are in balance, and the shear stress is symmetric. The M_i are those of the evaluation before: the difference of work is
booked as a loss. The w and S_i belong to the present positions: with the S_i of the evaluation before, a disc that
comes within reach would get a force as many times too large as its w has grown since then.
   Without these additional forces the ground would resist a rotation at the rate omega with the power pi/2 s omega per
area: a slope of clay on a weak seam moved 1.0 m instead of 1.7 m, since the wedge behind its crest did not fall.
   Bonds of two strata slip about the rotation of the weaker disc alone, and count in its sums alone.
   Ground with a strain potential is soft at first: the force-displacement law is a straight line up to the potential,
   with a dashpot in parallel, and a steep one from there to the limit (`kernels.liquefied_laws`). A part of a bond
   between liquefied and other ground lies in the other ground, which does not strain: the displacements of such a bond
   are multiplied by `STRAINING_SHARE`. Bonds that exist from the onset have 1 + `EXTRA_STRENGTH` times this limit until
   they have slipped: until slip has aligned all bonds, ground at its limit has only 0.8 to 0.95 s.

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

# Fields of a disc: degree of liquefaction (0 to 1), area with voids (m2); pressure u0 (Pa) and density rho0 (-) at the
# onset, stiffness K_w (Pa) and viscosity zeta (Pa s) of the pore water; residual strength (Pa) and the shear strain at
# which it is reached. At the last evaluation of the pairs: place (m), density (-), pressure term u/rho^2 (Pa) and its
# part by viscosity, bond term V/S (1/m), force (N). Strength at the strain potential over the residual strength, and
# strain potential over the strain at which the residual strength is reached (-); both 0 without a strain potential.
# Number of the stratum. Sum S of the levers of the bonds in which the rotation of the disc counts (m), this rotation
# since the evaluation before (rad), moment M of these bonds (N m), and the one that acts until the next evaluation,
# over S (N).
SHARE, AREA, PRESSURE, DENSITY, STIFFNESS, VISCOSITY, STRENGTH, STRAIN = range(8)
AT_X, AT_Z, PRESENT_DENSITY, PRESSURE_TERM, DRAG, BOND, FORCE_X, FORCE_Z = range(8, 16)
KNEE_STRENGTH, KNEE_STRAIN, STRATUM = 16, 17, 18
ARM, SPIN, COUPLE, APPLIED_COUPLE = 19, 20, 21, 22
FIELDS = 23
RECORD_Z, RECORD_VX, RECORD_VZ = (np.uint64(k) for k in (1, 2, 3))  # fields of the shared record of a disc

# Pairs lie in blocks of 64 lanes, as contacts do; a field of a block is 64 doubles in a row. History variables of a
# pair: mobilised share of its strength, along and across (pull and slip positive, resultant at most 1); the same of the
# spring in series with its second dashpot (Maxwell); twice the energy that the bond stores at its limit (J); force of
# the dashpots (N); remaining share of its extra strength (1 to 0); force that cancels the shear stress of its pressure
# (N), see `pressure_shear`.
LANES = 64
MEMORY = 10
ALONG_AT, ACROSS_AT, LIMIT_ENERGY_AT, DASH_ALONG_AT, DASH_ACROSS_AT = 0, 1, 4, 5, 6
EXTRA_SHARE_AT, COUNTER_ALONG_AT, COUNTER_ACROSS_AT = 7, 8, 9
(
    ALONG, ACROSS, MAXWELL_ALONG, MAXWELL_ACROSS, LIMIT_ENERGY, DASH_ALONG, DASH_ACROSS, EXTRA_SHARE, COUNTER_ALONG,
    COUNTER_ACROSS,
) = (np.uint64(k * LANES) for k in range(MEMORY))  # fmt: skip
MEMORY_BLOCK = np.uint64(MEMORY * LANES)  # doubles in the history variables of a block

# Work arrays of a pair: position and velocity of the second disc relative to the first (m, m/s), relative position at
# the last evaluation (m); areas times the pressures that stand in for a partner that has liquefied less (N m), areas
# (m2), slope of the kernel. The first seven are overwritten by direction, speeds along and across (m/s), stretch and
# slip (m), distance (m). Then contributions to the sums of the first and of the second disc: density, its rate, lever
# (m), motion across (m), which are overwritten by sums of pressure, strength and strain, rotation and moment, then by
# forces and moments. Last the time of the dashpot of soft ground (s), and the shares of both discs in the rotation.
WORKING = 23
(
    DX, DZ, UX, UZ, OLD_X, OLD_Z, STAND_IN_PRESSURE, AREA_1, AREA_2, SLOPE, WIDTH_1, WIDTH_2, RATE_1, RATE_2, LEVER_1,
    LEVER_2, TURN_1, TURN_2, ARM_1, ARM_2, CREEP_TIME, PART_1, PART_2,
) = (np.uint64(k * LANES) for k in range(WORKING))  # fmt: skip
NX, NZ, ALONG_SPEED, ACROSS_SPEED, STRETCH, SLIP, DISTANCE = DX, DZ, UX, UZ, OLD_X, OLD_Z, STAND_IN_PRESSURE
PAIR_PRESSURE, BOND_SUM, STRAIN_SUM, STAND_IN_SHARE = WIDTH_1, WIDTH_2, RATE_1, RATE_2
KNEE_STRENGTH_SUM, KNEE_STRAIN_SUM, PAIR_SPIN, PAIR_COUPLE = LEVER_1, LEVER_2, TURN_1, TURN_2
MOMENT_1, MOMENT_2 = LEVER_1, LEVER_2
FORCE_X1, FORCE_X2, FORCE_Z1, FORCE_Z2 = WIDTH_1, WIDTH_2, RATE_1, RATE_2
WORKING_BLOCK = np.uint64(WORKING * LANES)  # doubles in the work arrays of a block
# from the density of a contribution, or from its first force
TO_RATE, TO_LEVER, TO_TURN, TO_ARM = (row - WIDTH_1 for row in (RATE_1, LEVER_1, TURN_1, ARM_1))

ABSENT_SQUARE = 1e6  # square of the distance in lanes without a pair, over the square of the reach

SMALLEST_DIVISOR = 1e-12  # added to divisors (Pa), and times the reach (m), so that they are not zero


class Liquefied(NamedTuple):
    """Holds liquefied discs and their pairs as arguments of kernels; without liquefaction there are no pairs.

    Attributes
    ----------
    discs (slots, FIELDS) : fields of every disc, in spatial order
    disc_i, disc_j (lanes,) : numbers of the two discs in spatial order, sorted by ``disc_i``, then by ``disc_j``; equal
        in lanes without a pair
    linear (blocks,) : whether all bonds of the block are linear: without a strain potential and without extra strength
    memory (blocks * MEMORY_BLOCK,) : history variables, see `ALONG` and the names after it
    working (blocks * WORKING_BLOCK,) : work arrays, see `DX` and the names after it
    start (slices + 1,) : first block of each slice, to which ``disc_i`` belongs
    member (2 pairs,) : places in `working` of the contributions of pairs to the density of every disc
    members (slots + 1,) : first entry of `member` of each disc
    paired (discs with pairs,) : numbers of the discs that have pairs
    paired_start (slices + 1,) : first entry of `paired` of each slice
    reach : reach H of the kernels (m)
    steps_between_looks : number of steps for which forces are constant
    """

    discs: np.ndarray
    disc_i: np.ndarray
    disc_j: np.ndarray
    linear: np.ndarray
    memory: np.ndarray
    working: np.ndarray
    start: np.ndarray
    member: np.ndarray
    members: np.ndarray
    paired: np.ndarray
    paired_start: np.ndarray
    reach: float
    steps_between_looks: int


@device_function(forceinline=True)
def strength_weights(discs: np.ndarray, i: int, j: int) -> tuple[float, float]:
    """Return the weights of the strengths of both discs in the strength of their bond: 1 for each disc if both are of
    one stratum, else 2 for the weaker disc.

    While a disc liquefies, its contacts with clay, which already has bonds, fade before the residual strength of the
    disc has built up. Until the residual strength has built up, the bond has the strength of the clay, multiplied by
    the share of the disc that has not liquefied.
    """
    if discs[i, SHARE] == 0.0:
        return 0.0, 2.0
    if discs[j, SHARE] == 0.0:
        return 2.0, 0.0
    if discs[i, STRATUM] == discs[j, STRATUM]:
        return 1.0, 1.0
    if discs[i, BOND] * discs[j, SHARE] < discs[j, BOND] * discs[i, SHARE]:
        return 2.0, 2.0 * max(1.0 - discs[i, SHARE] / discs[j, SHARE], 0.0)
    return 2.0 * max(1.0 - discs[j, SHARE] / discs[i, SHARE], 0.0), 2.0


@device_function(forceinline=True)
def rotation_parts(discs: np.ndarray, i: int, j: int) -> tuple[float, float]:
    """Return the shares of both discs in the rotation about which their bond slips, by the strengths that count in it.

    Beside a weak stratum a strong one does not rotate with the slip of the weak one: bonds of two strata slip about the
    rotation of the weaker disc, and have no part in the rotation of the stronger one.
    """
    a, b = strength_weights(discs, i, j)
    return a / (a + b), b / (a + b)


@device_function(nogil=True, _nrt=False)
def fetch_motion(block: int, wet: Liquefied, shared: np.ndarray, later: float, with_losses: bool) -> None:
    """Compute the relative positions after `later` seconds, and the velocities, of the discs of a block of pairs.

    wet: liquefied pairs; shared: records of all discs; with_losses: whether work is summed.
    """
    discs, w = wet.discs, wet.working
    at = np.uint64(block) * WORKING_BLOCK
    for lane in range(LANES):
        q = at + np.uint64(lane)
        c = block * LANES + lane
        i, j = np.int64(wet.disc_i[c]), np.int64(wet.disc_j[c])
        a, b = np.uint64(8 * i), np.uint64(8 * j)
        ux, uz = shared[b + RECORD_VX] - shared[a + RECORD_VX], shared[b + RECORD_VZ] - shared[a + RECORD_VZ]
        w[q + UX], w[q + UZ] = ux, uz
        w[q + DX] = shared[b] - shared[a] + later * ux
        w[q + DZ] = shared[b + RECORD_Z] - shared[a + RECORD_Z] + later * uz
        w[q + OLD_X] = discs[j, AT_X] - discs[i, AT_X]
        w[q + OLD_Z] = discs[j, AT_Z] - discs[i, AT_Z]
        area_i, area_j = discs[i, AREA], discs[j, AREA]
        w[q + AREA_1], w[q + AREA_2] = area_i, area_j
        w[q + PART_1], w[q + PART_2] = rotation_parts(discs, i, j)
        if with_losses:
            more_i, more_j = stand_in_shares(discs[i, SHARE], discs[j, SHARE])
            w[q + STAND_IN_PRESSURE] = (
                area_i * area_j * (more_i * discs[i, PRESSURE_TERM] + more_j * discs[j, PRESSURE_TERM])
            )


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
        q = np.uint64(block) * WORKING_BLOCK + np.uint64(lane)
        ux, uz = w[q + UX], w[q + UZ]
        dx, dz = image(w[q + DX], w[q + DZ], period)
        ox, oz = image(w[q + OLD_X], w[q + OLD_Z], period)
        square = dx * dx + dz * dz
        apart = math.sqrt(square if square > 0.0 else ABSENT_SQUARE * reach * reach)
        before = math.sqrt(ox * ox + oz * oz)
        inverse = 1.0 / apart
        nx, nz = dx * inverse, dz * inverse
        inside = apart if apart < reach else reach
        width, slope = density_kernel(inside, reach)
        area_i, area_j, edge = w[q + AREA_1], w[q + AREA_2], w[q + STAND_IN_PRESSURE]
        if with_losses:
            was = before if before < reach else reach
            pressure_force = -edge * density_kernel(was, reach)[1]
            way = ((dx - ox) * ox + (dz - oz) * oz) / (before + SMALLEST_DIVISOR * reach)
            work = both(work, pressure_force * way)
        speed = ux * nx + uz * nz
        share = bond_kernel(inside, reach)
        slip = 2.0 * (ox * dz - oz * dx) / (apart + before)
        lever = share * inside
        first, second = (1.0 if w[q + PART_1] > 0.0 else 0.0), (1.0 if w[q + PART_2] > 0.0 else 0.0)
        w[q + NX], w[q + NZ], w[q + ALONG_SPEED], w[q + ACROSS_SPEED] = nx, nz, speed, uz * nx - ux * nz
        w[q + STRETCH], w[q + SLIP] = apart - before, slip
        w[q + DISTANCE], w[q + SLOPE] = apart, slope
        w[q + WIDTH_1], w[q + WIDTH_2] = area_j * width, area_i * width
        w[q + RATE_1], w[q + RATE_2] = area_j * slope * speed, area_i * slope * speed
        w[q + LEVER_1], w[q + LEVER_2] = lever, lever
        w[q + TURN_1], w[q + TURN_2] = first * share * slip, second * share * slip
        w[q + ARM_1], w[q + ARM_2] = first * lever, second * lever
    return (1.0 - 0.5 / wet.steps_between_looks) * work


@device_function(nogil=True, _nrt=False)
def look_at_discs(begin: int, end: int, wet: Liquefied, shared: np.ndarray, later: float, with_losses: bool) -> float:
    """Compute density, pressure and share of strength of the discs near[begin:end]; return the losses (J) by viscosity.

    wet: liquefied pairs; shared: records of all discs; later: see `fetch_motion`; with_losses: whether work is summed.
    """
    discs, w, reach = wet.discs, wet.working, wet.reach
    self_kernel = 7.0 / (math.pi * reach * reach)
    lost = 0.0
    for k in range(begin, end):
        i = np.int64(wet.paired[k])
        at = np.uint64(8 * i)
        discs[i, AT_X] = shared[at] + later * shared[at + RECORD_VX]
        discs[i, AT_Z] = shared[at + RECORD_Z] + later * shared[at + RECORD_VZ]
        share, area = discs[i, SHARE], discs[i, AREA]
        if share == 0.0:
            continue
        density, rate, levers, turn = area * self_kernel, 0.0, SMALLEST_DIVISOR * reach, 0.0
        arm = SMALLEST_DIVISOR * reach
        for m in range(wet.members[i], wet.members[i + 1]):
            q = np.uint64(wet.member[m])
            density += w[q]
            rate += w[q + TO_RATE]
            levers += w[q + TO_LEVER]
            turn += w[q + TO_TURN]
            arm += w[q + TO_ARM]
        still = water_pressure(share, discs[i, PRESSURE], discs[i, STIFFNESS], density / discs[i, DENSITY] - 1.0)
        whole = still + share * discs[i, VISCOSITY] * rate
        whole = whole if whole > 0.0 else 0.0
        drag = (whole - still) / (density * density)
        if with_losses:
            viscous_mean = discs[i, DRAG] + 0.5 / wet.steps_between_looks * (drag - discs[i, DRAG])
            lost += area * viscous_mean * (density - discs[i, PRESENT_DENSITY])
            lost += (discs[i, COUPLE] - discs[i, APPLIED_COUPLE] * discs[i, ARM]) * turn / arm
        discs[i, PRESENT_DENSITY] = density
        discs[i, PRESSURE_TERM] = whole / (density * density)
        discs[i, DRAG] = drag
        discs[i, BOND] = share * discs[i, STRENGTH] * area / levers
        discs[i, ARM], discs[i, SPIN], discs[i, APPLIED_COUPLE] = arm, turn / arm, discs[i, COUPLE] / arm
    return lost
