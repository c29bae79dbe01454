"""How the slices of a layout are shared out to threads, and who has to wait for whom."""

import numpy as np

from dem.kernels.layout import LANES, LINK_FIELDS, Layout


def needs(thread: int, threads: int, layout: Layout) -> tuple[np.ndarray, np.ndarray]:
    """Slices of a thread that share contacts with other threads, and how many slices each thread must be through.

    Returns (slices (shared,), counts (shared, threads)).
    """
    slices = len(layout.chunk_start) - 1
    ends = slices * np.arange(threads + 1) // threads  # as in `stepping.slices_of`
    begin, end = ends[thread], ends[thread + 1]
    shared = begin + np.flatnonzero((layout.first[begin:end] < begin) | (layout.last[begin:end] >= end))
    count = np.zeros((len(shared), threads), np.int64)
    for k, p in enumerate(shared):
        places = layout.incoming[layout.incoming_start[p] * LANES : layout.incoming_start[p + 1] * LANES]
        chunks = places.astype(np.int64) // (LINK_FIELDS * LANES)
        # behind the chunks lie nothing, and the rigid lines, which are the slice's own
        owners = np.searchsorted(layout.chunk_start, chunks[chunks < layout.chunk_start[-1]], side="right") - 1
        for t in range(threads):
            there = owners[(owners >= ends[t]) & (owners < ends[t + 1])]
            if t != thread and len(there):
                count[k, t] = there.max() - ends[t] + 1
    # What needs least of the others comes first, so that no slice waits behind one that needs their last.
    order = np.argsort(count.sum(axis=1), kind="stable")
    return shared[order], count[order]
