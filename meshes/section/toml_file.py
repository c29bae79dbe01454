"""Reads TOML files."""

import tomllib
from pathlib import Path
from typing import Any

from meshes.errors import InputError


def read_toml(path: Path | str) -> dict[str, Any]:
    """Read a TOML file.

    Parameters
    ----------
    path : path of the file, in UTF-8

    Returns
    -------
    The tables and keys of the file.

    Raises
    ------
    InputError
        If there is no such file, or it is not TOML.
    """
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8-sig")  # some editors on Windows begin a file with a mark
    except FileNotFoundError:
        raise InputError(str(path), ["there is no such file"]) from None
    except (OSError, UnicodeDecodeError) as error:
        reason = "it is a folder" if path.is_dir() else getattr(error, "strerror", None) or "it is not UTF-8 text"
        raise InputError(str(path), [f"cannot be read: {reason}"]) from None
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(str(path), [f"is not TOML: {error}"]) from None
    except RecursionError:
        raise InputError(str(path), ["is not TOML that can be read: too many brackets within brackets"]) from None
