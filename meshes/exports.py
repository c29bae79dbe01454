"""Lists the public names of a package. Each name is written once, in an import, and imported when it is first used."""

import ast
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any


def homes(file: str) -> dict[str, str]:
    """Return name and module of all names that the `__init__` of a package imports under `if TYPE_CHECKING`."""
    blocks = [line.body for line in ast.parse(Path(file).read_text(encoding="utf-8")).body if isinstance(line, ast.If)]
    imports = [line for block in blocks for line in block if isinstance(line, ast.ImportFrom)]
    return {alias.name: str(line.module) for line in imports for alias in line.names}


def exports(package: str, file: str) -> tuple[list[str], Callable[[str], Any]]:
    """Return `__all__` and `__getattr__` (PEP 562) of a package, so that its imports are delayed until they are used.

    The `__init__` of the package imports its names under `if TYPE_CHECKING`; type checkers read the same block.

    Parameters
    ----------
    package : name of the package
    file : path of its `__init__`

    Returns
    -------
    Sorted public names, and a function that imports one of them.

    Raises
    ------
    AttributeError
        By the second of them, for a name that is not in the block.
    """
    home = homes(file)

    def named(name: str) -> Any:
        if name not in home:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(import_module(home[name]), name)

    return sorted(home), named
