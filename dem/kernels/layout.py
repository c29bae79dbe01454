"""Defines the layout of discs and contacts in memory, and converts it to and from lists (kernel).

Discs are sorted in space and cut into slices of 64 lanes. A slice, a block of 64 discs, stores some of the contacts of
its discs, and partner slices store the others. The contacts of a slice are kept in chunks of 64 lanes: lane l of a
chunk is a contact of the disc in lane l of the slice. Each field of a slice or chunk is 64 doubles in a row, and all
fields of one slice (or chunk) are adjacent. Every inner loop then runs over 64 neighbouring doubles at fixed distances
from one base address, so that the compiler can use vector instructions; lanes without a contact point to a disc far
away.

A layout does not depend on the number of threads, so that the order of sums is the same for any number.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from dem.kernels.device_function import device_function
from dem.kernels.liquefied_pairs import LANES, Liquefied
from dem.kernels.transpose import LANE_GROUP, SHARED

# What partners read of a disc, eight doubles in a record of its own, a cache line; these are the offsets of the rows in
# which they stand in the buffer. Rim speeds are radius times spin; *S are the velocities extrapolated to the end of
# the step, the others stand half a step behind.
X, Z, VX, VZ, VR, VXS, VZS, VRS = (np.uint64(k * LANES) for k in range(SHARED))

# The other fields of a disc, as offsets from the base of its slice. PULL is the acceleration by weight and water, and
# by what else shakes with the ground; MASS, for the energy balance, is none where a disc is fixed.
DISC_FIELDS = 8
INVMASS, RIM, PULL_X, PULL_Z, X0, Z0, ROLL, MASS = (np.uint64(k * LANES) for k in range(DISC_FIELDS))
DISC = np.uint64(DISC_FIELDS * LANES)

# Fields of a contact: sum of the radii; pore length (negative: cracked, 0: none); tangential forces kept by element
# and pore spring; force on the partner and rim force.
LINK_FIELDS = 7
RADII, LENGTH, SHEAR, PORE, FX, FZ, FR = (np.uint64(k * LANES) for k in range(LINK_FIELDS))
LINK = np.uint64(LINK_FIELDS * LANES)

# What a contact of soil discs remembers of rolling, in an array of its own: r_i/(r_i + r_j) of its owner i; the force
# kept by the spring of rolling; that of spring and dashpot (rolling moment over R, N).
ROLL_FIELDS = 3
SHARE, ROLLED, TORQUE = (np.uint64(k * LANES) for k in range(ROLL_FIELDS))
ROLL_LINK = np.uint64(ROLL_FIELDS * LANES)


class Layout(NamedTuple):
    """Holds all arrays that the stepping kernel reads and writes; see `pack`.

    Attributes
    ----------
    discs (slices * DISC,) : fields of the discs that only their own slice reads, in spatial order
    links ((chunks + 1 + line chunks) * LINK,) : fields of the contacts: chunks, one chunk whose forces are always zero,
        then contacts with rigid lines
    rolling ((chunks + 1 + line chunks) * ROLL_LINK,) : history variables of rolling of the same contacts; empty for
        discs with the law "paper"
    shared (slices * 64 * SHARED,) : fields of the discs that partners read, disc by disc
    partner (chunks * 64,) : number of the partner of each contact in spatial order
    kinds (chunks * 64,) : column of each contact in the table of constants
    changed (groups of eight lanes,) : places in `kinds` of the groups of eight lanes whose kinds of pairs differ from
        the kinds in the same lanes of the chunk before
    changed_start (chunks + 1,) : first entry of `changed` of each chunk
    chunk_start (slices + 1,) : first chunk of each slice
    incoming (slots * 64,) : for each disc, the places in `links` of the contact forces that another disc owns
    incoming_start (slices + 1,) : first slot of each slice
    lowest_owner, highest_owner (slices,) : lowest and highest slice that owns a contact of the slice's discs
    line_disc, line_id, line_kind (contacts with lines,) : contacts with lines: number of the disc in spatial order,
        number of the line, column of the table of lines
    line_radius (contacts with lines,) : radius of the disc (m)
    line_start (slices + 1,) : first contact with a line in each slice
    added_mass_disc (discs with added mass,) : numbers of the discs with added mass, in spatial order
    added_mass (discs with added mass, 4) : acceleration of these discs without added mass (PULL_X, PULL_Z), and the
        acceleration by added mass over the horizontal acceleration
    added_mass_start (slices + 1,) : first disc with added mass in each slice
    liquefied : liquefied discs and their pairs
    """

    discs: np.ndarray
    links: np.ndarray
    rolling: np.ndarray
    shared: np.ndarray
    partner: np.ndarray
    kinds: np.ndarray
    changed: np.ndarray
    changed_start: np.ndarray
    chunk_start: np.ndarray
    incoming: np.ndarray
    incoming_start: np.ndarray
    lowest_owner: np.ndarray
    highest_owner: np.ndarray
    line_disc: np.ndarray
    line_id: np.ndarray
    line_kind: np.ndarray
    line_radius: np.ndarray
    line_start: np.ndarray
    added_mass_disc: np.ndarray
    added_mass: np.ndarray
    added_mass_start: np.ndarray
    liquefied: Liquefied


@device_function(nogil=True, forceinline=True)
def entry(disc: int, field: int) -> np.uint64:
    """Return the index in the array `shared` at which a field of a disc is stored."""
    return np.uint64(disc) * np.uint64(SHARED) + field // np.uint64(LANES)


@device_function(nogil=True, forceinline=True)
def place(disc: int, field: int) -> np.uint64:
    """Return the index in the array `discs` at which a field of a disc is stored."""
    return np.uint64(disc // LANES) * DISC + np.uint64(disc % LANES) + field


@njit(cache=True, nogil=True, error_model="numpy")
def count_slots(member: np.ndarray, slices: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the number of each entry among the entries of the same disc, and the first slot of each slice.

    A slot has one entry for each disc of the slice, so that a slice has as many slots as its most frequent disc has
    entries.

    Parameters
    ----------
    member (entries,) : number of the disc of each entry, in spatial order
    slices : number of slices

    Returns
    -------
    The numbers (entries,) from 0, and the first slots (slices + 1,).
    """
    seen = np.zeros(slices * LANES, np.int32)
    turn = np.empty(len(member), np.int32)
    for c in range(len(member)):
        turn[c] = seen[member[c]]
        seen[member[c]] += 1
    start = np.zeros(slices + 1, np.int64)
    for p in range(slices):
        most = 0
        for k in range(LANES):
            most = max(most, seen[p * LANES + k])
        start[p + 1] = start[p] + most
    return turn, start


def places_of_lines(chunk_start: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the chunk and the lane of every contact with a rigid line.

    Parameters
    ----------
    chunk_start : first chunk of the contacts of each slice, see `Layout`
    count : number of contacts with lines

    Returns
    -------
    Chunk (count,) and lane (count,). These contacts follow the pairs, after an empty chunk.
    """
    contact = np.arange(count)
    return chunk_start[-1] + 1 + contact // LANES, contact % LANES


@njit(cache=True, nogil=True, error_model="numpy")
def place_links(
    owner: np.ndarray,
    partner: np.ndarray,
    turn: np.ndarray,
    chunk_start: np.ndarray,
    radii: np.ndarray,
    kinds: np.ndarray,
    memory: tuple[np.ndarray, ...],
    links: np.ndarray,
    rolling: np.ndarray,
    where: np.ndarray,
    kind: np.ndarray,
    begin: int,
    end: int,
) -> None:
    """Write a range of the contacts into their lanes.

    Parameters
    ----------
    owner, partner (contacts,) : disc that owns a contact, in whose slice the contact is stored, and the other disc
    turn (contacts,) : number of the contact among the contacts of its owner
    chunk_start (slices + 1,) : as in `Layout`
    radii (n,) : radii of the discs (m), in spatial order
    kinds (contacts,) : column of the table of constants
    memory : history variables (contacts,), as named in `state.MEMORY`, then in `state.ROLLING_MEMORY` (empty for discs
        with the law "paper")
    links, rolling, where, kind : `links`, `rolling`, `partner` and `kinds` of the layout, filled here; before, they
        have the entries of lanes without contact
    begin, end : range of the contacts
    """
    for c in range(begin, end):
        i = owner[c]
        chunk = chunk_start[i // LANES] + turn[c]
        lane = i % LANES
        base = chunk * LINK_FIELDS * LANES + lane
        links[base] = radii[i] + radii[partner[c]]
        links[base + LANES] = memory[0][c]
        links[base + 2 * LANES] = memory[1][c]
        links[base + 3 * LANES] = memory[2][c]
        links[base + 4 * LANES] = memory[3][c]
        links[base + 5 * LANES] = memory[4][c]
        if len(rolling) > 0:
            base = chunk * ROLL_FIELDS * LANES + lane
            rolling[base] = radii[i] / (radii[i] + radii[partner[c]])
            rolling[base + LANES] = memory[5][c]
            rolling[base + 2 * LANES] = memory[6][c]
        where[chunk * LANES + lane] = partner[c]
        kind[chunk * LANES + lane] = kinds[c]


@njit(cache=True, nogil=True, error_model="numpy")
def find_changed(where: np.ndarray, nobody: int, kind: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Find the groups of lanes whose contacts have other constants than the same lanes of the chunk before.

    Parameters
    ----------
    where (lanes,) : partner in every lane
    nobody : number of discs: lanes with a partner from there on have no contact
    kind (lanes,) : column of the table of constants, changed here: lanes without a contact take that of the same lane
        in the chunk before

    Returns
    -------
    `changed` and `changed_start` of a `Layout`.
    """
    chunks = len(kind) // LANES
    for at in range(LANES, len(kind)):
        if where[at] >= nobody:
            kind[at] = kind[at - LANES]
    groups = np.empty(chunks * (LANES // LANE_GROUP), np.uint32)
    start = np.zeros(chunks + 1, np.int64)
    for chunk in range(chunks):
        count = start[chunk]
        for at in range(chunk * LANES, (chunk + 1) * LANES, LANE_GROUP):
            changes = chunk == 0
            for k in range(at, at + LANE_GROUP):
                changes |= kind[k] != kind[k - LANES]
            if changes:
                groups[count] = at
                count += 1
        start[chunk + 1] = count
    return groups[: start[-1]].copy(), start


@njit(cache=True, nogil=True, error_model="numpy")
def place_incoming(
    where: np.ndarray, chunk_start: np.ndarray, line_disc: np.ndarray, discs: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Find the places of the forces on every disc of contacts that the disc does not own: partners, then lines.

    The places are in the order of the lanes, so that a sum of these forces depends only on the layout, and not on the
    order of the contact list.

    Parameters
    ----------
    where (lanes,) : partner in every lane
    chunk_start (slices + 1,) : as in `Layout`
    line_disc (contacts with lines,) : as in `Layout`
    discs : number of discs

    Returns
    -------
    `incoming`, `incoming_start`, `lowest_owner` and `highest_owner` of a `Layout`.
    """
    slices = len(chunk_start) - 1
    chunks = chunk_start[-1]
    lowest, highest = np.arange(slices), np.arange(slices)
    seen = np.zeros(slices * LANES, np.int32)
    for p in range(slices):
        for place in range(chunk_start[p] * LANES, chunk_start[p + 1] * LANES):
            j = np.int64(where[place])
            if j < discs and p * LANES + place % LANES < discs:
                seen[j] += 1
                lowest[j // LANES] = min(lowest[j // LANES], p)
                highest[j // LANES] = max(highest[j // LANES], p)
    for e in range(len(line_disc)):
        seen[line_disc[e]] += 1
    start = np.zeros(slices + 1, np.int64)
    for p in range(slices):
        start[p + 1] = start[p] + seen[p * LANES : (p + 1) * LANES].max()
    silent = chunks * LINK_FIELDS * LANES + 4 * LANES
    incoming = np.full(start[-1] * LANES, silent, np.uint32)
    seen[:] = 0
    for p in range(slices):
        for place in range(chunk_start[p] * LANES, chunk_start[p + 1] * LANES):
            j = np.int64(where[place])
            if j < discs and p * LANES + place % LANES < discs:
                at = (place // LANES * LINK_FIELDS + 4) * LANES + place % LANES
                incoming[(start[j // LANES] + seen[j]) * LANES + j % LANES] = at
                seen[j] += 1
    for e in range(len(line_disc)):
        j = line_disc[e]
        at = ((chunks + 1 + e // LANES) * LINK_FIELDS + 4) * LANES + e % LANES
        incoming[(start[j // LANES] + seen[j]) * LANES + j % LANES] = at
        seen[j] += 1
    return incoming, start, lowest, highest


@njit(cache=True, nogil=True, error_model="numpy")
def count_links(layout: Layout, discs: int) -> np.ndarray:
    """Return the place in the contact list at which the contacts of each slice begin.

    Parameters
    ----------
    layout : discs and contacts
    discs : number of discs

    Returns
    -------
    Places (slices + 1,), the last of which is the number of contacts.
    """
    slices = len(layout.chunk_start) - 1
    start = np.zeros(slices + 1, np.int64)
    for p in range(slices):
        count = 0
        for place in range(layout.chunk_start[p] * LANES, layout.chunk_start[p + 1] * LANES):
            count += p * LANES + place % LANES < discs and layout.partner[place] < discs
        start[p + 1] = start[p] + count
    return start


@njit(cache=True, nogil=True, error_model="numpy")
def list_links(
    begin: int,
    end: int,
    start: np.ndarray,
    layout: Layout,
    order: np.ndarray,
    owner: np.ndarray,
    other: np.ndarray,
    kind: np.ndarray,
    memory: tuple[np.ndarray, ...],
) -> None:
    """List the contacts of a range of slices from their lanes, slice by slice, slot by slot, lane by lane.

    Parameters
    ----------
    begin, end : range of the slices
    start (slices + 1,) : places by `count_links`
    layout : discs and contacts
    order (n,) : original number of every disc
    owner, other (contacts,) : original numbers of both discs, filled here
    kind (contacts,) : column of the table of springs, filled here
    memory : history variables (contacts,), filled here, as named in `state.MEMORY`, then in `state.ROLLING_MEMORY`
        (empty for discs with the law "paper")
    """
    discs = len(order)
    for p in range(begin, end):
        count = start[p]
        for chunk in range(layout.chunk_start[p], layout.chunk_start[p + 1]):
            for lane in range(LANES):
                i = p * LANES + lane
                j = np.int64(layout.partner[chunk * LANES + lane])
                if i >= discs or j >= discs:
                    continue
                owner[count] = order[i]
                other[count] = order[j]
                kind[count] = layout.kinds[chunk * LANES + lane]
                base = chunk * LINK_FIELDS * LANES + lane
                for k in range(5):
                    memory[k][count] = layout.links[base + (k + 1) * LANES]
                if len(layout.rolling) > 0:
                    base = chunk * ROLL_FIELDS * LANES + lane
                    memory[5][count] = layout.rolling[base + LANES]
                    memory[6][count] = layout.rolling[base + 2 * LANES]
                count += 1
