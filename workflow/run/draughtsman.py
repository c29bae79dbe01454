"""A process that draws what stages have left, one stage after the other, while this one computes the next."""

import signal
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from multiprocessing import get_context
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnProcess
from typing import Any

from dem.team import alone
from workflow.run.progress import silent
from workflow.run.stage import Job

Drawing = Callable[[Job], None]


@dataclass(eq=False)
class Draughtsman:
    """One at work for a run; made by ``of``.

    Attributes
    ----------
    waiting: whom to tell of each drawing that is not done yet, the first one first.
    """

    process: SpawnProcess
    pipe: "Connection[Any, Any]"
    waiting: deque[Callable[[], None]] = field(default_factory=deque)

    @classmethod
    def of(cls, job: Job) -> "Draughtsman | None":
        """A process of its own, where the job may have more than one, and MPI did not start several."""
        if not getattr(job.team, "several", False) or (job.ranks is not None and job.ranks.comm.size > 1):
            return None
        context = get_context("spawn")
        pipe, other = context.Pipe()
        process = context.Process(target=_draws, args=(other,), daemon=True)
        process.start()
        other.close()  # so that the process hears the end of this one
        return cls(process, pipe)

    def begin(self, draw: Drawing, job: Job, done: Callable[[], None]) -> None:
        """Let it draw; ``done`` is called in ``look`` or ``wait`` once that is done."""
        self.pipe.send((draw, replace(job, stages=(), progress=silent, team=alone, ranks=None)))
        self.waiting.append(done)

    def look(self) -> None:
        """Tell of all that is done; raises the error of a drawing."""
        while self.waiting and self.pipe.poll():
            self._hear()

    def wait(self) -> None:
        """Wait until all is done; raises the first error of a drawing."""
        while self.waiting:
            self._hear()

    def leave(self) -> None:
        """End it, whatever it is at; a picture is there whole or not at all."""
        self.pipe.close()
        self.process.kill()
        self.process.join()

    def _hear(self) -> None:
        try:
            error = self.pipe.recv()
        except EOFError:
            error = RuntimeError("the process that draws has ended")
        done = self.waiting.popleft()
        if error is not None:
            raise error
        done()


def _draws(pipe: "Connection[Any, Any]") -> None:
    """What the process does until the other end of the pipe is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the run that is stopped ends it
    while True:
        try:
            draw, job = pipe.recv()
        except EOFError:
            return
        try:
            draw(job)
            pipe.send(None)
        except Exception as error:
            pipe.send(error)
