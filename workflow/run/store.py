"""Reads and writes the folder of a run, in which files are written completely or not at all."""

import errno
import json
import math
import os
import re
import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Protocol

from meshes.errors import InputError
from meshes.executor import check_cancelled
from meshes.files import TEMPORARY, whole_file

if TYPE_CHECKING:
    import pyvista as pv


def _finite(data: Any) -> Any:
    """Return the data with null for numbers that are not finite."""
    if isinstance(data, float):
        return data if math.isfinite(data) else None
    if isinstance(data, dict):
        return {key: _finite(value) for key, value in data.items()}
    return [_finite(value) for value in data] if isinstance(data, list | tuple) else data


def _by_numbers(name: str) -> list[str | int]:
    """Return a sort key by the numbers in a name: case2 before case10."""
    return [int(part) if part.isdigit() else part for part in re.split(r"([0-9]+)", name)]


class OtherVersionError(InputError):
    """The file was written by another version of the program: a key is missing, unknown, or of another type."""


class Savable(Protocol):
    """Is the interface of objects that write themselves to a file, such as pictures."""

    def save(self, path: Path) -> None:
        """Write the file."""


class Store:
    """Reads and writes the files in the folder of one run; docs/reference/files.md names the files.

    Parameters
    ----------
    folder : the folder, which is created with the first file
    """

    def __init__(self, folder: Path | str) -> None:
        self.folder = Path(folder)

    @contextmanager
    def writing(self, name: str) -> Iterator[Path]:
        """Yield a temporary path to write to; at the end of the block the file is renamed to ``name``.

        Raises InputError if it cannot be written, or if another file cannot be read meanwhile. After an error the
        temporary file is removed. After Ctrl-C a thread whose result is no longer needed writes nothing, but
        raises KeyboardInterrupt here.
        """
        check_cancelled()
        target = self.folder / name
        try:
            with whole_file(target) as temporary:
                yield temporary
        except OSError as error:
            reason = error.strerror or error
            other = Path(str(error.filename or target))
            if not TEMPORARY.fullmatch(other.name) and not target.is_relative_to(other):
                raise InputError(str(other), [f"cannot be read: {reason}"]) from error
            raise InputError(str(target), [f"cannot be written: {reason}"]) from error

    def save(self, name: str, what: Savable) -> Path:
        """Write a file by the ``save`` of its content; returns its path."""
        with self.writing(name) as path:
            what.save(path)
        return self.folder / name

    def write_grid(self, name: str, grid: "Savable | pv.DataSet") -> Path:
        """Write a VTK file; returns its path.

        VTK writes the file to the temporary folder of the system first, since with a full disk VTK only prints a
        message, or ends the program.
        """
        with self.writing(name) as path, TemporaryDirectory() as elsewhere:
            written = Path(elsewhere) / path.name
            grid.save(written)
            data = written.read_bytes()
            if not data.rstrip().endswith(b"</VTKFile>"):
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(written))
            path.write_bytes(data)
        return self.folder / name

    def write_text(self, name: str, text: str) -> Path:
        """Write a text file; returns its path."""
        with self.writing(name) as path:
            path.write_text(text, encoding="utf-8")
        return self.folder / name

    def write_collection(self, name: str, states: Sequence[tuple[float, str]]) -> Path:
        """Write a .pvd file for ParaView: for each state its time (or another number), and its file in the same
        folder.
        """
        entries = "".join(f'    <DataSet timestep="{time!r}" file="{file}"/>\n' for time, file in states)
        return self.write_text(
            name,
            f'<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n  <Collection>\n{entries}'
            "  </Collection>\n</VTKFile>\n",
        )

    def write_json(self, name: str, data: Any) -> Path:
        """Write a JSON file, with null for numbers that are not finite; returns its path."""
        return self.write_text(name, json.dumps(_finite(data), indent=1, allow_nan=False) + "\n")

    def read_json(self, name: str) -> Any:
        """Return the content of a JSON file; raise InputError if it is missing or not JSON."""
        path = self.folder / name
        try:
            return json.loads(path.read_text(encoding="utf-8"))
        except FileNotFoundError:
            raise InputError(str(path), ["there is no such file; run the stage that writes this file"]) from None
        except (OSError, ValueError) as error:
            raise InputError(str(path), [f"cannot be read: {error}; delete it and run again"]) from None

    def has(self, name: str) -> bool:
        """Return whether a file of the folder exists."""
        return (self.folder / name).is_file()

    def copy(self, name: str, to: str) -> None:
        """Copy a file of the folder to another name."""
        with self.writing(to) as path:
            shutil.copyfile(self.folder / name, path)

    def matching(self, patterns: Sequence[str]) -> list[str]:
        """Return the names of the complete files that match any of some patterns, sorted by the numbers in the
        names."""
        paths = {path for pattern in patterns for path in self.folder.glob(pattern) if path.is_file()}
        names = [str(path.relative_to(self.folder)) for path in paths if not TEMPORARY.fullmatch(path.name)]
        return sorted(names, key=_by_numbers)

    def marks(self, patterns: Sequence[str]) -> dict[str, tuple[int, int]]:
        """Return the inode and time of writing (ns) of every matching file, which change when the file is written
        again."""
        stats = {name: (self.folder / name).stat() for name in self.matching(patterns)}
        return {name: (stat.st_ino, stat.st_mtime_ns) for name, stat in stats.items()}

    def written(self, patterns: Sequence[str], before: Mapping[str, object]) -> list[str]:
        """Return the names of the matching files that were written since `marks` returned ``before``."""
        return [name for name, mark in self.marks(patterns).items() if before.get(name) != mark]

    def remove(self, patterns: Sequence[str]) -> None:
        """Remove the files that match some patterns; folders stay. Raises InputError if a file cannot be removed."""
        for name in self.matching(patterns):
            try:
                (self.folder / name).unlink()
            except OSError as error:
                raise InputError(str(self.folder / name), [f"cannot be removed: {error.strerror}"]) from error

    def sweep(self) -> None:
        """Remove files that killed processes left half-written. Call this function while the folder is locked."""
        for path in self.folder.rglob(".*"):
            if TEMPORARY.fullmatch(path.name) and path.is_file():
                with suppress(OSError):
                    path.unlink()
