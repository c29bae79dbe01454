"""A process that draws what stages have left, one stage after the other, while this one computes the next."""

import os
import signal
import traceback
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from multiprocessing import get_context, parent_process
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from threading import Thread, current_thread, main_thread
from typing import Any

from dem.team import alone
from meshes.errors import InputError, NoAnswerError
from workflow.run.progress import silent
from workflow.run.stage import Job

ENDED = "the process that draws has ended"
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
        with _deaf():
            process.start()
        other.close()  # so that the process hears the end of this one
        return cls(process, pipe)

    def begin(self, draw: Drawing, job: Job, done: Callable[[], None]) -> None:
        """Let it draw; ``done`` is called in ``look`` or ``wait`` once that is done."""
        try:
            self.pipe.send((draw, replace(job, stages=(), progress=silent, team=alone, ranks=None)))
        except OSError:
            raise RuntimeError(ENDED) from None
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
        self.process.kill()
        self.process.join()
        self.pipe.close()  # not before: it would complain of what nobody has read

    def _hear(self) -> None:
        try:
            error = self.pipe.recv()
        except (EOFError, OSError):
            error = RuntimeError(ENDED)
        done = self.waiting.popleft()
        if error is not None:
            raise error
        done()


@contextmanager
def _deaf() -> Iterator[None]:
    """What is started in this block does not hear Ctrl-C: the run that is stopped ends it."""
    if current_thread() is not main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _end_with_parent() -> None:
    """End this process with the one that started it, in the middle of a picture if need be."""
    parent = parent_process()
    assert parent is not None
    wait([parent.sentinel])
    os._exit(1)


def _draws(pipe: "Connection[Any, Any]") -> None:
    """What the process does until the other end of the pipe is closed."""
    Thread(target=_end_with_parent, daemon=True).start()
    while True:
        try:
            draw, job = pipe.recv()
        except (EOFError, OSError):
            return
        try:
            draw(job)
            pipe.send(None)
        except (InputError, NoAnswerError, MemoryError) as error:
            pipe.send(error)
        except Exception:
            pipe.send(RuntimeError(traceback.format_exc()))
