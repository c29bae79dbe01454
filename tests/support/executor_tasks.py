"""Provides tasks for processes, which import them from here."""

import os
import signal
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any


def squared(number: int, tell: Callable[[Any], None]) -> int:
    """Return the square, after reporting the number."""
    tell(number)
    return number * number


def own_number(_: int, tell: Callable[[Any], None]) -> int:
    """Return the number of the process."""
    return os.getpid()


def dies_first(folder: str) -> int:
    """Kill the first process that tries."""
    if not (Path(folder) / "tried").exists():
        (Path(folder) / "tried").touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return os.getpid()


def sleeps(folder: str, seconds: float = 3600.0) -> None:
    """Write the number of the process, and sleep."""
    (Path(folder) / "pid").write_text(str(os.getpid()))
    time.sleep(seconds)


class OddError(Exception):
    """An error that cannot be made again from its words alone."""

    def __init__(self, item: int, other: int) -> None:
        super().__init__("odd")


def raises_odd_error() -> None:
    raise OddError(1, 2)


def ends(*_: Any) -> None:
    """End the process as a crashing library does."""
    os._exit(3)
