"""Kernel: many time steps of all discs, by any number of threads, with the same bits for any number.

Scheme: velocity Verlet, which is the trapezoidal rule for the displacement (Sec. 2(2) of the paper). With the forces
F at t_n,
    v(n+1/2) = v(n-1/2) + dt F(n)/m,   x(n+1) = x(n) + dt v(n+1/2),   v*(n+1) = v(n+1/2) + dt/2 F(n)/m.
Dashpots need a velocity at t_(n+1) before its force is known: v* is that one, to second order. Slip, and so the
springs' memory, follows from v(n+1/2), that is from displacements.

A step goes through the slices in order: the contacts a slice owns, then all slices whose last contact is known, while
they are still in the cache. Slices that share contacts with another thread's wait for the others.
"""

import math

import numpy as np
from numba import njit

from dem.barrier import wait
from dem.contact import (
    ALLOWED,
    BC,
    BETA,
    CN,
    CONSTANTS,
    CT,
    FKPS,
    FKS,
    KN,
    KPN,
    KPS,
    KS,
    MU,
    TAN,
    element,
    pore,
)
from dem.prefetch import prefetch
from dem.layout import (
    DASH_N,
    DASH_T,
    ROLL,
    DISC,
    DISC_FIELDS,
    FR,
    FX,
    FZ,
    INVMASS,
    LANES,
    LENGTH,
    LINK,
    LINK_FIELDS,
    PORE,
    RADII,
    RIM,
    SHEAR,
    VR,
    VRS,
    VX,
    VXS,
    VZ,
    VZS,
    WEIGHT,
    X0,
    Z0,
    X,
    Z,
)

# Why a run of the kernel came to its end.
DONE, MOVED, OVERLAP = 0, 1, 2

# Columns of the ledger kept per slice: work of weight, of external acceleration and of moving boundaries; energy
# dissipated by dashpots, by sliding, by cracks. All in J per metre out of plane.
WORK_WEIGHT, WORK_EXTERNAL, WORK_BOUNDARY, DASHPOT, SLIDING, CRACKS = range(6)
LEDGER = 6

# Scratch rows of 64 doubles: the partners' first eight fields, the constants, three sums of forces.
CONSTANT = np.uint64(8 * LANES)
SUM_X, SUM_Z, SUM_R = (np.uint64((8 + CONSTANTS + k) * LANES) for k in range(3))
SCRATCH = (8 + CONSTANTS + 3) * LANES
R_KN, R_KS, R_CN, R_CT, R_MU, R_KPN, R_KPS, R_TAN, R_BC, R_BETA, R_ALLOWED, R_FKS, R_FKPS = (
    np.uint64((8 + k) * LANES) for k in (KN, KS, CN, CT, MU, KPN, KPS, TAN, BC, BETA, ALLOWED, FKS, FKPS)
)
ROW = np.uint64(LANES)

# Entries of a line (rigid wall): a point on it, its inward unit normal, and how far it reaches along
# (-nz, nx) from that point.
LINE_X, LINE_Z, LINE_NX, LINE_NZ, LINE_FROM, LINE_TO = range(6)


@njit(cache=True, forceinline=True, error_model="numpy", fastmath={"reassoc"})
def add(total, value):
    """A sum whose order the compiler may choose; for the ledger, never for the motion."""
    return total + value


@njit(cache=True, nogil=True, forceinline=True, error_model="numpy")
def load_constants(kind, kinds, first, table, scratch):
    """The constants of 64 contacts, in rows: all of one kind, or run by run of one kind where `kind` is -1."""
    lane = 0
    while lane < LANES:
        column = kind
        end = LANES
        if kind < 0:
            column = kinds[first + np.uint64(lane)]
            end = lane + 1
            while end < LANES and kinds[first + np.uint64(end)] == column:
                end += 1
        for row in range(CONSTANTS):
            value = table[row, column]
            base = CONSTANT + np.uint64(row) * ROW
            for l in range(lane, end):  # noqa: E741
                scratch[base + np.uint64(l)] = value
        lane = end


@njit(cache=True, nogil=True, forceinline=True, error_model="numpy")
def load_partners(partner, first, discs, scratch):
    """Position and velocities of 64 partners, in rows."""
    for lane in range(LANES):
        disc = np.uint64(partner[first + np.uint64(lane)])
        for row in range(8):
            scratch[np.uint64(row) * ROW + np.uint64(lane)] = discs[disc + np.uint64(row) * ROW]


@njit(cache=True, forceinline=True, error_model="numpy")
def geometry(b, l, discs, scratch, radii, slip_time):  # noqa: E741
    """Distance, direction, lever ratio, speeds, slip and stretch since the last step of the contact in lane l.

    The levers of the tangential force are the distance times r_i/(r_i + r_j): they add up to the distance, so that
    angular momentum is kept and a pair that turns as one body does not slip. One square root, one division.
    """
    dx = scratch[X + l] - discs[b + X + l]
    dz = scratch[Z + l] - discs[b + Z + l]
    square = dx * dx + dz * dz
    distance = math.sqrt(square)
    inverse = 1.0 / (distance * radii)
    lever = square * inverse
    nx = dx * (inverse * radii)
    nz = dz * (inverse * radii)
    ux = scratch[VXS + l] - discs[b + VXS + l]
    uz = scratch[VZS + l] - discs[b + VZS + l]
    hx = scratch[VX + l] - discs[b + VX + l]
    hz = scratch[VZ + l] - discs[b + VZ + l]
    vn = ux * nx + uz * nz
    vt = (uz * nx - ux * nz) - lever * (scratch[VRS + l] + discs[b + VRS + l])
    slip = slip_time * ((hz * nx - hx * nz) - lever * (scratch[VR + l] + discs[b + VR + l]))
    stretch = slip_time * (hx * nx + hz * nz)
    return distance, nx, nz, lever, vn, vt, slip, stretch


@njit(cache=True, forceinline=True, error_model="numpy")
def losses(stretch, slip, dash_n, dash_t, old_dash_n, old_dash_t, old, trial, kept, flexibility):
    """Work that the dashpots and the sliding of an element contact took since the last step (J).

    dash_*: what the dashpots add to the springs' forces, before and now. The work of a step is its displacement times
    the mean of the forces at its ends: that is what the scheme takes from the kinetic energy v(n-1/2) v(n+1/2) m/2, so
    the books of linear springs and dashpots close to rounding, whatever the step.
    """
    damped = 0.5 * ((dash_t + old_dash_t) * slip - (dash_n + old_dash_n) * stretch)
    return damped, 0.5 * (old + kept) * (trial - kept) * flexibility


@njit(cache=True, forceinline=True, error_model="numpy")
def pore_losses(kpn, length, new, distance, stretch, old, trial, kept, flexibility):
    """Work of sliding of a cracked pore spring, and energy a crack sets free, since the last step (J)."""
    lost = 0.5 * (old + kept) * (trial - kept) * flexibility
    pull = distance - abs(new)
    before = pull - stretch
    snapped = 0.5 * kpn * pull * before if (pull > 0.0) & (before > 0.0) else 0.0
    cracking = (length > 0.0) & (new <= 0.0)
    return 0.0 if cracking else lost, lost + snapped if cracking else 0.0


@njit(cache=True, forceinline=True, error_model="numpy")
def contact(b, d, l, discs, links, scratch, slip_time, floor, share, ledger):  # noqa: E741
    """The contact in lane l: writes forces and memory.

    Returns whether it is too deep, and what its dashpots, sliding and cracks took since the last step (J).
    """
    radii = links[d + RADII + l]
    distance, nx, nz, lever, vn, vt, slip, stretch = geometry(b, l, discs, scratch, radii, slip_time)
    over = radii - distance
    shear = links[d + SHEAR + l]
    kn = scratch[R_KN + l]
    normal, tangential, trial, kept = element(
        over, vn, vt, slip, shear, floor, kn, scratch[R_KS + l], scratch[R_CN + l], scratch[R_CT + l],
        scratch[R_MU + l],
    )  # fmt: skip
    length = links[d + LENGTH + l]
    old_pore = links[d + PORE + l]
    pore_normal, pore_trial, pore_kept, new = pore(
        length, distance, slip, old_pore, share * normal,
        scratch[R_KPN + l], scratch[R_KPS + l], scratch[R_TAN + l], scratch[R_BC + l], scratch[R_BETA + l],
    )  # fmt: skip
    damped = 0.0
    slid = 0.0
    crack = 0.0
    if ledger:
        dash_n = normal - (kn * over if over > 0.0 else 0.0)
        dash_t = tangential - kept
        damped, slid = losses(
            stretch, slip, dash_n, dash_t, links[d + DASH_N + l], links[d + DASH_T + l], shear, trial, kept,
            scratch[R_FKS + l],
        )  # fmt: skip
        pore_slid, crack = pore_losses(
            scratch[R_KPN + l], length, new, distance, stretch, old_pore, pore_trial, pore_kept, scratch[R_FKPS + l]
        )
        slid += pore_slid
        links[d + DASH_N + l] = dash_n
        links[d + DASH_T + l] = dash_t
    links[d + SHEAR + l] = kept
    links[d + PORE + l] = pore_kept
    if new != length:
        links[d + LENGTH + l] = new
    push = normal + pore_normal
    drag = tangential + pore_kept
    links[d + FX + l] = push * nx + drag * nz
    links[d + FZ + l] = push * nz - drag * nx
    links[d + FR + l] = drag * lever
    return over > scratch[R_ALLOWED + l] * radii, damped, slid, crack


@njit(cache=True, nogil=True, error_model="numpy")
def contacts(chunk, b, discs, links, scratch, slip_time, floor, share):
    """Forces and memory of one chunk of contacts; True if an overlap is larger than allowed."""
    too_deep = False
    for lane in range(LANES):
        deep, _, _, _ = contact(
            b, np.uint64(chunk) * LINK, np.uint64(lane), discs, links, scratch, slip_time, floor, share, False
        )
        too_deep |= deep
    return too_deep


@njit(cache=True, nogil=True, error_model="numpy")
def contacts_with_losses(chunk, b, discs, links, scratch, slip_time, floor, share):
    """The same, with what dashpots, sliding and cracks took since the last step (J)."""
    too_deep = False
    damping = 0.0
    sliding = 0.0
    cracks = 0.0
    for lane in range(LANES):
        deep, damped, slid, crack = contact(
            b, np.uint64(chunk) * LINK, np.uint64(lane), discs, links, scratch, slip_time, floor, share, True
        )
        too_deep |= deep
        damping = add(damping, damped)
        sliding = add(sliding, slid)
        cracks = add(cracks, crack)
    return too_deep, damping, sliding, cracks


@njit(cache=True, nogil=True, error_model="numpy")
def line_geometry(e, layout, lines, slip_time):
    """Overlap, direction, speeds, slip and stretch of a disc at a rigid line; the lever is the disc's radius."""
    disc = np.uint64(layout.line_disc[e])
    discs = layout.discs
    line = lines[layout.line_id[e]]
    nx, nz = line[LINE_NX], line[LINE_NZ]
    px, pz = discs[disc + X] - line[LINE_X], discs[disc + Z] - line[LINE_Z]
    over = layout.line_radius[e] - (px * nx + pz * nz)
    along = pz * nx - px * nz
    if along < line[LINE_FROM] or along > line[LINE_TO]:
        over = -1.0
    vn = discs[disc + VXS] * nx + discs[disc + VZS] * nz
    vt = discs[disc + VZS] * nx - discs[disc + VXS] * nz - discs[disc + VRS]
    slip = slip_time * (discs[disc + VZ] * nx - discs[disc + VX] * nz - discs[disc + VR])
    stretch = slip_time * (discs[disc + VX] * nx + discs[disc + VZ] * nz)
    return over, nx, nz, vn, vt, slip, stretch


@njit(cache=True, nogil=True, error_model="numpy")
def line_contact(e, at, layout, lines, line_table, slip_time, floor):
    """Forces of a rigid line on one disc, written to lane `at`.

    Returns whether it is too deep, and what dashpots and sliding took since the last step (J).
    """
    links = layout.links
    k = layout.line_kind[e]
    over, nx, nz, vn, vt, slip, stretch = line_geometry(e, layout, lines, slip_time)
    shear = links[at + SHEAR]
    normal, tangential, trial, kept = element(
        over, vn, vt, slip, shear, floor,
        line_table[KN, k], line_table[KS, k], line_table[CN, k], line_table[CT, k], line_table[MU, k],
    )  # fmt: skip
    dash_n = normal - (line_table[KN, k] * over if over > 0.0 else 0.0)
    dash_t = tangential - kept
    damped, slid = losses(
        stretch, slip, dash_n, dash_t, links[at + DASH_N], links[at + DASH_T], shear, trial, kept, line_table[FKS, k]
    )
    links[at + DASH_N] = dash_n
    links[at + DASH_T] = dash_t
    links[at + SHEAR] = kept
    links[at + FX] = normal * nx + tangential * nz
    links[at + FZ] = normal * nz - tangential * nx
    links[at + FR] = tangential
    return over > 2.0 * line_table[ALLOWED, k] * layout.line_radius[e], damped, slid


@njit(cache=True, nogil=True, error_model="numpy")
def line_lane(e, layout):
    """Where the forces of disc e at a rigid line lie in links: behind the chunks and the silent lane."""
    tail = np.uint64(layout.chunk_start[-1] + 1)
    return (tail + np.uint64(e // LANES)) * LINK + np.uint64(e % LANES)


@njit(cache=True, nogil=True, forceinline=True, error_model="numpy")
def sum_forces(p, layout, scratch):
    """Forces and rim force on the 64 discs of slice p, from the contacts they own, then from the others."""
    links = layout.links
    own = np.uint64(layout.chunk_start[p])
    owned = layout.chunk_start[p + 1] - layout.chunk_start[p]
    others = np.uint64(layout.incoming_start[p])
    count = layout.incoming_start[p + 1] - layout.incoming_start[p]
    for lane in range(LANES):
        l = np.uint64(lane)  # noqa: E741
        fx = 0.0
        fz = 0.0
        fr = 0.0
        for k in range(owned):
            at = (own + np.uint64(k)) * LINK + l
            fx -= links[at + FX]
            fz -= links[at + FZ]
            fr += links[at + FR]
        for k in range(count):
            at = np.uint64(layout.incoming[(others + np.uint64(k)) * ROW + l])
            fx += links[at]
            fz += links[at + ROW]
            fr += links[at + ROW + ROW]
        scratch[SUM_X + l] = fx
        scratch[SUM_Z + l] = fz
        scratch[SUM_R + l] = fr


@njit(cache=True, nogil=True, error_model="numpy")
def move(p, discs, scratch, kick, dt, weight_x, weight_z, ax, az, reach):
    """One step of the 64 discs of slice p; True if one has moved further than sqrt(reach) since the list was made.

    kick: time (s) between the velocities kept and the new ones; weight_*: gravity, ax, az: external acceleration.
    """
    b = np.uint64(p) * DISC
    half = 0.5 * dt
    moved = False
    for lane in range(LANES):
        l = np.uint64(lane)  # noqa: E741
        invmass = discs[b + INVMASS + l]
        weight = discs[b + WEIGHT + l]
        free = 1.0 if invmass > 0.0 else 0.0
        accel_x = scratch[SUM_X + l] * invmass + free * (weight * weight_x + ax)
        accel_z = scratch[SUM_Z + l] * invmass + free * (weight * weight_z + az)
        accel_r = scratch[SUM_R + l] * discs[b + RIM + l]
        vx = discs[b + VX + l] + kick * accel_x
        vz = discs[b + VZ + l] + kick * accel_z
        vr = discs[b + VR + l] + kick * accel_r
        x = discs[b + X + l] + dt * vx
        z = discs[b + Z + l] + dt * vz
        discs[b + VX + l] = vx
        discs[b + VZ + l] = vz
        discs[b + VR + l] = vr
        discs[b + VXS + l] = vx + half * accel_x
        discs[b + VZS + l] = vz + half * accel_z
        discs[b + VRS + l] = vr + half * accel_r
        discs[b + X + l] = x
        discs[b + Z + l] = z
        discs[b + ROLL + l] += dt * vr
        dx = x - discs[b + X0 + l]
        dz = z - discs[b + Z0 + l]
        moved |= not (dx * dx + dz * dz <= reach)
    return moved


@njit(cache=True, nogil=True, error_model="numpy")
def work(p, discs, scratch, kick, dt, weight_x, weight_z, ax, az):
    """Work of weight, external acceleration and moving boundaries on slice p, once `move` has moved it (J).

    ax, az: mean of the external acceleration over the step.
    """
    b = np.uint64(p) * DISC
    by_weight = 0.0
    by_external = 0.0
    by_boundary = 0.0
    for lane in range(LANES):
        l = np.uint64(lane)  # noqa: E741
        invmass = discs[b + INVMASS + l]
        mass = 1.0 / invmass if invmass > 0.0 else 0.0
        vx = discs[b + VX + l]
        vz = discs[b + VZ + l]
        by_weight = add(by_weight, mass * discs[b + WEIGHT + l] * (weight_x * vx + weight_z * vz))
        by_external = add(by_external, mass * (ax * vx + az * vz))
        driven = scratch[SUM_X + l] * vx + scratch[SUM_Z + l] * vz + scratch[SUM_R + l] * discs[b + VR + l]
        by_boundary = add(by_boundary, 0.0 if invmass > 0.0 else -driven)
    return by_weight * dt, by_external * dt, by_boundary * kick


@njit(cache=True, nogil=True, forceinline=True, error_model="numpy")
def contacts_of_slice(
    p, layout, table, lines, line_table, scratch, loaded, slip_time, floor, share, ledger, books
):
    """All contacts that slice p owns. Returns whether one is too deep, and the kind now in the scratch rows."""
    too_deep = False
    b = np.uint64(p) * DISC
    prefetch(layout.discs, b + DISC, DISC_FIELDS * LANES)
    for chunk in range(layout.chunk_start[p], layout.chunk_start[p + 1]):
        first = np.uint64(chunk) * ROW
        prefetch(layout.links, (first + ROW) * np.uint64(LINK_FIELDS), LINK_FIELDS * LANES)
        kind = layout.chunk_kind[chunk]
        if kind != loaded or kind < 0:
            load_constants(kind, layout.kinds, first, table, scratch)
            loaded = kind
        load_partners(layout.partner, first, layout.discs, scratch)
        if ledger:
            deep, damping, slid, cracked = contacts_with_losses(
                chunk, b, layout.discs, layout.links, scratch, slip_time, floor, share
            )
            books[p, DASHPOT] += damping
            books[p, SLIDING] += slid
            books[p, CRACKS] += cracked
        else:
            deep = contacts(chunk, b, layout.discs, layout.links, scratch, slip_time, floor, share)
        too_deep |= deep
    for e in range(layout.line_start[p], layout.line_start[p + 1]):
        deep, damping, slid = line_contact(e, line_lane(e, layout), layout, lines, line_table, slip_time, floor)
        too_deep |= deep
        if ledger:
            books[p, DASHPOT] += damping
            books[p, SLIDING] += slid
    return too_deep, loaded


@njit(cache=True, nogil=True, forceinline=True, error_model="numpy")
def move_slice(p, layout, scratch, kick, dt, weight_x, weight_z, ax, az, mean_x, mean_z, reach, ledger, books):
    """Sums the forces on slice p and moves it; True if a disc has left the reach of the neighbour list."""
    sum_forces(p, layout, scratch)
    moved = move(p, layout.discs, scratch, kick, dt, weight_x, weight_z, ax, az, reach)
    if ledger:
        by_weight, by_external, by_boundary = work(p, layout.discs, scratch, kick, dt, weight_x, weight_z, mean_x, mean_z)
        books[p, WORK_WEIGHT] += by_weight
        books[p, WORK_EXTERNAL] += by_external
        books[p, WORK_BOUNDARY] += by_boundary
    return moved


@njit(cache=True, nogil=True, error_model="numpy")
def interpolate(time, times, values, place):
    """Linear interpolation of a series, constant outside it; `place`: an interval at or before that of `time`."""
    if time <= times[0]:
        return values[0]
    if time >= times[-1]:
        return values[-1]
    while times[place + 1] < time:
        place += 1
    span = times[place + 1] - times[place]
    return values[place] + (values[place + 1] - values[place]) * ((time - times[place]) / span)


@njit(cache=True, nogil=True, error_model="numpy")
def advance(
    thread, threads, barrier, stops, steps, dt, last_dt, time, layout, table, lines, line_table,
    gravity, times, accelerations, reach, floor, share, ledger, books,
):  # fmt: skip
    """Takes up to `steps` steps of `dt`; each of `threads` threads calls it with its own number.

    stops (2, threads): what each thread found in a step. last_dt: the step before (0 after velocities were set).
    Returns (steps taken, time, reason): MOVED if the neighbour list must be made anew before the next step,
    OVERLAP if two discs are deeper in each other than allowed, DONE otherwise.
    """
    slices = len(layout.chunk_start) - 1
    begin = slices * thread // threads
    end = slices * (thread + 1) // threads
    scratch = np.zeros(SCRATCH)
    loaded = -1
    place = 0
    reason = DONE
    taken = 0
    while taken < steps and reason == DONE:
        # a new time step follows the old one without a jump of the velocities
        kick = 0.5 * (last_dt + dt)
        slip_time = last_dt
        while place + 2 < len(times) and times[place + 1] < time:
            place += 1
        ax = interpolate(time, times, accelerations[0], place)
        az = interpolate(time, times, accelerations[1], place)
        mean_x = 0.5 * (ax + interpolate(time + dt, times, accelerations[0], place))
        mean_z = 0.5 * (az + interpolate(time + dt, times, accelerations[1], place))
        too_deep = False
        moved = False
        ready = begin
        for p in range(begin, end):
            deep, loaded = contacts_of_slice(
                p, layout, table, lines, line_table, scratch, loaded, slip_time, floor, share, ledger, books
            )
            too_deep |= deep
            while ready < end and (layout.last[ready] <= p or layout.last[ready] >= end):
                if layout.first[ready] >= begin and layout.last[ready] < end:
                    moved |= move_slice(
                        ready, layout, scratch, kick, dt, gravity[0], gravity[1], ax, az, mean_x, mean_z, reach, ledger, books
                    )
                ready += 1
        if threads > 1:
            wait(barrier, threads)
            for p in range(begin, end):
                if layout.first[p] < begin or layout.last[p] >= end:
                    moved |= move_slice(
                        p, layout, scratch, kick, dt, gravity[0], gravity[1], ax, az, mean_x, mean_z, reach, ledger, books
                    )
        stops[taken % 2, thread] = OVERLAP if too_deep else (MOVED if moved else DONE)
        if threads > 1:
            wait(barrier, threads)
        for k in range(threads):
            reason = max(reason, stops[taken % 2, k])
        last_dt = dt
        time += dt
        taken += 1
    return taken, time, reason
