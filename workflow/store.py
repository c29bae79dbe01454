"""The folder of a run: every file is written beside its place and then moved there whole."""

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pyvista as pv

from meshes.errors import InputError


class Store:
    """The folder of one run; see the names of its files in the README."""

    def __init__(self, folder: Path | str) -> None:
        self.folder = Path(folder)

    @contextmanager
    def writing(self, name: str) -> Iterator[Path]:
        """A path to write to; what stands there at the end becomes ``name``, at once and whole.

        Raises InputError if the folder cannot be written to. On any error nothing is left behind.
        """
        target = self.folder / name
        beside = target.with_name(f".{os.getpid()}-{target.name}")
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
            yield beside
            beside.replace(target)
        except OSError as error:
            raise InputError(str(target), [f"cannot be written: {error.strerror or error}"]) from error
        finally:
            with suppress(OSError):
                beside.unlink()

    def write_grid(self, name: str, grid: pv.UnstructuredGrid) -> Path:
        """Write a VTK file; returns its path."""
        with self.writing(name) as path:
            grid.save(path)
            if not path.read_bytes().rstrip().endswith(b"</VTKFile>"):  # VTK prints that the disk is full, and goes on
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))
        return self.folder / name

    def write_text(self, name: str, text: str) -> Path:
        """Write a text file; returns its path."""
        with self.writing(name) as path:
            path.write_text(text, encoding="utf-8")
        return self.folder / name
