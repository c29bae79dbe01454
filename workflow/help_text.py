"""The help of commands, in which brackets are brackets: typer takes "[uncertain]" for a style, and leaves it out."""

from typing import Any

import typer


def with_literal_help(app: typer.Typer) -> Any:
    """The command line of ``app``, whose help shows every word in brackets as it was written."""
    from rich.markup import escape

    program: Any = typer.main.get_command(app)
    for command in (program, *program.commands.values()):
        for text in (command, *command.params):
            if text.help:
                text.help = escape(text.help)
    return program
