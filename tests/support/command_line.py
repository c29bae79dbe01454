"""`noshiro` as a person types it, in this process or in one of its own."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from tests.support import TOP
from workflow.cli import main


def run(*arguments: object) -> int:
    """The exit code of the command, in this process."""
    try:
        main([str(argument) for argument in arguments])
    except SystemExit as stop:
        return int(stop.code or 0)
    return 0


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
