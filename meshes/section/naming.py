"""Names of strata, each once and none that belongs to a boundary of the mesh."""

from collections.abc import Iterator, Sequence

BOUNDARIES = ("surface", "base", "left", "right")


def naming_problems(names: Sequence[str]) -> Iterator[str]:
    """What is wrong with the names of strata."""
    for name in dict.fromkeys(names):
        if names.count(name) > 1:
            yield f'strata: {names.count(name)} of them are called "{name}"; expected every name once'
        if name in BOUNDARIES:
            yield f'strata: the name "{name}" is taken by a boundary of the mesh'
