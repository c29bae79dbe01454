"""Chooses the disc that owns each contact of a new neighbour list, and copies the history variables of the contacts
(kernel).
"""

import numpy as np
from numba import njit

from dem.kernels.neighbours import PANEL_WIDTH


@njit(cache=True, nogil=True, error_model="numpy")
def share_out(i: np.ndarray, j: np.ndarray, n: int) -> None:
    """Exchange the discs of pairs in place, so that each disc owns about three contacts as the first of a pair.

    Three is the mean of a triangular lattice; computing lanes without a contact is wasted work. Owners are near their
    partners in the order, since a slice can move only after the last owner of its contacts is computed.

    Parameters
    ----------
    i, j (pairs,) : numbers of the discs in spatial order, i < j before; i is the owner afterwards
    n : number of discs
    """
    owned = np.zeros(n, np.int32)
    for c in range(len(i)):
        a, b = i[c], j[c]
        if owned[a] >= 3 and owned[b] < owned[a] and b - a < 2 * PANEL_WIDTH:
            i[c], j[c] = b, a
            a = b
        owned[a] += 1


@njit(cache=True, nogil=True, error_model="numpy")
def reversal_signs(owner: np.ndarray, other: np.ndarray, old: np.ndarray) -> np.ndarray:
    """Return the sign by which history variables of pairs change, since the owner of some pairs has changed.

    Parameters
    ----------
    owner (old pairs,) : owner of each pair of the old list
    other (pairs,) : second disc of each pair of the new list, numbered in the same way
    old (pairs,) : number of the old pair, as returned by `find_pairs`

    Returns
    -------
    -1 (pairs,) for pairs whose owner has changed, 1 for all others.
    """
    sign = np.ones(len(old))
    for c in range(len(old)):
        if old[c] >= 0 and owner[old[c]] == other[c]:
            sign[c] = -1.0
    return sign


@njit(cache=True, nogil=True, error_model="numpy")
def carry_over(
    begin: int,
    end: int,
    before: tuple[np.ndarray, ...],
    old: np.ndarray,
    sign: np.ndarray,
    turns: np.ndarray,
    after: tuple[np.ndarray, ...],
) -> None:
    """Copy the history variables of the old list to a range of the pairs of the new list, and zero to new pairs.

    Parameters
    ----------
    begin, end : range of the pairs
    before, after : arrays of history variables, one value for every pair of the old and of the new list; ``after`` is
        filled here
    old (pairs,) : number of each pair in the old list, -1 for a new pair
    sign (pairs,) : -1 where the first and second disc of the pair have been exchanged, 1 elsewhere
    turns (arrays,) : whether the history variables of an array change sign with this exchange
    """
    for k in range(len(before)):
        memory, values, turning = before[k], after[k], turns[k]
        for c in range(begin, end):
            if old[c] < 0:
                values[c] = 0.0
            else:
                values[c] = memory[old[c]] * sign[c] if turning else memory[old[c]]
