"""Defines the command `noshiro migrate`, which rewrites a section file with the names of settings of this version."""

from pathlib import Path
from typing import Annotated

import typer

from meshes.errors import InputError
from workflow.cli.options import SectionFile


def migrate(
    section: SectionFile,
    to: Annotated[
        Path | None, typer.Option("--out", "-o", help="Write the new form into this file.", show_default=False)
    ] = None,
    write: Annotated[bool, typer.Option("--write", help="Write the new form over the file itself.")] = False,
) -> None:
    """Rewrite a section file that has old names of settings; comments and layout stay unchanged."""
    from meshes.section.section import read_toml
    from workflow.cli.terminal import say
    from workflow.config.renamed import rewritten

    if to is not None and write:
        raise InputError("noshiro migrate", ["give either --out FILE or --write, not both"])
    if to is not None and to.exists():
        raise InputError(str(to), ["exists already; expected the name of a new file, or --write to change the old one"])
    read_toml(section)  # tells what is wrong with the file
    with section.open(encoding="utf-8-sig", newline="") as file:  # ends of lines stay as they are
        text, changes = rewritten(file.read(), str(section))
    for change in changes:
        say(change)
    target = to or (section if write and changes else None)
    if target is not None:
        with target.open("w", encoding="utf-8", newline="") as file:
            file.write(text)
        return say(f"Written: {target}")
    if not changes:
        return say(f"{section} has no old words.")
    return say("Nothing is written: --write changes the file, --out FILE writes another one.")
