"""Provides memory for large arrays: large pages where the system supports them, and reuse of freed pages."""

import ctypes
import math

import numpy as np

M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = -1, -3  # of glibc's mallopt
LARGE_ARRAY = 1 << 20  # bytes
LARGEST_ARRAY = 1 << 25  # bytes above which glibc returns every array to the system
RETAINED_BYTES = 1 << 28  # bytes that glibc keeps at the top of the heap
MANY_DISCS = 500_000  # discs
LINE = 8  # doubles in a cache line
ARRAY_GROWTH = 1.02  # factor on the requested size, since the next list may be longer


def large_zeros(*shape: int) -> np.ndarray:
    """Return an array of zeros in large pages of memory, which NumPy requests only for uninitialised arrays."""
    size = math.prod(shape)
    room = np.empty(size + LINE)
    begin = -room.ctypes.data % (8 * LINE) // 8
    values = room[begin : begin + size].reshape(shape)
    values[...] = 0.0
    return values


class ReusedMemory:
    """Reuses memory, by name, for arrays of about the same size. The earlier contents of the memory are lost.

    `ReusedMemory` serves arrays above `LARGEST_ARRAY`, which glibc otherwise returns to the system: for 300,000 discs a
    quarter of the time of a new neighbour list was spent on new pages.
    """

    def __init__(self, discs: int = MANY_DISCS + 1) -> None:
        self.keeps = discs <= MANY_DISCS  # of more, what a run holds at once counts
        self.rooms: dict[str, np.ndarray] = {}

    def zeros(self, name: str, *shape: int) -> np.ndarray:
        """Return an array of zeros in large pages of memory, by `large_zeros`."""
        size = math.prod(shape)
        if not self.keeps or 8 * size <= LARGEST_ARRAY:
            return large_zeros(*shape)
        if name not in self.rooms or len(self.rooms[name]) < size:
            self.rooms.pop(name, None)
            self.rooms[name] = large_zeros(int(ARRAY_GROWTH * size))
        values = self.rooms[name][:size].reshape(shape)
        values[...] = 0.0
        return values


def keep_freed_arrays(discs: int) -> None:
    """Set glibc to keep the memory that a new neighbour list frees, since the next list needs it again.

    A new page from the system costs as much time as a hundred doubles: without this setting, neighbour lists of 30,000
    discs take twice as long. With many discs the holes in the heap matter more (a third more memory for a million
    discs), and their arrays are returned to the system. The setting holds for the whole process, which may keep
    `RETAINED_BYTES` bytes more than it uses. The function does nothing if the C library has no such setting.
    """
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(M_MMAP_THRESHOLD, LARGE_ARRAY if discs > MANY_DISCS else LARGEST_ARRAY)
        mallopt(M_TRIM_THRESHOLD, LARGE_ARRAY if discs > MANY_DISCS else RETAINED_BYTES)
