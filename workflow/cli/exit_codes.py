"""Ends a command: prints the error message and sets the exit code."""

import os
import sys
import traceback
from collections.abc import Callable
from typing import NoReturn

from meshes.errors import InputError, NoAnswerError
from meshes.executor import is_interrupt, is_left_working
from workflow.run.spelling import spell_out

DONE, FAULT, BAD_INPUT, NO_ANSWER, STOPPED = 0, 1, 2, 3, 130


def exit_on_failure(call: Callable[[], object]) -> None:
    """Call a function, and leave the program with an exit code if it fails."""
    spell_out()
    try:
        call()
    except InputError as error:
        _complain(str(error))
        sys.exit(BAD_INPUT)
    except NoAnswerError as error:
        _complain(f"{error.MISSING}: {error}")
        sys.exit(NO_ANSWER)
    except (KeyboardInterrupt, SystemExit) as stop:
        if isinstance(stop, SystemExit) and stop.code != STOPPED:
            raise
        _stop()  # typer turns Ctrl-C into an exit without a word
    except MemoryError:
        _complain("Out of memory: use larger cells or discs, or a machine with more memory.")
        sys.exit(BAD_INPUT)
    except Exception as error:
        if is_interrupt(error):
            _stop()
        _complain(traceback.format_exc(), style="")
        _complain(
            f"This is a fault of noshiro, not of your input: {type(error).__name__}: {error}",
            "Please report it with log.txt and your section; finished results are kept.",
        )
        sys.exit(FAULT)


def exit_as_program(call: Callable[[], object]) -> None:
    """Call a function as `exit_on_failure` does, and end the process at once if threads of cancelled tasks still run.
    If the process continued to its normal end, Python would abort in these threads.
    """
    try:
        exit_on_failure(call)
    except SystemExit as stop:
        if is_left_working():
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(stop.code if isinstance(stop.code, int) else int(stop.code is not None))
        raise


def _stop() -> NoReturn:
    _complain("Stopped. Finished results are kept; the same command continues.", style="yellow")
    exec("")  # else Python ends by the signal if Ctrl-C came inside of another exec: as a class was made, for example
    sys.exit(STOPPED)


def _complain(*lines: str, style: str = "red") -> None:
    from rich.markup import escape

    from workflow.cli.terminal import err

    err.print(*(escape(line) for line in lines), style=style, soft_wrap=True)
