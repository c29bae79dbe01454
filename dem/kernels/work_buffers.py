"""Copies the state of partners and the constants of pairs into rows of 64 doubles (kernel).

The inner loops read and write rows of 64 doubles at fixed distances, so that the compiler can use vector instructions;
other data are copied into rows first.
"""

import numpy as np
from numba import njit

from dem.kernels.arguments import State
from dem.kernels.contact import KN
from dem.kernels.device_function import device_function
from dem.kernels.layout import LANES, LINK_FIELDS, ROLL_FIELDS
from dem.kernels.prefetch import CACHE_LINE, fetch
from dem.kernels.transpose import CONSTANT_RECORD, LANE_GROUP, SHARED, gather, unfold

# The partners' first eight fields, overwritten by the direction there, and two of `contact_geometry`;
# the constants; three sums of forces.
NORMAL_X, NORMAL_Z, DISTANCE, LEVER = (np.uint64(row * LANES) for row in (0, 1, 8, 9))
CONSTANT = np.uint64(10 * LANES)
SUM_X, SUM_Z, SUM_R = (np.uint64((10 + CONSTANT_RECORD + k) * LANES) for k in range(3))
OWNED_DISCS = np.uint64((13 + CONSTANT_RECORD) * LANES)  # the shared fields of the slice's own discs
BUFFER_SIZE = (13 + CONSTANT_RECORD + SHARED) * LANES
# Constants of the discs of the paper without pore springs; of those with pore springs, or of soil discs without; and of
# all discs: even numbers.
FEWEST_CONSTANTS, FEW_CONSTANTS, ALL_CONSTANTS = 8, 14, 20
ROW = np.uint64(LANES)
ONE = np.uint64(1)
FETCH_BLOCK = 16  # partners fetched at a time: the fewest lanes in a loop that LLVM makes vectors of
PREFETCHED_CHUNKS = 2  # chunks
CACHED_LINKS = 2**22  # doubles, 32 MiB: fewer lie in the last cache, from where the processor reads ahead by itself


@njit(cache=True, nogil=True)
def new_buffer() -> np.ndarray:
    """Return rows of zeros that are aligned to cache lines, since access across cache lines or pages is slow.

    Returns
    -------
    Zeros (BUFFER_SIZE,).
    """
    room = np.zeros(BUFFER_SIZE + 7)
    begin = -room.ctypes.data % 64 // 8
    return room[begin : begin + BUFFER_SIZE]


@device_function(forceinline=True)
def constant(row: int) -> np.uint64:
    """Return the index in the buffer at which the row of a constant begins."""
    return CONSTANT + np.uint64(row) * ROW


@device_function(nogil=True, forceinline=True)
def load_constants(
    first: int, kinds: np.ndarray, records: np.ndarray, soil: bool, pores: bool, buffer: np.ndarray
) -> None:
    """Load the constants of eight contacts, from `kinds[first]` on, into their lanes of `buffer`.

    records: see `Springs`; soil, pores: whether the discs are soil discs, and whether there are pore springs.
    """
    q = first % ROW
    if soil and pores:
        gather(records, CONSTANT_RECORD, ALL_CONSTANTS, kinds, first, buffer, CONSTANT + q)
    elif pores:
        gather(records, CONSTANT_RECORD, FEW_CONSTANTS, kinds, first, buffer, CONSTANT + q)
    elif soil:
        gather(records[KN:], CONSTANT_RECORD, FEW_CONSTANTS, kinds, first, buffer, constant(KN) + q)
    else:
        gather(records[KN:], CONSTANT_RECORD, FEWEST_CONSTANTS, kinds, first, buffer, constant(KN) + q)


@device_function(nogil=True)
def load_all_constants(
    first: int, kinds: np.ndarray, records: np.ndarray, soil: bool, pores: bool, buffer: np.ndarray
) -> None:
    """Load the constants of all contacts of a chunk; first, kinds, records, soil, pores, buffer: as in
    `load_constants`.
    """
    for lane in range(0, LANES, LANE_GROUP):
        load_constants(first + np.uint64(lane), kinds, records, soil, pores, buffer)


@device_function(nogil=True, forceinline=True)
def load_own(p: int, shared: np.ndarray, buffer: np.ndarray) -> None:
    """Copy the shared fields of the 64 discs of slice p into rows."""
    for lane in range(0, LANES, LANE_GROUP):
        q = np.uint64(lane)
        unfold(shared, (np.uint64(p) * ROW + q) * CACHE_LINE, buffer, OWNED_DISCS + q)


@device_function(nogil=True, forceinline=True)
def load_partners(chunk: int, lane: int, state: State, buffer: np.ndarray, soil: bool) -> None:
    """Load position and velocities of 16 partners from `lane` on into rows of `buffer`, and prefetch a later chunk.

    chunk: number of the chunk; state: arrays of discs and contacts; soil: whether contacts remember rolling. Partners
    lie anywhere; contacts lie in a row, and are prefetched only if there are too many for the last cache.
    """
    chunks = np.uint64(len(state.partner)) // ROW
    later = min(np.uint64(chunk + PREFETCHED_CHUNKS), chunks - ONE) * ROW
    for k in range(lane, lane + FETCH_BLOCK):
        fetch(state.shared, np.uint64(state.partner[later + np.uint64(k)]) * CACHE_LINE)
    if len(state.links) > CACHED_LINKS:
        for k in range(lane, lane + FETCH_BLOCK):
            fetch(state.links, later * np.uint64(LINK_FIELDS) + np.uint64(k) * CACHE_LINE)
        if soil:
            for k in range(lane * ROLL_FIELDS // 8, (lane + FETCH_BLOCK) * ROLL_FIELDS // 8):
                fetch(state.rolling, later * np.uint64(ROLL_FIELDS) + np.uint64(k) * CACHE_LINE)
    for k in range(lane, lane + FETCH_BLOCK, LANE_GROUP):
        q = np.uint64(k)
        gather(state.shared, SHARED, SHARED, state.partner, np.uint64(chunk) * ROW + q, buffer, q)
