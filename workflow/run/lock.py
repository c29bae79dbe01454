"""Locks a folder against two runs at the same time; the lock ends with the process."""

import errno
import fcntl
import json
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path

from meshes.errors import InputError

NAME = ".noshiro/lock"


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Lock the folder, which is created if necessary, until the end of the block.

    The lock is one of the operating system, which is released when the process ends in any way, and is not inherited by
    child processes. The content of the file only informs about the owner. Raises InputError if another run has locked
    the folder, or if nothing can be written.
    """
    path = folder / NAME
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
    except OSError as error:
        raise InputError(str(path), [f"cannot be written: {error.strerror or error}"]) from error
    try:
        _take_lock(descriptor, folder)
        yield
    finally:
        os.close(descriptor)


def _take_lock(descriptor: int, folder: Path) -> None:
    try:
        fcntl.lockf(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        if error.errno in (errno.ENOLCK, errno.ENOTSUP, errno.EINVAL):
            return  # a file system without locks: rather no lock than no run
        holder = _holder(descriptor)
        raise InputError(
            str(folder), [f"the folder is in use by another run{holder}; wait for it, or take another --out"]
        ) from None
    me = {"pid": os.getpid(), "host": socket.gethostname(), "since": datetime.now().isoformat(" ", "seconds")}
    try:
        os.ftruncate(descriptor, 0)
        os.pwrite(descriptor, json.dumps(me).encode(), 0)
    except OSError:
        pass  # a full disk: the lock holds without its note


def _holder(descriptor: int) -> str:
    try:
        holder = json.loads(os.pread(descriptor, 1000, 0))
        return f" (process {holder['pid']} on {holder['host']}, since {holder['since']})"
    except (OSError, ValueError, KeyError, TypeError):
        return ""
