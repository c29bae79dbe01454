"""Sets up the finite elements of a mesh on one MPI rank: strain-displacement matrices, weights, numbering, and exchange
between ranks."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from petsc4py import PETSc

from fem.settings import Element
from fem.solvers import dolfinx_api as api
from meshes.quad_mesh import QuadMesh

DEGREES: dict[Element, int] = {"bilinear": 1, "quadratic": 2, "reduced": 2}


@dataclass(frozen=True)
class Discretisation:
    """Holds the finite elements of the cells on one MPI rank, as flat arrays for the kernels.

    There are nc cells with nq quadrature points and nd displacement components each.

    Attributes
    ----------
    comm : processes among which the mesh is distributed
    element : "bilinear", "quadratic" or "reduced"
    matrix (nc, nq, 4, nd) : strain-displacement matrix B (1/m) of the strain [xx, yy, zz, xy] with engineering shear
    hourglass (nc or 0, nd, nd) : stiffness against hourglass modes, for a shear modulus of 1 (-)
    divergence (nc, nq, nd) : volumetric strain (1/m) by the shape functions, on which pore pressure does work. It is
        never smoothed; the volumetric strain in ``matrix`` may be.
    weights (nc, nq) : areas (m²) of the quadrature points
    shapes (nq, nodes) : shape functions at the quadrature points (-)
    corner_shapes (nq, 4) : bilinear shape functions of the corners (-)
    dofs (nc, nd) : numbers of the displacement components of each cell, among the components that this rank works with
    global_dofs (needed,) : global numbers of the displacement components that this rank works with
    cell (nc,) : number of each cell in the undistributed mesh
    corners (nc, 4) : numbers of the corners of each cell in the undistributed mesh
    stratum (nc,) : number of the stratum of each cell
    node_points (nodes of all ranks, 2) : coordinates of the nodes (m)
    size, owned : number of displacement components on all ranks (``size``), and on this rank (``owned``)
    sides : global numbers of the nodes on every boundary
    """

    comm: Any
    element: Element
    matrix: np.ndarray
    hourglass: np.ndarray
    divergence: np.ndarray
    weights: np.ndarray
    shapes: np.ndarray
    corner_shapes: np.ndarray
    dofs: np.ndarray
    global_dofs: np.ndarray
    cell: np.ndarray
    corners: np.ndarray
    stratum: np.ndarray
    node_points: np.ndarray
    size: int
    owned: int
    sides: dict[str, np.ndarray]

    @property
    def inside(self) -> int:
        """Return the number of displacement components inside a cell; no other cell shares these components, and they
        are numbered last."""
        return 2 if DEGREES[self.element] == 2 else 0

    @property
    def points_per_cell(self) -> int:
        return self.weights.shape[1]


def discretise(mesh: QuadMesh, element: Element, comm: Any = None) -> Discretisation:
    """Distribute a mesh among the ranks of ``comm``, by default this process alone, and set up its elements.

    "bilinear" is the 4-node quadrilateral with 2 x 2 points whose volumetric strain is its mean over the cell (B-bar,
    Hughes 1980, the out-of-plane component included). "quadratic" is the 9-node one with 3 x 3 points whose volumetric
    strain is linear over the cell, the displacement form of the Q2/P-1 pair; it has no spurious modes and does not lock
    where plastic flow keeps the volume. Where the ground dilates, ψ > 0, this element locks: the flow rule imposes more
    conditions at its points than its nodes have degrees of freedom. "reduced" is the 9-node one with 2 x 2 points,
    which follows dilating flow; its hourglass strain, which is zero at the points, is resisted by ``hourglass``.
    docs/theory/continuum.md compares them.
    """
    if comm is None:
        from mpi4py import MPI

        comm = MPI.COMM_SELF
    degree = DEGREES[element]
    part = api.distribute(comm, mesh.points, mesh.cells, degree)
    points = mesh.points[part.corners]
    gauss, weight = _gauss(3 if element == "quadratic" else 2)
    matrix, weights = _strain_matrix(degree, gauss, weight, points)
    divergence = matrix[:, :, 0] + matrix[:, :, 1]
    hourglass = np.zeros((0, matrix.shape[-1], matrix.shape[-1]))
    if element == "reduced":
        hourglass = _hourglass_stiffness(matrix, points)
    else:
        _project_volumetric_strain(matrix, weights, _modes(element, gauss, points, weights))

    nodes = part.nodes
    blocked = (2 * nodes[:, :, None] + np.arange(2)).reshape(len(nodes), -1)
    global_dofs, dofs = np.unique(blocked, return_inverse=True)
    return Discretisation(
        comm=comm,
        element=element,
        matrix=matrix,
        hourglass=hourglass,
        divergence=divergence,
        weights=weights,
        shapes=api.tabulate(degree, gauss)[0],
        corner_shapes=api.tabulate(1, gauss)[0],
        dofs=dofs.reshape(blocked.shape).astype(np.int32),
        global_dofs=global_dofs.astype(PETSc.IntType),
        cell=part.cell,
        corners=part.corners,
        stratum=mesh.stratum[part.cell],
        node_points=_node_points(comm, part, points, degree),
        size=2 * part.total,
        owned=2 * part.owned,
        sides={name: _side_nodes(comm, part, edges, degree) for name, edges in mesh.boundaries.items()},
    )


def periodic_discretisation(d: Discretisation, masters: np.ndarray, slaves: np.ndarray) -> Discretisation:
    """Return a copy of the elements in which slave components (k,) are replaced by master components (k,)."""
    replacement = np.arange(d.size, dtype=d.global_dofs.dtype)
    for axis in (0, 1):
        replacement[2 * slaves + axis] = 2 * masters + axis
    global_dofs, dofs = np.unique(replacement[d.global_dofs][d.dofs], return_inverse=True)
    return replace(d, global_dofs=global_dofs, dofs=dofs.reshape(d.dofs.shape).astype(np.int32))


def _gauss(order: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the order x order Gauss points of the reference square [0, 1]² and their weights."""
    x, w = np.polynomial.legendre.leggauss(order)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    return np.array([(a, b) for b in x for a in x]), np.array([a * b for b in w for a in w])


def _strain_matrix(
    degree: int, gauss: np.ndarray, weight: np.ndarray, points: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the strain-displacement matrix B (nc, nq, 4, nd) and the areas (nc, nq) of quadrature points of cells with
    corners ``points`` (nc, 4, 2)."""
    _, gradients = api.tabulate(degree, gauss)
    _, corner_gradients = api.tabulate(1, gauss)
    jacobian = np.einsum("qad,cai->cqid", corner_gradients, points)
    gradient = np.einsum("qad,cqdi->cqai", gradients, np.linalg.inv(jacobian))
    cells, count, nodes, _ = gradient.shape
    matrix = np.zeros((cells, count, 4, 2 * nodes))
    matrix[:, :, 0, 0::2] = gradient[..., 0]
    matrix[:, :, 1, 1::2] = gradient[..., 1]
    matrix[:, :, 3, 0::2] = gradient[..., 1]
    matrix[:, :, 3, 1::2] = gradient[..., 0]
    return matrix, np.abs(np.linalg.det(jacobian)) * weight


def _modes(element: Element, gauss: np.ndarray, points: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Return the values at the points (nc, nq, k) of the polynomials to which the volumetric strain is fitted: 1, and
    also x and y if ``quadratic``."""
    modes = [np.ones_like(weights)]
    if element == "quadratic":
        place = np.einsum("qa,cai->cqi", api.tabulate(1, gauss)[0], points)
        place = (place - place.mean(axis=1, keepdims=True)) / np.sqrt(weights.sum(axis=1))[:, None, None]
        modes += [place[..., 0], place[..., 1]]
    return np.stack(modes, axis=-1)


def _project_volumetric_strain(matrix: np.ndarray, weights: np.ndarray, modes: np.ndarray) -> None:
    """Replace the volumetric strain by its best fit among the ``modes`` (nc, nq, k) over the cell, in place.

    With the constant mode alone the projection is the mean dilatation method of Hughes (1980).
    """
    volumetric = matrix[:, :, 0] + matrix[:, :, 1]
    weighted = modes * weights[:, :, None]
    gram = np.einsum("cqk,cql->ckl", weighted, modes)
    fit = np.linalg.solve(gram, np.einsum("cqk,cqd->ckd", weighted, volumetric))
    smooth = np.einsum("cqk,ckd->cqd", modes, fit)
    matrix[:, :, :3] += ((smooth - volumetric) / 3.0)[:, :, None]


def _hourglass_stiffness(matrix: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return the stiffness (nc, nd, nd) against hourglass strain, the part of the strain that is zero at the 2 x 2
    points.

    The hourglass strain is the strain at 3 x 3 points less the bilinear field through its values at the 2 x 2 points,
    so that a displacement whose strain is linear over the cell is not resisted.
    """
    gauss, weight = _gauss(3)
    full, weights = _strain_matrix(2, gauss, weight, points)
    near, far = np.polynomial.legendre.leggauss(2)[0] / 2.0 + 0.5
    along = np.stack([(far - gauss) / (far - near), (gauss - near) / (far - near)])
    through = np.stack([along[i, :, 0] * along[j, :, 1] for j in (0, 1) for i in (0, 1)], axis=-1)
    remainder = full - np.einsum("qp,cpid->cqid", through, matrix)
    weighted = weights[:, :, None, None] * np.array([2.0, 2.0, 2.0, 1.0])[:, None] * remainder
    by_cell = (len(remainder), -1, remainder.shape[-1])
    return np.matmul(weighted.reshape(by_cell).transpose(0, 2, 1), remainder.reshape(by_cell))


def _node_points(comm: Any, part: api.RankDistribution, corners: np.ndarray, degree: int) -> np.ndarray:
    """Return coordinates (total, 2) of all nodes by their global numbers, on every rank."""
    reference = api.REFERENCE_CORNERS
    if degree == 2:
        middles = [(reference[a] + reference[b]) / 2.0 for a, b in api.REFERENCE_EDGES]
        reference = np.vstack([reference, middles, [[0.5, 0.5]]])
    shapes, _ = api.tabulate(1, reference)
    own_points = (part.nodes.ravel(), np.einsum("na,cai->cni", shapes, corners).reshape(-1, 2))
    points = np.empty((part.total, 2))
    for nodes, x in comm.allgather(own_points):
        points[nodes] = x
    return points


def _side_nodes(comm: Any, part: api.RankDistribution, edges: np.ndarray, degree: int) -> np.ndarray:
    """Return the global numbers of the nodes on boundary edges (k, 2), sorted, on every rank."""
    span = int(edges.max(initial=0)) + 1 if len(edges) else 1
    span = max(span, int(part.corners.max(initial=0)) + 1)
    side_edges = np.sort(edges, axis=1).astype(np.int64)
    keys = side_edges[:, 0] * span + side_edges[:, 1]
    nodes = []
    for number, (a, b) in enumerate(api.REFERENCE_EDGES):
        pair = np.sort(part.corners[:, [a, b]], axis=1).astype(np.int64)
        on_side = np.isin(pair[:, 0] * span + pair[:, 1], keys)
        nodes += [part.nodes[on_side, a], part.nodes[on_side, b]]
        if degree == 2:
            nodes.append(part.nodes[on_side, 4 + number])
    return np.unique(np.concatenate(comm.allgather(np.concatenate(nodes))))
