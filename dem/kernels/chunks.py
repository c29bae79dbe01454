"""Kernel: forces and memory of contacts, 64 lanes at a time, and what they cost since the last step.

The inner loops read and write rows of 64 doubles at fixed distances, so that they become vector instructions: what
comes from elsewhere, the partners' state and the constants of the pairs, is first copied into rows of a scratch array.
"""

import math

import numpy as np
from numba import njit

from dem.kernels.contact import (
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
from dem.kernels.layout import (
    FR,
    FX,
    FZ,
    LANES,
    LENGTH,
    LINK,
    LINK_FIELDS,
    PORE,
    RADII,
    SHEAR,
    VR,
    VRS,
    VX,
    VXS,
    VZ,
    VZS,
    Layout,
    X,
    Z,
)
from dem.kernels.prefetch import LINE, fetch

# Scratch rows of 64 doubles: the partners' first eight fields, the constants, three sums of forces.
CONSTANT = np.uint64(8 * LANES)
SUM_X, SUM_Z, SUM_R = (np.uint64((8 + CONSTANTS + k) * LANES) for k in range(3))
SCRATCH = (8 + CONSTANTS + 3) * LANES
R_KN, R_KS, R_CN, R_CT, R_MU, R_KPN, R_KPS, R_TAN, R_BC, R_BETA, R_ALLOWED, R_FKS, R_FKPS = (
    np.uint64((8 + k) * LANES) for k in (KN, KS, CN, CT, MU, KPN, KPS, TAN, BC, BETA, ALLOWED, FKS, FKPS)
)
ROW = np.uint64(LANES)
ONE = np.uint64(1)
AHEAD = 3  # chunks: as many as a slice mostly has

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
def load_partners(chunk: int, layout: Layout, scratch: np.ndarray) -> None:
    """Position and velocities of 64 partners, in rows, while the memory fetches what a later chunk will need.

    One line of its contacts and one of its partners at a time: a core waits once it has asked for a few dozen lines.
    Eight partners in a row mostly share their lines.
    """
    first = np.uint64(chunk) * ROW
    later = min(np.uint64(chunk + AHEAD), np.uint64(layout.chunk_start[-1] - 1)) * ROW
    for lane in range(LANES):
        q = np.uint64(lane)
        row_ahead = q & (LINE - ONE)
        fetch(layout.links, later * np.uint64(LINK_FIELDS) + q * LINE)
        fetch(layout.discs, np.uint64(layout.partner[later + q - row_ahead]) + row_ahead * ROW)
        disc = np.uint64(layout.partner[first + q])
        for row in range(8):
            scratch[np.uint64(row) * ROW + q] = layout.discs[disc + np.uint64(row) * ROW]


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
