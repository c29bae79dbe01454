"""What a package offers at its top: each name is written once, in an import, and imported when it is asked for."""

import ast
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any


def homes(file: str) -> dict[str, str]:
    """Name and module of all that the `__init__` of a package imports under `if TYPE_CHECKING`."""
    blocks = [line.body for line in ast.parse(Path(file).read_text(encoding="utf-8")).body if isinstance(line, ast.If)]
    imports = [line for block in blocks for line in block if isinstance(line, ast.ImportFrom)]
    return {alias.name: str(line.module) for line in imports for alias in line.names}


def exports(package: str, file: str) -> tuple[list[str], Callable[[str], Any]]:
    """`__all__` and `__getattr__` (PEP 562) of such a package, whose heavy imports so wait for their use.

    Type checkers read the same block. Raises AttributeError for a name that is not in it.
    """
    home = homes(file)

    def named(name: str) -> Any:
        if name not in home:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(import_module(home[name]), name)

    return sorted(home), named
