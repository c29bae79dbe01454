"""Some jobs at a time, in threads: the kernels let go of Python's lock. Results do not depend on how many at a time."""

from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from threading import Event
from typing import TypeVar

Result = TypeVar("Result")


class StoppedError(RuntimeError):
    """Raised in a job that was asked to stop because another failed, or someone interrupted."""


def side_by_side(jobs: Sequence[Callable[[], Result]], workers: int, stop: Event | None = None) -> list[Result]:
    """Runs jobs, so many at a time; returns their results in order.

    stop: set when a job fails or on an interrupt, and not otherwise; jobs look at it and end with StoppedError. The
    first error of another kind is raised once all have ended.
    """
    with ThreadPoolExecutor(workers) as pool:
        futures = [pool.submit(job) for job in jobs]
        try:
            wait(futures, return_when=FIRST_EXCEPTION)
            for future in futures:
                if future.done():
                    future.result()
            return [future.result() for future in futures]
        except BaseException:
            if stop is not None:
                stop.set()
            for future in futures:
                future.cancel()
            raise
