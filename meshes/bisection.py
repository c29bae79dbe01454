"""Bisects triangles at their longest edges (Rivara 1984): divides marked cells, and as few other cells as a
conforming mesh requires.

No angle becomes smaller than half of the smallest angle of the first mesh (Rosenberg & Stenger 1975), if lengths are
those of the plane. A metric that shortens lengths in one direction makes triangles that are as much longer there.
"""

import numpy as np

from meshes.triangles import TriMesh


def bisect(mesh: TriMesh, marked: np.ndarray, metric: np.ndarray | None = None) -> tuple[TriMesh, np.ndarray]:
    """Bisect cells at their longest edges, and as few other cells as a conforming mesh requires.

    Parameters
    ----------
    mesh : the triangles
    marked : cells to bisect, as numbers (k,) or a mask (m,)
    metric (m, 2, 2) : metric M of the cells: an edge d has the squared length d·M d, a mean of the cells on both of its
        sides; without a metric, lengths are those of the plane

    Returns
    -------
    The mesh, and the number of the old cell that contains each new cell.
    """
    rank = _rank(mesh, metric)
    longest = longest_edges(mesh, rank)
    cut = np.zeros(len(mesh.edges), dtype=bool)
    cut[longest[marked]] = True
    while True:  # a cell with a cut edge is first cut at its longest one
        more = longest[cut[mesh.cell_edges].any(axis=1) & ~cut[longest]]
        alike = _alike(mesh, cut)
        if not len(more) and alike.sum() == cut.sum():
            break
        cut = alike
        cut[more] = True
    return cut_edges(mesh, cut, rank)


def _alike(mesh: TriMesh, cut: np.ndarray) -> np.ndarray:
    """Return the edges to cut (a mask). Edges of one periodic side are cut together with their counterparts on the
    other side."""
    left, right = (mesh.edge_numbers(ends) for ends in mesh.matched)
    marked = cut.copy()
    marked[left] = marked[right] = cut[left] | cut[right]
    return marked


def fan_out(mesh: TriMesh, points: np.ndarray, widest: float) -> tuple[TriMesh, np.ndarray]:
    """Halve the cells with a wide angle at given points through these points.

    Bisection of the longest edges alone would never add cells at a point.

    Parameters
    ----------
    mesh : the triangles
    points (n,) : mask of the points
    widest : largest angle (rad) of a cell that is not halved

    Returns
    -------
    The mesh, and the number of the old cell that contains each new cell.
    """
    corners = mesh.points[mesh.cells]
    edges = np.roll(corners, -1, axis=1) - corners
    back = np.roll(corners, 1, axis=1) - corners
    cross = edges[..., 0] * back[..., 1] - edges[..., 1] * back[..., 0]
    angle = np.arctan2(cross, np.sum(edges * back, axis=-1))
    cut = np.zeros(len(mesh.edges), dtype=bool)
    cut[np.roll(mesh.cell_edges, -1, axis=1)[points[mesh.cells] & (angle > widest)]] = True
    return cut_edges(mesh, _alike(mesh, cut))


def cut_edges(mesh: TriMesh, cut: np.ndarray, rank: np.ndarray | None = None) -> tuple[TriMesh, np.ndarray]:
    """Cut edges (a mask) at their middles. Every cell is first cut at its longest marked edge, by the ``rank`` of the
    edges if it is given. Return the mesh, and the number of the old cell that contains each new cell."""
    rank = np.where(cut, _rank(mesh) if rank is None else rank, -1)[mesh.cell_edges]
    first = np.take_along_axis(mesh.cell_edges, np.argmax(rank, axis=1)[:, None], axis=1)[:, 0]
    middle = np.full(len(mesh.edges), -1)
    middle[cut] = len(mesh.points) + np.arange(np.count_nonzero(cut))
    points = np.vstack([mesh.points, mesh.points[mesh.edges[cut]].mean(axis=1)])
    cells, parent = _divided(mesh, first, middle)
    boundaries = {name: _divided_edges(ends, middle[mesh.edge_numbers(ends)]) for name, ends in mesh.boundaries.items()}
    return TriMesh(points, cells, mesh.stratum[parent], boundaries, mesh.repeats), parent


def longest_edges(mesh: TriMesh, rank: np.ndarray) -> np.ndarray:
    """Return the number of the longest edge of every cell, by the ``rank`` of all edges. Among equal edges,
    neighbouring cells take the same edge."""
    of_cells = rank[mesh.cell_edges]
    return np.take_along_axis(mesh.cell_edges, np.argmax(of_cells, axis=1)[:, None], axis=1)[:, 0]


def _rank(mesh: TriMesh, metric: np.ndarray | None = None) -> np.ndarray:
    """Return the rank of every edge in the order of lengths, with a ``metric`` of the mean of the lengths in both cells
    beside it. Rounding does not decide which of two equal edges comes first."""
    ends = mesh.points[mesh.edges]
    along = ends[:, 1] - ends[:, 0]
    length = np.sum(along**2, axis=1)
    if metric is not None:
        sides = np.where(mesh.edge_cells >= 0, mesh.edge_cells, mesh.edge_cells[:, :1])
        length = np.einsum("ea,esab,eb->e", along, metric[sides], along) / 2.0
    order = np.lexsort((-np.arange(len(length)), np.round(np.log(length), 9)))
    place = np.empty(len(length), dtype=np.int64)
    place[order] = np.arange(len(length))
    return place


def _divided(mesh: TriMesh, base: np.ndarray, middle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the cells, and the number of the old cell of each, after every cell was cut at its base edge and its
    halves at their own cut edges."""
    at = np.argmax(mesh.cell_edges == base[:, None], axis=1)
    rows = np.arange(len(mesh.cells))
    a, b, c = (mesh.cells[rows, (at + k) % 3] for k in range(3))
    m, ma, mb = (middle[mesh.cell_edges[rows, (at + k) % 3]] for k in (0, 2, 1))  # on ab, ca, bc
    whole = m < 0
    cells, parent = [np.stack([a, b, c], axis=1)[whole]], [rows[whole]]
    for first, second, third, half in ((c, a, m, ma), (b, c, m, mb)):
        once, twice = ~whole & (half < 0), ~whole & (half >= 0)
        cells.append(np.stack([first, second, third], axis=1)[once])
        cells.append(np.stack([first, half, third], axis=1)[twice])
        cells.append(np.stack([half, second, third], axis=1)[twice])
        parent += [rows[once], rows[twice], rows[twice]]
    return np.concatenate(cells), np.concatenate(parent)


def _divided_edges(ends: np.ndarray, middle: np.ndarray) -> np.ndarray:
    """Return edges (k, 2) of a boundary; each edge with a middle point is divided in two."""
    cut = middle >= 0
    start, end, mid = ends[cut, 0], ends[cut, 1], middle[cut]
    return np.concatenate([ends[~cut], np.column_stack([start, mid]), np.column_stack([mid, end])])


def split_at_middle(mesh: TriMesh, marked: np.ndarray) -> TriMesh:
    """Return the mesh with some cells divided into three at their middles.

    Parameters
    ----------
    mesh : the triangles
    marked (m,) : mask of the cells to divide

    Returns
    -------
    The mesh, with the divided cells last; the mesh itself if no cell is marked.
    """
    if not marked.any():
        return mesh
    centre = len(mesh.points) + np.arange(np.count_nonzero(marked))
    points = np.vstack([mesh.points, mesh.points[mesh.cells[marked]].mean(axis=1)])
    corners = mesh.cells[marked]
    parts = [np.column_stack([corners[:, k], corners[:, (k + 1) % 3], centre]) for k in range(3)]
    cells = np.concatenate([mesh.cells[~marked], *parts])
    stratum = np.concatenate([mesh.stratum[~marked], *[mesh.stratum[marked]] * 3])
    return TriMesh(points, cells, stratum, mesh.boundaries, mesh.repeats)
