"""The commands of `noshiro`: their options, the terminal, exit codes; what one needs is imported when it is called."""

from workflow.cli.commands import app, main
