"""Large arrays: in large pages where the system has them, and back to it as soon as they are freed."""

import ctypes
import math

import numpy as np

M_MMAP_THRESHOLD = -3  # of glibc's mallopt
LARGE = 1 << 20  # bytes
LINE = 8  # doubles in a cache line


def large_zeros(*shape: int) -> np.ndarray:
    """Zeros in large pages: NumPy asks the system for those where it makes arrays that are not zero yet."""
    size = math.prod(shape)
    room = np.empty(size + LINE)
    begin = -room.ctypes.data % (8 * LINE) // 8
    values = room[begin : begin + size].reshape(shape)
    values[...] = 0.0
    return values


def give_back_large_arrays() -> None:
    """Fixes the size from which glibc keeps arrays apart from its heap.

    Left alone it raises that size up to 32 MB as arrays are freed, and the holes they leave in the heap made a million
    discs take a third more memory. Does nothing where the C library has no such switch.
    """
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(M_MMAP_THRESHOLD, LARGE)
