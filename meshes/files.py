"""Writes files completely or not at all, and checkpoints of arrays in such files."""

import json
import os
import re
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np

# What `whole` calls a file that is not whole yet: the number of the process that writes it, then its name.
TEMPORARY = re.compile(r"\.(\d+)-.+")
PLAIN = "plain"  # name in a checkpoint of all values that are no arrays, as JSON


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Provide the path of a temporary file to write to. At the end of the block it replaces the final file in one
    operation.

    The folder of the file is made if necessary. After any error the earlier file remains, and the temporary file is
    removed. Raises OSError if the file cannot be written.
    """
    temporary = path.with_name(f".{os.getpid()}-{path.name}")
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        yield temporary
        temporary.replace(path)
    finally:
        with suppress(OSError):
            temporary.unlink()


def write_checkpoint(path: Path, arrays: Mapping[str, np.ndarray], plain: Mapping[str, Any]) -> None:
    """Write arrays, and plain values that JSON can hold, to a file of NumPy (.npz), exact to the last bit."""
    with whole_file(path) as temporary, temporary.open("wb") as file:
        np.savez(file, **arrays, **{PLAIN: np.array(json.dumps(plain))})


def read_checkpoint(path: Path) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """Read arrays and plain values back. Raises OSError for a file that is no such checkpoint."""
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = dict(file)
        return arrays, json.loads(str(arrays.pop(PLAIN)))
    except (KeyError, ValueError, EOFError, zipfile.BadZipFile) as error:
        raise OSError(f"{path} is no checkpoint") from error
