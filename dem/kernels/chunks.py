"""Kernel: forces and memory of contacts, 64 lanes at a time, and their energy losses since the last step."""

import numpy as np

from dem.kernels.arguments import Law, Springs, State
from dem.kernels.contact import ALLOWED
from dem.kernels.inner import inner
from dem.kernels.interaction import at_line, between_discs, face, line_lane
from dem.kernels.layout import (
    FR,
    FX,
    FZ,
    LANES,
    LENGTH,
    LINK,
    PORE,
    RADII,
    ROLL_LINK,
    ROLLED,
    SHARE,
    SHEAR,
    TORQUE,
    Layout,
)
from dem.kernels.losses import ANY_ORDER
from dem.kernels.prefetch import wide_vectors
from dem.kernels.scratch import BLOCK, constant, load_partners


@inner(forceinline=True, fastmath=ANY_ORDER)
def add(total: float, value: float) -> float:
    """A sum whose order the compiler may choose; for the energy balance, never for the motion."""
    return total + value


@inner(forceinline=True)
def contact(
    d: int, q: int, w: int, state: State, scratch: np.ndarray, slip_time: float, law: Law, soil: bool,
    pores: bool, with_losses: bool,
) -> tuple[bool, float, float, float, float]:  # fmt: skip
    """The contact in lane q: writes forces and memory.

    Returns whether it is too deep, and twice what dashpots, sliding, cracks and rolling took since the last step (J).
    """
    links = state.links
    m, now = between_discs(d, q, w, state, scratch, slip_time, law, soil, pores, with_losses)
    deep = now.over > scratch[constant(ALLOWED) + q] * links[d + RADII + q]
    if pores:
        cracked = now.length != links[d + LENGTH + q]
        links[d + PORE + q] = now.pore
        if cracked:
            links[d + LENGTH + q] = now.length
    links[d + SHEAR + q] = now.shear
    links[d + FX + q] = now.push * m.nx + now.drag * m.nz
    links[d + FZ + q] = now.push * m.nz - now.drag * m.nx
    rim = now.drag * m.lever
    if soil:
        rim -= state.rolling[w + SHARE + q] * now.torque
        state.rolling[w + ROLLED + q] = now.rolled
        state.rolling[w + TORQUE + q] = now.torque
    links[d + FR + q] = rim
    return deep, now.damped, now.slid, now.cracked, now.rolled_off


@inner(forceinline=True)
def face_partners(chunk: int, state: State, scratch: np.ndarray, law: Law, soil: bool) -> None:
    """Fetches the partners of one chunk into the scratch rows, with directions and distances."""
    wide_vectors()
    for begin in range(0, LANES, BLOCK):
        load_partners(chunk, begin, state, scratch, soil)
        for lane in range(begin, begin + BLOCK):
            face(np.uint64(chunk) * LINK, np.uint64(lane), state, scratch, law, soil)


@inner(forceinline=True)
def all_lanes(
    chunk: int, state: State, scratch: np.ndarray, slip_time: float, law: Law, soil: bool, pores: bool,
    with_losses: bool,
) -> tuple[bool, float, float, float, float]:  # fmt: skip
    """The contacts of one chunk, and the sums of their losses."""
    wide_vectors()
    too_deep = False
    damping, sliding, cracks, rolling = 0.0, 0.0, 0.0, 0.0
    d, w = np.uint64(chunk) * LINK, np.uint64(chunk) * ROLL_LINK
    face_partners(chunk, state, scratch, law, soil)
    for lane in range(LANES):
        deep, damped, slid, cracked, rolled = contact(
            d, np.uint64(lane), w, state, scratch, slip_time, law, soil, pores, with_losses
        )
        too_deep |= deep
        if with_losses:
            damping = add(damping, damped)
            sliding = add(sliding, slid)
            cracks = add(cracks, cracked)
            rolling = add(rolling, rolled)
    return too_deep, 0.5 * damping, 0.5 * sliding, 0.5 * cracks, 0.5 * rolling


@inner(nogil=True)
def contacts(chunk: int, state: State, scratch: np.ndarray, slip_time: float, law: Law) -> bool:
    """Forces and memory of one chunk of contacts; True if an overlap is larger than allowed."""
    if not law.soil:
        return all_lanes(chunk, state, scratch, slip_time, law, False, True, False)[0]
    if law.pores:
        return all_lanes(chunk, state, scratch, slip_time, law, True, True, False)[0]
    return all_lanes(chunk, state, scratch, slip_time, law, True, False, False)[0]


@inner(nogil=True)
def contacts_with_losses(
    chunk: int, state: State, scratch: np.ndarray, slip_time: float, law: Law
) -> tuple[bool, float, float, float, float]:
    """Forces and memory of one chunk, and the losses by dashpots, sliding, cracks and rolling in the last step (J)."""
    if not law.soil:
        return all_lanes(chunk, state, scratch, slip_time, law, False, True, True)
    if law.pores:
        return all_lanes(chunk, state, scratch, slip_time, law, True, True, True)
    return all_lanes(chunk, state, scratch, slip_time, law, True, False, True)


@inner(nogil=True)
def line_contact(
    e: int, layout: Layout, springs: Springs, slip_time: float, law: Law
) -> tuple[bool, float, float, float]:
    """Forces of a rigid line on one disc.

    Returns whether it is too deep, and what dashpots, sliding and rolling took since the last step (J).
    """
    links = layout.links
    at, w = line_lane(e, layout)
    m, now = at_line(e, at, w, layout, springs, slip_time, law)
    links[at + SHEAR] = now.shear
    links[at + FX] = now.push * m.nx + now.drag * m.nz
    links[at + FZ] = now.push * m.nz - now.drag * m.nx
    links[at + FR] = now.drag
    if law.soil:
        links[at + FR] += now.torque
        layout.rolling[w + ROLLED] = now.rolled
        layout.rolling[w + TORQUE] = now.torque
    allowed = 2.0 * springs.lines[ALLOWED, layout.line_kind[e]] * layout.line_radius[e]
    return now.over > allowed, 0.5 * now.damped, 0.5 * now.slid, 0.5 * now.rolled_off
