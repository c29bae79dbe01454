"""A process of its own for gmsh, in which every mesh begins in the same state.

gmsh keeps nodes in the order of their addresses, and where two are equally near to a place takes the first one: what
else a process had done decided between meshes of 5,184 and 5,156 cells of one section. This process has done nothing
but import. For each mesh it forks a child, whose one thread has fresh memory of its own. What ends gmsh ends that child
and not the program, and Ctrl-C need not wait for it.
"""

import atexit
import os
import pickle
import signal
import subprocess
import sys
import traceback
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from threading import Lock, Thread
from typing import Any, TypeVar

from meshes.errors import InputError, NoAnswerError

A = TypeVar("A")

# What a number of bytes is told in.
SIZE = 8
# All that it takes over of the environment: where libraries lie.
KEPT = ("LD_LIBRARY_PATH",)
_ROOT = str(Path(__file__).parents[1])
# It imports all that meshes are made with, so that no child has to.
_PROGRAM = f"""
import sys
sys.path.insert(0, {_ROOT!r})
import meshes.gmsh_model
from meshes.gmsh_process import serve
serve()
"""


class GmshEndedError(RuntimeError):
    """gmsh has ended its process."""


class _Server:
    """The process, once it is needed, and again where it has ended or is that of a parent."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._owner = 0

    def call(self, work: Callable[..., A], *given: Any) -> A:
        """What some work makes there; raises its error, and GmshEndedError."""
        with self._lock:
            process = self._started()
            try:
                assert process.stdin is not None
                assert process.stdout is not None
                _write(process.stdin.fileno(), pickle.dumps((work, given)))
                answer = _read(process.stdout.fileno())
            except OSError:
                answer = None
            except BaseException:
                self.end()
                raise
            if answer is None:
                self.end()
                raise GmshEndedError("gmsh has ended its process")
        found, error = pickle.loads(answer)
        if error is not None:
            raise error
        return found

    def _started(self) -> "subprocess.Popen[bytes]":
        if self._process is None or self._owner != os.getpid():
            kept = {name: os.environ[name] for name in KEPT if name in os.environ}
            self._process, self._owner = subprocess.Popen(
                [sys.executable, "-P", "-s", "-c", _PROGRAM], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                env={"PYTHONHASHSEED": "0", "PYTHONDONTWRITEBYTECODE": "1", "OPENBLAS_NUM_THREADS": "1", **kept},
                start_new_session=True,  # Ctrl-C is for the program, which then ends this
            ), os.getpid()  # fmt: skip
        return self._process

    def end(self) -> None:
        """End the process and its child, whatever they are at."""
        process, self._process = self._process, None
        if process is not None and self._owner == os.getpid():
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.communicate()


_server = _Server()
atexit.register(_server.end)
in_process_of_its_own = _server.call


def serve() -> None:
    """What the process does until the program that has begun it ends."""
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # nobody is there to hear of it
    while size := os.read(0, SIZE):
        child = os.fork()
        if child == 0:
            thread = Thread(target=_work, args=(int.from_bytes(size, "little"),))
            thread.start()
            thread.join()
            os._exit(1)
        if os.waitpid(child, 0)[1] != 0:
            os._exit(1)


def _work(size: int) -> None:
    """Do what was asked for in so many bytes, tell what came of it, and end the process."""
    work, given = pickle.loads(_exactly(0, size) or b"")
    found: Any = None
    failed: Exception | None = None
    try:
        found = work(*given)
    except (InputError, NoAnswerError, OSError, MemoryError) as error:
        failed = error
    except Exception:
        failed = RuntimeError(traceback.format_exc())
    _write(1, pickle.dumps((found, failed)))
    os._exit(0)


def _write(to: int, data: bytes) -> None:
    view = memoryview(len(data).to_bytes(SIZE, "little") + data)
    while view:
        view = view[os.write(to, view) :]


def _read(source: int) -> bytes | None:
    size = _exactly(source, SIZE)
    return None if size is None else _exactly(source, int.from_bytes(size, "little"))


def _exactly(source: int, size: int) -> bytes | None:
    """So many bytes; None where there are no more."""
    parts: list[bytes] = []
    while size and (part := os.read(source, min(size, 1 << 20))):
        parts.append(part)
        size -= len(part)
    return None if size else b"".join(parts)
