"""Several MPI ranks of one finite element analysis: the first rank runs the command, the others only compute."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from fem.solvers import dolfinx_api

PAUSE = 0.01  # s between two looks for a message: MPI itself waits without one, and takes a core for that


class Ranks:
    """The MPI ranks of this program: one, unless mpirun started several.

    Attributes
    ----------
    comm: MPI's communicator of all of them.
    first: whether this is the rank that runs the command, writes and draws; the others only compute.
    waiting: on the first rank, whether the others still wait for a call.
    """

    def __init__(self) -> None:
        """Raises InputError if there is no dolfinx."""
        dolfinx_api.require()
        from mpi4py import MPI

        self.comm: Any = MPI.COMM_WORLD
        self.first = self.comm.rank == 0
        self.waiting = True

    def call(self) -> None:
        """Call the other ranks, from the first rank, to compute with it."""
        self.waiting = False
        self._tell_others(True)

    def called(self) -> bool:
        """On the other ranks, wait for the first rank; return whether it called them (False: released them)."""
        while not self.comm.iprobe(source=0):
            time.sleep(PAUSE)
        return bool(self.comm.recv(source=0))

    @contextmanager
    def leading(self) -> Iterator[None]:
        """Release the other ranks at the end of the block if they were not called in it; on the first rank."""
        try:
            yield
        finally:
            if self.waiting:
                self._tell_others(False)

    def _tell_others(self, compute: bool) -> None:
        """Tell the others whether there is something to compute."""
        for other in range(1, self.comm.size):
            self.comm.send(compute, dest=other)
