"""Divides the columns that the user names among several files of borings."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from meshes.borings.csv_file import columns_of_csv
from meshes.borings.text_file import read_text
from meshes.errors import InputError


def columns_of_files(files: Sequence[Path], columns: Mapping[str, str]) -> list[Mapping[str, str]]:
    """Return for each file the named columns that it has.

    Parameters
    ----------
    files : files of borings and cones; a single file gets all columns, and its reader reports those that it has not
    columns : names of columns in the files by the expected names, such as {"layer": "GEOL_LEG"}

    Returns
    -------
    Names of columns by the expected names, for each of the files.

    Raises
    ------
    InputError
        If none of several files has a named column.
    """
    if len(files) == 1:
        return [columns]
    divided = [_columns_of(file, columns) for file in files]
    if missing := [key for key in columns if not any(key in taken for taken in divided)]:
        raise InputError(
            "--columns",
            [f"{key}={columns[key]}: none of the files has a column {columns[key]!r} for {key}" for key in missing],
        )
    return divided


def _columns_of(file: Path, columns: Mapping[str, str]) -> Mapping[str, str]:
    match file.suffix.lower():
        case ".csv":
            return columns_of_csv(file, columns)
        case ".ags":
            text, _ = read_text(file)
            return {key: name for key, name in columns.items() if key == "layer" and name in text}
        case _:
            return {}
