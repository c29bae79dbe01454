"""Memory of large arrays: large pages where the system has them, and what happens to freed pages."""

import ctypes
import math

import numpy as np

M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = -1, -3  # of glibc's mallopt
LARGE = 1 << 20  # bytes
LARGEST = 1 << 25  # bytes: above this glibc gives back every array in any case
KEPT = 1 << 28  # bytes at the top of the heap, which it keeps
MANY = 500_000  # discs
LINE = 8  # doubles in a cache line
MORE = 1.02  # times what is wanted now: the next list is a little longer, or shorter


def large_zeros(*shape: int) -> np.ndarray:
    """An array of zeros in large pages of memory, for which NumPy asks the system only where an array is not zero
    yet.
    """
    size = math.prod(shape)
    room = np.empty(size + LINE)
    begin = -room.ctypes.data % (8 * LINE) // 8
    values = room[begin : begin + size].reshape(shape)
    values[...] = 0.0
    return values


class Room:
    """Memory that is used again, by name, for arrays of zeros of about the same size; what they held before is lost.

    It is kept for arrays above `LARGEST`, which glibc gives back: of 300,000 discs a quarter of the time of a new list
    went into getting such pages anew.
    """

    def __init__(self, discs: int = MANY + 1) -> None:
        self.keeps = discs <= MANY  # of more, what a run holds at once counts
        self.rooms: dict[str, np.ndarray] = {}

    def zeros(self, name: str, *shape: int) -> np.ndarray:
        """Zeros in large pages, as of `large_zeros`."""
        size = math.prod(shape)
        if not self.keeps or 8 * size <= LARGEST:
            return large_zeros(*shape)
        if name not in self.rooms or len(self.rooms[name]) < size:
            self.rooms.pop(name, None)
            self.rooms[name] = large_zeros(int(MORE * size))
        values = self.rooms[name][:size].reshape(shape)
        values[...] = 0.0
        return values


def keep_freed_arrays(discs: int) -> None:
    """Tells glibc to keep the arrays that a new list of neighbours frees, since the next list needs them again.

    A page that comes new from the system costs as much as a hundred doubles: lists of 30,000 discs took twice as long.
    For many discs, the holes in the heap matter more (a million took a third more memory): their arrays are given back.
    The setting holds for the whole process from then on, which may keep `KEPT` bytes more than it uses. Does nothing
    where the C library has no such switch.
    """
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(M_MMAP_THRESHOLD, LARGE if discs > MANY else LARGEST)
        mallopt(M_TRIM_THRESHOLD, LARGE if discs > MANY else KEPT)
