"""Kernel: the energies of the discs at one instant, from the layout that the stepping kernel works on.

The springs' memory is one step behind the positions, and dashpots are booked up to half a step ago; both are brought
up to the instant here without being changed.
"""

import numpy as np
from numba import njit

from dem.contact import CN, CT, FKS, KN, KS, MU, element, pore
from dem.layout import (
    DISC,
    LANES,
    LENGTH,
    LINK,
    INVMASS,
    PORE,
    RADII,
    RIM,
    SHEAR,
    VRS,
    VXS,
    VZS,
)
from dem.stepping import (
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
    geometry,
    line_geometry,
    line_lane,
    load_constants,
    load_partners,
    losses,
    pore_losses,
)

# Entries of what `energies` returns (J per metre out of plane); the last three came about since the last step.
TRANSLATION, ROTATION, ELEMENTS, PORES, LATE_DASHPOT, LATE_SLIDING, LATE_CRACKS = range(7)
ENERGIES = 7


@njit(cache=True, nogil=True, error_model="numpy")
def kinetic(discs, slices, out):
    """Adds the kinetic energy of all discs that can move."""
    for p in range(slices):
        b = np.uint64(p) * DISC
        for lane in range(LANES):
            l = np.uint64(lane)  # noqa: E741
            vx, vz, vr = discs[b + VXS + l], discs[b + VZS + l], discs[b + VRS + l]
            if discs[b + INVMASS + l] > 0.0:
                out[TRANSLATION] += 0.5 * (vx * vx + vz * vz) / discs[b + INVMASS + l]
            if discs[b + RIM + l] > 0.0:
                out[ROTATION] += 0.5 * vr * vr / discs[b + RIM + l]


@njit(cache=True, nogil=True, error_model="numpy")
def contact_energy(b, d, l, discs, links, scratch, slip_time, wait, floor, share, out):  # noqa: E741
    """Adds what the contact in lane l stores, and dissipated since the last step; wait: time since dashpots were booked."""
    radii = links[d + RADII + l]
    distance, _, _, _, vn, vt, slip = geometry(b, l, discs, scratch, radii, slip_time)
    over = radii - distance
    kn, kpn = scratch[R_KN + l], scratch[R_KPN + l]
    shear, length, old = links[d + SHEAR + l], links[d + LENGTH + l], links[d + PORE + l]
    normal, tangential, trial, kept = element(
        over, vn, vt, slip, shear, floor, kn, scratch[R_KS + l], scratch[R_CN + l], scratch[R_CT + l],
        scratch[R_MU + l],
    )  # fmt: skip
    push, pore_trial, pore_kept, new = pore(
        length, distance, slip, old, share * normal, kpn, scratch[R_KPS + l], scratch[R_TAN + l],
        scratch[R_BC + l], scratch[R_BETA + l],
    )  # fmt: skip
    stiff, pore_stiff = scratch[R_FKS + l], scratch[R_FKPS + l]
    power, slid = losses(kn, over, vn, vt, normal, tangential, shear, trial, kept, stiff)
    pore_slid, crack = pore_losses(kpn, length, new, distance, vn * slip_time, old, pore_trial, pore_kept, pore_stiff)
    if over > 0.0:
        out[ELEMENTS] += 0.5 * kn * over * over
    out[ELEMENTS] += 0.5 * kept * kept * stiff
    if kpn > 0.0:
        out[PORES] += 0.5 * push * push / kpn
    out[PORES] += 0.5 * pore_kept * pore_kept * pore_stiff
    out[LATE_DASHPOT] += power * wait
    out[LATE_SLIDING] += slid + pore_slid
    out[LATE_CRACKS] += crack


@njit(cache=True, nogil=True, error_model="numpy")
def energies(layout, table, lines, line_table, last_dt, floor, share):
    """The energies of all discs and contacts (ENERGIES,)."""
    out = np.zeros(ENERGIES)
    slices = len(layout.chunk_start) - 1
    kinetic(layout.discs, slices, out)
    scratch = np.zeros(SCRATCH)
    wait = 0.5 * last_dt
    for p in range(slices):
        for chunk in range(layout.chunk_start[p], layout.chunk_start[p + 1]):
            first = np.uint64(chunk) * ROW
            load_constants(layout.chunk_kind[chunk], layout.kinds, first, table, scratch)
            load_partners(layout.partner, first, layout.discs, scratch)
            for lane in range(LANES):
                contact_energy(
                    np.uint64(p) * DISC, np.uint64(chunk) * LINK, np.uint64(lane), layout.discs, layout.links,
                    scratch, last_dt, wait, floor, share, out,
                )  # fmt: skip
    for e in range(len(layout.line_disc)):
        k = layout.line_kind[e]
        over, _, _, vn, vt, slip = line_geometry(e, layout, lines, last_dt)
        shear = layout.links[line_lane(e, layout) + SHEAR]
        normal, tangential, trial, kept = element(
            over, vn, vt, slip, shear, floor,
            line_table[KN, k], line_table[KS, k], line_table[CN, k], line_table[CT, k], line_table[MU, k],
        )  # fmt: skip
        power, slid = losses(
            line_table[KN, k], over, vn, vt, normal, tangential, shear, trial, kept, line_table[FKS, k]
        )
        if over > 0.0:
            out[ELEMENTS] += 0.5 * line_table[KN, k] * over * over
        out[ELEMENTS] += 0.5 * kept * kept * line_table[FKS, k]
        out[LATE_DASHPOT] += power * wait
        out[LATE_SLIDING] += slid
    return out
