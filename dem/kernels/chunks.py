"""Computes forces and history variables of contacts, 64 lanes at a time, and their energy losses since the last step
(kernel)."""

import numpy as np

from dem.kernels import layout as field
from dem.kernels.arguments import Law, Springs, State
from dem.kernels.contact import ALLOWED
from dem.kernels.device_function import device_function
from dem.kernels.interaction import at_line, between_discs, contact_geometry, line_lane
from dem.kernels.layout import Layout
from dem.kernels.losses import ANY_ORDER
from dem.kernels.prefetch import wide_vectors
from dem.kernels.work_buffers import FETCH_BLOCK, constant, load_partners


@device_function(forceinline=True, fastmath=ANY_ORDER)
def add(total: float, value: float) -> float:
    """Add two numbers in an order that the compiler may choose. A sum in any order is used for the energy balance only,
    never for the motion of the discs."""
    return total + value


@device_function(forceinline=True)
def contact(
    d: int, q: int, w: int, state: State, buffer: np.ndarray, slip_time: float, soil: bool,
    pores: bool, with_losses: bool,
) -> tuple[bool, float, float, float, float]:  # fmt: skip
    """Compute the contact in lane q of a chunk, and write its forces and history variables.

    d, w: places at which the chunk begins in `state.links` and `state.rolling`; state: arrays of discs and contacts;
    buffer: rows that `load_geometry` filled; slip_time: length of the last step (s); soil, pores, with_losses: see
    `between_discs`. Returns whether the overlap is too large, and twice the energy (J)
    dissipated by dashpots, sliding, cracks and rolling since the last step.
    """
    links = state.links
    m, now = between_discs(d, q, w, state, buffer, slip_time, soil, pores, with_losses)
    deep = now.over > buffer[constant(ALLOWED) + q] * links[d + field.RADII + q]
    if pores:
        cracked = now.length != links[d + field.LENGTH + q]
        links[d + field.PORE + q] = now.pore
        if cracked:
            links[d + field.LENGTH + q] = now.length
    links[d + field.SHEAR + q] = now.shear
    links[d + field.FX + q] = now.normal * m.nx + now.drag * m.nz
    links[d + field.FZ + q] = now.normal * m.nz - now.drag * m.nx
    rim = now.drag * m.lever
    if soil:
        rim -= state.rolling[w + field.SHARE + q] * now.torque
        state.rolling[w + field.ROLLED + q] = now.rolled
        state.rolling[w + field.TORQUE + q] = now.torque
    links[d + field.FR + q] = rim
    return deep, now.damped, now.slid, now.cracked, now.rolled_off


@device_function(forceinline=True)
def load_geometry(chunk: int, state: State, buffer: np.ndarray, law: Law, soil: bool) -> None:
    """Load the partners of one chunk into the rows of `buffer`, with directions and distances.

    state: arrays of discs and contacts; law: contact law with the period of the ground; soil: whether the discs are
    soil discs.
    """
    wide_vectors()
    for begin in range(0, field.LANES, FETCH_BLOCK):
        load_partners(chunk, begin, state, buffer, soil)
        for lane in range(begin, begin + FETCH_BLOCK):
            contact_geometry(np.uint64(chunk) * field.LINK, np.uint64(lane), state, buffer, law, soil)


@device_function(forceinline=True)
def all_lanes(
    chunk: int, state: State, buffer: np.ndarray, slip_time: float, law: Law, soil: bool, pores: bool,
    with_losses: bool,
) -> tuple[bool, float, float, float, float]:  # fmt: skip
    """Compute the contacts of one chunk.

    law: contact law with the period of the ground; state, buffer, slip_time, soil, pores, with_losses: as in `contact`.
    Returns whether an overlap is too large, and the energy (J) dissipated by dashpots, sliding, cracks and rolling.
    """
    wide_vectors()
    too_deep = False
    damping, sliding, cracks, rolling = 0.0, 0.0, 0.0, 0.0
    d, w = np.uint64(chunk) * field.LINK, np.uint64(chunk) * field.ROLL_LINK
    load_geometry(chunk, state, buffer, law, soil)
    for lane in range(field.LANES):
        deep, damped, slid, cracked, rolled = contact(
            d, np.uint64(lane), w, state, buffer, slip_time, soil, pores, with_losses
        )
        too_deep |= deep
        if with_losses:
            damping = add(damping, damped)
            sliding = add(sliding, slid)
            cracks = add(cracks, cracked)
            rolling = add(rolling, rolled)
    return too_deep, 0.5 * damping, 0.5 * sliding, 0.5 * cracks, 0.5 * rolling


@device_function(forceinline=True)
def lanes_by_law(
    chunk: int, state: State, buffer: np.ndarray, slip_time: float, law: Law, with_losses: bool
) -> tuple[bool, float, float, float, float]:
    """Compute the contacts of one chunk by the parts of the law that its discs have; state, buffer, slip_time,
    with_losses and result as in `all_lanes`."""
    if law.soil and law.pores:
        return all_lanes(chunk, state, buffer, slip_time, law, True, True, with_losses)
    if law.soil:
        return all_lanes(chunk, state, buffer, slip_time, law, True, False, with_losses)
    if law.pores:
        return all_lanes(chunk, state, buffer, slip_time, law, False, True, with_losses)
    return all_lanes(chunk, state, buffer, slip_time, law, False, False, with_losses)


@device_function(nogil=True)
def contacts(chunk: int, state: State, buffer: np.ndarray, slip_time: float, law: Law) -> bool:
    """Compute forces and history variables of one chunk of contacts; return True if an overlap is larger than allowed.

    state, buffer, slip_time, law: as in `all_lanes`.
    """
    return lanes_by_law(chunk, state, buffer, slip_time, law, False)[0]


@device_function(nogil=True)
def contacts_with_losses(
    chunk: int, state: State, buffer: np.ndarray, slip_time: float, law: Law
) -> tuple[bool, float, float, float, float]:
    """Compute forces and history variables of one chunk as `contacts` does, and the losses since the last step.

    state, buffer, slip_time, law: as in `all_lanes`. Returns whether an overlap is too large, and the losses by
    dashpots, sliding, cracks and rolling (J).
    """
    return lanes_by_law(chunk, state, buffer, slip_time, law, True)


@device_function(nogil=True)
def line_contact(
    e: int, layout: Layout, springs: Springs, slip_time: float, law: Law
) -> tuple[bool, float, float, float]:
    """Compute the contact e of a disc with a rigid line, and write its forces and history variables.

    layout: discs and contacts; springs: constants; slip_time: length of the last step (s); law: law of the contacts.
    Returns whether the overlap is too large, and the energy (J) dissipated by dashpots, sliding and rolling since the
    last step.
    """
    links = layout.links
    at, w = line_lane(e, layout)
    m, now = at_line(e, at, w, layout, springs, slip_time, law)
    links[at + field.SHEAR] = now.shear
    links[at + field.FX] = now.normal * m.nx + now.drag * m.nz
    links[at + field.FZ] = now.normal * m.nz - now.drag * m.nx
    links[at + field.FR] = now.drag
    if law.soil:
        links[at + field.FR] += now.torque
        layout.rolling[w + field.ROLLED] = now.rolled
        layout.rolling[w + field.TORQUE] = now.torque
    allowed = 2.0 * springs.lines[ALLOWED, layout.line_kind[e]] * layout.line_radius[e]
    return now.over > allowed, 0.5 * now.damped, 0.5 * now.slid, 0.5 * now.rolled_off
