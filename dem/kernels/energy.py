"""Kernel: the energies of the discs at one instant, from the layout that the stepping kernel works on.

The kinetic energy is m/2 v(n-1/2) v(n+1/2): of second order like the scheme, and what the scheme keeps exactly. Its
second velocity takes the forces of this instant. They are taken here, and so is what springs, dashpots and boundaries
did since the last step, without anything being changed.
"""

import numpy as np
from numba import njit

from dem.kernels.added_mass import pull_added_mass
from dem.kernels.arguments import Law, Loads, Springs, State
from dem.kernels.chunks import add, face_partners
from dem.kernels.inner import inner
from dem.kernels.interaction import Contact, at_line, between_discs, line_lane
from dem.kernels.layout import (
    DISC,
    INVMASS,
    LANES,
    LINK,
    MASS,
    PULL_X,
    PULL_Z,
    RIM,
    ROLL_LINK,
    SHARE,
    VR,
    VX,
    VZ,
    Layout,
)
from dem.kernels.liquefied_pairs import liquefied_energy
from dem.kernels.losses import along
from dem.kernels.prefetch import wide_vectors
from dem.kernels.scratch import OWN, ROW, SUM_R, SUM_X, SUM_Z, load_all_constants, load_own, new_scratch

# Entries of what `energies` returns (J per metre out of plane); LATE ones came about since the last step.
TRANSLATION, ROTATION, ELEMENTS, PORES, ROLLING_SPRINGS, BONDS = range(6)
LATE_DASHPOT, LATE_SLIDING, LATE_CRACKS, LATE_ROLLING, LATE_BOUNDARY = range(6, 11)
PORE_WATER, LIQUEFIED_BONDS = 11, 12
ENERGIES = 13

# Where a chunk's forces on partners, and their rim forces, come to lie: over velocities no longer needed.
PARTNER_X, PARTNER_Z, PARTNER_R = VX, VZ, VR


@inner(nogil=True, forceinline=True)
def book(now: Contact, out: np.ndarray) -> None:
    """Adds the energy stored in a contact, and its losses since the last step."""
    out[ELEMENTS] += now.elements
    out[BONDS] += now.bonds
    out[PORES] += now.pores
    out[ROLLING_SPRINGS] += now.rolling
    out[LATE_DASHPOT] += 0.5 * now.damped
    out[LATE_SLIDING] += 0.5 * now.slid
    out[LATE_CRACKS] += 0.5 * now.cracked
    out[LATE_ROLLING] += 0.5 * now.rolled_off


@inner(nogil=True, forceinline=True)
def lanes_energy(
    chunk: int, state: State, scratch: np.ndarray, slip_time: float, law: Law, soil: bool, out: np.ndarray
) -> None:
    """Adds the energies of one chunk of contacts; their forces go to the owners' sums, and into the partners' rows."""
    wide_vectors()
    d, w = np.uint64(chunk) * LINK, np.uint64(chunk) * ROLL_LINK
    elements, bonds, pores, rolling = 0.0, 0.0, 0.0, 0.0
    damping, sliding, cracks, rolled_off = 0.0, 0.0, 0.0, 0.0
    for lane in range(LANES):
        q = np.uint64(lane)
        m, now = between_discs(d, q, w, state, scratch, slip_time, law, soil, True, True)
        elements = add(elements, now.elements)
        bonds = add(bonds, now.bonds)
        pores = add(pores, now.pores)
        rolling = add(rolling, now.rolling)
        damping = add(damping, now.damped)
        sliding = add(sliding, now.slid)
        cracks = add(cracks, now.cracked)
        rolled_off = add(rolled_off, now.rolled_off)
        fx, fz = now.push * m.nx + now.drag * m.nz, now.push * m.nz - now.drag * m.nx
        rim = now.drag * m.lever
        if soil:
            rim -= state.rolling[w + SHARE + q] * now.torque
        scratch[SUM_X + q] -= fx
        scratch[SUM_Z + q] -= fz
        scratch[SUM_R + q] += rim + now.torque
        scratch[PARTNER_X + q], scratch[PARTNER_Z + q], scratch[PARTNER_R + q] = fx, fz, rim
    out[ELEMENTS] += elements
    out[BONDS] += bonds
    out[PORES] += pores
    out[ROLLING_SPRINGS] += rolling
    out[LATE_DASHPOT] += 0.5 * damping
    out[LATE_SLIDING] += 0.5 * sliding
    out[LATE_CRACKS] += 0.5 * cracks
    out[LATE_ROLLING] += 0.5 * rolled_off


@inner(nogil=True)
def slice_energy(
    p: int, layout: Layout, springs: Springs, scratch: np.ndarray, slip_time: float, law: Law, force: np.ndarray,
    out: np.ndarray,
) -> None:  # fmt: skip
    """Adds the energies of all contacts that slice p owns, and their forces and rim forces to those on the discs."""
    state = State(layout.discs, layout.links, layout.rolling, layout.shared, layout.partner)
    load_own(p, layout.shared, scratch)
    for row in range(3):
        for lane in range(LANES):
            scratch[SUM_X + np.uint64(row) * ROW + np.uint64(lane)] = 0.0
    for chunk in range(layout.chunk_start[p], layout.chunk_start[p + 1]):
        load_all_constants(np.uint64(chunk) * ROW, layout.kinds, springs.records, True, True, scratch)
        face_partners(chunk, state, scratch, law, law.soil)
        if law.soil:
            lanes_energy(chunk, state, scratch, slip_time, law, True, out)
        else:
            lanes_energy(chunk, state, scratch, slip_time, law, False, out)
        for lane in range(LANES):
            j, q = np.int64(layout.partner[chunk * LANES + lane]), np.uint64(lane)
            force[0, j] += scratch[PARTNER_X + q]
            force[1, j] += scratch[PARTNER_Z + q]
            force[2, j] += scratch[PARTNER_R + q]
    for row in range(3):
        for lane in range(LANES):
            force[row, p * LANES + lane] += scratch[SUM_X + np.uint64(row) * ROW + np.uint64(lane)]


@inner(nogil=True)
def line_energy(
    e: int, layout: Layout, springs: Springs, slip_time: float, law: Law, out: np.ndarray
) -> tuple[float, float, float]:
    """The energies of the contact of a disc with a rigid line; returns the force and the rim force on the disc."""
    at, w = line_lane(e, layout)
    m, now = at_line(e, at, w, layout, springs, slip_time, law)
    book(now, out)
    return now.push * m.nx + now.drag * m.nz, now.push * m.nz - now.drag * m.nx, now.drag + now.torque


@inner(nogil=True)
def kinetic(
    p: int, layout: Layout, scratch: np.ndarray, force: np.ndarray, loads: Loads, dt: float, out: np.ndarray
) -> None:
    """Adds the kinetic energy of the discs of slice p that can move, and the work on those that are moved."""
    wide_vectors()
    discs = layout.discs
    ax, az = loads.acceleration[0, 0], loads.acceleration[1, 0]
    pull_added_mass(p, layout, loads.acceleration[2, 0])
    load_own(p, layout.shared, scratch)
    b, i = np.uint64(p) * DISC, np.uint64(p) * ROW
    translation, rotation, boundary = 0.0, 0.0, 0.0
    for lane in range(LANES):
        q = np.uint64(lane)
        fx, fz, fr = force[0, i + q], force[1, i + q], force[2, i + q]
        vx, vz, vr = scratch[OWN + VX + q], scratch[OWN + VZ + q], scratch[OWN + VR + q]
        invmass, rim = discs[b + INVMASS + q], discs[b + RIM + q]
        next_x = vx + dt * (fx * invmass + discs[b + PULL_X + q] + ax)
        next_z = vz + dt * (fz * invmass + discs[b + PULL_Z + q] + az)
        translation = add(translation, discs[b + MASS + q] * along(vx, vz, next_x, next_z))
        rotation = add(rotation, vr * (vr + dt * fr * rim) / rim if rim > 0.0 else 0.0)
        boundary = add(boundary, 0.0 if invmass > 0.0 else along(fx, fz, vx, vz) + fr * vr)
    out[TRANSLATION] += 0.5 * translation
    out[ROTATION] += 0.5 * rotation
    out[LATE_BOUNDARY] -= 0.5 * dt * boundary


@njit(cache=True, nogil=True, error_model="numpy")
def energies(layout: Layout, springs: Springs, law: Law, loads: Loads, last_dt: float) -> np.ndarray:
    """The energies of all discs and contacts (ENERGIES,); loads: those of this instant alone."""
    out = np.zeros(ENERGIES)
    slices = len(layout.chunk_start) - 1
    scratch = new_scratch()
    force = np.zeros((3, slices * LANES))
    for p in range(slices):
        slice_energy(p, layout, springs, scratch, last_dt, law, force, out)
    for e in range(len(layout.line_disc)):
        fx, fz, rim = line_energy(e, layout, springs, last_dt, law, out)
        i = layout.line_disc[e]
        force[0, i] += fx
        force[1, i] += fz
        force[2, i] += rim
    if len(layout.liquefied.first) > 0:
        out[PORE_WATER], out[LIQUEFIED_BONDS] = liquefied_energy(layout.liquefied, layout.shared, force)
    for p in range(slices):
        kinetic(p, layout, scratch, force, loads, last_dt, out)
    return out
