"""Computes the energies of the discs at one instant, from the layout that the stepping kernel works on (kernel).

The kinetic energy is m/2 v(n-1/2) v(n+1/2), which is of second order, and which the scheme conserves exactly. The
velocity half a step later requires the forces at this instant. This kernel computes the forces on the discs at the
instant, and the work of springs, dashpots and boundaries since the last step, without changing the state.
"""

import numpy as np
from numba import njit

from dem.kernels import layout as field
from dem.kernels import liquefied_pairs as bond
from dem.kernels.added_mass import pull_added_mass
from dem.kernels.arguments import Law, Loads, Springs, State
from dem.kernels.chunks import add, load_geometry
from dem.kernels.device_function import device_function
from dem.kernels.interaction import Contact, at_line, between_discs, line_lane
from dem.kernels.layout import Layout
from dem.kernels.liquefied_bonds import bond_lines
from dem.kernels.liquefied_laws import energy_share, water_energy
from dem.kernels.losses import along
from dem.kernels.prefetch import wide_vectors
from dem.kernels.work_buffers import OWNED_DISCS, ROW, SUM_R, SUM_X, SUM_Z, load_all_constants, load_own, new_buffer

# Entries of what `energies` returns (J per metre out of plane); LATE ones came about since the last step.
TRANSLATION, ROTATION, ELEMENTS, PORES, ROLLING_SPRINGS, BONDS = range(6)
LATE_DASHPOT, LATE_SLIDING, LATE_CRACKS, LATE_ROLLING, LATE_BOUNDARY = range(6, 11)
PORE_WATER, LIQUEFIED_BONDS = 11, 12
ENERGIES = 13

# Rows of a chunk's forces on partners and forces on their circumference, in place of velocities no longer needed.
PARTNER_X, PARTNER_Z, PARTNER_R = field.VX, field.VZ, field.VR


@device_function(nogil=True, forceinline=True)
def book(now: Contact, out: np.ndarray) -> None:
    """Add the energy stored in a contact, and its losses since the last step, to `out`."""
    out[ELEMENTS] += now.elements
    out[BONDS] += now.bonds
    out[PORES] += now.pores
    out[ROLLING_SPRINGS] += now.rolling
    out[LATE_DASHPOT] += 0.5 * now.damped
    out[LATE_SLIDING] += 0.5 * now.slid
    out[LATE_CRACKS] += 0.5 * now.cracked
    out[LATE_ROLLING] += 0.5 * now.rolled_off


@device_function(nogil=True, forceinline=True)
def lanes_energy(chunk: int, state: State, buffer: np.ndarray, slip_time: float, soil: bool, out: np.ndarray) -> None:
    """Add the energies of one chunk of contacts to `out`, and compute the forces on both discs of each contact.

    The force on the disc that owns the contact is added to its sum of forces in `buffer`. The force on the other disc,
    the partner, is written into the rows of `buffer` for partners.

    state, buffer, slip_time, soil: as in `chunks.contact`; out: energies (ENERGIES,) in J.
    """
    wide_vectors()
    d, w = np.uint64(chunk) * field.LINK, np.uint64(chunk) * field.ROLL_LINK
    elements, bonds, pores, rolling = 0.0, 0.0, 0.0, 0.0
    damping, sliding, cracks, rolled_off = 0.0, 0.0, 0.0, 0.0
    for lane in range(field.LANES):
        q = np.uint64(lane)
        m, now = between_discs(d, q, w, state, buffer, slip_time, soil, True, True)
        elements = add(elements, now.elements)
        bonds = add(bonds, now.bonds)
        pores = add(pores, now.pores)
        rolling = add(rolling, now.rolling)
        damping = add(damping, now.damped)
        sliding = add(sliding, now.slid)
        cracks = add(cracks, now.cracked)
        rolled_off = add(rolled_off, now.rolled_off)
        fx, fz = now.normal * m.nx + now.drag * m.nz, now.normal * m.nz - now.drag * m.nx
        rim = now.drag * m.lever
        if soil:
            rim -= state.rolling[w + field.SHARE + q] * now.torque
        buffer[SUM_X + q] -= fx
        buffer[SUM_Z + q] -= fz
        buffer[SUM_R + q] += rim + now.torque
        buffer[PARTNER_X + q], buffer[PARTNER_Z + q], buffer[PARTNER_R + q] = fx, fz, rim
    out[ELEMENTS] += elements
    out[BONDS] += bonds
    out[PORES] += pores
    out[ROLLING_SPRINGS] += rolling
    out[LATE_DASHPOT] += 0.5 * damping
    out[LATE_SLIDING] += 0.5 * sliding
    out[LATE_CRACKS] += 0.5 * cracks
    out[LATE_ROLLING] += 0.5 * rolled_off


@device_function(nogil=True)
def slice_energy(
    p: int, layout: Layout, springs: Springs, buffer: np.ndarray, slip_time: float, law: Law, force: np.ndarray,
    out: np.ndarray,
) -> None:  # fmt: skip
    """Add the energies of all contacts that slice p owns to `out`, and the forces and moments (over the radius) of
    these contacts to those on the discs.

    layout: discs and contacts; springs: constants; buffer: rows to work in; slip_time: length of the last step (s);
    law: law of the contacts; force: (3, discs) force along x and z, and moment over the radius (N); out: energies
    (ENERGIES,) in J.
    """
    state = State(layout.discs, layout.links, layout.rolling, layout.shared, layout.partner)
    load_own(p, layout.shared, buffer)
    for row in range(3):
        for lane in range(field.LANES):
            buffer[SUM_X + np.uint64(row) * ROW + np.uint64(lane)] = 0.0
    for chunk in range(layout.chunk_start[p], layout.chunk_start[p + 1]):
        load_all_constants(np.uint64(chunk) * ROW, layout.kinds, springs.records, True, True, buffer)
        load_geometry(chunk, state, buffer, law, law.soil)
        if law.soil:
            lanes_energy(chunk, state, buffer, slip_time, True, out)
        else:
            lanes_energy(chunk, state, buffer, slip_time, False, out)
        for lane in range(field.LANES):
            j, q = np.int64(layout.partner[chunk * field.LANES + lane]), np.uint64(lane)
            force[0, j] += buffer[PARTNER_X + q]
            force[1, j] += buffer[PARTNER_Z + q]
            force[2, j] += buffer[PARTNER_R + q]
    for row in range(3):
        for lane in range(field.LANES):
            force[row, p * field.LANES + lane] += buffer[SUM_X + np.uint64(row) * ROW + np.uint64(lane)]


@device_function(nogil=True)
def line_energy(
    e: int, layout: Layout, springs: Springs, slip_time: float, law: Law, out: np.ndarray
) -> tuple[float, float, float]:
    """Add the energies of the contact e of a disc with a rigid line to `out`.

    layout, springs, slip_time, law, out: as in `slice_energy`. Returns the force along x and z, and the moment over the
    radius, on the disc (N).
    """
    at, w = line_lane(e, layout)
    m, now = at_line(e, at, w, layout, springs, slip_time, law)
    book(now, out)
    return now.normal * m.nx + now.drag * m.nz, now.normal * m.nz - now.drag * m.nx, now.drag + now.torque


@device_function(nogil=True)
def kinetic(
    p: int, layout: Layout, buffer: np.ndarray, force: np.ndarray, loads: Loads, dt: float, out: np.ndarray
) -> None:
    """Add the kinetic energy of the free discs of slice p to `out`, and the work done on discs whose motion is
    prescribed.

    layout, buffer, out: as in `slice_energy`; force: forces (3, discs) on every disc (N); loads: acceleration at this
    instant; dt: length of the last step (s).
    """
    wide_vectors()
    discs = layout.discs
    ax, az = loads.acceleration[0, 0], loads.acceleration[1, 0]
    pull_added_mass(p, layout, loads.acceleration[2, 0])
    load_own(p, layout.shared, buffer)
    b, i = np.uint64(p) * field.DISC, np.uint64(p) * ROW
    translation, rotation, boundary = 0.0, 0.0, 0.0
    for lane in range(field.LANES):
        q = np.uint64(lane)
        fx, fz, fr = force[0, i + q], force[1, i + q], force[2, i + q]
        vx, vz, vr = (
            buffer[OWNED_DISCS + field.VX + q],
            buffer[OWNED_DISCS + field.VZ + q],
            buffer[OWNED_DISCS + field.VR + q],
        )
        invmass, rim = discs[b + field.INVMASS + q], discs[b + field.RIM + q]
        next_x = vx + dt * (fx * invmass + discs[b + field.PULL_X + q] + ax)
        next_z = vz + dt * (fz * invmass + discs[b + field.PULL_Z + q] + az)
        translation = add(translation, discs[b + field.MASS + q] * along(vx, vz, next_x, next_z))
        rotation = add(rotation, vr * (vr + dt * fr * rim) / rim if rim > 0.0 else 0.0)
        boundary = add(boundary, 0.0 if invmass > 0.0 else along(fx, fz, vx, vz) + fr * vr)
    out[TRANSLATION] += 0.5 * translation
    out[ROTATION] += 0.5 * rotation
    out[LATE_BOUNDARY] -= 0.5 * dt * boundary


@njit(cache=True, nogil=True, error_model="numpy")
def energies(layout: Layout, springs: Springs, law: Law, loads: Loads, last_dt: float) -> np.ndarray:
    """Compute the energies of all discs and contacts.

    Parameters
    ----------
    layout : discs and contacts
    springs : constants of the contacts
    law : law of the contacts
    loads : acceleration at this instant
    last_dt : length of the last step (s)

    Returns
    -------
    Energies (ENERGIES,) in J.
    """
    out = np.zeros(ENERGIES)
    slices = len(layout.chunk_start) - 1
    buffer = new_buffer()
    force = np.zeros((3, slices * field.LANES))
    for p in range(slices):
        slice_energy(p, layout, springs, buffer, last_dt, law, force, out)
    for e in range(len(layout.line_disc)):
        fx, fz, rim = line_energy(e, layout, springs, last_dt, law, out)
        i = layout.line_disc[e]
        force[0, i] += fx
        force[1, i] += fz
        force[2, i] += rim
    if len(layout.liquefied.disc_i) > 0:
        out[PORE_WATER], out[LIQUEFIED_BONDS] = liquefied_energy(layout.liquefied, layout.shared, force)
    for p in range(slices):
        kinetic(p, layout, buffer, force, loads, last_dt, out)
    return out


@device_function(nogil=True)
def liquefied_energy(wet: bond.Liquefied, shared: np.ndarray, force: np.ndarray) -> tuple[float, float]:
    """Return the energy (J) stored in pore water and in bonds. Also add the last forces to `force` (3, slots).

    The work of the last forces on the displacements since their evaluation counts as stored energy.
    """
    discs = wet.discs
    water, bonds = 0.0, 0.0
    for k in range(len(wet.paired)):
        i = np.int64(wet.paired[k])
        fx, fz = discs[i, bond.FORCE_X], discs[i, bond.FORCE_Z]
        force[0, i] += fx
        force[1, i] += fz
        water -= fx * (shared[8 * i] - discs[i, bond.AT_X]) + fz * (shared[8 * i + 1] - discs[i, bond.AT_Z])
        if discs[i, bond.SHARE] > 0.0:
            water += water_energy(
                discs[i, bond.SHARE], discs[i, bond.AREA], discs[i, bond.PRESSURE], discs[i, bond.STIFFNESS],
                discs[i, bond.DENSITY], discs[i, bond.PRESENT_DENSITY],
            )  # fmt: skip
    for block in range(wet.start[-1]):
        for lane in range(bond.LANES):
            r = np.uint64(block) * bond.MEMORY_BLOCK + np.uint64(lane)
            i, j = np.int64(wet.disc_i[block * bond.LANES + lane]), np.int64(wet.disc_j[block * bond.LANES + lane])
            soft, steep, soft_to = bond_lines(discs, i, j)
            stored = energy_share(wet.memory[r + bond.ALONG], wet.memory[r + bond.ACROSS], soft, steep, soft_to)
            bonds += 0.5 * wet.memory[r + bond.LIMIT_ENERGY] * stored
    return water, bonds
