"""Runs the command: `python -m workflow.cli`."""

from workflow.cli.commands import main

main()
