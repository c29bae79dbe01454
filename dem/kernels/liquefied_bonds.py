"""Computes the forces of pairs of liquefied discs from pore pressure and residual strength, and adds them up on the
discs (kernel); the laws are described in `liquefied_pairs`.
"""

import math

import numpy as np
from numba import njit

from dem.kernels import liquefied_pairs as bond
from dem.kernels.device_function import device_function
from dem.kernels.liquefied_laws import (
    SOFT_CREEP_TIME,
    bond_kernel,
    dashpot_share,
    decay,
    energy_share,
    force_share,
    mobilised,
    slopes,
    stand_in_shares,
)
from dem.kernels.losses import both
from dem.kernels.prefetch import wide_vectors

# s: dashpot over stiffness of the spring in series with the second dashpot of a bond: ground at rest oscillates at 5 to
# 20 rad/s.
MAXWELL_TIME = 0.1
MAXWELL_STIFFNESS_RATIO = 0.5  # stiffness of this spring over that of the bond
# Of the strength, of a bond that has not slipped yet: until slip has aligned the bonds, ground at its limit has 0.8 to
# 0.95 of its strength.
EXTRA_STRENGTH = 0.175
EXTRA_STRENGTH_STRAIN = 0.03  # shear strain beyond the limit in which the extra strength falls to 1/e
FITTED_STRENGTH = 1.0 / 0.97  # discs slip along surfaces whose strength is below the mean of all directions
BOND_LIMIT = 2.0 * FITTED_STRENGTH  # of a bond, over the sum of the bond terms of its discs and the kernel
# Share of a bond between liquefied and other ground that strains. Half of such a bond lies in the other ground, but
# neighbouring bonds share in its larger stiffness: crusts on layers of one to eight rows of discs move 0.9 to 1.0 times
# as far as in closed form (1.5 to 1.0 with a share of 1).
STRAINING_SHARE = 0.75


@device_function(forceinline=True)
def bond_weights(a: float, b: float) -> tuple[float, float]:
    """Return the weights of the force-displacement laws of both discs in their bond, which follow from the weights of
    their strengths."""
    return (2.0 - b if a > b else a), (2.0 - a if b > a else b)


@device_function(forceinline=True)
def bond_lines(discs: np.ndarray, i: int, j: int) -> tuple[float, float, float]:
    """Return the slopes of both lines of a bond, and the share of the displacement at which the lines meet."""
    a, b = bond_weights(*bond.strength_weights(discs, i, j))
    soft_to = 0.5 * (a * discs[i, bond.KNEE_STRAIN] + b * discs[j, bond.KNEE_STRAIN])
    soft, steep = slopes(0.5 * (a * discs[i, bond.KNEE_STRENGTH] + b * discs[j, bond.KNEE_STRENGTH]), soft_to)
    return soft, steep, soft_to


@device_function(forceinline=True)
def limiting_strain(discs: np.ndarray, i: int, j: int, a: float, b: float) -> float:
    """Return twice the strain at which the bond of the discs i and j reaches its limit; a, b: their `bond_weights`."""
    soft = a * discs[i, bond.KNEE_STRAIN] + b * discs[j, bond.KNEE_STRAIN] > 0.0
    straining = STRAINING_SHARE if a != b and soft else 1.0
    return straining * (a * discs[i, bond.STRAIN] + b * discs[j, bond.STRAIN])


@njit(cache=True, nogil=True, error_model="numpy")
def limiting_strains(discs: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    """Return the `limiting_strain` of the bonds of all pairs.

    Parameters
    ----------
    discs : (n, FIELDS) Fields of liquefied discs
    pairs : (2, pairs) Numbers of the discs of each pair

    Returns
    -------
    Twice the strain (pairs,) at which each bond reaches its limit.
    """
    strains = np.empty(pairs.shape[1])
    for c in range(pairs.shape[1]):
        i, j = pairs[0, c], pairs[1, c]
        a, b = bond_weights(*bond.strength_weights(discs, i, j))
        strains[c] = limiting_strain(discs, i, j, a, b)
    return strains


@device_function(nogil=True, _nrt=False)
def fetch_strength(block: int, wet: bond.Liquefied) -> None:
    """Compute pressure and strength of the pairs of a block as sums over both discs; the sums for bonds are
    weighted."""
    discs, w = wet.discs, wet.working
    for lane in range(bond.LANES):
        q = np.uint64(block) * bond.WORKING_BLOCK + np.uint64(lane)
        c = block * bond.LANES + lane
        i, j = np.int64(wet.disc_i[c]), np.int64(wet.disc_j[c])
        more_i, more_j = stand_in_shares(discs[i, bond.SHARE], discs[j, bond.SHARE])
        stands_in = more_i * discs[i, bond.PRESSURE_TERM] + more_j * discs[j, bond.PRESSURE_TERM]
        pressure = discs[i, bond.PRESSURE_TERM] + discs[j, bond.PRESSURE_TERM] + stands_in
        w[q + bond.PAIR_PRESSURE], w[q + bond.STAND_IN_SHARE] = pressure, stands_in / (pressure + bond.SMALLEST_DIVISOR)
        a, b = bond.strength_weights(discs, i, j)
        w[q + bond.BOND_SUM] = a * discs[i, bond.BOND] + b * discs[j, bond.BOND]
        a, b = bond_weights(a, b)
        w[q + bond.STRAIN_SUM] = limiting_strain(discs, i, j, a, b)
        w[q + bond.KNEE_STRENGTH_SUM] = a * discs[i, bond.KNEE_STRENGTH] + b * discs[j, bond.KNEE_STRENGTH]
        w[q + bond.KNEE_STRAIN_SUM] = a * discs[i, bond.KNEE_STRAIN] + b * discs[j, bond.KNEE_STRAIN]
        first, second = w[q + bond.PART_1], w[q + bond.PART_2]
        w[q + bond.PAIR_SPIN] = first * discs[i, bond.SPIN] + second * discs[j, bond.SPIN]
        couple_i = discs[i, bond.APPLIED_COUPLE] if first > 0.0 else 0.0
        w[q + bond.PAIR_COUPLE] = couple_i + (discs[j, bond.APPLIED_COUPLE] if second > 0.0 else 0.0)
        w[q + bond.CREEP_TIME], soft = SOFT_CREEP_TIME, i if discs[i, bond.KNEE_STRAIN] > 0.0 else j
        if (discs[i, bond.KNEE_STRAIN] > 0.0) != (discs[j, bond.KNEE_STRAIN] > 0.0):
            single = discs[soft, bond.BOND], STRAINING_SHARE * discs[soft, bond.STRAIN]
            w[q + bond.CREEP_TIME] *= dashpot_share(single, (w[q + bond.BOND_SUM], w[q + bond.STRAIN_SUM]))


@device_function(nogil=True, _nrt=False, forceinline=True)
def press_lanes(
    block: int, wet: bond.Liquefied, damping_time: float, relaxation: float, linear: bool, with_losses: bool
) -> tuple[float, float, float]:
    """Compute forces and history variables of the pairs of a block, after `fetch_strength` has read their strength; the
    compiler vectorises the loop only without calls, and with one sum for each energy. For `linear` bonds half of the
    roots and divisions, which take most of the time, have known results and are omitted.

    Returns energies (J) since the last evaluation: dissipation of bonds by slip and by dashpots, and the work of the
    pressures that stand in for partners that have liquefied less; zeros without `with_losses`. wet: arrays of the
    liquefied ground; damping_time: dashpot over stiffness of a bond (s); relaxation: share of the force of the spring
    in series with the second dashpot that remains at the next evaluation.
    """
    wide_vectors()
    w, memory, reach = wet.working, wet.memory, wet.reach
    slid, damped, work = 0.0, 0.0, 0.0
    part = 0.5 / wet.steps_between_looks
    rate = 0.5 / damping_time  # one over the time between two evaluations (1/s)
    for lane in range(bond.LANES):
        q = np.uint64(block) * bond.WORKING_BLOCK + np.uint64(lane)
        r = np.uint64(block) * bond.MEMORY_BLOCK + np.uint64(lane)
        apart, stands_in = w[q + bond.DISTANCE], w[q + bond.STAND_IN_SHARE]
        here = 1.0 if apart < reach else 0.0
        inside = apart if apart < reach else reach
        pressure_force = -w[q + bond.PAIR_PRESSURE] * w[q + bond.AREA_1] * w[q + bond.AREA_2] * w[q + bond.SLOPE]
        kernel = here * bond_kernel(inside, reach)
        strength = BOND_LIMIT * w[q + bond.BOND_SUM] * kernel
        room = 0.5 * w[q + bond.STRAIN_SUM] * inside + bond.SMALLEST_DIVISOR * reach  # way (m) at which the bond slips
        rotation, couple = inside * w[q + bond.PAIR_SPIN], kernel * w[q + bond.PAIR_COUPLE]
        stretch, slip = w[q + bond.STRETCH], w[q + bond.SLIP] - rotation
        soft, steep, soft_to, fresh, more = 0.0, 1.0, 0.0, 0.0, 1.0
        if not linear:
            soft_to = 0.5 * w[q + bond.KNEE_STRAIN_SUM]
            soft, steep = slopes(0.5 * w[q + bond.KNEE_STRENGTH_SUM], soft_to)
            fresh = memory[r + bond.EXTRA_SHARE]
            more = 1.0 + EXTRA_STRENGTH * fresh
            strength, room = more * strength, more * room
        along, across = memory[r + bond.ALONG], memory[r + bond.ACROSS]
        inverse = here / room
        tried_along, tried_across = along + stretch * inverse, across + slip * inverse
        new_along, new_across = mobilised(tried_along, tried_across)
        left, gain, energy = 0.0, 1.0, strength * room
        yields = energy
        if not linear:
            past = math.sqrt((tried_along - new_along) ** 2 + (tried_across - new_across) ** 2)
            left = here * fresh * decay(past * room / (EXTRA_STRENGTH_STRAIN * inside))
            gain = more / (1.0 + EXTRA_STRENGTH * left)  # the limit falls, and what is mobilised of it grows
            yields = energy / (gain * gain)
        here_along, here_across = mobilised(here * gain * new_along, here * gain * new_across)
        mobilised_share = 1.0 if linear else force_share(new_along, new_across, soft, steep)
        if with_losses:
            dashed = memory[r + bond.DASH_ALONG] * stretch + memory[r + bond.DASH_ACROSS] * slip
            damped_here = (1.0 - part) * dashed
            work_here = stands_in * part * pressure_force * stretch
            weaker = 0.5 * (memory[r + bond.LIMIT_ENERGY] - energy)
            weaker *= energy_share(along, across, soft, steep, soft_to, linear)
            was = 1.0 if linear else force_share(along, across, soft, steep)
            cut = (was * along + mobilised_share * new_along) * (tried_along - new_along)
            cut += (was * across + mobilised_share * new_across) * (tried_across - new_across)
            stored = energy * energy_share(new_along, new_across, soft, steep, soft_to, linear)
            left_over = yields * energy_share(here_along, here_across, soft, steep, soft_to, linear)
            slid = both(slid, weaker + 0.5 * (energy * cut + stored - left_over))
        memory[r + bond.LIMIT_ENERGY], memory[r + bond.EXTRA_SHARE] = yields, left
        late_along, late_across = mobilised(
            relaxation * (memory[r + bond.MAXWELL_ALONG] + MAXWELL_STIFFNESS_RATIO * stretch * inverse),
            relaxation * (memory[r + bond.MAXWELL_ACROSS] + MAXWELL_STIFFNESS_RATIO * slip * inverse),
        )
        delay = damping_time * inverse
        if not linear:
            delay = (damping_time + w[q + bond.CREEP_TIME] * soft) * inverse
        new_along, new_across = mobilised_share * new_along, mobilised_share * new_across
        soon_along, soon_across = mobilised(
            new_along + late_along + w[q + bond.ALONG_SPEED] * delay,
            new_across + late_across + (w[q + bond.ACROSS_SPEED] - rotation * rate) * delay,
        )
        pull, drag = strength * soon_along, strength * soon_across
        dash_along, dash_across = pull - strength * new_along, drag - strength * new_across
        taken_along, taken_across = here * memory[r + bond.COUNTER_ALONG], here * memory[r + bond.COUNTER_ACROSS]
        moment = drag * inside
        pull, drag = pull + taken_along, drag + taken_across - couple
        if with_losses:
            work = both(work, work_here - (taken_along * stretch + taken_across * w[q + bond.SLIP]))
        # beyond the reach strength has gone to nothing, and is forgotten
        memory[r + bond.ALONG], memory[r + bond.ACROSS] = here_along, here_across
        memory[r + bond.MAXWELL_ALONG], memory[r + bond.MAXWELL_ACROSS] = here * late_along, here * late_across
        memory[r + bond.DASH_ALONG], memory[r + bond.DASH_ACROSS] = dash_along, dash_across
        if with_losses:
            damped = both(damped, damped_here + part * (dash_along * stretch + dash_across * slip))
        nx, nz, normal = w[q + bond.NX], w[q + bond.NZ], pressure_force - pull
        fx, fz = normal * nx + drag * nz, normal * nz - drag * nx
        w[q + bond.FORCE_X1], w[q + bond.FORCE_X2], w[q + bond.FORCE_Z1], w[q + bond.FORCE_Z2] = -fx, fx, -fz, fz
        w[q + bond.MOMENT_1], w[q + bond.MOMENT_2] = w[q + bond.PART_1] * moment, w[q + bond.PART_2] * moment
    return slid, damped, work


@device_function(nogil=True, _nrt=False)
def press_pairs(block: int, wet: bond.Liquefied, damping_time: float, relaxation: float, linear: bool) -> None:
    """Compute the forces of the pairs of a block; wet, damping_time, relaxation, linear: as in `press_lanes`."""
    if linear:
        press_lanes(block, wet, damping_time, relaxation, True, False)
    else:
        press_lanes(block, wet, damping_time, relaxation, False, False)


@device_function(nogil=True, _nrt=False)
def press_pairs_with_losses(
    block: int, wet: bond.Liquefied, damping_time: float, relaxation: float, linear: bool
) -> tuple[float, float, float]:
    """Compute the forces and the energies of the pairs of a block; wet, damping_time, relaxation, linear and result: as
    in `press_lanes`."""
    if linear:
        return press_lanes(block, wet, damping_time, relaxation, True, True)
    return press_lanes(block, wet, damping_time, relaxation, False, True)


@device_function(nogil=True, _nrt=False)
def sum_pairs(begin: int, end: int, wet: bond.Liquefied) -> None:
    """Add up the forces of pairs on the discs near[begin:end]."""
    discs, w = wet.discs, wet.working
    for k in range(begin, end):
        i = np.int64(wet.paired[k])
        fx, fz, moment = 0.0, 0.0, 0.0
        for m in range(wet.members[i], wet.members[i + 1]):
            q = np.uint64(wet.member[m])
            fx += w[q]
            fz += w[q + bond.TO_RATE]
            moment += w[q + bond.TO_LEVER]
        discs[i, bond.FORCE_X], discs[i, bond.FORCE_Z] = fx, fz
        discs[i, bond.COUPLE] = moment
