"""Kernel: rows of 64 doubles into which the partners' state and the pairs' constants are copied.

The inner loops read and write rows of 64 doubles at fixed distances, so that they become vector instructions; what
comes from elsewhere must first lie in rows.
"""

import numpy as np
from numba import njit

from dem.kernels.arguments import State
from dem.kernels.contact import KN
from dem.kernels.inner import inner
from dem.kernels.layout import LANES, LINK_FIELDS, ROLL_FIELDS
from dem.kernels.prefetch import LINE, fetch
from dem.kernels.records import CONSTANT_RECORD, EIGHT, SHARED, gather, unfold

# The partners' first eight fields, whose place soon gives way to the direction there, and two of `interaction.face`;
# the constants; three sums of forces.
NORMAL_X, NORMAL_Z, DISTANCE, LEVER = (np.uint64(row * LANES) for row in (0, 1, 8, 9))
CONSTANT = np.uint64(10 * LANES)
SUM_X, SUM_Z, SUM_R = (np.uint64((10 + CONSTANT_RECORD + k) * LANES) for k in range(3))
OWN = np.uint64((13 + CONSTANT_RECORD) * LANES)  # the shared fields of the slice's own discs
SCRATCH = (13 + CONSTANT_RECORD + SHARED) * LANES
FEWER, ALL = 14, 20  # constants of the paper's discs, or of soil discs without pore springs; of all: even numbers
ROW = np.uint64(LANES)
ONE = np.uint64(1)
BLOCK = 16  # partners fetched at a time: the fewest lanes in a loop that LLVM makes vectors of
AHEAD = 2  # chunks


@njit(cache=True, nogil=True)
def new_scratch() -> np.ndarray:
    """Rows of zeros aligned to cache lines, since access across lines or pages is slow."""
    room = np.zeros(SCRATCH + 7)
    begin = -room.ctypes.data % 64 // 8
    return room[begin : begin + SCRATCH]


@inner(forceinline=True)
def constant(row: int) -> np.uint64:
    """Where the row of a constant begins."""
    return CONSTANT + np.uint64(row) * ROW


@inner(nogil=True, forceinline=True)
def load_constants(
    first: int, kinds: np.ndarray, records: np.ndarray, soil: bool, pores: bool, scratch: np.ndarray
) -> None:
    """The constants that the law of eight contacts needs, those from place `first` of `kinds` on, into their lanes."""
    q = first % ROW
    if soil and pores:
        gather(records, CONSTANT_RECORD, ALL, kinds, first, scratch, CONSTANT + q)
    elif pores:
        gather(records, CONSTANT_RECORD, FEWER, kinds, first, scratch, CONSTANT + q)
    else:
        gather(records[KN:], CONSTANT_RECORD, FEWER, kinds, first, scratch, constant(KN) + q)


@inner(nogil=True)
def load_all_constants(
    first: int, kinds: np.ndarray, records: np.ndarray, soil: bool, pores: bool, scratch: np.ndarray
) -> None:
    """The constants that the law needs, for all contacts of a chunk."""
    for lane in range(0, LANES, EIGHT):
        load_constants(first + np.uint64(lane), kinds, records, soil, pores, scratch)


@inner(nogil=True, forceinline=True)
def load_own(p: int, shared: np.ndarray, scratch: np.ndarray) -> None:
    """The shared fields of the 64 discs of slice p, in rows."""
    for lane in range(0, LANES, EIGHT):
        q = np.uint64(lane)
        unfold(shared, (np.uint64(p) * ROW + q) * LINE, scratch, OWN + q)


@inner(nogil=True, forceinline=True)
def load_partners(chunk: int, lane: int, state: State, scratch: np.ndarray, soil: bool) -> None:
    """Position and velocities of 16 partners from `lane` on, in rows; the memory fetches what a later chunk will need.

    One line of its contacts and one of its partners at a time: a core waits once it has asked for a few dozen lines.
    """
    chunks = np.uint64(len(state.partner)) // ROW
    later = min(np.uint64(chunk + AHEAD), chunks - ONE) * ROW
    for k in range(lane, lane + BLOCK):
        q = np.uint64(k)
        fetch(state.links, later * np.uint64(LINK_FIELDS) + q * LINE)
        fetch(state.shared, np.uint64(state.partner[later + q]) * LINE)
    if soil:
        for k in range(lane * ROLL_FIELDS // 8, (lane + BLOCK) * ROLL_FIELDS // 8):
            fetch(state.rolling, later * np.uint64(ROLL_FIELDS) + np.uint64(k) * LINE)
    for k in range(lane, lane + BLOCK, EIGHT):
        q = np.uint64(k)
        gather(state.shared, SHARED, SHARED, state.partner, np.uint64(chunk) * ROW + q, scratch, q)
