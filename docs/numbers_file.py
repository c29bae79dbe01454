"""Stores the numbers that README and documentation quote in `docs/numbers.toml` of a checkout, one table per
command."""

import tomllib
from collections.abc import Collection, Mapping
from datetime import date
from pathlib import Path
from typing import Any

import tomli_w

from docs.verify.record import version_of
from workflow.run.store import Store

FILE = "numbers.toml"
HEAD = "# Written by the commands that stand in it. README and pages quote these numbers; a test compares them.\n\n"


def keep_numbers(
    folder: Path, table: str, command: str, numbers: Mapping[str, Any], commits: Collection[str] = ()
) -> Path | None:
    """Replace one table of the file of numbers.

    Parameters
    ----------
    folder : folder `docs` of a checkout; nothing is written if it does not exist, as beside an installed package
    table : name of the table
    command : command that computes these numbers
    numbers : numbers by their names, which end with the unit, and lists of rows of numbers
    commits : versions of the program that computed the numbers; by default the present version

    Returns
    -------
    The file; None if there is no such folder.
    """
    if not folder.is_dir():
        return None
    path = folder / FILE
    tables = tomllib.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
    commits_named = ", ".join(sorted({commit or "unknown" for commit in commits})) or version_of(folder)
    origin = {"command": command, "date": date.today().isoformat(), "commit": commits_named}
    tables[table] = {**origin, **numbers}
    text = HEAD + tomli_w.dumps({name: tables[name] for name in sorted(tables)})
    return Store(folder).write_text(FILE, text)
