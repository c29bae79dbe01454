"""Finds the places of uncertain numbers in an input, by paths such as "strata.5 Asd.bottom.depth.2", and changes the
numbers.

A path leads from table to table; an entry of a list is given by its name or its number from 1. At the end of a line,
".2" means the depth or elevation of its second point. "*" stands for every entry that has the key.
"""

from collections.abc import Iterator, Mapping
from typing import Any

from workflow.uncertain.distribution import Distribution, in_unit, measured

Place = tuple[int | str, ...]  # keys and indices, from the outermost table inwards


def mutable_copy(data: Any) -> Any:
    """Return a copy of nested tables in which dicts and lists replace read-only mappings and tuples.

    Parameters
    ----------
    data : nested tables, or a value in them

    Returns
    -------
    The copy; values in the tables are the same objects.
    """
    if isinstance(data, Mapping):
        return {key: mutable_copy(value) for key, value in data.items()}
    return [mutable_copy(value) for value in data] if isinstance(data, list | tuple) else data


def changed(data: Mapping[str, Any], drawn: Mapping[str, Any], numbers: Mapping[str, Distribution]) -> dict[str, Any]:
    """Return an input with drawn values in the places of its uncertain numbers.

    Parameters
    ----------
    data : nested tables of the input, which are not changed
    drawn : drawn values by path, in the unit of the distribution
    numbers : distributions by path, which tell whether a value replaces, shifts or multiplies the number

    Returns
    -------
    A changed copy of the tables. A path without a place raises ValueError.
    """
    new: dict[str, Any] = mutable_copy(data)
    for path, value in drawn.items():
        for place in list(places(new, path)):
            holder = value_at(new, place[:-1])
            holder[place[-1]] = changed_value(value_at(new, place), numbers[path], value)
    return new


def value_at(data: Any, place: Place) -> Any:
    """Return the value at a place of nested tables; None if the last key is not set."""
    for key in place[:-1]:
        data = data[key]
    return data.get(place[-1]) if place and isinstance(data, Mapping) else data[place[-1]] if place else data


def places(data: Any, path: str) -> Iterator[Place]:
    """Yield the keys that lead to each number that a path names, such as "strata.*.cohesion".

    Raises ValueError if there is no such number.
    """
    entries = _entries(data)
    if path.startswith("*.") and isinstance(data, list | tuple):
        for number, entry in enumerate(data):
            if _longest_entry(_entries(entry), path[2:]) is not None:
                yield from ((number, *rest) for rest in places(entry, path[2:]))
        return
    name = _longest_entry(entries, path)
    if name is None and isinstance(data, Mapping) and "." not in path:
        yield (path,)  # not set yet; the key is checked as in a file
    elif name is None:
        there = ", ".join(dict.fromkeys(entries)) or "nothing"
        raise ValueError(f'"{path}" is unknown; expected one of {there}')
    elif path == name:
        yield (entries[name],)
    else:
        yield from ((entries[name], *rest) for rest in places(data[entries[name]], path[len(name) + 1 :]))


def _entries(data: Any) -> dict[str, Any]:
    """Return the keys of a table, or the names and numbers of the entries of a list, as they are written in paths."""
    if isinstance(data, Mapping):
        return {str(key): key for key in data}
    if not isinstance(data, list | tuple):
        return {}
    named = {entry["name"]: at for at, entry in enumerate(data) if isinstance(entry, Mapping) and "name" in entry}
    return {**named, **{str(at + 1): at for at in range(len(data))}}


def _longest_entry(entries: Mapping[str, Any], path: str) -> str | None:
    """Return the longest entry with which a path begins, since names of entries may contain dots; None without one."""
    return max((name for name in entries if path == name or path.startswith(f"{name}.")), key=len, default=None)


def changed_value(before: Any, distribution: Distribution, value: Any) -> Any:
    """Return the value that replaces ``before`` for a drawn number; raise ValueError if ``before`` is no number."""
    if distribution.applied_as == "value":
        if _is_point(before):
            return [before[0], distribution.written(value)]
        if isinstance(before, dict | list):
            raise ValueError(
                'holds more than one number; expected the path of one number, or applied_as = "shift" or "factor"'
            )
        return distribution.written(value)
    return _changed_value(before, distribution, value)


def _changed_value(before: Any, distribution: Distribution, value: Any) -> Any:
    """Return a number or a line (or a table that contains a line), shifted or multiplied by a factor."""
    if isinstance(before, dict):
        return {key: _changed_value(inside, distribution, value) for key, inside in before.items()}
    if _is_point(before):
        return [before[0], _changed_value(before[1], distribution, value)]
    if isinstance(before, list):
        return [_changed_value(inside, distribution, value) for inside in before]
    if before is None:
        raise ValueError("is not set in the section file; expected a number, which the distribution changes")
    number, unit = measured(before)
    if distribution.applied_as == "factor":
        number *= float(value)
    else:
        number += in_unit(distribution.written(value), unit)
    return f"{number!r} {unit}" if unit else number


def _is_point(value: Any) -> bool:
    return isinstance(value, list) and len(value) == 2 and not any(isinstance(entry, list | dict) for entry in value)
