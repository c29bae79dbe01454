"""Checks names of strata, which must be different and must not be the name of a boundary of the mesh, and names of the
tables of a section."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from difflib import get_close_matches
from typing import Any

BOUNDARIES = ("surface", "base", "left", "right")
# gmsh cuts the names of physical groups after 127 bytes; meshio takes a backslash for a sign of its own.
LONGEST_GROUP = 120
MISSPELLING_RATIO = 0.75  # similarity (difflib's ratio) above which one name is a misspelling of the other


def naming_problems(names: Sequence[str]) -> Iterator[str]:
    """Return the problems of the names of strata."""
    for name in dict.fromkeys(names):
        if names.count(name) > 1:
            yield f'strata: {names.count(name)} strata are called "{name}"; expected different names'
        if name in BOUNDARIES:
            yield f'strata: the name "{name}" is the name of a boundary of the mesh'


def group_names(names: Sequence[str]) -> list[str]:
    """Return the names of the physical groups of strata in a gmsh file.

    Parameters
    ----------
    names : names of the strata

    Returns
    -------
    The names; "stratum" with the number from 1 for a stratum whose name gmsh cannot write.
    """
    groups = []
    for number, name in enumerate(names, start=1):
        is_short = len(name.encode()) <= LONGEST_GROUP and "\\" not in name
        group = name if is_short else f"stratum {number}"
        while not is_short and group in names:
            group += "'"
        groups.append(group)
    return groups


def without_other_tables(data: Mapping[str, Any], names: Iterable[str]) -> dict[str, Any]:
    """Return the tables of a file whose names are among ``names``, and those whose names are nearly one of them."""
    known = list(names)
    return {
        key: value
        for key, value in data.items()
        if not isinstance(value, Mapping) or get_close_matches(key, known, n=1, cutoff=MISSPELLING_RATIO)
    }
