"""Kernel: who can touch whom. A cell grid finds the pairs closer than the sum of their radii and a skin.

The list holds until some disc has moved half the skin. It also holds every pair with a pore spring, whole or
cracked, at whatever distance: a cracked spring resists again when the discs come back to its length, so forgetting it
would make the result depend on the skin. Springs' memory is carried over as it stands.
"""

import numpy as np
from numba import njit

from dem.kernels.inner import inner
from dem.kernels.period import ENDLESS, Period, folded, image

PANEL = 192  # discs across a panel of the spatial order: two rows of it stay in a core's cache


def spatial_order(x: np.ndarray, z: np.ndarray, spacing: float) -> np.ndarray:
    """Numbers of the discs, sorted by panels of x, then rows of z, then x; spacing: typical diameter (m)."""
    panel = np.floor((x - x.min()) / (PANEL * spacing))
    row = np.floor((z - z.min()) / (spacing * np.sqrt(0.75)) + 0.5)
    return np.lexsort((x, row, panel)).astype(np.int32)


@inner(nogil=True)
def cell_grid(
    x: np.ndarray, z: np.ndarray, size: float, length: float
) -> tuple[np.ndarray, np.ndarray, int, int, float, np.ndarray, np.ndarray]:
    """Discs sorted into cells no smaller than `size` (m), and at most four cells a disc; square, but where the columns
    have to fill a period of this length.

    Returns (column of each disc, row of each disc, columns, rows, their height (m), first item of each cell, items).
    """
    n = len(x)
    left, low = x.min(), z.min()
    width, height = x.max() - left, z.max() - low
    while (width / size + 1.0) * (height / size + 1.0) > 4.0 * n + 64.0:
        size *= 1.5
    columns, rows = int(width / size) + 1, int(height / size) + 1
    across = size
    if length < ENDLESS.length:
        columns = max(int(length / size), 1)
        across = length / columns
    column = np.empty(n, np.int32)
    row = np.empty(n, np.int32)
    start = np.zeros(columns * rows + 1, np.int32)
    for i in range(n):
        column[i] = min(int((x[i] - left) / across), columns - 1)
        row[i] = min(int((z[i] - low) / size), rows - 1)
        start[row[i] * columns + column[i] + 1] += 1
    for c in range(columns * rows):
        start[c + 1] += start[c]
    free = start[:-1].copy()
    items = np.empty(n, np.int32)
    for i in range(n):
        c = row[i] * columns + column[i]
        items[free[c]] = i
        free[c] += 1
    return column, row, columns, rows, size, start, items


@inner(nogil=True)
def sort_by_lower(i: np.ndarray, j: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Order of pairs by their lower number, and where each number's pairs begin."""
    start = np.zeros(n + 1, np.int32)
    for c in range(len(i)):
        start[min(i[c], j[c]) + 1] += 1
    for a in range(n):
        start[a + 1] += start[a]
    free = start[:-1].copy()
    by_lower = np.empty(len(i), np.int32)
    for c in range(len(i)):
        a = min(i[c], j[c])
        by_lower[free[a]] = c
        free[a] += 1
    return by_lower, start


@inner(nogil=True)
def longer(array: np.ndarray, size: int) -> np.ndarray:
    """A copy with room for `size` entries."""
    grown = np.empty(size, array.dtype)
    for k in range(len(array)):
        grown[k] = array[k]
    return grown


@inner(nogil=True)
def sort_run(begin: int, end: int, key: np.ndarray, other: np.ndarray) -> None:
    """Sorts a short stretch of `key`, and `other` with it: slots then point in one direction along a row of discs."""
    for a in range(begin + 1, end):
        k, o = key[a], other[a]
        b = a
        while b > begin and key[b - 1] > k:
            key[b], other[b] = key[b - 1], other[b - 1]
            b -= 1
        key[b], other[b] = k, o


@inner(nogil=True)
def near_pairs(
    x: np.ndarray, z: np.ndarray, radius: np.ndarray, fixed: np.ndarray, factor: float, skin: float, period: Period
) -> tuple[np.ndarray, np.ndarray]:
    """All pairs i < j nearer than factor (r_i + r_j) + skin, not both fixed: where those of each i begin, and all j.

    A period must be longer than three such distances.
    """
    xs, zs = folded(x, z, period)
    low = zs.min()
    reach = 2.0 * factor * radius.max() + skin
    column, row, columns, rows, size, start, items = cell_grid(xs, zs, reach, period.length)
    room = 4 * len(x) + 16
    begin = np.empty(len(x) + 1, np.int32)
    others = np.empty(room, np.int32)
    count = 0
    for i in range(len(x)):
        begin[i] = count
        for side in range(-1, 2):
            c, middle = column[i] + side, row[i]
            if c < 0 or c >= columns:
                if period.length == ENDLESS.length:
                    continue
                # neighbours beyond a side are listed at the other one, higher or lower by the rise
                c -= side * columns
                middle = int(np.floor((zs[i] - side * period.rise - low) / size))
            for cell in range(max(middle - 1, 0) * columns + c, min(middle + 2, rows) * columns + c, columns):
                for e in range(start[cell], start[cell + 1]):
                    j = items[e]
                    if j <= i or (fixed[i] and fixed[j]):
                        continue
                    reach = factor * (radius[i] + radius[j]) + skin
                    dx, dz = image(x[j] - x[i], z[j] - z[i], period)
                    if dx * dx + dz * dz >= reach * reach:
                        continue
                    if count == room:
                        room += room // 2
                        others = longer(others, room)
                    others[count] = j
                    count += 1
    begin[-1] = count
    return begin, others[:count]


@njit(cache=True, nogil=True, error_model="numpy")
def find_pairs(
    x: np.ndarray,
    z: np.ndarray,
    radius: np.ndarray,
    fixed: np.ndarray,
    factor: float,
    skin: float,
    old_i: np.ndarray,
    old_j: np.ndarray,
    old_length: np.ndarray,
    period: Period,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """All pairs nearer than factor (r_i + r_j) + skin, not both fixed, and the old ones with a pore spring.

    Arrays in spatial order; old pairs by their numbers in it. Returns (i, j, old) with i < j, sorted by both; old is
    the number of the old pair with the same discs, or -1.
    """
    near, others = near_pairs(x, z, radius, fixed, factor, skin, period)
    by_lower, old_start = sort_by_lower(old_i, old_j, len(x))
    room = len(others) + len(old_i)
    first = np.empty(room, np.int32)
    second = np.empty(room, np.int32)
    known = np.empty(room, np.int32)
    used = np.zeros(len(old_i), np.bool_)
    count = np.int64(0)
    for i in range(len(x)):
        begin = count
        for j in others[near[i] : near[i + 1]]:
            match = -1
            for o in range(old_start[i], old_start[i + 1]):
                if max(old_i[by_lower[o]], old_j[by_lower[o]]) == j:
                    match = by_lower[o]
                    used[match] = True
            first[count], second[count], known[count] = i, j, match
            count += 1
        for o in range(old_start[i], old_start[i + 1]):
            c = by_lower[o]
            if not used[c] and old_length[c] != 0.0:
                first[count], second[count], known[count] = i, max(old_i[c], old_j[c]), c
                count += 1
        sort_run(begin, count, second, known)
    return first[:count].copy(), second[:count].copy(), known[:count].copy()


@njit(cache=True, nogil=True, error_model="numpy")
def share_out(i: np.ndarray, j: np.ndarray, n: int) -> None:
    """Gives every pair to one of its discs, so that few own more than three; swaps it there. Owners come first.

    Three is the mean of a triangular lattice; lanes of a slice without a contact are computed in vain. Owners stay near
    their partners in the order, for a slice can move only once the last owner of its contacts has been through.
    """
    owned = np.zeros(n, np.int32)
    for c in range(len(i)):
        a, b = i[c], j[c]
        if owned[a] >= 3 and owned[b] < owned[a] and b - a < 2 * PANEL:
            i[c], j[c] = b, a
            a = b
        owned[a] += 1


@njit(cache=True, nogil=True, error_model="numpy")
def find_lines(
    x: np.ndarray, z: np.ndarray, radius: np.ndarray, fixed: np.ndarray, skin: float, lines: np.ndarray, depth: float
) -> tuple[np.ndarray, np.ndarray]:
    """(disc, line) of all discs that a rigid line can touch: less than r + skin before it, or behind it."""
    n = 0
    disc = np.empty(64, np.int32)
    which = np.empty(64, np.int32)
    for i in range(len(x)):
        for k in range(len(lines)):
            px, pz = x[i] - lines[k, 0], z[i] - lines[k, 1]
            before = px * lines[k, 2] + pz * lines[k, 3]
            along = pz * lines[k, 2] - px * lines[k, 3]
            if fixed[i] or before >= radius[i] + skin or before < -depth:
                continue
            if along < lines[k, 4] - skin or along > lines[k, 5] + skin:
                continue
            if n == len(disc):
                disc, which = longer(disc, 2 * n), longer(which, 2 * n)
            disc[n], which[n] = i, k
            n += 1
    return disc[:n].copy(), which[:n].copy()
