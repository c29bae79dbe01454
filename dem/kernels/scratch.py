"""Kernel: rows of 64 doubles into which the partners' state and the pairs' constants are copied.

The inner loops read and write rows of 64 doubles at fixed distances, so that they become vector instructions; what
comes from elsewhere must first lie in rows.
"""

import numpy as np
from numba import njit

from dem.kernels.contact import CONSTANTS
from dem.kernels.layout import LANES, LINK_FIELDS, Layout
from dem.kernels.prefetch import LINE, fetch

# The partners' first eight fields, the constants, three sums of forces.
CONSTANT = np.uint64(8 * LANES)
SUM_X, SUM_Z, SUM_R = (np.uint64((8 + CONSTANTS + k) * LANES) for k in range(3))
SCRATCH = (8 + CONSTANTS + 3) * LANES
ROW = np.uint64(LANES)
ONE = np.uint64(1)
AHEAD = 3  # chunks: as many as a slice mostly has


@njit(cache=True, forceinline=True, error_model="numpy")
def constant(row: int) -> np.uint64:
    """Where the row of a constant begins."""
    return CONSTANT + np.uint64(row) * ROW


@njit(cache=True, nogil=True, forceinline=True, error_model="numpy")
def load_constants(kind: int, kinds: np.ndarray, first: int, table: np.ndarray, rows: int, scratch: np.ndarray) -> None:
    """The first `rows` constants of 64 contacts: all of one kind, or run by run of one kind where `kind` is -1."""
    lane = 0
    while lane < LANES:
        column = kind
        end = LANES
        if kind < 0:
            column = kinds[first + np.uint64(lane)]
            end = lane + 1
            while end < LANES and kinds[first + np.uint64(end)] == column:
                end += 1
        for row in range(rows):
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
