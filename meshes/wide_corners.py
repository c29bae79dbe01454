"""Moves single nodes inside a stratum so that narrow and flat corners of cells become wider.

Free meshes have a few narrow corners where lines meet at a small angle, such as a water table and the bottom of a
layer. The width of a corner is its angle or 180° less its angle, whichever is smaller. Nodes on interfaces and
boundaries stay. Another node goes where the smallest width in its cells is largest, by a pattern search (Hooke & Jeeves
1961, J. ACM 8, 212-229), so that no corner of these cells becomes narrower or flatter than the worst was.
"""

from dataclasses import replace

import numpy as np

from meshes.quad_mesh import QuadMesh
from meshes.quality import corner_angles

SWEEPS = 4  # over all nodes of cells with a narrow corner
MOST_CELLS = 400  # with a narrow corner; the widest of more stay as they are
FIRST_STEP, STEPS = 0.25, 6  # of the shortest edge at a node; how often the step is halved
DIRECTIONS = np.stack([np.cos(np.pi * np.arange(8) / 4.0), np.sin(np.pi * np.arange(8) / 4.0)], axis=1)


def with_wider_corners(mesh: QuadMesh, narrow: float) -> QuadMesh:
    """Return the mesh with wider corners where cells have corners below a width.

    Parameters
    ----------
    mesh : QuadMesh
        A mesh without folded cells.
    narrow : float
        Width of their narrowest corner (deg) from which on cells stay as they are.

    Returns
    -------
    The mesh with the same cells, and some nodes elsewhere.
    """
    points, movable = mesh.points.copy(), _inside(mesh)
    cells_of = _cells_of(mesh.cells)
    for _ in range(SWEEPS):
        smallest = corner_widths(points, mesh.cells).min(axis=1)
        worst = np.argsort(smallest, kind="stable")[:MOST_CELLS]
        nodes = [node for cell in worst[smallest[worst] < narrow] for node in mesh.cells[cell] if movable[node]]
        moved = [_move(points, node, mesh.cells[cells_of[node]]) for node in dict.fromkeys(nodes)]
        if not any(moved):
            break
    return replace(mesh, points=points)


def corner_widths(points: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Return the angles (cells, 4) in degrees in the corners of cells, or 180 less the angle where this is smaller."""
    angles = corner_angles(points, cells)
    return np.minimum(angles, 180.0 - angles)


def _inside(mesh: QuadMesh) -> np.ndarray:
    """Return the mask of the nodes whose cells are of one stratum, and that lie on no boundary."""
    low, high = np.full(len(mesh.points), len(mesh.strata)), np.full(len(mesh.points), -1)
    for corner in mesh.cells.T:
        np.minimum.at(low, corner, mesh.stratum)
        np.maximum.at(high, corner, mesh.stratum)
    inside = low == high
    for edges in mesh.boundaries.values():
        inside[edges.ravel()] = False
    return inside


def _cells_of(cells: np.ndarray) -> list[np.ndarray]:
    """Return the numbers of the cells at every node."""
    order = np.argsort(cells.ravel(), kind="stable")
    nodes = cells.ravel()[order]
    return np.split(order // cells.shape[1], np.searchsorted(nodes, np.arange(1, int(nodes[-1]) + 1)))


def _move(points: np.ndarray, node: int, cells: np.ndarray) -> bool:
    """Move a node to where the narrowest corner of its ``cells`` is widest; return whether it has moved."""

    def narrowest_at(place: np.ndarray) -> float:
        points[node] = place
        return float(corner_widths(points, cells).min())

    around = np.setdiff1d(cells, node)
    place = began = points[node].copy()
    best = narrowest_at(place)
    step = FIRST_STEP * float(np.hypot(*(points[around] - place).T).min())
    for _ in range(STEPS):
        tries = place + step * DIRECTIONS
        angles = [narrowest_at(each) for each in tries]
        better = int(np.argmax(angles))
        if angles[better] > best:
            place, best = tries[better], angles[better]
        else:
            step *= 0.5
    points[node] = place
    return not np.array_equal(place, began)
