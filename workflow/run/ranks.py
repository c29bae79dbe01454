"""Runs one finite element analysis on several MPI ranks: the first rank runs the command, the other ranks only
compute."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from fem.solvers import dolfinx_api

POLL_INTERVAL = 0.01  # s between two checks for a message: waiting by MPI itself would occupy a core


class Ranks:
    """Represents the MPI ranks of this program: one rank, unless mpirun started several.

    Attributes
    ----------
    comm : MPI's communicator of all of them.
    is_first : whether this is the rank that runs the command, writes and draws; the other ranks only compute.
    waiting : on the first rank, whether the other ranks still wait for a call.
    """

    def __init__(self) -> None:
        """Find the MPI ranks on which this process and others run. Raises InputError if there is no dolfinx."""
        dolfinx_api.require()
        from mpi4py import MPI

        self.comm: Any = MPI.COMM_WORLD
        self.is_first = self.comm.rank == 0
        self.waiting = True

    def call(self) -> None:
        """Call the other ranks, from the first rank, to compute with it."""
        self.waiting = False
        self._tell_others(True)

    def called(self) -> bool:
        """Wait, on any other rank than the first, for the first rank. Return True if the first rank called this rank to
        compute, False if the first rank released it."""
        while not self.comm.iprobe(source=0):
            time.sleep(POLL_INTERVAL)
        return bool(self.comm.recv(source=0))

    @contextmanager
    def leading(self) -> Iterator[None]:
        """On the first rank, release the other ranks at the end of the block if they were not called in it."""
        try:
            yield
        finally:
            if self.waiting:
                self._tell_others(False)

    def _tell_others(self, compute: bool) -> None:
        """Send the other ranks the message whether there is something to compute."""
        for other in range(1, self.comm.size):
            self.comm.send(compute, dest=other)
