"""Provides example sections: a commented one, and those that come with the program."""

import json
from importlib import resources
from pathlib import Path

from meshes import shipped
from meshes.errors import InputError


def example(name: str | None = None) -> str:
    """Return the text of the commented example, or of a section that comes with the program; raise InputError if there
    is no section of this name."""
    if name is None:
        return resources.files("workflow.cli").joinpath("example.toml").read_text(encoding="utf-8")
    if name not in shipped.names():
        raise InputError("--from", [f"{name!r}: expected one of {', '.join(shipped.names())}"])
    return shipped.file_of(name).read_text(encoding="utf-8")


def write_example(path: Path, name: str | None = None) -> None:
    """Write an example. Raises InputError if the file exists already or cannot be written."""
    text = example(name)
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError:
        raise InputError(str(path), ["exists already; expected the name of a new file"]) from None
    except OSError as error:
        raise InputError(str(path), [f"cannot be written: {error.strerror or error}"]) from None


def said_of(path: Path, as_json: bool) -> str:
    """Return the message printed after an example is written: how to use it, or its path as JSON."""
    if as_json:
        return json.dumps({"section": str(path)})
    return f"{path} is a section that runs as it is. Change it to yours, then: noshiro run {path}"
