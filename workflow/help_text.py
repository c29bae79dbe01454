"""Help texts of commands with their square brackets, which typer would take for styles and leave out."""

from collections.abc import Callable
from typing import Any

import typer


def literal_help(call: Callable[..., Any]) -> Any:
    """A command line whose help shows every word in brackets as it was written; another call as it is."""
    from rich.markup import escape

    if not isinstance(call, typer.Typer):
        return call
    program: Any = typer.main.get_command(call)
    for command in (program, *program.commands.values()):
        for text in (command, *command.params):
            if text.help:
                text.help = escape(text.help)
    return program
