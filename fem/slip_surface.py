"""The slip surface of a state: the ridge of plastic shear strain in the ground that fails."""

from dataclasses import dataclass

import numpy as np

from fem.fields import State, is_mechanism
from meshes.quad_mesh import QuadMesh

# A cell is part of the ridge where its strain is above this share of the largest.
FAINT = 0.1
# A slip surface goes down, then up; the middles of its cells may deviate from that by this share of their heights.
SLACK = 0.75
# From one column to the next it goes by no more than this many cells up or down.
FARTHEST = 2.5


@dataclass(frozen=True)
class Column:
    """The cells of the ridge at one x, and the best line that ends in each of them; k cells.

    Attributes
    ----------
    x : float
        Where the column is (m).
    cells : ndarray (k,)
        Numbers of the cells.
    sums : ndarray (2, k)
        Sum over the best line that goes down throughout (0), or has begun to rise (1).
    before : ndarray (2, k)
        Where that line comes from: 2 j + phase for cell j of the column before, -1 if it begins here.
    """

    x: float
    cells: np.ndarray
    sums: np.ndarray
    before: np.ndarray


def slip_surface(mesh: QuadMesh, state: State, columns: int = 100) -> np.ndarray:
    """The ridge of plastic shear strain along x, (k, 2) in m; empty without a mechanism.

    Of all lines that go down and then up, with one cell in each column, it is the one with the largest sum of
    log(strain / faintest strain), found by dynamic programming.
    """
    if not is_mechanism(state):
        return np.zeros((0, 2))
    strain = state.plastic_shear_strain / state.plastic_shear_strain.max()
    corners = mesh.points[mesh.cells]
    middle, half = corners.mean(axis=1), np.ptp(corners[:, :, 0], axis=1) / 2.0
    height = np.ptp(corners[:, :, 1], axis=1)
    edges = np.linspace(mesh.points[:, 0].min(), mesh.points[:, 0].max(), columns + 1)
    chain: list[Column] = []
    for x in 0.5 * (edges[1:] + edges[:-1]):
        cells = np.flatnonzero((np.abs(middle[:, 0] - x) <= half) & (strain > FAINT))
        worth = np.log(strain[cells] / FAINT)
        last = chain[-1] if chain else None
        if last is None or not len(last.cells) or not len(cells):
            nothing = np.full((2, len(cells)), -1)
            chain.append(Column(float(x), cells, np.stack([worth, worth]), nothing))
            continue
        rise = middle[cells, 1][:, None] - middle[last.cells, 1][None, :]
        size = np.maximum(height[cells][:, None], height[last.cells][None, :])
        near, slack = np.abs(rise) <= FARTHEST * size, SLACK * size
        chain.append(_next(last, float(x), cells, worth, near & (rise <= slack), near & (rise >= -slack)))
    return _traced(chain, middle)


def _next(last: Column, x: float, cells: np.ndarray, worth: np.ndarray, falls: np.ndarray, rises: np.ndarray) -> Column:
    """The next column: from every cell (k,) back to those of the last (l,) that it may follow, falling or rising."""
    down = np.where(falls, last.sums[0][None, :], -np.inf)
    up = np.where(rises, last.sums.max(axis=0)[None, :], -np.inf)
    best = np.stack([down.max(axis=1), up.max(axis=1)])
    phase = last.sums.argmax(axis=0)[up.argmax(axis=1)]
    before = np.stack([2 * down.argmax(axis=1), 2 * up.argmax(axis=1) + phase])
    begins = best <= 0.0
    return Column(x, cells, np.where(begins, 0.0, best) + worth, np.where(begins, -1, before))


def _traced(chain: list[Column], middle: np.ndarray) -> np.ndarray:
    """The best line of all, from its end back to where it begins."""
    ends = [column.sums.max() if len(column.cells) else -np.inf for column in chain]
    at = int(np.argmax(ends))
    phase, cell = divmod(int(chain[at].sums.argmax()), len(chain[at].cells))
    line: list[tuple[float, float]] = []
    while True:
        column = chain[at]
        line.append((column.x, float(middle[column.cells[cell], 1])))
        before = int(column.before[phase, cell])
        if before < 0:
            return np.array(line[::-1])
        at, cell, phase = at - 1, before // 2, before % 2
