"""Makes triangles of a section for limit analysis by gmsh, which conform to every interface and have named
boundaries."""

from dataclasses import dataclass
from functools import cached_property

import gmsh
import numpy as np

from meshes.edges import edges_of
from meshes.free import Sizes, build_triangles
from meshes.gmsh_model import group_nodes, refuse_bare_ground, session
from meshes.quad_mesh import BadMeshError
from meshes.section.naming import BOUNDARIES, group_names
from meshes.section.section import Section

GMSH_TRIANGLE, GMSH_LINE = 2, 1


# Sizes that are tried, over the requested ones: if Delaunay's algorithm fails, slightly smaller cells often succeed.
SCALES = (1.0, 0.83, 0.61, 0.4)


@dataclass(frozen=True, eq=False)
class TriMesh:
    """Holds a mesh of triangles; edge j of a cell goes from its corner j to the next.

    Attributes
    ----------
    points : array (n, 2)
        Coordinates of the corners (m).
    cells : array (m, 3)
        Indices of the corners of every triangle, counter-clockwise.
    stratum : array (m,)
        Index of the stratum of every triangle.
    boundaries : dict of str to array (k, 2)
        Edges of every named boundary.
    repeats : bool
        Whether the section is periodic: its left and right side have the same edges up to a shift.
    """

    points: np.ndarray
    cells: np.ndarray
    stratum: np.ndarray
    boundaries: dict[str, np.ndarray]
    repeats: bool = False

    @cached_property
    def areas(self) -> np.ndarray:
        """Return the area (m²) of every cell, positive."""
        a, b, c = (self.points[self.cells[:, k]] for k in range(3))
        return 0.5 * ((b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0]))

    @cached_property
    def _numbered(self) -> tuple[np.ndarray, np.ndarray]:
        return edges_of(self.cells)

    @property
    def edges(self) -> np.ndarray:
        """Return the edges (e, 2), each once, its lower point first."""
        return self._numbered[0]

    @property
    def cell_edges(self) -> np.ndarray:
        """Return the numbers of the edges of every cell, (m, 3)."""
        return self._numbered[1]

    @cached_property
    def edge_cells(self) -> np.ndarray:
        """Return the cells on either side of every edge, (e, 2), the second -1 on the outline."""
        order = np.argsort(self.cell_edges.ravel(), kind="stable")
        edge, cell = self.cell_edges.ravel()[order], order // 3
        first = np.concatenate([[True], edge[1:] != edge[:-1]])
        sides = np.full((len(self.edges), 2), -1)
        sides[:, 0] = cell[first]
        sides[edge[~first], 1] = cell[~first]
        return sides

    @property
    def six_nodes(self) -> np.ndarray:
        """Return the nodes of quadratic triangles (m, 6): corners, then middles of edges, numbered after the points."""
        return np.hstack([self.cells, len(self.points) + self.cell_edges])

    @cached_property
    def gradients(self) -> np.ndarray:
        """Return the gradients (m, 3, 2) of the three area coordinates of every cell (1/m)."""
        corners = self.points[self.cells]
        opposite = np.roll(corners, 1, axis=1) - np.roll(corners, -1, axis=1)
        normals = np.stack([-opposite[..., 1], opposite[..., 0]], axis=-1)
        return normals / (2.0 * self.areas)[:, None, None]

    def edge_numbers(self, ends: np.ndarray) -> np.ndarray:
        """Return the numbers of edges given by their end points (k, 2)."""
        span = len(self.points)
        key = np.sort(ends, axis=1) @ np.array([span, 1])
        return np.searchsorted(self.edges @ np.array([span, 1]), key)

    @cached_property
    def matched(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the end points (k, 2) of the edges of the left side, and of the corresponding edges of the right side,
        upwards; nothing unless the section repeats."""
        pairs = []
        for name in ("left", "right"):
            ends = self.boundaries[name] if self.repeats else np.empty((0, 2), dtype=np.int64)
            upwards = np.argsort(self.points[ends, 1], axis=1)
            ends = np.take_along_axis(ends, upwards, axis=1)
            pairs.append(ends[np.argsort(self.points[ends[:, 0], 1])])
        return pairs[0], pairs[1]

    @cached_property
    def own_node(self) -> np.ndarray:
        """Return the number of each node of quadratic triangles; on periodic sides the right side has the numbers of
        the left."""
        nodes = np.arange(len(self.points) + len(self.edges))
        left, right = self.matched
        nodes[right] = left
        nodes[len(self.points) + self.edge_numbers(right)] = len(self.points) + self.edge_numbers(left)
        return nodes

    def moved(self, shift: np.ndarray, scale: float) -> "TriMesh":
        """Return a copy of the mesh with its points at ``(points - shift) / scale``."""
        return TriMesh((self.points - shift) / scale, self.cells, self.stratum, self.boundaries, self.repeats)


def triangulate(section: Section, size: float, sizes: dict[str, float] | None = None, repeats: bool = False) -> TriMesh:
    """Mesh a section with triangles.

    Parameters
    ----------
    section : Section
        The section to be meshed.
    size : float
        Approximate length of edges (m).
    sizes : dict of str to float, optional
        Other lengths (m) in strata, by name.
    repeats : bool
        Whether the section is periodic, so that both sides have the same edges.

    Returns
    -------
    TriMesh

    Raises
    ------
    BadMeshError
        If gmsh makes no triangles of about that size.
    """
    failure: BadMeshError | None = None
    for scale in SCALES:
        try:
            return _triangulated(section, Sizes(size, sizes or {}).times(scale), repeats)
        except BadMeshError as error:
            failure = failure or error
    assert failure is not None
    raise failure


def _triangulated(section: Section, sizes: Sizes, repeats: bool) -> TriMesh:
    """Return the triangles of these sizes. Raises BadMeshError if gmsh gives up, or leaves a hole or a flat cell."""
    with session(section.name):
        try:
            build_triangles(section, sizes, repeats)
        except Exception as error:  # gmsh raises plain Exception with its last error message
            raise BadMeshError(f"gmsh gave up: {error}") from error
        mesh = _from_gmsh(section, repeats)
    worst = int(np.argmin(mesh.areas))
    if mesh.areas[worst] <= 0.0:
        x, z = mesh.points[mesh.cells[worst]].mean(axis=0)
        raise BadMeshError(f"gmsh made a triangle without area near x = {x:.2f} m, z = {z:.2f} m")
    return mesh


def _from_gmsh(section: Section, repeats: bool) -> TriMesh:
    """Return the meshed gmsh model as arrays, its points numbered from 0 without gaps."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    groups = group_names([layer.name for layer in section.strata])
    parts = [group_nodes(2, group, GMSH_TRIANGLE, 3) for group in groups]
    triangles = np.concatenate(parts)
    boundaries = {name: group_nodes(1, name, GMSH_LINE, 2) for name in BOUNDARIES}
    refuse_bare_ground(triangles, np.concatenate(list(boundaries.values())), tags, coordinates)
    used = np.unique(triangles)
    points = coordinates.reshape(-1, 3)[np.argsort(tags)][np.searchsorted(np.sort(tags), used), :2]
    cells = np.searchsorted(used, triangles)
    a, b, c = (points[cells[:, k]] for k in range(3))
    clockwise = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) < (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    cells[clockwise] = cells[clockwise][:, ::-1]
    return TriMesh(
        points=points,
        cells=cells,
        stratum=np.repeat(np.arange(len(parts)), [len(part) for part in parts]),
        boundaries={name: np.searchsorted(used, ends).reshape(-1, 2) for name, ends in boundaries.items()},
        repeats=repeats,
    )
