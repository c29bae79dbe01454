"""Exit codes of the program and what it says at its end."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from meshes.errors import InputError
from tests.support.command_line import TOP
from workflow.cli.exit_codes import BAD_INPUT, FAULT, NO_ANSWER, STOPPED, exit_on_failure
from workflow.stages.bounds import NoBracketError

STOPPED_MESSAGE = "Stopped. Finished results are kept; the same command continues.\n"


def interrupted_by_itself() -> None:
    raise KeyboardInterrupt


def interrupted_as_compiled_code_returns() -> None:
    """As Python tells Ctrl-C that is heard while Numba calls a kernel: twice removed from its cause."""
    try:
        try:
            raise KeyboardInterrupt
        except KeyboardInterrupt as heard:
            raise SystemError("<function _numba_unpickle> returned a result with an exception set") from heard
    except SystemError as error:
        raise SystemError("CPUDispatcher(<function members_of>) returned a result with an exception set") from error


def refused() -> None:
    raise InputError("section.toml", ["strata: missing"])


def without_bounds() -> None:
    """As `fem --safety-factor` ends whose finite elements have an answer, and whose bounds do not."""
    raise NoBracketError("there is no lower bound", "rely on the finite elements")


def faulty() -> None:
    raise SystemError("a fault")


@pytest.mark.parametrize(
    ("call", "code", "message"),
    [
        (interrupted_by_itself, STOPPED, STOPPED_MESSAGE),
        (interrupted_as_compiled_code_returns, STOPPED, STOPPED_MESSAGE),
        (refused, BAD_INPUT, "strata: missing"),
        (without_bounds, NO_ANSWER, "No strict bounds: there is no lower bound; rely on"),
        (faulty, FAULT, "This is a fault of noshiro, not of your input: SystemError: a fault"),
    ],
)
def test_ends_with_the_code_and_a_sentence(
    call: Callable[[], None], code: int, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as stop:
        exit_on_failure(call)
    assert stop.value.code == code
    said = capsys.readouterr().err
    assert message in said
    assert (said == message) == (code == STOPPED)


def test_ctrl_c_while_a_class_is_made_ends_with_the_code_of_a_stop(tmp_path: Path) -> None:
    """A module ends by the signal, -2, once Ctrl-C has left an `exec` in it, whoever has heard it since."""
    program = """
import rich.markup, workflow.cli.terminal  # which make classes, too
from workflow.cli.exit_codes import exit_on_failure
exit_on_failure(lambda: exec("raise KeyboardInterrupt"))
"""
    (tmp_path / "stopped.py").write_text(program)
    paths = os.pathsep.join([str(tmp_path), str(TOP)])
    done = subprocess.run(
        [sys.executable, "-m", "stopped"], capture_output=True, text=True, env={**os.environ, "PYTHONPATH": paths},
        check=False,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (STOPPED, STOPPED_MESSAGE)
