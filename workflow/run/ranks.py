"""Several MPI ranks at one finite element analysis: the first runs the command, the others help it to compute."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from fem import dolfinx_api


class Ranks:
    """The ranks of this program, which is one unless mpirun started it."""

    def __init__(self) -> None:
        """Raises InputError if there is no dolfinx."""
        dolfinx_api.require()
        from mpi4py import MPI

        self.comm: Any = MPI.COMM_WORLD
        self.first = self.comm.rank == 0
        self.waiting = True

    def call(self) -> None:
        """On the first rank: the others shall compute with it now."""
        self.waiting = False
        self.comm.bcast(True)

    def called(self) -> bool:
        """On the others: wait until there is something to compute, or until it is sure that there is nothing."""
        return bool(self.comm.bcast(None))

    @contextmanager
    def leading(self) -> Iterator[None]:
        """On the first rank: let the others go at the end of the block if they were not called in it."""
        try:
            yield
        finally:
            if self.waiting:
                self.comm.bcast(False)
