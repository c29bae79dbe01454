"""Caches the answers of tasks: one file for each, named by its fingerprint."""

import errno
import fcntl
import json
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, Field

from meshes.errors import InputError
from meshes.files import whole_file
from workflow.config.renamed import current_answer

FOLDER = "tasks"


class Outcome(BaseModel):
    """Holds the outcome of a task."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    task: str = Field(description="name of the function")
    argument: dict[str, Any] = Field(description="input of the function")
    answer: dict[str, Any] | None = Field(default=None, description="None if the task failed")
    reason: str = Field(default="", description="reason of the failure")
    seconds: float = Field(default=0.0, description="computing time (s)")
    host: str = Field(default="", description="machine that computed the task")
    lasting: bool = Field(default=True, description="whether the task would have the same outcome again")


class ResultCache:
    """Stores answers of tasks in a folder, which several machines may share.

    A task is claimed by a file lock of the operating system. Therefore the workers of all machines compute each task
    only once, and a worker that dies releases its claim. On a file system without locks a task may be computed twice,
    with the same answer.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder / FOLDER

    def path(self, fingerprint: str) -> Path:
        """Return the file of the outcome of a task."""
        return self.folder / f"{fingerprint}.json"

    def read(self, fingerprint: str) -> Outcome | None:
        """Return the outcome of a task; None if it has not ended, or if the file is not an outcome of this program."""
        try:
            return Outcome.model_validate(current_answer(json.loads(self.path(fingerprint).read_bytes())))
        except (OSError, ValueError):
            return None

    def write(self, fingerprint: str, outcome: Outcome) -> None:
        """Store an outcome; raises InputError if it cannot be written."""
        path = self.path(fingerprint)
        try:
            with whole_file(path) as temporary:
                temporary.write_text(outcome.model_dump_json(indent=1) + "\n", encoding="utf-8")
        except OSError as error:
            raise InputError(str(path), [f"cannot be written: {error.strerror or error}"]) from error

    @contextmanager
    def claimed(self, fingerprint: str) -> Iterator[bool]:
        """Return whether this process has claimed the task until the end of the block. The result is False if another
        process has claimed the task."""
        self.folder.mkdir(parents=True, exist_ok=True)
        path = self.folder / f".{fingerprint}.claim"
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
        try:
            locked = _locked(descriptor)
            yield locked
            if locked:
                # its outcome is written by now, or the task is free for anybody: a late claim on the old file does
                # no harm, since who holds one looks for an outcome first
                with suppress(OSError):
                    path.unlink()
        finally:
            os.close(descriptor)


def _locked(descriptor: int) -> bool:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        return error.errno in (errno.ENOLCK, errno.ENOTSUP, errno.EINVAL)
    return True
