"""Finds the slices at the borders between threads, and the order in which threads wait for each other."""

import numpy as np

from dem.kernels.layout import LANES, LINK_FIELDS, Layout


def neighbour_slices(thread: int, threads: int, layout: Layout) -> tuple[np.ndarray, np.ndarray]:
    """Return the slices of a thread that share contacts with other threads, and how far the other threads must be
    before these slices move.

    Returns the shared slices (shared,), and for each of these the number of slices (shared, threads) that every other
    thread must have finished.
    """
    slices = len(layout.chunk_start) - 1
    if threads == 1:
        return np.zeros(0, np.int64), np.zeros((0, 1), np.int64)
    ends = slices * np.arange(threads + 1) // threads  # as in `stepping.slices_of`
    begin, end = ends[thread], ends[thread + 1]
    shared = begin + np.flatnonzero((layout.lowest_owner[begin:end] < begin) | (layout.highest_owner[begin:end] >= end))
    count = np.zeros((len(shared), threads), np.int64)
    if not len(shared):
        return shared, count
    # behind the chunks lie nothing, and the rigid lines, which are the slice's own: nobody's
    owner_of = np.append(np.repeat(np.arange(slices), np.diff(layout.chunk_start)), -1)
    starts, sizes = layout.incoming_start[shared] * LANES, np.diff(layout.incoming_start)[shared] * LANES
    begins = np.cumsum(sizes) - sizes
    places = layout.incoming[np.repeat(starts - begins, sizes) + np.arange(sizes.sum())]
    owners = owner_of[np.minimum(places // (LINK_FIELDS * LANES), len(owner_of) - 1)]
    for t in range(threads):
        if t != thread:
            receivers = np.where((owners >= ends[t]) & (owners < ends[t + 1]), owners - ends[t] + 1, 0)
            count[:, t] = np.maximum.reduceat(receivers, begins)
    # Slices that need the fewest slices of other threads come first, so that no slice waits unnecessarily.
    order = np.argsort(count.sum(axis=1), kind="stable")
    return shared[order], count[order]
