"""Finds the strips of a mapped mesh, which are its columns and rows, and divides them along a mechanism.

Opposite edges of quadrilaterals follow each other through a strip of cells from boundary to boundary. In a mapped mesh
these strips are its columns and its rows. A strip that is cut lengthwise leaves all other strips unchanged.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from meshes.edges import edges_of
from meshes.quad_mesh import QuadMesh
from meshes.quality import areas


@dataclass(frozen=True, eq=False)
class Strips:
    """Holds the strips of a mesh of m cells and e edges.

    Attributes
    ----------
    edges (e, 2) : ends of the edges, the smaller point number first
    of_cell (m, 4) : numbers of the edges of every cell, from corner to corner
    of_edge (e,) : number of the strip that every edge lies across
    """

    edges: np.ndarray
    of_cell: np.ndarray
    of_edge: np.ndarray


def strips_of(mesh: QuadMesh) -> Strips:
    """Return the strips of a mesh."""
    edges, of_cell = edges_of(mesh.cells)
    opposite = np.concatenate([of_cell[:, [0, 2]], of_cell[:, [1, 3]]])
    graph = coo_array((np.ones(len(opposite)), opposite.T), shape=(len(edges), len(edges)))
    return Strips(edges, of_cell, connected_components(graph, directed=False)[1])


def with_finer_strips(mesh: QuadMesh, indicator: np.ndarray, cells: int) -> QuadMesh:
    """Return a mesh with columns and rows divided where division is most useful.

    The benefit of a cut is the indicator times area and width of the cells of the strip, per cell that the cut adds.

    Parameters
    ----------
    mesh : quadrilaterals in columns and rows
    indicator (m,) : indicator of each cell, not negative, such as plastic shear strain
    cells : number of cells that the mesh gets at least, if every strip divided once gives so many

    Returns
    -------
    The mesh.
    """
    strips = strips_of(mesh)
    size = areas(mesh.points, mesh.cells)
    length = np.hypot(*(mesh.points[strips.edges[:, 0]] - mesh.points[strips.edges[:, 1]]).T)
    strips_of_cell = strips.of_edge[strips.of_cell[:, :2]]
    width = 0.5 * (length[strips.of_cell[:, :2]] + length[strips.of_cell[:, 2:]])
    count = int(strips.of_edge.max()) + 1
    worth = np.bincount(strips_of_cell.ravel(), ((indicator * size)[:, None] * width).ravel(), minlength=count)
    added = np.bincount(strips_of_cell.ravel(), minlength=count)
    order = np.argsort(-worth / np.maximum(added, 1), kind="stable")
    selected = order[: 1 + int(np.searchsorted(np.cumsum(added[order]), cells - len(mesh.cells)))]
    return _halved(mesh, strips, np.isin(strips.of_edge, selected))


def _halved(mesh: QuadMesh, strips: Strips, marked: np.ndarray) -> QuadMesh:
    """Return the mesh in which the ``marked`` edges are halved. Opposite edges are marked together."""
    n, (a, b, c, d) = len(mesh.points), mesh.cells.T
    place = np.full(len(marked), -1)
    place[marked] = n + np.arange(np.count_nonzero(marked))
    first, second, third, fourth = place[strips.of_cell].T
    along, across = first >= 0, second >= 0
    both = along & across
    centre = np.full(len(mesh.cells), -1)
    centre[both] = n + np.count_nonzero(marked) + np.arange(np.count_nonzero(both))
    parts = (
        (~along & ~across, ((a, b, c, d),)),
        (along & ~across, ((a, first, third, d), (first, b, c, third))),
        (across & ~along, ((a, b, second, fourth), (fourth, second, c, d))),
        (both, ((a, first, centre, fourth), (first, b, second, centre), (centre, second, c, third),
                (fourth, centre, third, d))),
    )  # fmt: skip
    cells = [np.column_stack(corners)[which] for which, quads in parts for corners in quads]
    stratum = [mesh.stratum[which] for which, quads in parts for _ in quads]
    middles = mesh.points[strips.edges[marked]].mean(axis=1)
    centres = mesh.points[mesh.cells[both]].mean(axis=1)
    key = np.array([n, 1])

    def halves(boundary: np.ndarray) -> np.ndarray:
        between = place[np.searchsorted(strips.edges @ key, np.sort(boundary, axis=1) @ key)]
        whole = between < 0
        pairs = [np.column_stack([boundary[:, 0], between]), np.column_stack([between, boundary[:, 1]])]
        return np.concatenate([boundary[whole], *(pair[~whole] for pair in pairs)])

    return replace(
        mesh,
        points=np.vstack([mesh.points, middles, centres]),
        cells=np.concatenate(cells),
        stratum=np.concatenate(stratum),
        boundaries={name: halves(edges) for name, edges in mesh.boundaries.items()},
    )
