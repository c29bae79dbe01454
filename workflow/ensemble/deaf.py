"""Loaded by every worker of this machine: Ctrl-C is for the process that hired it, which then ends its workers."""

import signal
from typing import Any


def dask_setup(_worker: Any) -> None:
    """Called by Dask when a worker starts, in its main thread."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
