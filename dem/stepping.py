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
from dem.layout import (
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
    ROLL,
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
    Layout,
    X,
    Z,
)
from dem.prefetch import prefetch

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
def add(total: float, value: float) -> float:
    """A sum whose order the compiler may choose; for the ledger, never for the motion."""
    return total + value


@njit(cache=True, nogil=True, forceinline=True, error_model="numpy")
def load_constants(kind: int, kinds: np.ndarray, first: int, table: np.ndarray, scratch: np.ndarray) -> None:
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
            for q in range(lane, end):
                scratch[base + np.uint64(q)] = value
        lane = end


@njit(cache=True, nogil=True, forceinline=True, error_model="numpy")
def load_partners(partner: np.ndarray, first: int, discs: np.ndarray, scratch: np.ndarray) -> None:
    """Position and velocities of 64 partners, in rows."""
    for lane in range(LANES):
        disc = np.uint64(partner[first + np.uint64(lane)])
        for row in range(8):
            scratch[np.uint64(row) * ROW + np.uint64(lane)] = discs[disc + np.uint64(row) * ROW]


@njit(cache=True, forceinline=True, error_model="numpy")
def geometry(
    b: int, q: int, discs: np.ndarray, scratch: np.ndarray, radii: float, slip_time: float
) -> tuple[float, float, float, float, float, float, float, float]:
    """Distance, direction, lever ratio, speeds, slip and stretch since the last step of the contact in lane q.

    The levers of the tangential force are the distance times r_i/(r_i + r_j): they add up to the distance, so that
    angular momentum is kept and a pair that turns as one body does not slip. One square root, one division.
    """
    dx = scratch[X + q] - discs[b + X + q]
    dz = scratch[Z + q] - discs[b + Z + q]
    square = dx * dx + dz * dz
    distance = math.sqrt(square)
    inverse = 1.0 / (distance * radii)
    lever = square * inverse
    nx = dx * (inverse * radii)
    nz = dz * (inverse * radii)
    ux = scratch[VXS + q] - discs[b + VXS + q]
    uz = scratch[VZS + q] - discs[b + VZS + q]
    hx = scratch[VX + q] - discs[b + VX + q]
    hz = scratch[VZ + q] - discs[b + VZ + q]
    vn = ux * nx + uz * nz
    vt = (uz * nx - ux * nz) - lever * (scratch[VRS + q] + discs[b + VRS + q])
    slip = slip_time * ((hz * nx - hx * nz) - lever * (scratch[VR + q] + discs[b + VR + q]))
    stretch = slip_time * (hx * nx + hz * nz)
    return distance, nx, nz, lever, vn, vt, slip, stretch


@njit(cache=True, forceinline=True, error_model="numpy")
def dashpots_before(
    fx: float,
    fz: float,
    nx: float,
    nz: float,
    kn: float,
    over: float,
    kpn: float,
    length: float,
    distance: float,
    stretch: float,
    shear: float,
) -> tuple[float, float]:
    """Normal and tangential force of the dashpots in the last step: all the force there was, less that of springs.

    fx, fz: force on the partner then; over, distance: now, and longer by `stretch` since; shear: of both springs then.
    """
    over_then = over + stretch
    spring = kn * over_then if over_then > 0.0 else 0.0
    push = kpn * (abs(length) - distance + stretch)
    push = push if (length > 0.0) | (push > 0.0) else 0.0
    return (fx * nx + fz * nz) - spring - push, (fx * nz - fz * nx) - shear


@njit(cache=True, forceinline=True, error_model="numpy")
def losses(
    stretch: float,
    slip: float,
    dash_n: float,
    dash_t: float,
    old_dash_n: float,
    old_dash_t: float,
    old: float,
    trial: float,
    kept: float,
    flexibility: float,
) -> tuple[float, float]:
    """Work that the dashpots and the sliding of an element contact took since the last step (J).

    dash_*: what the dashpots add to the springs' forces, before and now. The work of a step is its displacement times
    the mean of the forces at its ends: that is what the scheme takes from the kinetic energy v(n-1/2) v(n+1/2) m/2, so
    the books of linear springs and dashpots close to rounding, whatever the step.
    """
    damped = 0.5 * ((dash_t + old_dash_t) * slip - (dash_n + old_dash_n) * stretch)
    return damped, 0.5 * (old + kept) * (trial - kept) * flexibility


@njit(cache=True, forceinline=True, error_model="numpy")
def pore_losses(
    kpn: float,
    length: float,
    new: float,
    distance: float,
    stretch: float,
    old: float,
    trial: float,
    kept: float,
    flexibility: float,
) -> tuple[float, float]:
    """Work of sliding of a cracked pore spring, and energy a crack sets free, since the last step (J)."""
    lost = 0.5 * (old + kept) * (trial - kept) * flexibility
    pull = distance - abs(new)
    before = pull - stretch
    snapped = 0.5 * kpn * pull * before if (pull > 0.0) & (before > 0.0) else 0.0
    cracking = (length > 0.0) & (new <= 0.0)
    return 0.0 if cracking else lost, lost + snapped if cracking else 0.0


@njit(cache=True, forceinline=True, error_model="numpy")
def contact(
    b: int,
    d: int,
    q: int,
    discs: np.ndarray,
    links: np.ndarray,
    scratch: np.ndarray,
    slip_time: float,
    floor: float,
    share: float,
    ledger: bool,
) -> tuple[bool, float, float, float]:
    """The contact in lane q: writes forces and memory.

    Returns whether it is too deep, and what its dashpots, sliding and cracks took since the last step (J).
    """
    radii = links[d + RADII + q]
    distance, nx, nz, lever, vn, vt, slip, stretch = geometry(b, q, discs, scratch, radii, slip_time)
    over = radii - distance
    shear = links[d + SHEAR + q]
    kn = scratch[R_KN + q]
    normal, tangential, trial, kept = element(
        over, vn, vt, slip, shear, floor, kn, scratch[R_KS + q], scratch[R_CN + q], scratch[R_CT + q],
        scratch[R_MU + q],
    )  # fmt: skip
    length = links[d + LENGTH + q]
    old_pore = links[d + PORE + q]
    pore_normal, pore_trial, pore_kept, new = pore(
        length, distance, slip, old_pore, share * normal,
        scratch[R_KPN + q], scratch[R_KPS + q], scratch[R_TAN + q], scratch[R_BC + q], scratch[R_BETA + q],
    )  # fmt: skip
    damped = 0.0
    slid = 0.0
    crack = 0.0
    if ledger:
        dash_n = normal - (kn * over if over > 0.0 else 0.0)
        dash_t = tangential - kept
        old_n, old_t = dashpots_before(
            links[d + FX + q], links[d + FZ + q], nx, nz, kn, over, scratch[R_KPN + q], length, distance, stretch,
            shear + old_pore,
        )  # fmt: skip
        damped, slid = losses(stretch, slip, dash_n, dash_t, old_n, old_t, shear, trial, kept, scratch[R_FKS + q])
        pore_slid, crack = pore_losses(
            scratch[R_KPN + q], length, new, distance, stretch, old_pore, pore_trial, pore_kept, scratch[R_FKPS + q]
        )
        slid += pore_slid
    links[d + SHEAR + q] = kept
    links[d + PORE + q] = pore_kept
    if new != length:
        links[d + LENGTH + q] = new
    push = normal + pore_normal
    drag = tangential + pore_kept
    links[d + FX + q] = push * nx + drag * nz
    links[d + FZ + q] = push * nz - drag * nx
    links[d + FR + q] = drag * lever
    return over > scratch[R_ALLOWED + q] * radii, damped, slid, crack


@njit(cache=True, nogil=True, error_model="numpy")
def contacts(
    chunk: int,
    b: int,
    discs: np.ndarray,
    links: np.ndarray,
    scratch: np.ndarray,
    slip_time: float,
    floor: float,
    share: float,
) -> bool:
    """Forces and memory of one chunk of contacts; True if an overlap is larger than allowed."""
    too_deep = False
    for lane in range(LANES):
        deep, _, _, _ = contact(
            b, np.uint64(chunk) * LINK, np.uint64(lane), discs, links, scratch, slip_time, floor, share, False
        )
        too_deep |= deep
    return too_deep


@njit(cache=True, nogil=True, error_model="numpy")
def contacts_with_losses(
    chunk: int,
    b: int,
    discs: np.ndarray,
    links: np.ndarray,
    scratch: np.ndarray,
    slip_time: float,
    floor: float,
    share: float,
) -> tuple[bool, float, float, float]:
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
def line_geometry(
    e: int, layout: Layout, lines: np.ndarray, slip_time: float
) -> tuple[float, float, float, float, float, float, float]:
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
def line_contact(
    e: int, at: np.uint64, layout: Layout, lines: np.ndarray, line_table: np.ndarray, slip_time: float, floor: float
) -> tuple[bool, float, float]:
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
    old_n, old_t = dashpots_before(
        links[at + FX], links[at + FZ], nx, nz, line_table[KN, k], over, 0.0, 0.0, 0.0, stretch, shear
    )
    damped, slid = losses(stretch, slip, dash_n, dash_t, old_n, old_t, shear, trial, kept, line_table[FKS, k])
    links[at + SHEAR] = kept
    links[at + FX] = normal * nx + tangential * nz
    links[at + FZ] = normal * nz - tangential * nx
    links[at + FR] = tangential
    return over > 2.0 * line_table[ALLOWED, k] * layout.line_radius[e], damped, slid


@njit(cache=True, nogil=True, error_model="numpy")
def line_lane(e: int, layout: Layout) -> np.uint64:
    """Where the forces of disc e at a rigid line lie in links: behind the chunks and the silent lane."""
    tail = np.uint64(layout.chunk_start[-1] + 1)
    return (tail + np.uint64(e // LANES)) * LINK + np.uint64(e % LANES)


@njit(cache=True, nogil=True, forceinline=True, error_model="numpy")
def sum_forces(p: int, layout: Layout, scratch: np.ndarray) -> None:
    """Forces and rim force on the 64 discs of slice p, from the contacts they own, then from the others."""
    links = layout.links
    own = np.uint64(layout.chunk_start[p])
    owned = layout.chunk_start[p + 1] - layout.chunk_start[p]
    others = np.uint64(layout.incoming_start[p])
    count = layout.incoming_start[p + 1] - layout.incoming_start[p]
    for lane in range(LANES):
        q = np.uint64(lane)
        fx = 0.0
        fz = 0.0
        fr = 0.0
        for k in range(owned):
            at = (own + np.uint64(k)) * LINK + q
            fx -= links[at + FX]
            fz -= links[at + FZ]
            fr += links[at + FR]
        for k in range(count):
            at = np.uint64(layout.incoming[(others + np.uint64(k)) * ROW + q])
            fx += links[at]
            fz += links[at + ROW]
            fr += links[at + ROW + ROW]
        scratch[SUM_X + q] = fx
        scratch[SUM_Z + q] = fz
        scratch[SUM_R + q] = fr


@njit(cache=True, nogil=True, error_model="numpy")
def move(
    p: int,
    discs: np.ndarray,
    scratch: np.ndarray,
    kick: float,
    dt: float,
    weight_x: float,
    weight_z: float,
    ax: float,
    az: float,
    reach: float,
) -> bool:
    """One step of the 64 discs of slice p; True if one has moved further than sqrt(reach) since the list was made.

    kick: time (s) between the velocities kept and the new ones; weight_*: gravity, ax, az: external acceleration.
    """
    b = np.uint64(p) * DISC
    half = 0.5 * dt
    moved = False
    for lane in range(LANES):
        q = np.uint64(lane)
        invmass = discs[b + INVMASS + q]
        weight = discs[b + WEIGHT + q]
        free = 1.0 if invmass > 0.0 else 0.0
        accel_x = scratch[SUM_X + q] * invmass + free * (weight * weight_x + ax)
        accel_z = scratch[SUM_Z + q] * invmass + free * (weight * weight_z + az)
        accel_r = scratch[SUM_R + q] * discs[b + RIM + q]
        vx = discs[b + VX + q] + kick * accel_x
        vz = discs[b + VZ + q] + kick * accel_z
        vr = discs[b + VR + q] + kick * accel_r
        x = discs[b + X + q] + dt * vx
        z = discs[b + Z + q] + dt * vz
        discs[b + VX + q] = vx
        discs[b + VZ + q] = vz
        discs[b + VR + q] = vr
        discs[b + VXS + q] = vx + half * accel_x
        discs[b + VZS + q] = vz + half * accel_z
        discs[b + VRS + q] = vr + half * accel_r
        discs[b + X + q] = x
        discs[b + Z + q] = z
        discs[b + ROLL + q] += dt * vr
        dx = x - discs[b + X0 + q]
        dz = z - discs[b + Z0 + q]
        moved |= not (dx * dx + dz * dz <= reach)
    return moved


@njit(cache=True, nogil=True, error_model="numpy")
def work(
    p: int,
    discs: np.ndarray,
    scratch: np.ndarray,
    kick: float,
    dt: float,
    weight_x: float,
    weight_z: float,
    ax: float,
    az: float,
) -> tuple[float, float, float]:
    """Work of weight, external acceleration and moving boundaries on slice p, once `move` has moved it (J).

    ax, az: mean of the external acceleration over the step.
    """
    b = np.uint64(p) * DISC
    by_weight = 0.0
    by_external = 0.0
    by_boundary = 0.0
    for lane in range(LANES):
        q = np.uint64(lane)
        invmass = discs[b + INVMASS + q]
        mass = 1.0 / invmass if invmass > 0.0 else 0.0
        vx = discs[b + VX + q]
        vz = discs[b + VZ + q]
        by_weight = add(by_weight, mass * discs[b + WEIGHT + q] * (weight_x * vx + weight_z * vz))
        by_external = add(by_external, mass * (ax * vx + az * vz))
        driven = scratch[SUM_X + q] * vx + scratch[SUM_Z + q] * vz + scratch[SUM_R + q] * discs[b + VR + q]
        by_boundary = add(by_boundary, 0.0 if invmass > 0.0 else -driven)
    return by_weight * dt, by_external * dt, by_boundary * kick


@njit(cache=True, nogil=True, forceinline=True, error_model="numpy")
def contacts_of_slice(
    p: int,
    layout: Layout,
    table: np.ndarray,
    lines: np.ndarray,
    line_table: np.ndarray,
    scratch: np.ndarray,
    loaded: int,
    slip_time: float,
    floor: float,
    share: float,
    ledger: bool,
    books: np.ndarray,
) -> tuple[bool, int]:
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
def move_slice(
    p: int,
    layout: Layout,
    scratch: np.ndarray,
    kick: float,
    dt: float,
    weight_x: float,
    weight_z: float,
    ax: float,
    az: float,
    mean_x: float,
    mean_z: float,
    reach: float,
    ledger: bool,
    books: np.ndarray,
) -> bool:
    """Sums the forces on slice p and moves it; True if a disc has left the reach of the neighbour list."""
    sum_forces(p, layout, scratch)
    moved = move(p, layout.discs, scratch, kick, dt, weight_x, weight_z, ax, az, reach)
    if ledger:
        by_weight, by_external, by_boundary = work(
            p, layout.discs, scratch, kick, dt, weight_x, weight_z, mean_x, mean_z
        )
        books[p, WORK_WEIGHT] += by_weight
        books[p, WORK_EXTERNAL] += by_external
        books[p, WORK_BOUNDARY] += by_boundary
    return moved


@njit(cache=True, nogil=True, error_model="numpy")
def interpolate(time: float, times: np.ndarray, values: np.ndarray, place: int) -> float:
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
    thread: int,
    threads: int,
    barrier: np.ndarray,
    stops: np.ndarray,
    steps: int,
    dt: float,
    last_dt: float,
    time: float,
    layout: Layout,
    table: np.ndarray,
    lines: np.ndarray,
    line_table: np.ndarray,
    gravity: np.ndarray,
    times: np.ndarray,
    accelerations: np.ndarray,
    reach: float,
    floor: float,
    share: float,
    ledger: bool,
    books: np.ndarray,
) -> tuple[int, float, int]:
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
                        ready,
                        layout,
                        scratch,
                        kick,
                        dt,
                        gravity[0],
                        gravity[1],
                        ax,
                        az,
                        mean_x,
                        mean_z,
                        reach,
                        ledger,
                        books,
                    )
                ready += 1
        if threads > 1:
            wait(barrier, threads)
            for p in range(begin, end):
                if layout.first[p] < begin or layout.last[p] >= end:
                    moved |= move_slice(
                        p,
                        layout,
                        scratch,
                        kick,
                        dt,
                        gravity[0],
                        gravity[1],
                        ax,
                        az,
                        mean_x,
                        mean_z,
                        reach,
                        ledger,
                        books,
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
