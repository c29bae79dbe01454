"""Provides the commands of `noshiro`: options, terminal output, exit codes. A command imports the modules that it needs
when it is called.
"""

from workflow.cli.commands import app, main
