"""Computes forces, energies and losses of one contact, from the motion of its two sides and its history variables
(kernel).

The functions of this module apply the contact law to the arrays of `layout`. The stepping kernel stores the new history
variables of a contact; the energy balance only reads them. All functions of this module are inlined, so that values
that a caller does not need are not computed.
"""

import math
from typing import NamedTuple

import numpy as np

from dem.kernels import contact as row
from dem.kernels import layout as field
from dem.kernels.arguments import Law, Springs, State
from dem.kernels.contact import (
    friction_limit,
    friction_spring,
    normal_force,
    pore,
    spring,
    spring_energy,
    stop,
    strength,
)
from dem.kernels.device_function import device_function
from dem.kernels.layout import Layout, entry
from dem.kernels.losses import (
    along,
    both,
    crack_loss,
    damping_loss,
    damping_losses,
    pore_before,
    sliding_loss,
    spring_before,
)
from dem.kernels.period import image
from dem.kernels.work_buffers import DISTANCE, LEVER, NORMAL_X, NORMAL_Z, OWNED_DISCS, constant

# Entries of a line (rigid wall): a point on it, its inward unit normal, and how far it reaches along
# (-nz, nx) from that point.
LINE_X, LINE_Z, LINE_NX, LINE_NZ, LINE_FROM, LINE_TO = range(6)


class Motion(NamedTuple):
    """Holds geometry and relative motion of the two sides of a contact.

    Attributes
    ----------
    distance : distance of the centres (m)
    nx, nz : unit vector from i to j
    lever : lever of the tangential force over the radius, the same for both discs. The levers are the distance times
        r_i/(r_i + r_j). The sum of both levers is the distance, so that angular momentum is conserved and a pair that
        rotates as one body does not slip.
    vn, vt : speeds of separation and of slip at the end of the step (m/s)
    slip, stretch : slip and separation since the last step (m); separation is used only by the energy balance
    """

    distance: float
    nx: float
    nz: float
    lever: float
    vn: float
    vt: float
    slip: float
    stretch: float


class Contact(NamedTuple):
    """Holds forces, history variables and losses of a contact by its law.

    Attributes
    ----------
    over : overlap (m)
    normal, drag : normal force (`normal`) and tangential force (`drag`) of contact and pore spring together (N)
    torque : rolling moment over R = r_i r_j/(r_i + r_j) (N); positive on i, negative on j
    shear, pore, rolled : stored forces of the springs of slip, of the pore spring and of rolling (N)
    length : length of the pore spring (m), see `contact.pore`
    elements, bonds, pores, rolling : energy stored in contact springs, bonds of cohesive soil, pore springs and springs
        of rolling (J)
    damped, slid, cracked, rolled_off : twice the energy that dashpots, sliding, cracks and rolling dissipated since the
        last step (J)
    """

    over: float
    normal: float
    drag: float
    torque: float
    shear: float
    pore: float
    rolled: float
    length: float
    elements: float
    bonds: float
    pores: float
    rolling: float
    damped: float
    slid: float
    cracked: float
    rolled_off: float


@device_function(forceinline=True)
def contact_geometry(d: int, q: int, state: State, buffer: np.ndarray, law: Law, soil: bool) -> None:
    """Write direction, distance and lever arms of the contact in lane q into the rows of `buffer`.

    d: place at which the chunk begins in `state.links`; law: contact law with the period of the ground, which only
    `soil` discs have. One square root and one division take longer than the rest of the contact law. Root and division
    are therefore computed in a separate loop, while the records of the next partners are fetched.
    """
    radii = state.links[d + field.RADII + q]
    dx = buffer[field.X + q] - buffer[OWNED_DISCS + field.X + q]
    dz = buffer[field.Z + q] - buffer[OWNED_DISCS + field.Z + q]
    if soil:
        dx, dz = image(dx, dz, law.period)
    square = dx * dx + dz * dz
    distance = math.sqrt(square)
    inverse = 1.0 / (distance * radii)
    buffer[NORMAL_X + q] = dx * (inverse * radii)
    buffer[NORMAL_Z + q] = dz * (inverse * radii)
    buffer[DISTANCE + q] = distance
    buffer[LEVER + q] = square * inverse


@device_function(forceinline=True)
def motion(q: int, buffer: np.ndarray, slip_time: float) -> Motion:
    """Return slip and separation of the contact in lane q of a slice, after `contact_geometry` has written its
    geometry."""
    nx, nz = buffer[NORMAL_X + q], buffer[NORMAL_Z + q]
    distance, lever = buffer[DISTANCE + q], buffer[LEVER + q]
    ux = buffer[field.VXS + q] - buffer[OWNED_DISCS + field.VXS + q]
    uz = buffer[field.VZS + q] - buffer[OWNED_DISCS + field.VZS + q]
    hx = buffer[field.VX + q] - buffer[OWNED_DISCS + field.VX + q]
    hz = buffer[field.VZ + q] - buffer[OWNED_DISCS + field.VZ + q]
    vn = ux * nx + uz * nz
    vt = (uz * nx - ux * nz) - lever * (buffer[field.VRS + q] + buffer[OWNED_DISCS + field.VRS + q])
    slip = slip_time * ((hz * nx - hx * nz) - lever * (buffer[field.VR + q] + buffer[OWNED_DISCS + field.VR + q]))
    return Motion(distance, nx, nz, lever, vn, vt, slip, slip_time * along(hx, hz, nx, nz))


@device_function(forceinline=True)
def rolling_motion(q: int, buffer: np.ndarray, share: float, slip_time: float) -> tuple[float, float]:
    """Return R times the difference of the rotations of the discs j and i since the last step (m), and R times the
    difference of their angular velocities at the end of the step (m/s); R = r_i r_j/(r_i + r_j).

    q: lane of the contact; buffer: rows that `load_geometry` filled; slip_time: length of the last step (s); share:
    r_i/(r_i + r_j). With the circumferential speeds r_i w_i, R (w_j - w_i) is share (r_i w_i + r_j w_j) - r_i w_i.
    """
    rim, rim_end = buffer[OWNED_DISCS + field.VR + q], buffer[OWNED_DISCS + field.VRS + q]
    roll = slip_time * (share * (rim + buffer[field.VR + q]) - rim)
    return roll, share * (rim_end + buffer[field.VRS + q]) - rim_end


@device_function(forceinline=True)
def between_discs(
    d: int,
    q: int,
    w: int,
    state: State,
    buffer: np.ndarray,
    slip_time: float,
    soil: bool,
    pores: bool,
    with_losses: bool,
) -> tuple[Motion, Contact]:
    """Compute the contact in lane q of the chunk at d (rolling memory at w) without changing the state.

    state: arrays of discs and contacts; buffer: rows that `load_geometry` filled; slip_time: length of the last step
    (s); soil, pores, with_losses: whether the law of soil discs holds, there are pore springs, and losses are computed.
    Callers pass `soil`, `pores` and `with_losses` as literals, so that the compiler omits unused parts of the law.
    """
    links = state.links
    radii = links[d + field.RADII + q]
    m = motion(q, buffer, slip_time)
    over = radii - m.distance
    kn, ks = buffer[constant(row.KN) + q], buffer[constant(row.KS) + q]
    ct, fks = buffer[constant(row.CT) + q], buffer[constant(row.FKS) + q]
    mu = buffer[constant(row.MU) + q]
    gap = buffer[constant(row.ATTRACTION_REACH) + q] if soil else 0.0
    elastic = spring(over, kn, gap)
    elements, bonds = spring_energy(over, kn, gap)
    stiffness, depth = 0.0, 0.0
    if soil:
        stiffness, depth = buffer[constant(row.STOP_STIFFNESS) + q], buffer[constant(row.STOP_OVERLAP) + q] * radii
        more = stop(over, stiffness, depth)
        elements += 0.5 * more * (over - depth)
        elastic += more
    normal = normal_force(over, m.vn, kn, elastic, buffer[constant(row.CN) + q], gap)
    if soil:
        limit = strength(
            over, normal, mu, buffer[constant(row.COHESION) + q], buffer[constant(row.MU_OTHER) + q],
            buffer[constant(row.COHESION_OTHER) + q], gap,
        )  # fmt: skip
    else:
        limit = friction_limit(normal, mu)
    shear = links[d + field.SHEAR + q]
    tangential, trial, spring_force = friction_spring(shear, m.slip, m.vt, ks, ct, limit)

    kpn, fkps, length, old_pore = 0.0, 0.0, 0.0, 0.0
    pore_normal, pore_trial, pore_spring_force, new = 0.0, 0.0, 0.0, 0.0
    if pores:
        kpn, fkps = buffer[constant(row.KPN) + q], buffer[constant(row.FKPS) + q]
        length, old_pore = links[d + field.LENGTH + q], links[d + field.PORE + q]
        # the normal force of a contact of soil discs already counts in the friction of the contact
        pore_normal, pore_trial, pore_spring_force, new = pore(
            length, m.distance, m.slip, old_pore, 0.0 if soil else normal, kpn, buffer[constant(row.KPS) + q],
            buffer[constant(row.TAN) + q], buffer[constant(row.BC) + q], buffer[constant(row.BETA) + q],
        )  # fmt: skip

    torque, rolled, rolling, rolled_off = 0.0, 0.0, 0.0, 0.0
    if soil:
        before, whole = state.rolling[w + field.ROLLED + q], state.rolling[w + field.TORQUE + q]
        roll, rate = rolling_motion(q, buffer, state.rolling[w + field.SHARE + q], slip_time)
        most = friction_limit(normal, buffer[constant(row.MU_ROLLING) + q])
        torque, tried, rolled = friction_spring(before, roll, rate, ks, ct, most)
        rolling = 0.5 * rolled * rolled * fks
        rolled_off = both(damping_loss(roll, torque - rolled, whole - before), sliding_loss(before, tried, rolled, fks))

    damped, slid, cracked = 0.0, 0.0, 0.0
    if with_losses:
        # dashpots in the last step: all the force there was, less that of springs
        springs_then = spring_before(over, m.stretch, kn, gap)
        if soil:
            springs_then = both(springs_then, spring_before(over - depth, m.stretch, stiffness, 0.0))
        if pores:
            springs_then = both(springs_then, pore_before(length, m.distance, m.stretch, kpn))
        fx, fz = links[d + field.FX + q], links[d + field.FZ + q]
        damped = damping_losses(
            m.nx,
            m.nz,
            m.slip,
            m.stretch,
            fx,
            fz,
            tangential - spring_force,
            normal - elastic,
            shear + old_pore,
            springs_then,
        )
        slid = sliding_loss(shear, trial, spring_force, fks)
        if pores:
            pore_lost = sliding_loss(old_pore, pore_trial, pore_spring_force, fkps)
            cracking = (length > 0.0) & (new <= 0.0)
            slid = both(slid, 0.0 if cracking else pore_lost)
            cracked = both(pore_lost, crack_loss(kpn, length, m.distance, m.stretch)) if cracking else 0.0
    in_pores = 0.5 * pore_spring_force * pore_spring_force * fkps
    if kpn > 0.0:
        in_pores += 0.5 * pore_normal * pore_normal / kpn
    return m, Contact(
        over, normal + pore_normal, tangential + pore_spring_force, torque, spring_force, pore_spring_force,
        rolled, new, elements + 0.5 * spring_force * spring_force * fks, bonds, in_pores, rolling, damped,
        slid, cracked, rolled_off,
    )  # fmt: skip


@device_function(nogil=True)
def line_motion(e: int, layout: Layout, walls: np.ndarray, slip_time: float) -> tuple[float, Motion]:
    """Return the overlap (m) of a disc with a rigid line, and the motion of the disc relative to the line. The lever is
    the radius of the disc.

    e: number of the contact; layout: discs and contacts; walls: see `Springs`; slip_time: length of the last step (s).
    """
    disc, shared = layout.line_disc[e], layout.shared
    line = walls[layout.line_id[e]]
    nx, nz = line[LINE_NX], line[LINE_NZ]
    px, pz = shared[entry(disc, field.X)] - line[LINE_X], shared[entry(disc, field.Z)] - line[LINE_Z]
    distance = px * nx + pz * nz
    over = layout.line_radius[e] - distance
    along = pz * nx - px * nz
    if along < line[LINE_FROM] or along > line[LINE_TO]:
        over = -1.0
    vn = shared[entry(disc, field.VXS)] * nx + shared[entry(disc, field.VZS)] * nz
    vt = shared[entry(disc, field.VZS)] * nx - shared[entry(disc, field.VXS)] * nz - shared[entry(disc, field.VRS)]
    slip = slip_time * (
        shared[entry(disc, field.VZ)] * nx - shared[entry(disc, field.VX)] * nz - shared[entry(disc, field.VR)]
    )
    stretch = slip_time * (shared[entry(disc, field.VX)] * nx + shared[entry(disc, field.VZ)] * nz)
    return over, Motion(distance, nx, nz, 1.0, vn, vt, slip, stretch)


@device_function(nogil=True)
def at_line(
    e: int, at: np.uint64, w: np.uint64, layout: Layout, springs: Springs, slip_time: float, law: Law
) -> tuple[Motion, Contact]:
    """Compute the contact of a disc with a rigid line without changing the state. The forces are in lane `at`, the
    history variables of rolling at w.

    e: number of the contact; layout: discs and contacts; springs: constants; slip_time: length of the last step (s);
    law: law of the contacts.
    """
    links = layout.links
    column = springs.lines[:, layout.line_kind[e]]
    over, m = line_motion(e, layout, springs.walls, slip_time)
    kn, ks, ct, fks = column[row.KN], column[row.KS], column[row.CT], column[row.FKS]
    elastic = spring(over, kn, 0.0)
    normal = normal_force(over, m.vn, kn, elastic, column[row.CN], 0.0)
    limit = friction_limit(normal, column[row.MU])
    torque, rolled, rolling, rolled_off = 0.0, 0.0, 0.0, 0.0
    if law.soil:
        limit = strength(
            over, normal, column[row.MU], column[row.COHESION], column[row.MU_OTHER], column[row.COHESION_OTHER], 0.0
        )
        disc = layout.line_disc[e]
        before, whole = layout.rolling[w + field.ROLLED], layout.rolling[w + field.TORQUE]
        roll = -slip_time * layout.shared[entry(disc, field.VR)]
        most = friction_limit(normal, column[row.MU_ROLLING])
        torque, tried, rolled = friction_spring(before, roll, -layout.shared[entry(disc, field.VRS)], ks, ct, most)
        rolling = 0.5 * rolled * rolled * fks
        rolled_off = both(damping_loss(roll, torque - rolled, whole - before), sliding_loss(before, tried, rolled, fks))
    shear = links[at + field.SHEAR]
    tangential, trial, spring_force = friction_spring(shear, m.slip, m.vt, ks, ct, limit)
    damped = damping_losses(
        m.nx, m.nz, m.slip, m.stretch, links[at + field.FX], links[at + field.FZ], tangential - spring_force,
        normal - elastic, shear, spring(over + m.stretch, kn, 0.0),
    )  # fmt: skip
    elements = 0.5 * elastic * elastic / kn + 0.5 * spring_force * spring_force * fks
    return m, Contact(
        over, normal, tangential, torque, spring_force, 0.0, rolled, 0.0, elements, 0.0, 0.0, rolling, damped,
        sliding_loss(shear, trial, spring_force, fks), 0.0, rolled_off,
    )  # fmt: skip


@device_function(nogil=True)
def line_lane(e: int, layout: Layout) -> tuple[np.uint64, np.uint64]:
    """Return the places of the contact e with a rigid line in `links` and in `rolling`, after the chunks and the empty
    chunk."""
    place = np.uint64(layout.chunk_start[-1] + 1) + np.uint64(e // field.LANES)
    return place * field.LINK + np.uint64(e % field.LANES), place * field.ROLL_LINK + np.uint64(e % field.LANES)
