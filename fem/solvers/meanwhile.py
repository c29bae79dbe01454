"""Work that goes on in a thread while this one does other work: the solver of cone programs lets go of Python's lock.

What is found does not depend on it. Nobody waits for work that is left: a program that ends while some goes on
(``is_working``) has to do so at once, since Python would take the solver down with an abort.
"""

from collections.abc import Callable
from concurrent.futures import Future
from contextvars import ContextVar
from queue import SimpleQueue
from threading import Event, Lock, Thread, current_thread, main_thread
from typing import Any, Self, TypeVar
from weakref import WeakSet

from fem.solvers.blas_threads import bears_threads

A = TypeVar("A")

# All that were started.
_threads: WeakSet[Thread] = WeakSet()
# Set where nobody waits any more for the work of a thread.
_left: ContextVar[Event | None] = ContextVar("_left", default=None)


def interruptible(work: Callable[[], A]) -> A:
    """What some work makes that does not hear of Ctrl-C: done in a thread that Ctrl-C leaves alone.

    Raises its error, and KeyboardInterrupt in a thread whose work nobody waits for any more.
    """
    if current_thread() is main_thread():
        done: Future[A] = Future()
        _started(_do, work, done)
        return done.result()
    stop_if_left()
    found = work()
    stop_if_left()
    return found


def stop_if_left() -> None:
    """Raise KeyboardInterrupt if nobody waits any more for the work of this thread."""
    event = _left.get()
    if event is not None and event.is_set():
        raise KeyboardInterrupt


def is_working() -> bool:
    """Whether any thread still works."""
    return any(thread.is_alive() for thread in _threads)


def _started(work: Callable[..., None], *given: Any) -> Thread:
    thread = Thread(target=work, args=given, daemon=True)
    _threads.add(thread)
    thread.start()
    return thread


class Begun(Future[A]):
    """Work that was begun: whoever asks for its result does it, unless the other thread is at it already."""

    def __init__(self, work: Callable[[], A]) -> None:
        super().__init__()
        self._work, self._free = work, Lock()

    def result(self, timeout: float | None = None) -> A:
        """What came of it; raises its error, and KeyboardInterrupt where Ctrl-C is heard in this thread."""
        self.do(Exception)
        return super().result(timeout)

    def do(self, kept: type[BaseException] = BaseException) -> None:
        """Do it here if nobody has taken it, and keep what came of it, errors of a kind as well."""
        if self._free.acquire(blocking=False):
            _do(self._work, self, kept)


class Meanwhile:
    """One more thread for other work, until the end of a ``with`` block; what is then not done is left.

    It takes up work in the order in which it was begun. Without that thread, ``beside`` false, or where BLAS does not
    bear it, all work is done where it is begun.
    """

    def __init__(self, beside: bool = True) -> None:
        self._beside, self._event = beside and bears_threads(), Event()
        self._queue: SimpleQueue[Begun[Any] | None] = SimpleQueue()
        self._thread: Thread | None = None

    def begin(self, work: Callable[[], A]) -> Begun[A]:
        """Begin with some work; its result or its error is that of the future."""
        begun = Begun(work)
        if not self._beside:
            begun.do(Exception)  # Ctrl-C is heard at once
            return begun
        if self._thread is None:
            self._thread = _started(self._serve)
        self._queue.put(begun)
        return begun

    def _serve(self) -> None:
        _left.set(self._event)
        while not self._event.is_set():
            if (begun := self._queue.get()) is not None:
                begun.do()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: Any) -> None:
        self._event.set()
        self._queue.put(None)


def _do(work: Callable[[], A], done: "Future[A]", kept: type[BaseException] = BaseException) -> None:
    """Do some work and keep what came of it, errors of a kind as well."""
    try:
        done.set_result(work())
    except kept as error:
        done.set_exception(error)


IN_TURN = Meanwhile(beside=False)
