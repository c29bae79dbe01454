"""Writes log.txt: commands and stages with their times, versions, and machine."""

import os
import platform
import socket
import time
import traceback
from contextlib import suppress
from datetime import datetime
from importlib import metadata

from meshes.errors import InputError
from meshes.executor import is_interrupt
from workflow.run.store import Store

NAME = "log.txt"
PACKAGES = (
    "noshiro",
    "numpy",
    "scipy",
    "numba",
    "fenics-dolfinx",
    "petsc4py",
    "gmsh",
    "meshio",
    "vtk",
    "pyvista",
    "matplotlib",
    "clarabel",
)


class RunLog:
    """Adds lines with their time to the end of log.txt as they come."""

    def __init__(self, store: Store) -> None:
        self.store = store
        self.start = time.perf_counter()

    def line(self, text: str) -> None:
        """Add a line; raises InputError if it cannot be written."""
        path = self.store.folder / NAME
        try:
            with path.open("a", encoding="utf-8") as file:
                file.write(f"{datetime.now().isoformat(' ', 'seconds')}  {text}\n")
        except OSError as error:
            raise InputError(str(path), [f"cannot be written: {error.strerror or error}"]) from error

    def begin(self, what: str) -> None:
        """Add the command that begins, its machine, and its versions."""
        self.line(f"--- {what}")
        for name, text in machine().items():
            self.line(f"{name}: {text}")
        self.line("versions: " + ", ".join(f"{name} {number}" for name, number in versions().items()))

    def done(self) -> None:
        self.line(f"all done after {time.perf_counter() - self.start:.1f} s")

    def stop(self, error: BaseException) -> None:
        """Add the reason why the run stopped, with the traceback if it is a fault of the program; a full disk is
        ignored.
        """
        expected = isinstance(error, InputError) or is_interrupt(error)
        lines = [str(error) or type(error).__name__] if expected else traceback.format_exception(error)
        with suppress(InputError):
            self.line(f"stopped after {time.perf_counter() - self.start:.1f} s: {''.join(lines)}")


def machine() -> dict[str, str]:
    """Return the host, its system and its processors, in words.

    Returns
    -------
    Texts of "host", "system", and "processor", which counts the cores that this process may use.
    """
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return {
        "host": socket.gethostname(),
        "system": f"{platform.system()} {platform.release()} {platform.machine()}",
        "processor": f"{_processor()}, {cores} cores to use",
    }


def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            names = [line.partition(":")[2].strip() for line in file if line.startswith("model name")]
    except OSError:
        names = []
    return names[0] if names else platform.processor() or "unknown"


def versions() -> dict[str, str]:
    """Return the versions of this program, of Python, and of every package that computes or draws.

    Returns
    -------
    Versions by names of packages; packages that are not installed are missing.
    """
    numbers = {"python": platform.python_version()}
    for name in PACKAGES:
        with suppress(metadata.PackageNotFoundError):
            numbers[name] = metadata.version(name)
    return numbers
