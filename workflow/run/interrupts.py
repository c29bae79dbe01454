"""Ctrl-C that is not lost, although compiled libraries may swallow one, or crash on one, at a bad moment."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

# Code that is called by what ignores exceptions: imports, what LLVM tells of a kernel that it has compiled, and what
# the garbage collector tells the team.
SWALLOWING = ("<frozen importlib", "llvmlite/binding/executionengine.py", "distributed/gc.py")


class _Memory:
    """What SIGINT calls in a block of `remembered`."""

    def __init__(self) -> None:
        self.came = False

    def __call__(self, number: int, frame: FrameType | None) -> None:
        self.came = True
        if not _is_lost_in(frame):
            raise KeyboardInterrupt

    def check(self) -> None:
        """Raises KeyboardInterrupt if there was a Ctrl-C."""
        if self.came:
            raise KeyboardInterrupt


@contextmanager
def remembered() -> Iterator[Callable[[], None]]:
    """Remember every Ctrl-C in this block, so that one which a library swallows can be raised again.

    Yields a function to be called now and then: it raises KeyboardInterrupt if there was a Ctrl-C and the program has
    gone on all the same. Ctrl-C still raises KeyboardInterrupt at once, except in the middle of an import, or where the
    compiler of kernels or the garbage collector calls back: there Python would print the exception and go on. A block
    within a block shares its memory. A program that was told to ignore Ctrl-C (as by nohup) keeps ignoring it.
    """
    before = signal.getsignal(signal.SIGINT)
    if isinstance(before, _Memory):
        yield before.check
        return
    if before is not signal.default_int_handler or threading.current_thread() is not threading.main_thread():
        yield lambda: None
        return
    memory = _Memory()
    signal.signal(signal.SIGINT, memory)
    try:
        yield memory.check
    finally:
        signal.signal(signal.SIGINT, before)


@contextmanager
def postponed() -> Iterator[None]:
    """A Ctrl-C in this block counts at its end. For short calls of a compiled library that crashes on one."""
    before = signal.getsignal(signal.SIGINT)
    if not callable(before) or threading.current_thread() is not threading.main_thread():
        yield
        return
    came: list[tuple[int, FrameType | None]] = []
    signal.signal(signal.SIGINT, lambda *signalled: came.append(signalled))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
    if came:
        before(*came[0])


def _is_lost_in(frame: FrameType | None) -> bool:
    while frame is not None:
        if any(place in frame.f_code.co_filename for place in SWALLOWING):
            return True
        frame = frame.f_back
    return False
