"""The processes that compute: a local cluster of Dask's, one Numba thread each, or one that is there already."""

import logging
import socket
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TypeVar

from meshes.errors import InputError

if TYPE_CHECKING:
    from distributed import Client

Given = TypeVar("Given")

# A worker that dies is not asked why: its task gets one second try, on another worker.
TRIES = 2
CONFIGURATION = {
    "distributed.scheduler.allowed-failures": TRIES - 1,
    # a worker holds the task that it computes and no other, which would count as tried if it died
    "distributed.scheduler.worker-saturation": 1.0,
    "distributed.admin.large-graph-warning-threshold": "1 GiB",
}
ONE_THREAD = {name: "1" for name in ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}
PATIENCE = 30  # s for a scheduler to answer


class LostError(RuntimeError):
    """A task whose workers died, or were taken away, each time it was tried."""


class Workers:
    """Processes that compute what they are given; made by `hired`."""

    def __init__(self, client: "Client") -> None:
        self.client = client

    def results(self, function: Callable[[Given], Any], given: Sequence[Given]) -> Iterator[tuple[int, Any]]:
        """The place of each input and what the function makes of it, or the error it raised, as they come.

        ``LostError`` stands for the result where a worker died, and the one that tried again died as well.
        """
        from distributed import as_completed

        futures = [self.client.submit(function, one, pure=False) for one in given]
        places = {future.key: place for place, future in enumerate(futures)}
        try:
            for future in as_completed(futures, loop=self.client.loop):
                try:
                    result = self.result(future)
                except Exception as error:
                    result = error
                future.release()
                yield places[future.key], result
        finally:
            self.client.cancel(futures)

    def result(self, future: Any) -> Any:
        """The result of one that is done; raises the error of its function, or LostError."""
        from distributed import KilledWorker

        error = future.exception()
        if isinstance(error, KilledWorker):
            raise LostError(f"its worker died, and so did the next that tried ({TRIES} tries)") from None
        if error is not None:
            raise error
        return future.result()


@contextmanager
def hired(count: int, scheduler: str | None = None) -> Iterator[Workers]:
    """Workers until the end of the block: so many of this machine, or those of a scheduler by its address.

    Raises InputError if there is no scheduler there.
    """
    import dask
    from distributed import Client

    with dask.config.set(CONFIGURATION):
        if scheduler is not None:
            with _quiet(), _client(scheduler) as client:
                yield Workers(client)
            return
        with _quiet(), _cluster(count) as cluster, Client(cluster, set_as_default=False) as client:
            yield Workers(client)


@contextmanager
def _cluster(count: int) -> Iterator[Any]:
    from tempfile import TemporaryDirectory

    from distributed import LocalCluster

    with TemporaryDirectory(prefix="noshiro-") as folder:
        cluster = LocalCluster(
            n_workers=count, threads_per_worker=1, processes=True, host="127.0.0.1", dashboard_address="127.0.0.1:0",
            memory_limit=0, local_directory=folder, env=ONE_THREAD, silence_logs=logging.CRITICAL,
            preload=["workflow.ensemble.deaf"],
        )  # fmt: skip
        try:
            yield cluster
        finally:
            cluster.close(timeout=PATIENCE)


def _client(address: str) -> "Client":
    from distributed import Client

    try:
        return Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        told = f"no Dask scheduler answers ({error}); expected an address such as tcp://{socket.gethostname()}:8786"
        raise InputError(f"--scheduler {address}", [told]) from None


@contextmanager
def _quiet() -> Iterator[None]:
    """Without Dask's remarks on workers that died or were slow to close: what came of it is told as rows."""
    logger = logging.getLogger("distributed")
    before, logger.level = logger.level, logging.CRITICAL
    try:
        yield
    finally:
        logger.level = before
