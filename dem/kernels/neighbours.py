"""Makes the neighbour list (kernel). A cell grid finds the pairs whose distance is below the sum of their radii plus a
margin, the skin.

The neighbour list is valid until some disc has moved half the margin. The list also contains every pair with a pore
spring, intact or cracked, at any distance. A cracked spring resists again when its discs return to the length of the
spring. If the cracked spring were removed from the list, the result would depend on the margin of the list.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from dem.kernels.device_function import device_function
from dem.kernels.period import NO_PERIOD, Period, folded, image

PANEL_WIDTH = 192  # discs across a panel of the spatial order: two rows of it stay in a core's cache


def spatial_order(x: np.ndarray, z: np.ndarray, spacing: float) -> np.ndarray:
    """Return the numbers of the discs, sorted by panels of x, then rows of z, then x.

    Parameters
    ----------
    x, z (n,) : positions (m)
    spacing : typical diameter (m): a panel is `PANEL_WIDTH` wide in it, a row sqrt(3)/2 high

    Returns
    -------
    Numbers (n,).
    """
    panel = np.floor((x - x.min()) / (PANEL_WIDTH * spacing))
    row = np.floor((z - z.min()) / (spacing * np.sqrt(0.75)) + 0.5)
    return np.lexsort((x, row, panel)).astype(np.int32)


class Near(NamedTuple):
    """Holds discs in spatial order, and the criterion of neighbours.

    Two discs are neighbours if their distance is below factor (r_i + r_j) + skin, and they are not both fixed.

    Attributes
    ----------
    x, z, radius (n,) : positions and radii (m)
    fixed (n,) : whether discs are fixed
    factor, skin : factor (-) and margin (m) of the criterion of neighbours
    period : period of the ground, longer than three times the largest distance of neighbours
    """

    x: np.ndarray
    z: np.ndarray
    radius: np.ndarray
    fixed: np.ndarray
    factor: float
    skin: float
    period: Period


class Grid(NamedTuple):
    """Holds discs sorted into cells, at most four cells for each disc. Cells are square unless their columns have to
    fill a period.

    Attributes
    ----------
    column, row (n,) : column and row of the cell of each disc
    columns, rows : numbers of columns and rows
    size, low : height of a cell, and elevation of the bottom of the lowest cell (m)
    start (cells + 1,) : first item of each cell, row by row from the left
    items (n,) : discs by cell
    places (n, 3) : positions and radii (m) in the order of `items`, so that neighbouring discs are adjacent in memory
    height (n,) : height of every disc, moved into the period of the grid (m)
    """

    column: np.ndarray
    row: np.ndarray
    columns: int
    rows: int
    size: float
    low: float
    start: np.ndarray
    items: np.ndarray
    places: np.ndarray
    height: np.ndarray


class Known(NamedTuple):
    """Holds the pairs of an old list by their lower number.

    Attributes
    ----------
    pair, higher (pairs,) : number of each pair, and number of its other disc
    start (n + 1,) : place at which the pairs of each lower number begin
    """

    pair: np.ndarray
    higher: np.ndarray
    start: np.ndarray


@njit(cache=True, nogil=True, error_model="numpy")
def cell_grid(near: Near) -> Grid:
    """Sort discs into cells that are no smaller than the largest distance of neighbours.

    Parameters
    ----------
    near : discs and criterion of neighbours

    Returns
    -------
    The cells. If the ground is periodic, their columns fill the period.
    """
    x, z, radius, period = near.x, near.z, near.radius, near.period
    n = len(x)
    xs, zs = folded(x, z, period)
    left, low = xs.min(), zs.min()
    width, height = xs.max() - left, zs.max() - low
    size = 2.0 * near.factor * radius.max() + near.skin
    while (width / size + 1.0) * (height / size + 1.0) > 4.0 * n + 64.0:
        size *= 1.5
    columns, rows = int(width / size) + 1, int(height / size) + 1
    across = size
    if period.length < NO_PERIOD.length:
        columns = max(int(period.length / size), 1)
        across = period.length / columns
    column = np.empty(n, np.int32)
    row = np.empty(n, np.int32)
    start = np.zeros(columns * rows + 1, np.int32)
    for i in range(n):
        column[i] = min(int((xs[i] - left) / across), columns - 1)
        row[i] = min(int((zs[i] - low) / size), rows - 1)
        start[row[i] * columns + column[i] + 1] += 1
    for c in range(columns * rows):
        start[c + 1] += start[c]
    free = start[:-1].copy()
    items = np.empty(n, np.int32)
    places = np.empty((n, 3))
    for i in range(n):
        c = row[i] * columns + column[i]
        e = free[c]
        items[e] = i
        places[e, 0], places[e, 1], places[e, 2] = x[i], z[i], radius[i]
        free[c] += 1
    return Grid(column, row, columns, rows, size, low, start, items, places, zs)


@njit(cache=True, nogil=True, error_model="numpy")
def known_pairs(i: np.ndarray, j: np.ndarray, number: np.ndarray) -> Known:
    """Return the pairs of an old list by their lower number in spatial order.

    Parameters
    ----------
    i, j (pairs,) : original numbers of the discs of each pair
    number (n,) : number of each disc in spatial order

    Returns
    -------
    The pairs, grouped by their lower number.
    """
    start = np.zeros(len(number) + 1, np.int32)
    for c in range(len(i)):
        start[min(number[i[c]], number[j[c]]) + 1] += 1
    for a in range(len(number)):
        start[a + 1] += start[a]
    free = start[:-1].copy()
    pair = np.empty(len(i), np.int32)
    higher = np.empty(len(i), np.int32)
    for c in range(len(i)):
        a, b = number[i[c]], number[j[c]]
        place = free[min(a, b)]
        pair[place], higher[place] = c, max(a, b)
        free[min(a, b)] += 1
    return Known(pair, higher, start)


@device_function(nogil=True)
def longer(array: np.ndarray, size: int) -> np.ndarray:
    """Return a copy of the array with space for `size` entries."""
    grown = np.empty(size, array.dtype)
    for k in range(len(array)):
        grown[k] = array[k]
    return grown


@device_function(nogil=True)
def sort_run(begin: int, end: int, key: np.ndarray, other: np.ndarray) -> None:
    """Sort `key` from begin to end, and `other` with it, so that equal slots of neighbouring discs hold contacts in the
    same direction.
    """
    for a in range(begin + 1, end):
        k, o = key[a], other[a]
        b = a
        while b > begin and key[b - 1] > k:
            key[b], other[b] = key[b - 1], other[b - 1]
            b -= 1
        key[b], other[b] = k, o


@device_function(nogil=True)
def near_pairs(begin: int, end: int, near: Near, grid: Grid) -> tuple[np.ndarray, np.ndarray]:
    """Find the neighbouring pairs i < j for `find_pairs`: first pair of each i, and the j of all pairs.

    begin, end: range of the numbers i; near: discs and distance of neighbours; grid: the discs sorted into cells.
    """
    # by name: a field of a tuple of arrays is counted as referred to at every use
    x, z, radius, fixed, factor, skin, period = near
    column, row, columns, rows = grid.column, grid.row, grid.columns, grid.rows
    start, items, places, height = grid.start, grid.items, grid.places, grid.height
    ends = period.length == NO_PERIOD.length
    room = 4 * (end - begin) + 16
    first = np.empty(end - begin + 1, np.int32)
    others = np.empty(room, np.int32)
    count = 0
    for i in range(begin, end):
        first[i - begin] = count
        xi, zi, ri, still = x[i], z[i], radius[i], fixed[i]
        # a row of cells at a time; across the sides of a period a column at a time
        for side in range(0 if ends else -1, 1 if ends else 2):
            left, right, middle = column[i] + side, column[i] + side, row[i]
            if ends:
                left, right = max(left - 1, 0), min(right + 1, columns - 1)
            elif left < 0 or left >= columns:
                # neighbours beyond a side are listed at the other one, higher or lower by the rise
                left -= side * columns
                right = left
                middle = int(np.floor((height[i] - side * period.rise - grid.low) / grid.size))
            for line in range(max(middle - 1, 0), min(middle + 2, rows)):
                begins, ends_at = start[line * columns + left], start[line * columns + right + 1]
                if count + ends_at - begins > room:
                    room += room // 2 + ends_at - begins
                    others = longer(others, room)
                for e in range(begins, ends_at):
                    j = items[e]
                    reach = factor * (ri + places[e, 2]) + skin
                    dx, dz = image(places[e, 0] - xi, places[e, 1] - zi, period)
                    # written in any case and kept if near: which it will be, no processor guesses
                    others[count] = j
                    count += (j > i) & (dx * dx + dz * dz < reach * reach) & (not (still and fixed[j]))
    first[-1] = count
    return first, others[:count]


@njit(cache=True, nogil=True, error_model="numpy")
def find_pairs(
    begin: int, end: int, near: Near, grid: Grid, known: Known, old_length: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Find all neighbouring pairs, and the old pairs with a pore spring, for a range of the lower numbers.

    Parameters
    ----------
    begin, end : range of the lower numbers
    near : discs and criterion of neighbours
    grid : the discs sorted into cells
    known : old pairs, by their numbers in spatial order
    old_length (old pairs,) : length of their pore springs (m), 0 without one

    Returns
    -------
    Numbers i < j (pairs,) in spatial order, sorted by both, and the number of the old pair with the same discs, -1 for
    a new pair.
    """
    listed, others = near_pairs(begin, end, near, grid)
    pair, higher, old_start = known.pair, known.higher, known.start
    room = len(others) + old_start[end] - old_start[begin]
    first, second, old = np.empty(room, np.int32), np.empty(room, np.int32), np.empty(room, np.int32)
    used = np.zeros(old_start[end] - old_start[begin], np.bool_)
    count = np.int64(0)
    for i in range(begin, end):
        start = count
        for j in others[listed[i - begin] : listed[i - begin + 1]]:
            match = -1
            for o in range(old_start[i], old_start[i + 1]):
                if higher[o] == j:
                    match = pair[o]
                    used[o - old_start[begin]] = True
            first[count], second[count], old[count] = i, j, match
            count += 1
        for o in range(old_start[i], old_start[i + 1]):
            if not used[o - old_start[begin]] and old_length[pair[o]] != 0.0:
                first[count], second[count], old[count] = i, higher[o], pair[o]
                count += 1
        sort_run(start, count, second, old)
    return first[:count].copy(), second[:count].copy(), old[:count].copy()


def pairs_within(
    x: np.ndarray, z: np.ndarray, radius: np.ndarray, fixed: np.ndarray, skin: float, period: Period
) -> tuple[np.ndarray, np.ndarray]:
    """Find all pairs of discs that are nearer than the sum of their radii and a margin, and not both fixed.

    Parameters
    ----------
    x, z (n,) : positions (m)
    radius (n,) : radii (m)
    fixed (n,) : whether discs are fixed
    skin : margin (m)
    period : length along x and rise along z of a period (m)

    Returns
    -------
    Numbers i < j (pairs,), sorted by both.
    """
    none = np.zeros(0, np.int32)
    near = Near(x, z, radius, fixed, 1.0, skin, period)
    known = known_pairs(none, none, np.zeros(len(x), np.int32))
    i, j, _ = find_pairs(0, len(x), near, cell_grid(near), known, np.zeros(0))
    return i, j


@njit(cache=True, nogil=True, error_model="numpy")
def find_lines(
    x: np.ndarray, z: np.ndarray, radius: np.ndarray, fixed: np.ndarray, skin: float, lines: np.ndarray, depth: float
) -> tuple[np.ndarray, np.ndarray]:
    """Find all free discs that can touch a rigid line: less than r + skin in front of the line, or behind it.

    Parameters
    ----------
    x, z (n,) : positions (m)
    radius (n,) : radii (m)
    fixed (n,) : whether discs are fixed
    skin : margin of the neighbour list (m), also beyond the ends of the line
    lines (k, 6) : point, inward normal, begin and end along the line (m), see `DiscState`
    depth : largest distance behind a line at which the line still acts on a disc (m)

    Returns
    -------
    Numbers of disc and line (contacts,), sorted by both.
    """
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
