"""Who goes through the discs in ranges of their numbers: this thread all at once, or several threads side by side.

What is found does not depend on it: ranges are put one behind the other.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from itertools import pairwise
from typing import Any, Protocol

FEW = 20_000  # of fewer discs one thread has found the neighbours before another has begun


class Ranges(Protocol):
    """Calls work with the begin and end of ranges that cover all numbers below n, and returns what it makes of each."""

    def __call__(self, work: Callable[[int, int], Any], n: int) -> list[Any]:
        """What the work makes of every range, in their order."""


def serial(work: Callable[[int, int], Any], n: int) -> list[Any]:
    """One range of all."""
    return [work(0, n)]


def threaded(pool: ThreadPoolExecutor | None, threads: int) -> Ranges:
    """As many ranges as there are threads, where that is worth their while."""

    def shared(work: Callable[[int, int], Any], n: int) -> list[Any]:
        if pool is None or threads == 1 or n < FEW:
            return serial(work, n)
        ends = [n * k // threads for k in range(threads + 1)]
        others = [pool.submit(work, *ends_of_range) for ends_of_range in pairwise(ends[1:])]
        try:
            first = work(0, ends[1])
        finally:
            wait(others)
        return [first, *(other.result() for other in others)]

    return shared
