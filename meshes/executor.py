"""Executes tasks in order, in threads, or in processes of this machine. The results of the tasks do not depend on the
choice of the executor.

One rule for interruption and cancelling
----------------------------------------
The main thread waits while another one works (`interruptible`), so that it hears Ctrl-C at once, and no library does.
The end of an executor's ``with`` block cancels its unfinished tasks. Tasks that have not begun are not run. A process
is killed in the middle of its task: files are there whole or not at all. A process also ends by itself when the program
that started the process ends for any reason. A thread raises KeyboardInterrupt at its next `check_cancelled`; the
program does not wait for the thread, and ends at once even if a thread `is_left_working`. Work of the main thread that
would leave arrays half changed defers Ctrl-C until they are whole (`deferred_interruption`).
"""

import pickle
import signal
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent import futures
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar
from functools import partial
from queue import SimpleQueue
from threading import Event, Lock, current_thread, local, main_thread
from typing import Any, ParamSpec, TypeVar
from weakref import WeakSet

from meshes.worker import DONE, MESSAGE, Worker, WorkerEndedError

A = TypeVar("A")
P = ParamSpec("P")
Input = TypeVar("Input")
Result = TypeVar("Result")

# Type of the progress messages of a task: a few plain values.
Tell = Callable[[Any], None]

# Set when the task of this thread is cancelled.
_cancelled: ContextVar[Event | None] = ContextVar("_cancelled", default=None)
# Longest wait of the main thread for another thread, in seconds: the system may let another thread notice the signal of
# Ctrl-C, whose handler Python then calls as soon as the main thread runs.
_WAIT = 0.2
# Cancelled tasks of threads.
_left: WeakSet["Future[Any]"] = WeakSet()


class Executor(futures.Executor):
    """Executes tasks one after the other, each when it is submitted; base class of concurrent executors.

    Attributes
    ----------
    count : int
        Number of concurrent tasks.
    """

    count = 1

    def submit(self, work: Callable[P, A], /, *arguments: P.args, **named: P.kwargs) -> "Future[A]":
        """Return a future with the result of some work."""
        return self.begin(partial(_telling_nothing, partial(work, *arguments, **named)))

    def begin(self, work: Callable[[Tell], A], heard: Tell | None = None) -> "Future[A]":
        """Return a future with the result of work that reports its progress. Work for another process must be
        picklable."""
        future: Future[A] = Future()
        _do(future, partial(work, heard or _unheard), Exception)
        return future

    def compute(
        self,
        work: Callable[[Input, Tell], Result],
        inputs: Sequence[Input],
        heard: Callable[[int, Any], None] | None = None,
        done: Callable[[int, Result], None] | None = None,
    ) -> list[Result]:
        """Compute the results for all inputs, in the order of the inputs; raise the first error of a task.

        ``work`` computes the result of one input, and reports to its second argument. ``heard`` is called in this
        thread with every message of a task and the place of the task's input, ``done`` with every result. ``inputs``:
        one input for each task.
        """
        results = []
        for place, task_input in enumerate(inputs):
            results.append(work(task_input, partial(heard, place) if heard is not None else _unheard))
            if done is not None:
                done(place, results[-1])
        return results


SERIAL = Executor()


def _unheard(_: Any) -> None:
    """Ignore a message."""


def _telling_nothing(work: Callable[[], A], _: Tell) -> A:
    return work()


def _do(future: "Future[A]", work: Callable[[], A], errors: type[BaseException] = BaseException) -> None:
    """Do some work, and store its result, or its error if it is of a given kind."""
    try:
        future.set_result(work())
    except errors as error:
        future.set_exception(error)


def then(future: "Future[A]", follow: Callable[["Future[A]"], Result]) -> "Future[Result]":
    """Return a future for work that follows once another future is done.

    Parameters
    ----------
    future : the future to wait for
    follow : function of this future when it is done; it runs in the thread that has done the future

    Returns
    -------
    Future with the result or the error of ``follow``.
    """
    following: Future[Result] = Future()
    future.add_done_callback(lambda done: _do(following, partial(follow, done)))
    return following


class OneThread(Executor):
    """Executes tasks in one additional thread, in their order; for work that releases Python's global lock."""

    count = 2

    def __init__(self) -> None:
        self._event, self._futures = Event(), WeakSet["Future[Any]"]()
        self._pool = ThreadPoolExecutor(1, initializer=_cancelled.set, initargs=(self._event,))

    def begin(self, work: Callable[[Tell], A], heard: Tell | None = None) -> "Future[A]":
        """Start a task, see `Executor.begin`. The thread that asks for the result does the task itself, unless the
        other thread has begun it.
        """
        return self.submit(work, heard or _unheard)

    def submit(self, work: Callable[P, A], /, *arguments: P.args, **named: P.kwargs) -> "Future[A]":
        """Return a future with the result of some work, which the thread that asks for it may do itself."""
        shared = _Shared(partial(work, *arguments, **named))
        self.begin_there(shared.do)
        return shared

    def begin_there(self, work: Callable[[], A]) -> "Future[A]":
        """Return a task that the thread will do."""
        future = self._pool.submit(work)
        self._futures.add(future)
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Cancel all remaining tasks without waiting for any task."""
        self._event.set()
        self._pool.shutdown(wait=False, cancel_futures=True)
        _left.update(future for future in self._futures if not future.done())


class _Shared(Future[A]):
    """Represents a task for another thread. The thread that needs the result does the task itself if the other thread
    has not begun it."""

    def __init__(self, work: Callable[[], A]) -> None:
        super().__init__()
        self._work, self._claim = work, Lock()

    def do(self) -> None:
        """Do the task, unless another thread has begun it or it was cancelled."""
        if self._claim.acquire(blocking=False) and self.set_running_or_notify_cancel():
            try:
                self.set_result(self._work())
            except BaseException as error:
                self.set_exception(error)

    def result(self, timeout: float | None = None) -> A:
        """Return the result of the task; raise its error, and KeyboardInterrupt on Ctrl-C in this thread."""
        self.do()
        return super().result(timeout)


def interruptible(work: Callable[[], A]) -> A:
    """Return the result of some work, and notice Ctrl-C at once meanwhile.

    The main thread lets another thread do the work; other threads do the work themselves.

    Parameters
    ----------
    work : function without arguments

    Returns
    -------
    The result. An error of the work is raised here.

    Raises
    ------
    KeyboardInterrupt
        On Ctrl-C in the main thread, and in a thread whose result is no longer needed.
    """
    if current_thread() is main_thread():
        with OneThread() as thread:
            future = thread.begin_there(work)
            while not futures.wait([future], _WAIT).done:
                pass
            return future.result()
    check_cancelled()
    result = work()
    check_cancelled()
    return result


@contextmanager
def deferred_interruption() -> Iterator[Callable[[], None]]:
    """Defer Ctrl-C in the main thread, as a context manager; other threads do not hear Ctrl-C.

    Returns
    -------
    Context manager that yields a function, which raises a Ctrl-C that was deferred; so does the end of the block.
    """
    handler = signal.getsignal(signal.SIGINT)
    pending: list[int] = []  # signals; an Event has a lock, which a second Ctrl-C would wait for in vain
    if current_thread() is not main_thread() or not callable(handler):
        yield lambda: None
        return

    def let_through() -> None:
        if pending:
            pending.clear()
            handler(signal.SIGINT, None)

    signal.signal(signal.SIGINT, lambda number, _: pending.append(number))
    try:
        yield let_through
    finally:
        signal.signal(signal.SIGINT, handler)
        let_through()


def check_cancelled() -> None:
    """Raise an error if the result of the work of this thread is no longer needed.

    Raises
    ------
    KeyboardInterrupt
        If the task of this thread was cancelled.
    """
    event = _cancelled.get()
    if event is not None and event.is_set():
        raise KeyboardInterrupt


def is_interrupt(error: BaseException | None) -> bool:
    """Return whether an error is Ctrl-C.

    Parameters
    ----------
    error : an error, or None

    Returns
    -------
    True for KeyboardInterrupt, and for an error that it caused, as compiled code raises it.
    """
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__ or error.__context__
    return error is not None


def is_left_working() -> bool:
    """Return whether a thread whose result is no longer needed is still working.

    Returns
    -------
    True if a task of a closed `OneThread` has not ended.
    """
    return any(not future.done() for future in _left)


class LostError(RuntimeError):
    """A task was lost, since its process ended each time that the task was tried.

    Attributes
    ----------
    args : the message, with the number of tries
    """


class Processes(Executor):
    """Executes tasks in processes of this machine. Each process is started when it is first needed.

    Parameters
    ----------
    count : number of processes
    environment : environment of the processes; by default that of this process, with one thread each
    preload, forks, tries : as in `Worker`; ``tries``: how often a task is tried whose process ends
    """

    def __init__(
        self,
        count: int,
        environment: Mapping[str, str] | None = None,
        preload: str = "",
        forks: bool = False,
        tries: int = 2,
    ) -> None:
        self.count, self.tries = count, tries
        self._start = partial(Worker, environment, preload, forks)
        self._threads = ThreadPoolExecutor(count)  # each has one process do its tasks
        self._of_thread, self._workers, self._lock, self._ended = local(), set[Worker](), Lock(), False

    def begin(self, work: Callable[[Tell], A], heard: Tell | None = None) -> "Future[A]":
        """Start a task, see `Executor.begin`. If the processes of the task have ended, its error is LostError."""
        return self._threads.submit(self._done, pickle.dumps(work), heard or _unheard)

    def compute(
        self,
        work: Callable[[Input, Tell], Result],
        inputs: Sequence[Input],
        heard: Callable[[int, Any], None] | None = None,
        done: Callable[[int, Result], None] | None = None,
    ) -> list[Result]:
        """Compute the results for all inputs, see `Executor.compute`. A single task, or all tasks for one process, are
        done in this process.

        ``work``, ``inputs``, ``heard``, ``done``: as in `Executor.compute`.
        """
        if self.count < 2 or len(inputs) < 2:
            return super().compute(work, inputs, heard, done)
        news: SimpleQueue[tuple[int, bool, Any]] = SimpleQueue()

        def begin(place: int, task_input: Input) -> "Future[Result]":
            future = self.begin(partial(work, task_input), lambda message: news.put((place, False, message)))
            future.add_done_callback(lambda _: news.put((place, True, None)))
            return future

        tasks: list[Future[Result]] = []
        missing = len(inputs)
        try:
            for place, task_input in enumerate(inputs):
                tasks.append(begin(place, task_input))
            while missing:
                place, ended, message = news.get()
                if ended:
                    missing, result = missing - 1, tasks[place].result()
                    if done is not None:
                        done(place, result)
                elif heard is not None:
                    heard(place, message)
        finally:
            for task in tasks:
                task.cancel()
        return [task.result() for task in tasks]

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Cancel all remaining tasks, and end the processes at once."""
        with self._lock:
            self._ended = True
        self._threads.shutdown(wait=False, cancel_futures=True)
        for worker in list(self._workers):
            worker.kill()
        self._threads.shutdown(wait=True)

    def _done(self, request: bytes, heard: Tell) -> Any:
        """Return the result of a task in the process of this thread. If that process ends, a new process is started."""
        for _ in range(self.tries):
            worker = self._worker()
            try:
                kind, value = worker.call(request)
                while kind == MESSAGE:
                    heard(value)
                    kind, value = worker.next()
            except WorkerEndedError:
                self._let_go(worker)
                continue
            except BaseException:  # raised by the listener: the process is not awaited
                self._let_go(worker)
                raise
            if kind == DONE:
                return value
            raise value
        raise LostError(
            f"the worker process ended, and so did every other worker that tried the task ({self.tries} tries)"
        )

    def _worker(self) -> Worker:
        with self._lock:
            if self._ended:
                raise futures.CancelledError
            worker: Worker | None = getattr(self._of_thread, "worker", None)
            if worker is None:
                self._of_thread.worker = worker = self._start()
                self._workers.add(worker)
            return worker

    def _let_go(self, worker: Worker) -> None:
        worker.kill()
        self._of_thread.worker = None
        self._workers.discard(worker)
