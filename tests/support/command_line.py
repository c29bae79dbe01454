"""Runs `noshiro` as a user does, in this process or in a separate one."""

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
    """Return an executor of one separate process for all tasks that several processes would do, since each takes
    seconds to import its modules."""
    other = Processes(1)
    other.count = 2  # a single one would leave tasks to this process
    return other


# Who does the tasks of a command: this process, another one, or as many as a person would have.
EXECUTORS: dict[str, Callable[[int], Executor]] = {
    "here": lambda count: SERIAL, "in another": in_another_process, "side by side": Processes,
}  # fmt: skip


def run(*arguments: object, tasks: str = "here", painted: bool = False) -> int:
    """Run the command in this process, and return its exit code.

    This process also does all tasks, unless ``tasks`` names an executor of `EXECUTORS`; the results are equal. Pictures
    are only ``painted`` if a test looks at them. Otherwise every picture is prepared up to its last steps, the views of
    VTK are white, and one white line is saved, which saves half of the time of drawing and compressing.
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
    """Replace pictures by white lines while a patch is active."""
    patch.setattr("matplotlib.figure.Figure.savefig", _white)
    patch.setattr("pyvista.Plotter.screenshot", _blank)


def _white(_: object, path: Path | str, **__: object) -> None:
    """Return a picture of the usual width without content."""
    Image.new("RGB", (1600, 1), "white").save(path, format="PNG")


def _blank(plotter: Plotter, **_: object) -> np.ndarray:
    """Return a white view."""
    width, height = plotter.window_size
    return np.full((height, width, 3), 255, np.uint8)


def line(*arguments: object) -> list[str]:
    """Return the command line of a separate process."""
    return [sys.executable, "-m", "workflow.cli", *map(str, arguments)]


def process(
    *arguments: object, before: Callable[[], None] | None = None, folder: Path = TOP
) -> subprocess.CompletedProcess[str]:
    """Run the command as a separate process in a folder."""
    return subprocess.run(
        line(*arguments), capture_output=True, text=True, preexec_fn=before, timeout=300, check=False, cwd=folder,
        stdin=subprocess.DEVNULL,
    )  # fmt: skip
