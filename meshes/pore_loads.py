"""Computes pore pressures on triangles: at their corners, and the edges across which the pressure jumps."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from meshes.triangles import TriMesh

# Pressure (k,) in Pa at points (k, 2) in m, with points near them and their strata.
Pressure = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]
# Jumps of this share of the largest pore pressure are rounding.
SAME_PRESSURE = 1e-12


class EdgeJumps(NamedTuple):
    """Holds the k inner edges across which the pore pressure jumps.

    Attributes
    ----------
    edges (k,) : numbers of the jump edges in the mesh
    ends (k, 2) : numbers of the end points of each edge
    traction (k, 2 ends, 2) : traction on the skeleton (Pa) that does not depend on a load multiplier. It acts away from
        the first cell of ``TriMesh.edge_cells`` if the pressure in that cell is larger.
    live (k, 2 ends, 2) : traction on the skeleton (Pa) that is multiplied by the load multiplier
    """

    edges: np.ndarray
    ends: np.ndarray
    traction: np.ndarray
    live: np.ndarray


def corner_pressure(mesh: TriMesh, pressure: Pressure | None) -> np.ndarray:
    """Return a pressure at the corners of every cell, on the inner side of the cell.

    Parameters
    ----------
    mesh : the triangles
    pressure : function of points (k, 2) in m, points inside the cells near them, and strata (k,); None for no pressure

    Returns
    -------
    Pressure (m, 3) in Pa; zero without pressure.
    """
    if pressure is None:
        return np.zeros(mesh.cells.shape)
    corners = mesh.points[mesh.cells]
    near = np.repeat(corners.mean(axis=1), 3, axis=0)
    return pressure(corners.reshape(-1, 2), near, np.repeat(mesh.stratum, 3)).reshape(-1, 3)


def outward_normals(mesh: TriMesh, cells: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Return the unit normals of edges that point out of their cells.

    Parameters
    ----------
    mesh : the triangles
    cells (k,) : number of the cell of each edge
    ends (k, 2) : numbers of the end points of each edge

    Returns
    -------
    Normals (k, 2).
    """
    along = mesh.points[ends[:, 1]] - mesh.points[ends[:, 0]]
    normal = np.column_stack([along[:, 1], -along[:, 0]]) / np.hypot(*along.T)[:, None]
    outwards = mesh.points[ends[:, 0]] - mesh.points[mesh.cells[cells]].mean(axis=1)
    return normal * np.sign(np.sum(normal * outwards, axis=1))[:, None]


def at_ends(mesh: TriMesh, values: np.ndarray, cells: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Return values at the ends of edges, from values at the corners of all cells.

    Parameters
    ----------
    mesh : the triangles
    values (m, 3) : values at the corners of every cell
    cells (k,) : number of the cell of each edge
    ends (k, 2) : numbers of the end points of each edge

    Returns
    -------
    Values (k, 2).
    """
    corner = np.argmax(mesh.cells[cells][:, None, :] == ends[:, :, None], axis=2)
    return values[cells[:, None], corner]


def edge_jumps(mesh: TriMesh, pressure: np.ndarray) -> EdgeJumps:
    """Find the inner edges across which a pressure jumps.

    Parameters
    ----------
    mesh : the triangles
    pressure (m, 3) : pressure at the corners of every cell (Pa)

    Returns
    -------
    The edges, with the traction that acts on the skeleton there (Pa).
    """
    interior = np.flatnonzero(mesh.edge_cells[:, 1] >= 0)
    ends = mesh.edges[interior]
    first, second = (at_ends(mesh, pressure, mesh.edge_cells[interior, side], ends) for side in (0, 1))
    jump = first - second
    jumping = np.abs(jump).max(axis=1) > SAME_PRESSURE * np.abs(pressure).max(initial=0.0)
    normal = outward_normals(mesh, mesh.edge_cells[interior[jumping], 0], ends[jumping])
    traction = jump[jumping][:, :, None] * normal[:, None, :]
    return EdgeJumps(interior[jumping], ends[jumping], traction, np.zeros_like(traction))
