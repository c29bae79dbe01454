"""Numbers layers that are met several times from the top down, and connects them by their order."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

MATCH = 1.0  # what it is worth to go on with a layer; overlapping it is worth less than this in sum


class Piece(NamedTuple):
    """Holds a piece of a layer in one column.

    Attributes
    ----------
    name : name of the layer
    left, right (2,) : elevations of top and bottom at the left and the right end (m)
    """

    name: str
    left: tuple[float, float]
    right: tuple[float, float]


@dataclass
class _Stratum:
    """Holds a stratum under construction: its name, and where it was met last."""

    name: str
    last_piece: Piece


@dataclass(frozen=True)
class Stack:
    """Holds strata from the top down.

    Attributes
    ----------
    layers : name of the layer of each stratum
    names : names of the strata, with numbers if several have the same name
    numbers : for each column, the index (from 0) of the stratum of every piece
    notices : a sentence for each name that several strata have
    """

    layers: tuple[str, ...]
    names: tuple[str, ...]
    numbers: list[list[int]]
    notices: list[str]


def stacked(columns: Sequence[Sequence[Piece]]) -> Stack:
    """Return the strata, from the top down, that columns of pieces form.

    A piece belongs to a stratum of its name. From one column to the next, as many strata continue as the order allows.
    Among several strata of one name, the one that the piece overlaps most continues. A remaining piece becomes a new
    stratum, placed by its elevation.

    Parameters
    ----------
    columns : pieces of layers from the top down, for each column from left to right

    Returns
    -------
    The strata, and the stratum of every piece.
    """
    strata: list[_Stratum] = []
    members: list[list[_Stratum]] = []
    for column in columns:
        aligned = _aligned(column, strata)
        members.append([])
        place = 0
        for k, piece in enumerate(column):
            stratum = aligned.get(k)
            if stratum is None:
                after = next((strata.index(aligned[j]) for j in range(k + 1, len(column)) if j in aligned), len(strata))
                while place < after and sum(strata[place].last_piece.right) > sum(piece.left):
                    place += 1
                stratum = _Stratum(piece.name, piece)
                strata.insert(place, stratum)
            stratum.last_piece = piece
            place = strata.index(stratum) + 1
            members[-1].append(stratum)
    numbers = {id(stratum): k for k, stratum in enumerate(strata)}
    before = [stratum.name for stratum in strata]
    names = numbered_names(before)
    notices = []
    for name in dict.fromkeys(before):
        several = [f'"{new}"' for old, new in zip(before, names, strict=True) if old == name]
        if len(several) > 1:
            notices.append(
                f'"{name}" lies above and below other layers, and is divided: from the top down, '
                f"{' and '.join(several)}"
            )
    return Stack(
        tuple(before), tuple(names), [[numbers[id(member)] for member in of_column] for of_column in members], notices
    )


def _aligned(column: Sequence[Piece], strata: Sequence[_Stratum]) -> dict[int, _Stratum]:
    """Return, by the number of a piece of a column, the stratum that the piece continues. The best assignment that
    keeps the order of pieces and strata is chosen."""
    worth = [[0.0] * (len(strata) + 1) for _ in range(len(column) + 1)]
    for i in range(len(column) - 1, -1, -1):
        for j in range(len(strata) - 1, -1, -1):
            both = _worth(column[i], strata[j], len(column)) + worth[i + 1][j + 1]
            worth[i][j] = max(worth[i + 1][j], worth[i][j + 1], both)
    pairs, i, j = {}, 0, 0
    while i < len(column) and j < len(strata):
        value = _worth(column[i], strata[j], len(column))
        if value > 0.0 and worth[i][j] == value + worth[i + 1][j + 1]:
            pairs[i] = strata[j]
            i, j = i + 1, j + 1
        elif worth[i][j] == worth[i][j + 1]:
            j += 1
        else:
            i += 1
    return pairs


def _worth(piece: Piece, stratum: _Stratum, pieces: int) -> float:
    if piece.name != stratum.name:
        return 0.0
    (top, bottom), (last_top, last_bottom) = piece.left, stratum.last_piece.right
    overlap, whole = min(top, last_top) - max(bottom, last_bottom), max(top, last_top) - min(bottom, last_bottom)
    return MATCH + 0.9 * MATCH * max(0.0, overlap / whole if whole > 0.0 else 0.0) / pieces


def numbered_names(names: Sequence[str]) -> list[str]:
    """Return names with numbers where several are equal.

    Parameters
    ----------
    names : the names

    Returns
    -------
    The names in their order, such as "sand 1" and "sand 2" for "sand" twice; all of them are different.
    """
    forms = ("{} {}", "{} ({})", "{} no. {}", "{} - {}")
    numbers = range(1, len(names) + 1)
    form = next(
        pattern for pattern in forms if not any(pattern.format(name, k) in names for name in names for k in numbers)
    )
    met: dict[str, int] = {}
    numbered = []
    for name in names:
        met[name] = met.get(name, 0) + 1
        numbered.append(form.format(name, met[name]) if names.count(name) > 1 else name)
    return numbered
