"""Kernel: the energies of the discs at one instant, from the layout that the stepping kernel works on.

The kinetic energy is m/2 v(n-1/2) v(n+1/2): of second order like the scheme, and what the scheme keeps exactly. Its
second velocity takes the forces of this instant. They are taken here, and so is what springs, dashpots and boundaries
did since the last step, without anything being changed.
"""

import numpy as np
from numba import njit

from dem.kernels.chunks import (
    R_BC,
    R_BETA,
    R_CN,
    R_CT,
    R_FKPS,
    R_FKS,
    R_KN,
    R_KPN,
    R_KPS,
    R_KS,
    R_MU,
    R_TAN,
    ROW,
    SCRATCH,
    dashpots_before,
    geometry,
    line_geometry,
    line_lane,
    load_constants,
    load_partners,
    losses,
    pore_losses,
)
from dem.kernels.contact import CN, CT, FKS, KN, KS, MU, element, pore
from dem.kernels.layout import (
    DISC,
    FX,
    FZ,
    INVMASS,
    LANES,
    LENGTH,
    LINK,
    PORE,
    RADII,
    RIM,
    SHEAR,
    VR,
    VX,
    VZ,
    WEIGHT,
    Layout,
    disc_at,
)

# Entries of what `energies` returns (J per metre out of plane); the last four came about since the last step.
TRANSLATION, ROTATION, ELEMENTS, PORES, LATE_DASHPOT, LATE_SLIDING, LATE_CRACKS, LATE_BOUNDARY = range(8)
ENERGIES = 8


@njit(cache=True, nogil=True, error_model="numpy")
def contact_energy(
    b: int,
    d: int,
    q: int,
    layout: Layout,
    scratch: np.ndarray,
    slip_time: float,
    floor: float,
    share: float,
    out: np.ndarray,
) -> tuple[float, float, float]:
    """Adds what the contact in lane q stores, and lost since the last step; returns its force on the partner."""
    links = layout.links
    radii = links[d + RADII + q]
    distance, nx, nz, lever, vn, vt, slip, stretch = geometry(b, q, layout.discs, scratch, radii, slip_time)
    over = radii - distance
    kn, kpn = scratch[R_KN + q], scratch[R_KPN + q]
    shear, length, old = links[d + SHEAR + q], links[d + LENGTH + q], links[d + PORE + q]
    normal, tangential, trial, kept = element(
        over, vn, vt, slip, shear, floor, kn, scratch[R_KS + q], scratch[R_CN + q], scratch[R_CT + q], scratch[R_MU + q]
    )
    push, pore_trial, pore_kept, new = pore(
        length, distance, slip, old, share * normal, kpn, scratch[R_KPS + q], scratch[R_TAN + q],
        scratch[R_BC + q], scratch[R_BETA + q],
    )  # fmt: skip
    spring = kn * over if over > 0.0 else 0.0
    old_n, old_t = dashpots_before(
        links[d + FX + q], links[d + FZ + q], nx, nz, kn, over, kpn, length, distance, stretch, shear + old
    )
    damped, slid = losses(
        stretch, slip, normal - spring, tangential - kept, old_n, old_t, shear, trial, kept, scratch[R_FKS + q]
    )
    pore_slid, crack = pore_losses(kpn, length, new, distance, stretch, old, pore_trial, pore_kept, scratch[R_FKPS + q])
    out[ELEMENTS] += 0.5 * spring * spring / kn + 0.5 * kept * kept * scratch[R_FKS + q]
    if kpn > 0.0:
        out[PORES] += 0.5 * push * push / kpn
    out[PORES] += 0.5 * pore_kept * pore_kept * scratch[R_FKPS + q]
    out[LATE_DASHPOT] += damped
    out[LATE_SLIDING] += slid + pore_slid
    out[LATE_CRACKS] += crack
    total, drag = normal + push, tangential + pore_kept
    return total * nx + drag * nz, total * nz - drag * nx, drag * lever


@njit(cache=True, nogil=True, error_model="numpy")
def line_energy(
    e: int, layout: Layout, lines: np.ndarray, line_table: np.ndarray, slip_time: float, floor: float, out: np.ndarray
) -> tuple[float, float, float]:
    """The same for a disc at a rigid line; returns the force on the disc."""
    k = layout.line_kind[e]
    over, nx, nz, vn, vt, slip, stretch = line_geometry(e, layout, lines, slip_time)
    at = line_lane(e, layout)
    shear = layout.links[at + SHEAR]
    kn = line_table[KN, k]
    normal, tangential, trial, kept = element(
        over, vn, vt, slip, shear, floor, kn, line_table[KS, k], line_table[CN, k], line_table[CT, k], line_table[MU, k]
    )
    spring = kn * over if over > 0.0 else 0.0
    old_n, old_t = dashpots_before(
        layout.links[at + FX], layout.links[at + FZ], nx, nz, kn, over, 0.0, 0.0, 0.0, stretch, shear
    )
    damped, slid = losses(
        stretch, slip, normal - spring, tangential - kept, old_n, old_t, shear, trial, kept, line_table[FKS, k]
    )
    out[ELEMENTS] += 0.5 * spring * spring / kn + 0.5 * kept * kept * line_table[FKS, k]
    out[LATE_DASHPOT] += damped
    out[LATE_SLIDING] += slid
    return normal * nx + tangential * nz, normal * nz - tangential * nx, tangential


@njit(cache=True, nogil=True, error_model="numpy")
def kinetic(
    layout: Layout,
    force: np.ndarray,
    weight_x: float,
    weight_z: float,
    ax: float,
    az: float,
    dt: float,
    out: np.ndarray,
) -> None:
    """Adds the kinetic energy of all discs that can move, and the work on those that are moved."""
    discs = layout.discs
    for p in range(len(layout.chunk_start) - 1):
        b = np.uint64(p) * DISC
        for lane in range(LANES):
            q = np.uint64(lane)
            fx, fz, fr = force[p * LANES + lane]
            vx, vz, vr = discs[b + VX + q], discs[b + VZ + q], discs[b + VR + q]
            invmass, rim, weight = discs[b + INVMASS + q], discs[b + RIM + q], discs[b + WEIGHT + q]
            if invmass > 0.0:
                next_x = vx + dt * (fx * invmass + weight * weight_x + ax)
                next_z = vz + dt * (fz * invmass + weight * weight_z + az)
                out[TRANSLATION] += 0.5 * (vx * next_x + vz * next_z) / invmass
            else:
                out[LATE_BOUNDARY] -= 0.5 * dt * (fx * vx + fz * vz + fr * vr)
            if rim > 0.0:
                out[ROTATION] += 0.5 * vr * (vr + dt * fr * rim) / rim


@njit(cache=True, nogil=True, error_model="numpy")
def energies(
    layout: Layout,
    table: np.ndarray,
    lines: np.ndarray,
    line_table: np.ndarray,
    gravity: np.ndarray,
    ax: float,
    az: float,
    last_dt: float,
    floor: float,
    share: float,
) -> np.ndarray:
    """The energies of all discs and contacts (ENERGIES,); ax, az: external acceleration at this instant."""
    out = np.zeros(ENERGIES)
    slices = len(layout.chunk_start) - 1
    scratch = np.zeros(SCRATCH)
    force = np.zeros((slices * LANES, 3))
    for p in range(slices):
        for chunk in range(layout.chunk_start[p], layout.chunk_start[p + 1]):
            first = np.uint64(chunk) * ROW
            load_constants(layout.chunk_kind[chunk], layout.kinds, first, table, scratch)
            load_partners(chunk, layout, scratch)
            for lane in range(LANES):
                fx, fz, fr = contact_energy(
                    np.uint64(p) * DISC, np.uint64(chunk) * LINK, np.uint64(lane), layout, scratch, last_dt, floor,
                    share, out,
                )  # fmt: skip
                i, j = p * LANES + lane, disc_at(layout.partner[chunk * LANES + lane])
                force[i, 0] -= fx
                force[i, 1] -= fz
                force[i, 2] += fr
                force[j, 0] += fx
                force[j, 1] += fz
                force[j, 2] += fr
    for e in range(len(layout.line_disc)):
        fx, fz, fr = line_energy(e, layout, lines, line_table, last_dt, floor, out)
        i = disc_at(layout.line_disc[e])
        force[i, 0] += fx
        force[i, 1] += fz
        force[i, 2] += fr
    kinetic(layout, force, gravity[0], gravity[1], ax, az, last_dt, out)
    return out
