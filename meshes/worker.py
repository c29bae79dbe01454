"""Runs a process of this machine that does tasks for another process, one after the other.

The process ignores Ctrl-C. The process ends with the program that started it, even in the middle of a task: its main
thread only waits for requests, and ends the process when the requests end.
"""

import os
import pickle
import signal
import subprocess
import sys
import traceback
from collections.abc import Mapping
from contextlib import suppress
from importlib import import_module
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from pathlib import Path
from threading import Event, Lock, Thread
from typing import Any

# Kinds of answers: a message of the task, its result, or the error that it raised.
MESSAGE, DONE, FAILED = range(3)
ONE_THREAD = dict.fromkeys(("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
_ROOT = str(Path(__file__).parents[1])
_PROGRAM = "import sys; sys.path[:] = {path!r}; from meshes.worker import serve; serve({pipe}, {preload!r}, {forks})"


class WorkerEndedError(RuntimeError):
    """The process of a worker ended in the middle of a task."""


class Worker:
    """Represents a process of this machine that does tasks for this process.

    Parameters
    ----------
    environment : environment of the process; by default that of this process, with one thread
    preload : module that the process imports before its first task
    forks : whether each task is done in a forked child process, in a separate thread: so each task begins in the same
        state, with fresh memory, whatever was done before
    """

    def __init__(self, environment: Mapping[str, str] | None, preload: str, forks: bool) -> None:
        self._pipe, other = Pipe()
        # nothing that lies where the user works may stand in for a module of ours
        path = [folder for folder in sys.path if folder]
        path = path if _ROOT in path else [*path, _ROOT]
        program = _PROGRAM.format(path=path, pipe=other.fileno(), preload=preload, forks=forks)
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-s", "-c", program], stdin=subprocess.DEVNULL, pass_fds=[other.fileno()],
            env={**os.environ, **ONE_THREAD} if environment is None else environment,
            start_new_session=True,  # Ctrl-C at a terminal is for the program
        )  # fmt: skip
        other.close()  # so that this process notices the end of the other

    def call(self, request: bytes) -> tuple[int, Any]:
        """Start a task, and return its first answer; raise WorkerEndedError."""
        try:
            self._pipe.send_bytes(request)
        except OSError:
            raise WorkerEndedError from None
        return self.next()

    def next(self) -> tuple[int, Any]:
        """Return the next answer, after a message was sent; raise WorkerEndedError."""
        try:
            answer = self._pipe.recv_bytes()
        except (EOFError, OSError):
            raise WorkerEndedError from None
        kind, value, text = pickle.loads(answer)
        if kind == FAILED:
            value.__cause__ = RuntimeError(f"in another process:\n{text}")
        return kind, value

    def kill(self) -> None:
        """End the process and its child process at once, whatever they do."""
        if self._process.poll() is None:
            with suppress(ProcessLookupError):
                os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()


def serve(descriptor: int, preload: str, forks: bool) -> None:
    """Do tasks until there are no more requests; this is the loop of the process."""
    if preload:
        import_module(preload)
    pipe: Connection[Any, Any] = Connection(descriptor)
    while True:
        try:
            request = pipe.recv_bytes()
        except (EOFError, OSError):
            os._exit(0)
        if forks and (child := os.fork()):
            if os.waitpid(child, 0)[1] != 0:
                os._exit(1)
            continue
        answered = Event()
        thread = Thread(target=_answer, args=(pipe, request, forks, answered), daemon=True)
        thread.start()
        if forks:
            pipe.poll(None)  # until the request is cancelled, or the next request arrives
            if answered.is_set():
                thread.join()  # which ends this child
            os._exit(1)


def _answer(pipe: "Connection[Any, Any]", request: bytes, ends: bool, answered: Event) -> None:
    """Do the requested task and send its answer; a child process then ends."""
    lock = Lock()

    def send(kind: int, value: Any, text: str = "") -> None:
        data = pickle.dumps((kind, value, text))
        if kind != MESSAGE:
            answered.set()
        with lock:
            pipe.send_bytes(data)

    try:
        send(DONE, pickle.loads(request)(lambda message: send(MESSAGE, message)))
    except BaseException as error:
        text = traceback.format_exc()
        send(FAILED, error if _can_travel(error) else RuntimeError(text), text)
    if ends:
        os._exit(0)


def _can_travel(error: BaseException) -> bool:
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return False
    return True
