"""A commented section to start from."""

from importlib import resources
from pathlib import Path

from meshes.errors import InputError


def example() -> str:
    """The text of the example."""
    return resources.files("workflow").joinpath("example.toml").read_text(encoding="utf-8")


def write_example(path: Path) -> None:
    """Write the example; raises InputError if there is such a file or it cannot be written."""
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(example())
    except FileExistsError:
        raise InputError(str(path), ["is there already; expected the name of a new file"]) from None
    except OSError as error:
        raise InputError(str(path), [f"cannot be written: {error.strerror or error}"]) from None
