"""Contains every difference between dolfinx 0.5 (bookworm), 0.9 (trixie) and 0.11 (sid)."""

import logging
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from meshes.errors import InputError
from meshes.executor import is_interrupt

OLDEST_VERSION = (0, 5)
INSTALLATION_HINT = (
    "on Debian and Ubuntu: apt-get install python3-dolfinx, with a virtual environment that sees it "
    "(make setup does both); elsewhere: conda install -c conda-forge fenics-dolfinx"
)

# gmsh numbers the corners of a quadrilateral round it, dolfinx along the axes of the reference square.
TENSOR_ORDER = np.array([0, 1, 3, 2])
# Corners of the reference square in dolfinx's order, and the corners of its four edges.
REFERENCE_CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])
REFERENCE_EDGES = ((0, 1), (0, 2), (1, 3), (2, 3))


@contextmanager
def _symbols_to_themselves() -> Iterator[None]:
    """Make later libraries load with private symbols.

    After import of dolfinx 0.5, Python loads libraries with public symbols (RTLD_GLOBAL). Then other libraries call
    parts of Pillow's HarfBuzz in place of the system's HarfBuzz, and the mixture of both crashes.
    """
    flags = sys.getdlopenflags()
    try:
        yield
    finally:
        sys.setdlopenflags(flags)


def require() -> None:
    """Refuse to continue unless dolfinx is installed and recent enough.

    Raises
    ------
    InputError
        With instructions of installation.
    """
    try:
        with _symbols_to_themselves():
            import dolfinx
    except ImportError as error:
        if is_interrupt(error):
            raise KeyboardInterrupt from None
        raise InputError("dolfinx", [f"cannot be imported ({error}); {INSTALLATION_HINT}"]) from None
    version = tuple(int(part) for part in dolfinx.__version__.split(".")[:2])
    if version < OLDEST_VERSION:
        raise InputError(
            "dolfinx", [f"version {dolfinx.__version__} is too old; expected 0.5 or newer; {INSTALLATION_HINT}"]
        )


@dataclass(frozen=True)
class RankDistribution:
    """Holds the share of a mesh, and of a scalar Lagrange space on it, on this MPI rank; nc cells.

    Attributes
    ----------
    cell (nc,) : numbers of the cells in the undistributed mesh
    corners (nc, 4) : numbers of the corners of the cells in the undistributed mesh, in the order of dolfinx
    nodes (nc, nodes of an element) : global numbers of the nodes of the space
    total, owned : number of nodes of all ranks, and of this rank
    """

    cell: np.ndarray
    corners: np.ndarray
    nodes: np.ndarray
    total: int
    owned: int


def distribute(comm: Any, points: np.ndarray, cells: np.ndarray, degree: int) -> RankDistribution:
    """Distribute quadrilaterals among the ranks, and number the nodes of a scalar Lagrange space on them.

    Parameters
    ----------
    comm : MPI communicator
    points (n, 2) : coordinates of the corners (m), read on the first rank
    cells (m, 4) : corners of the cells in the order of gmsh, round each cell
    degree : degree of the space, 1 (bilinear) or 2 (biquadratic)

    Returns
    -------
    The cells of this rank and their nodes.
    """
    if comm.rank == 0:
        ordered, x = cells[:, TENSOR_ORDER].astype(np.int64), np.ascontiguousarray(points, dtype=np.float64)
    else:
        ordered, x = np.empty((0, 4), dtype=np.int64), np.empty((0, 2))
    logging.disable(logging.INFO)  # FFCx would log every call of the compiler
    try:
        grid, space = _grid_and_space(comm, ordered, x, degree)
    finally:
        logging.disable(logging.NOTSET)
    owned_cells = grid.topology.index_map(2).size_local
    index_map = space.dofmap.index_map
    local = _rows(space.dofmap.list)[:owned_cells]
    geometry = _rows(grid.geometry.dofmap)[:owned_cells]
    return RankDistribution(
        cell=np.asarray(grid.topology.original_cell_index)[:owned_cells],
        corners=np.asarray(grid.geometry.input_global_indices)[geometry],
        nodes=index_map.local_to_global(np.ascontiguousarray(local.ravel(), dtype=np.int32)).reshape(local.shape),
        total=int(index_map.size_global),
        owned=int(index_map.size_local),
    )


def _grid_and_space(comm: Any, cells: np.ndarray, x: np.ndarray, degree: int) -> tuple[Any, Any]:
    """Return the distributed mesh and the scalar space on it."""
    with _symbols_to_themselves():
        from dolfinx import fem, mesh

    try:
        import basix.ufl  # from dolfinx 0.7 on
        import ufl

        domain = ufl.Mesh(basix.ufl.element("Lagrange", "quadrilateral", 1, shape=(2,)))
        grid = mesh.create_mesh(comm, cells=cells, x=x, e=domain)
        space = fem.functionspace(grid, _element(degree, basix.ufl.element))
    except ImportError:
        import ufl

        grid = mesh.create_mesh(comm, cells, x, ufl.Mesh(ufl.VectorElement("Lagrange", "quadrilateral", 1)))
        space = fem.FunctionSpace(grid, ufl.FiniteElement("Lagrange", "quadrilateral", degree))
    return grid, space


def tabulate(degree: int, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the shape functions and their gradients at points of the reference square.

    Parameters
    ----------
    degree : degree of the shape functions, 1 or 2
    points (n, 2) : points in [0, 1]²

    Returns
    -------
    Shape functions (n, nodes), and gradients (n, nodes, 2) by the reference coordinates (-).
    """
    import basix

    table = _element(degree, basix.create_element).tabulate(1, points)[..., 0]
    return table[0], np.moveaxis(table[1:], 0, -1)


def _element(degree: int, create: Any) -> Any:
    import basix

    return create(basix.ElementFamily.P, basix.CellType.quadrilateral, degree, basix.LagrangeVariant.gll_warped)


def _rows(table: Any) -> np.ndarray:
    """Return the table of a dofmap as an array (cells, entries); up to version 0.6 dolfinx had adjacency lists."""
    if hasattr(table, "array"):
        return np.asarray(table.array).reshape(table.num_nodes, -1)
    return np.asarray(table)
