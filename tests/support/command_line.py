"""`noshiro` as a person types it, in this process or in one of its own."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from pyvista import Plotter

from meshes.executor import SERIAL, Executor, Processes
from tests.support import TOP
from workflow.cli import main


def in_another_process(_: int) -> Executor:
    """One process beside this one, which does all tasks that several would do: each takes seconds to import what it
    draws and computes with."""
    other = Processes(1)
    other.count = 2  # a single one would leave tasks to this process
    return other


# Who does the tasks of a command: this process, another one, or as many as a person would have.
EXECUTORS: dict[str, Callable[[int], Executor]] = {
    "here": lambda count: SERIAL, "in another": in_another_process, "side by side": Processes,
}  # fmt: skip


def run(*arguments: object, tasks: str = "here", painted: bool = False) -> int:
    """The exit code of the command, in this process.

    Unless its ``tasks`` are to be done by others (`EXECUTORS`) this process does them all, which finds the same.
    Where a test looks at its pictures they are ``painted``;
    else each is made up to its last steps, the views of VTK are white, and a line of white is saved, which takes half
    of the time of drawing, and of compressing for the report.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("workflow.cli.terminal.Processes", EXECUTORS[tasks])
        if not painted:
            unpainted(patch)
        try:
            main([str(argument) for argument in arguments])
        except SystemExit as stop:
            return int(stop.code or 0)
    return 0


def unpainted(patch: pytest.MonkeyPatch) -> None:
    """Lets pictures be white lines for as long as a patch holds."""
    patch.setattr("matplotlib.figure.Figure.savefig", _white)
    patch.setattr("pyvista.Plotter.screenshot", _blank)


def _white(_: object, path: Path | str, **__: object) -> None:
    """A picture as wide as any, without anything in it."""
    Image.new("RGB", (1600, 1), "white").save(path, format="PNG")


def _blank(plotter: Plotter, **_: object) -> np.ndarray:
    """A white view."""
    width, height = plotter.window_size
    return np.full((height, width, 3), 255, np.uint8)


def line(*arguments: object) -> list[str]:
    """The command as a process of its own."""
    return [sys.executable, "-m", "workflow.cli", *map(str, arguments)]


def process(
    *arguments: object, before: Callable[[], None] | None = None, folder: Path = TOP
) -> subprocess.CompletedProcess[str]:
    """Run the command as a process of its own, from a folder."""
    return subprocess.run(
        line(*arguments), capture_output=True, text=True, preexec_fn=before, timeout=300, check=False, cwd=folder,
        stdin=subprocess.DEVNULL,
    )  # fmt: skip
