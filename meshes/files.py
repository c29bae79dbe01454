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

# Name of the temporary file of `whole_file`: the number of the process that writes it, then the name of the file.
TEMPORARY = re.compile(r"\.(\d+)-.+")
PLAIN = "plain"  # name in a checkpoint of all values that are no arrays, as JSON


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Provide a temporary file to write to, which replaces the final file in one operation at the end of the block.

    The folder of the file is made if necessary. After any error the earlier file remains, and the temporary file is
    removed. OSError is raised if the file cannot be written.

    Parameters
    ----------
    path : path of the final file

    Returns
    -------
    Context manager that yields the path of the temporary file.
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
    """Write arrays and plain values to a file of NumPy (.npz), completely or not at all, exact to the last bit.

    Parameters
    ----------
    path : path of the file
    arrays : arrays by their names
    plain : values that JSON can hold, by their names
    """
    with whole_file(path) as temporary, temporary.open("wb") as file:
        np.savez(file, **arrays, **{PLAIN: np.array(json.dumps(plain))})


def read_checkpoint(path: Path) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """Read arrays and plain values of a file that `write_checkpoint` wrote.

    Parameters
    ----------
    path : path of the file

    Returns
    -------
    Arrays by their names, and plain values by their names; tuples are lists.

    Raises
    ------
    OSError
        If there is no such file, or the file is no checkpoint.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = dict(file)
        return arrays, json.loads(str(arrays.pop(PLAIN)))
    except (KeyError, ValueError, EOFError, zipfile.BadZipFile) as error:
        raise OSError(f"{path} is no checkpoint") from error
