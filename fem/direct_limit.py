"""The limit load of discretised ground at once, without a path: the largest multiplier of a load for which stresses at
the quadrature points balance the nodal forces within the yield surface.

By the duality of limit analysis (Krabbenhoft & Damkilde 2003, Int. J. Numer. Meth. Engng 56, 165; the program is that
of ``fem/cone_program.py``) it is also the smallest multiplier at which a velocity field of the same elements dissipates
what the loads do. It is the load that a path of associated flow tends to, with neither steps nor elastic strains, in
some twenty factorisations; and no bound, since between the points nothing is asked for.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import sparse

from fem import cone_program
from fem.errors import UnstableError
from fem.fields import State
from fem.kernels import mohr_coulomb
from meshes.errors import NoAnswerError
from meshes.quad_mesh import QuadMesh

if TYPE_CHECKING:
    from fem.plane_strain import PlaneStrain


@dataclass(frozen=True, eq=False)
class DirectLimit:
    """The limit load of a discretised section.

    Attributes
    ----------
    multiplier : float
        The load multiplier (-); infinite where in no mechanism the load does work.
    mechanism : State or None
        Stresses at the limit load, and in the place of displacement and strain the velocities of the mechanism, the
        largest of which is 1 m/s, and its strain rates; None without a mechanism.
    """

    multiplier: float
    mechanism: State | None


@dataclass(frozen=True, eq=False)
class _Cells:
    """The elements of all ranks: B (nc, nq, [xx, yy, xy], nd), weights (nc, nq), global components (nc, nd), the cells'
    numbers and corners in the mesh, and the numbers of the soils of the points (nc, nq)."""

    matrix: np.ndarray
    weights: np.ndarray
    dofs: np.ndarray
    cell: np.ndarray
    corners: np.ndarray
    material: np.ndarray


def direct_limit(problem: "PlaneStrain", mesh: QuadMesh, dead: np.ndarray, live: np.ndarray) -> DirectLimit:
    """The largest λ at which the nodal forces ``dead`` + λ ``live``, both (dofs,) in N/m, are borne.

    The flow is associated, the element "reduced"; initial stress and stiffness have no part in it. All ranks get the
    answer of the first. Raises UnstableError if no stress balances the forces, NoAnswerError if the solver leaves no
    answer.
    """
    comm = problem.grid.comm
    parts = comm.gather((_own_cells(problem), problem.free, dead, live))
    found: DirectLimit | NoAnswerError | None = None
    if comm.rank == 0:
        own, *vectors = zip(*parts, strict=True)
        cells = _Cells(*(np.concatenate(values) for values in zip(*(vars(part).values() for part in own), strict=True)))
        found = _solved(problem, mesh, cells, *(np.concatenate(parts) for parts in vectors))
    found = comm.bcast(found)
    if isinstance(found, NoAnswerError):
        raise found
    assert found is not None
    return found


def _own_cells(problem: "PlaneStrain") -> _Cells:
    grid = problem.grid
    material = problem.material.reshape(grid.weights.shape)
    return _Cells(
        grid.matrix[:, :, [0, 1, 3]], grid.weights, grid.global_dofs[grid.dofs], grid.cell, grid.corners, material
    )


def _solved(
    problem: "PlaneStrain", mesh: QuadMesh, cells: _Cells, free: np.ndarray, dead: np.ndarray, live: np.ndarray
) -> DirectLimit | NoAnswerError:
    """The limit load, or why there is none."""
    length = float(np.ptp(mesh.points[:, 1]))
    sizes = [float(np.abs(force[free]).sum()) for force in (dead, live)]
    unit, ratio = sizes[0] / length, sizes[0] / sizes[1]  # both loads as large as one
    weight = np.sqrt(cells.weights) / length
    strain = _strain_matrix(cells, weight * length, problem.grid.size)[:, np.flatnonzero(free)].tocsr()
    material = cells.material.ravel()
    solution = cone_program.solve(
        cone_program.ConeProgram(
            strain,
            problem.strength.cohesion[material] / unit,
            problem.strength.friction[material],
            weight.ravel(),
            dead[free] / (unit * length),
            ratio * live[free] / (unit * length),
            tension=problem.strength.tension[material] / unit,
        ),
        again=True,
    )
    if solution.none == "no mechanism":
        return DirectLimit(np.inf, None)
    if solution.none:
        return UnstableError("the section fails under its own weight: no stress balances it")
    if solution.ended:
        return NoAnswerError(f"the limit load of the elements was not found ({solution.ended})", "use another mesh")
    points = cells.weights.shape
    rates = (strain @ solution.rates).reshape(*points, 3) / (weight * length)[..., None]
    xx, yy, xy = unit * solution.stress.T
    stress = np.column_stack([xx, yy, 0.5 * (xx + yy), xy])
    mobilised = mohr_coulomb.mobilised_strength(stress, material, problem.table).reshape(points)
    velocity = np.zeros(problem.grid.size)
    velocity[free] = solution.rates
    fields = _Fields(velocity, rates, stress.reshape(*points, 4), np.minimum(mobilised, 1.0))
    return DirectLimit(ratio * solution.multiplier, _state(mesh, cells, ratio * solution.multiplier, fields))


def _strain_matrix(cells: _Cells, factor: np.ndarray, size: int) -> sparse.csr_matrix:
    """B of all points, each times its ``factor`` (nc, nq), on the displacement components of all nodes."""
    values = cells.matrix * factor[..., None, None]
    rows = np.arange(values[..., 0].size).reshape(values.shape[:3])[..., None]
    columns = cells.dofs[:, None, None, :]
    rows, columns = (np.broadcast_to(numbers, values.shape).ravel() for numbers in (rows, columns))
    return sparse.csr_matrix((values.ravel(), (rows, columns)), shape=(values[..., 0].size, size))


@dataclass(frozen=True, eq=False)
class _Fields:
    """Velocities (all components,), and at the points strain rates (nc, nq, 3), stresses (nc, nq, 4) in Pa and the
    mobilised shares of strength (nc, nq)."""

    velocity: np.ndarray
    rates: np.ndarray
    stress: np.ndarray
    mobilised: np.ndarray


def _state(mesh: QuadMesh, cells: _Cells, kh: float, fields: _Fields) -> State:
    """The mechanism as fields of the mesh; the stress out of plane, which a limit load leaves open, is the mean one."""
    share = cells.weights / cells.weights.sum(axis=1, keepdims=True)
    shear = np.hypot(fields.rates[..., 0] - fields.rates[..., 1], fields.rates[..., 2])
    by_cell = [np.einsum("cq,cq...->c...", share, values) for values in (fields.stress, shear, fields.mobilised)]
    stress, strain, mobilised = (np.zeros((len(mesh.cells), *values.shape[1:])) for values in by_cell)
    stress[cells.cell], strain[cells.cell], mobilised[cells.cell] = by_cell
    velocity = np.zeros((len(mesh.points), 2))
    velocity[cells.corners] = fields.velocity[cells.dofs[:, :8]].reshape(-1, 4, 2)
    scale = 1.0 / max(float(np.hypot(*velocity.T).max()), 1e-300)
    return State(f"mechanism, Kh = {kh:.3f}", kh, scale * velocity, stress, scale * strain, scale * strain, mobilised)
