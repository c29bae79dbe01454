"""Kernel: the energies of the discs at one instant, from the layout that the stepping kernel works on.

The kinetic energy is m/2 v(n-1/2) v(n+1/2): of second order like the scheme, and what the scheme keeps exactly. Its
second velocity takes the forces of this instant. They are taken here, and so is what springs, dashpots and boundaries
did since the last step, without anything being changed.
"""

import numpy as np
from numba import njit

from dem.kernels.arguments import Law, Loads, Springs, State
from dem.kernels.chunks import face_partners
from dem.kernels.interaction import Contact, at_line, between_discs, line_lane
from dem.kernels.layout import (
    DISC,
    INVMASS,
    LANES,
    LINK,
    PULL_X,
    PULL_Z,
    RIM,
    ROLL_LINK,
    SHARE,
    VR,
    VX,
    VZ,
    Layout,
    entry,
)
from dem.kernels.scratch import ROW, load_all_constants, load_own, new_scratch
from dem.kernels.swing import swing_slice

# Entries of what `energies` returns (J per metre out of plane); the last five came about since the last step.
TRANSLATION, ROTATION, ELEMENTS, PORES, ROLLING_SPRINGS, BONDS = range(6)
LATE_DASHPOT, LATE_SLIDING, LATE_CRACKS, LATE_ROLLING, LATE_BOUNDARY = range(6, 11)
ENERGIES = 11


@njit(cache=True, nogil=True, forceinline=True, error_model="numpy")
def book(now: Contact, out: np.ndarray) -> None:
    """Adds what a contact stores, and lost since the last step."""
    out[ELEMENTS] += now.elements
    out[BONDS] += now.bonds
    out[PORES] += now.pores
    out[ROLLING_SPRINGS] += now.rolling
    out[LATE_DASHPOT] += now.damped
    out[LATE_SLIDING] += now.slid
    out[LATE_CRACKS] += now.cracked
    out[LATE_ROLLING] += now.rolled_off


@njit(cache=True, nogil=True, error_model="numpy")
def contact_energy(
    chunk: int, lane: int, state: State, scratch: np.ndarray, slip_time: float, law: Law, out: np.ndarray
) -> tuple[float, float, float, float]:
    """Books the contact in this lane. Returns its force on the partner, and rim forces on partner and owner."""
    d, w, q = np.uint64(chunk) * LINK, np.uint64(chunk) * ROLL_LINK, np.uint64(lane)
    share = 0.0
    if law.soil:
        share = state.rolling[w + SHARE + q]
        m, now = between_discs(d, q, w, state, scratch, slip_time, law, True, True, True)
    else:
        m, now = between_discs(d, q, w, state, scratch, slip_time, law, False, True, True)
    book(now, out)
    rim = now.drag * m.lever - share * now.torque
    return now.push * m.nx + now.drag * m.nz, now.push * m.nz - now.drag * m.nx, rim, rim + now.torque


@njit(cache=True, nogil=True, error_model="numpy")
def line_energy(
    e: int, layout: Layout, springs: Springs, slip_time: float, law: Law, out: np.ndarray
) -> tuple[float, float, float]:
    """The same for a disc at a rigid line; returns the force and the rim force on the disc."""
    at, w = line_lane(e, layout)
    m, now = at_line(e, at, w, layout, springs, slip_time, law)
    book(now, out)
    return now.push * m.nx + now.drag * m.nz, now.push * m.nz - now.drag * m.nx, now.drag + now.torque


@njit(cache=True, nogil=True, error_model="numpy")
def kinetic(layout: Layout, force: np.ndarray, loads: Loads, dt: float, out: np.ndarray) -> None:
    """Adds the kinetic energy of all discs that can move, and the work on those that are moved."""
    discs = layout.discs
    ax, az = loads.acceleration[0, 0], loads.acceleration[1, 0]
    for p in range(len(layout.chunk_start) - 1):
        swing_slice(p, layout, loads.acceleration[2, 0])
        b = np.uint64(p) * DISC
        for lane in range(LANES):
            q = np.uint64(lane)
            fx, fz, fr = force[p * LANES + lane]
            i = p * LANES + lane
            vx, vz = layout.shared[entry(i, VX)], layout.shared[entry(i, VZ)]
            vr = layout.shared[entry(i, VR)]
            invmass, rim = discs[b + INVMASS + q], discs[b + RIM + q]
            if invmass > 0.0:
                next_x = vx + dt * (fx * invmass + discs[b + PULL_X + q] + ax)
                next_z = vz + dt * (fz * invmass + discs[b + PULL_Z + q] + az)
                out[TRANSLATION] += 0.5 * (vx * next_x + vz * next_z) / invmass
            else:
                out[LATE_BOUNDARY] -= 0.5 * dt * (fx * vx + fz * vz + fr * vr)
            if rim > 0.0:
                out[ROTATION] += 0.5 * vr * (vr + dt * fr * rim) / rim


@njit(cache=True, nogil=True, error_model="numpy")
def energies(layout: Layout, springs: Springs, law: Law, loads: Loads, last_dt: float) -> np.ndarray:
    """The energies of all discs and contacts (ENERGIES,); loads: those of this instant alone."""
    out = np.zeros(ENERGIES)
    slices = len(layout.chunk_start) - 1
    scratch = new_scratch()
    force = np.zeros((slices * LANES, 3))
    state = State(layout.discs, layout.links, layout.rolling, layout.shared, layout.partner)
    for p in range(slices):
        load_own(p, layout.shared, scratch)
        for chunk in range(layout.chunk_start[p], layout.chunk_start[p + 1]):
            first = np.uint64(chunk) * ROW
            load_all_constants(first, layout.kinds, springs.records, True, True, scratch)
            face_partners(chunk, state, scratch, law, law.soil)
            for lane in range(LANES):
                fx, fz, rim, own = contact_energy(chunk, lane, state, scratch, last_dt, law, out)
                i, j = p * LANES + lane, np.int64(layout.partner[chunk * LANES + lane])
                force[i, 0] -= fx
                force[i, 1] -= fz
                force[i, 2] += own
                force[j, 0] += fx
                force[j, 1] += fz
                force[j, 2] += rim
    for e in range(len(layout.line_disc)):
        fx, fz, rim = line_energy(e, layout, springs, last_dt, law, out)
        i = layout.line_disc[e]
        force[i, 0] += fx
        force[i, 1] += fz
        force[i, 2] += rim
    kinetic(layout, force, loads, last_dt, out)
    return out
