"""Splits work on the discs into ranges of their numbers, in one thread or several. The result is the same, since ranges
are joined in their order.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from itertools import pairwise
from typing import Any, Protocol

import numpy as np

from dem.kernels.neighbours import Near, cell_grid, find_pairs

FEW_DISCS = 20_000  # below which one thread is faster than several


class Ranges(Protocol):
    """Calls a function for ranges that cover all numbers below n, and returns the results in their order.

    Parameters
    ----------
    work : function of begin and end of a range; the end is not part of the range
    n : count of the numbers
    """

    def __call__(self, work: Callable[[int, int], Any], n: int) -> list[Any]:
        """Return the results of all ranges, in their order."""


def serial(work: Callable[[int, int], Any], n: int) -> list[Any]:
    """Call a function with one range of all numbers, in this thread.

    Parameters
    ----------
    work : function of begin and end of a range
    n : count of the numbers

    Returns
    -------
    List of the one result.
    """
    return [work(0, n)]


def threaded(pool: ThreadPoolExecutor | None, threads: int) -> Ranges:
    """Return a way to call a function with one range per thread, as far as threads save time.

    Parameters
    ----------
    pool : threads beside the calling one; None without any
    threads : number of ranges, one of which the calling thread takes

    Returns
    -------
    Function of ``work`` and ``n`` as of `serial`. It uses one range for fewer than `FEW_DISCS` numbers.
    """

    def shared(work: Callable[[int, int], Any], n: int) -> list[Any]:
        if pool is None or threads == 1 or n < FEW_DISCS:
            return serial(work, n)
        ends = [n * k // threads for k in range(threads + 1)]
        others = [pool.submit(work, *ends_of_range) for ends_of_range in pairwise(ends[1:])]
        try:
            first = work(0, ends[1])
        finally:
            wait(others)
        return [first, *(other.result() for other in others)]

    return shared


def pairs_near(
    near: Near, known: tuple[np.ndarray, ...], pore_lengths: np.ndarray, in_ranges: Ranges
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the first and second disc of every pair of discs that are ``near``, and its number among the ``known``
    pairs, with ``pore_lengths`` of their pore springs (m); ``in_ranges`` divides the work among threads."""
    grid = cell_grid(near)
    pairs = in_ranges(lambda begin, end: find_pairs(begin, end, near, grid, known, pore_lengths), len(near.x))
    first, second, old = pairs[0] if len(pairs) == 1 else map(np.concatenate, zip(*pairs, strict=True))
    return first, second, old
