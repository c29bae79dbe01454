"""Adapts a mesh to the answer on the last mesh: small cells where the ground yields, large cells elsewhere.

Plastic shear is concentrated in a band as narrow as the cells allow, and the limit load is too large in proportion to
the width of the band. So small cells are most useful in the band.
"""

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from meshes.edges import edges_of
from meshes.errors import InputError
from meshes.free import Sizes
from meshes.gmsh_model import free_mesh
from meshes.quad_mesh import QuadMesh
from meshes.quality import areas
from meshes.section.section import Section
from meshes.settings import MeshSettings

# The size of cells may grow by this much for each metre away from a smaller one: neighbours differ by a quarter.
GROWTH = 0.25
# Elastic ground may have cells this many times larger than the ordinary ones.
COARSER = 2.0
# No cell becomes more than this many times smaller at once: what is not resolved yet is not known that well.
FINER = 4.0
# Indicators below this share of the largest count as this share: elastic ground.
FLOOR = 1e-6
# gmsh makes about this many times as many quadrilaterals as sizes and areas say.
SURPLUS = 1.17
# Where it makes more than so many times as many as wanted, as thin bands and narrow layers may bring about, the mesh is
# made once more from as much larger sizes.
TOO_MANY = 1.4


def adapted(
    section: Section,
    settings: MeshSettings,
    mesh: QuadMesh,
    indicator: np.ndarray,
    cells: int,
    repeats: bool = False,
) -> QuadMesh:
    """Make a free mesh of a section with small cells where an indicator is large.

    The size of a new cell is proportional to one over the root of the indicator, so that the integral of the indicator
    is the same over each cell. If the indicator is zero everywhere, all cells have the same size.

    Parameters
    ----------
    section : Section
        The section.
    settings : MeshSettings
        Settings of the mesh; sizes in strata and towards lines remain upper limits.
    mesh : QuadMesh
        The last mesh of this section.
    indicator : array (cells of ``mesh``,)
        Indicator, not negative, such as the plastic shear strain of each cell.
    cells : int
        Approximate number of quadrilaterals.
    repeats : bool, optional
        Whether the sides are periodic. Periodic sides with the same layers get the same points.

    Returns
    -------
    QuadMesh

    Raises
    ------
    InputError
        If the indicator does not fit the mesh.
    BadMeshError
        If gmsh leaves a cell without a positive Jacobian.
    """
    indicator = np.asarray(indicator, dtype=float)
    if indicator.shape != (len(mesh.cells),) or not np.all(indicator >= 0.0):
        wish = f"expected {len(mesh.cells)} numbers that are not negative, one for each cell"
        raise InputError(section.name, [f"indicator of shape {indicator.shape}: {wish}"])
    largest = COARSER * settings.cell_size(section)
    triangles = np.concatenate([mesh.cells[:, [0, 1, 2]], mesh.cells[:, [0, 2, 3]]])
    scale = 1.0 / settings.refine

    def made(expected: float) -> QuadMesh:
        sizes = Sizes(
            largest,
            {name: scale * size for name, size in settings.sizes_in(section).items()},
            {name: scale * size for name, size in settings.towards_in(section).items()},
            mesh.points[triangles],
            wanted_sizes(mesh, indicator, expected, largest)[triangles],
            repeats=repeats,
        )
        return free_mesh(section, settings, sizes)

    first = made(cells / SURPLUS)
    if len(first.cells) <= TOO_MANY * cells:
        return first
    return made(cells / SURPLUS * cells / len(first.cells))


def wanted_sizes(mesh: QuadMesh, indicator: np.ndarray, cells: float, largest: float) -> np.ndarray:
    """Return the size (m) of new cells at the points (n,) of a mesh, so that about ``cells`` cells result. No size is
    above ``largest``.

    ``indicator`` (n,): values at the points of ``mesh``; cells are small where it is large.
    """
    area = areas(mesh.points, mesh.cells)
    least = np.sqrt(area) / FINER
    shape = np.maximum(indicator, FLOOR * indicator.max(initial=0.0)) if indicator.any() else np.ones_like(indicator)
    shape = (shape / shape.max()) ** -0.5
    low, high, growth = float(least.min()) / shape.max(), largest, Growth(mesh)
    for _ in range(40):  # halving the logarithm: to a millionth of any span of sizes
        middle = float(np.sqrt(low * high))
        sizes = growth.limited(np.clip(middle * shape, least, np.maximum(largest, least)))
        many = float((area / sizes[mesh.cells].mean(axis=1) ** 2).sum()) > cells
        low, high = (middle, high) if many else (low, middle)
    return sizes


class Growth:
    """Limits sizes at the points of a mesh, so that they grow by no more than GROWTH per metre from cell to cell.

    The limited sizes are the lengths of shortest paths, along edges and diagonals, from an additional point. The
    distance from this point to every other point is the wanted size at the other point.
    """

    def __init__(self, mesh: QuadMesh) -> None:
        self._cells, self._count = mesh.cells, len(mesh.points)
        around, _ = edges_of(mesh.cells)
        edges = np.concatenate([around, mesh.cells[:, [0, 2]], mesh.cells[:, [1, 3]]])
        lengths = np.hypot(*(mesh.points[edges[:, 0]] - mesh.points[edges[:, 1]]).T)
        points = np.arange(self._count)
        self._rows = np.concatenate([edges[:, 0], np.full(self._count, self._count)])
        self._columns = np.concatenate([edges[:, 1], points])
        self._growth = GROWTH * lengths

    def limited(self, sizes: np.ndarray) -> np.ndarray:
        """Return sizes (n,) at the points, at most the ``sizes`` (m,) of the cells around each point."""
        at_points = np.full(self._count, np.inf)
        np.minimum.at(at_points, self._cells.ravel(), np.repeat(sizes, 4))
        entries = np.concatenate([self._growth, at_points]), (self._rows, self._columns)
        graph = csr_array(entries, shape=(self._count + 1, self._count + 1))
        return np.asarray(dijkstra(graph, directed=False, indices=self._count)[: self._count])
