"""Computes the limit load of discretised ground by finite element limit analysis. The limit load is the largest load
multiplier for which stresses at the quadrature points, within the yield surface, are in equilibrium with the nodal
forces.

By the duality of limit analysis (Krabbenhoft & Damkilde 2003, Int. J. Numer. Meth. Engng 56, 165; the program is that
of ``cone_program.py``) it is also the smallest multiplier at which the dissipation of a velocity field of the same
elements equals the work of the loads. The limit load is the limit of an equilibrium path with associated flow, computed
without steps and elastic strains in some twenty factorisations. The limit load is not a bound, since the yield
condition is required at the quadrature points only.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeVar, cast

import numpy as np
from scipy import sparse

from fem.continuum.fields import FieldState
from fem.continuum.strength import StrataStrength
from fem.errors import UnstableError
from fem.kernels import mohr_coulomb
from fem.settings import LEAST_KH
from fem.solvers import cone_program
from fem.solvers.program_accuracy import LEAST_MULTIPLIER, ProgramAccuracy, accuracy_of_elements
from meshes.errors import NoAnswerError
from meshes.quad_mesh import QuadMesh

if TYPE_CHECKING:
    from fem.continuum.plane_strain import PlaneStrain


# Unit of force over the sum of all forces. The residuals of the solver are absolute for forces below one; with nodal
# forces far below one, half a per cent of the answer remained open, and a quarter of it in cohesionless sand. With this
# unit it is 0.01 %, after fewer iterations.
FORCE_UNIT = 0.01
# If the strength is large in this unit, the solver may find no answer or report that almost surely there is none; the
# program is then solved again in a unit larger by this ratio.
UNIT_RATIO = 10.0


@dataclass(frozen=True, eq=False)
class ConicLimitLoad:
    """Holds the limit load of a discretised section.

    Attributes
    ----------
    multiplier : the load multiplier (-); infinite if the load does no work in any mechanism
    mechanism : stresses at the limit load; its displacements are the velocities of the mechanism, scaled to a largest
        velocity of 1 m/s, and its strains the strain rates. None if there is no mechanism.
    bracket : lower and upper multiplier at which the solver stopped; ``multiplier`` is the mean of both
    start : starting point of the solver for the same elements and loads with another strength
    """

    multiplier: float
    mechanism: FieldState | None
    bracket: tuple[float, float]
    start: cone_program.Warm | None = None


@dataclass(frozen=True, eq=False)
class _Cells:
    """Holds the elements of all ranks: B (nc, nq, [xx, yy, xy], nd), weights (nc, nq), global components (nc, nd),
    numbers and corners of the cells in the mesh, and numbers of the soils of the points (nc, nq)."""

    matrix: np.ndarray
    weights: np.ndarray
    dofs: np.ndarray
    cell: np.ndarray
    corners: np.ndarray
    material: np.ndarray


@dataclass(frozen=True, eq=False)
class DiscreteEquilibrium:
    """Holds the dimensionless equilibrium of the elements of all MPI ranks under nodal forces, gathered on the first
    rank.

    Attributes
    ----------
    cells : the elements
    free (all components,) : mask of the displacement components that are not fixed
    forces (all components,) : nodal forces (N/m)
    length, unit : unit of length (m), the height of the mesh, and unit of stress (Pa), which follows from the sum of
        the first forces
    strain (3 points, free components) : strain rates at the points times the root of the area of each, over the unit of
        length
    """

    cells: _Cells
    free: np.ndarray
    forces: tuple[np.ndarray, ...]
    length: float
    unit: float
    strain: sparse.csr_matrix

    @property
    def weight(self) -> np.ndarray:
        """Return the square root of the area of every point (nc, nq), over the unit of length."""
        return np.sqrt(self.cells.weights) / self.length

    def load(self, number: int) -> np.ndarray:
        """Return the nodal forces of load ``number`` on the free components, over the unit of force (-)."""
        return self.forces[number][self.free] / (self.unit * self.length)

    def program(
        self, strength: StrataStrength, dead: np.ndarray, live: np.ndarray, softening: np.ndarray | None = None
    ) -> cone_program.ConeProgram:
        """Return the cone program that finds the stress in equilibrium with the loads on the free components, for the
        largest multiplier.

        ``strength`` is that of the strata; ``dead`` and ``live`` are constant and growing nodal forces, over the unit
        of force; ``softening`` (points,) is the loss of strength per unit of the multiplier (Pa).
        """
        material = self.cells.material.ravel()
        return cone_program.ConeProgram(
            self.strain,
            strength.cohesion[material] / self.unit,
            strength.friction[material],
            self.weight.ravel(),
            dead,
            live,
            tension=strength.tension[material] / self.unit,
            softening=None if softening is None else softening / self.unit,
        )

    def solved(
        self,
        program: "Callable[[DiscreteEquilibrium], cone_program.ConeProgram]",
        accuracy: ProgramAccuracy,
        start: cone_program.Warm | None = None,
    ) -> "tuple[DiscreteEquilibrium, cone_program.Solution]":
        """Solve the cone program to an ``accuracy``, and return the solution with the problem in the unit of stress
        that was used. If the solver is not certain, or Clarabel finds no stress because forces were rounded, the
        program is solved again with a larger unit of stress. Only the first of the two solutions begins at ``start``.
        """
        attempts = []
        for ground, place in ((self, start), (replace(self, unit=UNIT_RATIO * self.unit), None)):
            solution = cone_program.solve(program(ground), accuracy, start=place)
            if solution.sure and (solution.none != "no stress" or not solution.fallback):
                return ground, solution
            attempts.append((ground, solution))
        return next((pair for pair in attempts if pair[1].sure), attempts[-1])

    def stress(self, solution: cone_program.Solution) -> np.ndarray:
        """Return the stress (points, [xx, yy, xy]) in Pa of a solution."""
        return self.unit * solution.stress

    def mechanism(
        self, problem: "PlaneStrain", mesh: QuadMesh, solution: cone_program.Solution, kh: float
    ) -> FieldState:
        """Return the fields of a ``solution`` on ``mesh`` at ``kh``; the mobilised strength refers to the present
        strength of ``problem``.
        """
        points = self.cells.weights.shape
        rates = (self.strain @ solution.rates).reshape(*points, 3) / self.weight[..., None]
        xx, yy, xy = self.stress(solution).T
        stress = np.column_stack([xx, yy, 0.5 * (xx + yy), xy])
        mobilised = mohr_coulomb.mobilised_strength(stress, self.cells.material.ravel(), problem.table).reshape(points)
        velocity = np.zeros(len(self.free))
        velocity[self.free] = solution.rates
        fields = _Fields(velocity, rates, stress.reshape(*points, 4), np.minimum(mobilised, 1.0))
        return replace(_state(mesh, self.cells, kh, fields), repeats=problem.repeats)


def conic_limit_load(
    problem: "PlaneStrain",
    mesh: QuadMesh,
    dead: np.ndarray,
    live: np.ndarray,
    start: cone_program.Warm | None = None,
) -> ConicLimitLoad:
    """Find the largest λ at which the ground resists the nodal forces ``dead`` + λ ``live``.

    The flow is associated, the element "reduced"; the result does not depend on initial stress and stiffness. All MPI
    ranks get the answer of the first rank.

    Parameters
    ----------
    problem : the elements of the mesh, with their strength and their fixed components
    mesh : the mesh
    dead, live (dofs,) : constant and growing nodal forces (N/m)
    start : the ``start`` of another limit load with the same mesh, fixed components and loads, which saves half of the
        work

    Returns
    -------
    The limit load with its mechanism; an infinite one if the live forces do no work in any mechanism.

    Raises
    ------
    UnstableError
        If no stress balances the forces, whatever λ is.
    NoAnswerError
        If the solver leaves no answer.
    """
    ground = gathered(problem, mesh, dead, live)
    answer: ConicLimitLoad | NoAnswerError | None = None
    warm = None  # it is not sent to other ranks
    if problem.grid.comm.rank == 0:
        ratio = float(np.abs(ground.load(0)).sum() / np.abs(ground.load(1)).sum())  # both loads as large as one
        ground, solution = ground.solved(
            lambda unit: unit.program(problem.strength, unit.load(0), ratio * unit.load(1)),
            accuracy_of_elements(LEAST_KH / ratio, floor=LEAST_MULTIPLIER / ratio),
            start,
        )
        answer = _limit_load_of(problem, mesh, ground, solution, ratio)
        warm = None if solution.none else solution.warm
    return replace(of_first_rank(problem, answer), start=warm)


A = TypeVar("A")


def of_first_rank(problem: "PlaneStrain", answer: A | NoAnswerError | None) -> A:
    """Return the answer of the first MPI rank on all ranks; if the answer is a NoAnswerError, raise it."""
    answer = problem.grid.comm.bcast(answer)
    if isinstance(answer, NoAnswerError):
        raise answer
    return cast(A, answer)


def gathered(problem: "PlaneStrain", mesh: QuadMesh, *forces: np.ndarray) -> DiscreteEquilibrium:
    """Return the elements of all ranks under nodal forces (dofs,), gathered on the first rank; each other rank gets its
    own elements only.
    """
    grid = problem.grid
    material = problem.material.reshape(grid.weights.shape)
    local_cells = _Cells(
        grid.matrix[:, :, [0, 1, 3]], grid.weights, grid.global_dofs[grid.dofs], grid.cell, grid.corners, material
    )
    parts = grid.comm.gather((local_cells, problem.free, *forces)) or [(local_cells, problem.free, *forces)]
    all_cells, *vectors = zip(*parts, strict=True)
    cells = _Cells(
        *(np.concatenate(values) for values in zip(*(vars(part).values() for part in all_cells), strict=True))
    )
    free, *all_forces = (np.concatenate(vector) for vector in vectors)
    length = float(np.ptp(mesh.points[:, 1]))
    unit = FORCE_UNIT * float(np.abs(all_forces[0][free]).sum()) / length
    strain = _strain_matrix(cells, np.sqrt(cells.weights), grid.size)[:, np.flatnonzero(free)].tocsr()
    return DiscreteEquilibrium(cells, free, tuple(all_forces), length, unit, strain)


def _limit_load_of(
    problem: "PlaneStrain", mesh: QuadMesh, ground: DiscreteEquilibrium, solution: cone_program.Solution, ratio: float
) -> ConicLimitLoad | NoAnswerError:
    """Return the limit load from a ``solution``, in whose program the live load is multiplied by ``ratio``, or the
    reason why there is no limit load.
    """
    if not solution.sure:
        return NoAnswerError(
            f"the limit load by finite elements was not found ({solution.end_status})", "use another mesh"
        )
    if solution.none == "no mechanism":
        return ConicLimitLoad(np.inf, None, (np.inf, np.inf))
    if solution.none:
        return UnstableError("the section fails under its own weight: no stress balances it")
    kh = ratio * solution.multiplier
    low, high = (ratio * multiplier for multiplier in solution.bracket)
    return ConicLimitLoad(kh, ground.mechanism(problem, mesh, solution, kh), (low, high))


def _strain_matrix(cells: _Cells, factor: np.ndarray, size: int) -> sparse.csr_matrix:
    """Return the strain-displacement matrix B of all points, each times its ``factor`` (nc, nq), on the displacement
    components of all nodes."""
    values = cells.matrix * factor[..., None, None]
    rows = np.arange(values[..., 0].size).reshape(values.shape[:3])[..., None]
    columns = cells.dofs[:, None, None, :]
    rows, columns = (np.broadcast_to(numbers, values.shape).ravel() for numbers in (rows, columns))
    return sparse.csr_matrix((values.ravel(), (rows, columns)), shape=(values[..., 0].size, size))


@dataclass(frozen=True, eq=False)
class _Fields:
    """Holds the velocities (all components,), and at the points the strain rates (nc, nq, 3), the stresses (nc, nq, 4)
    in Pa and the mobilised shares of strength (nc, nq)."""

    velocity: np.ndarray
    rates: np.ndarray
    stress: np.ndarray
    mobilised: np.ndarray


def _state(mesh: QuadMesh, cells: _Cells, kh: float, fields: _Fields) -> FieldState:
    """Return the mechanism as fields of the mesh. Limit analysis does not determine the out-of-plane stress, which is
    set to the mean stress.
    """
    share = cells.weights / cells.weights.sum(axis=1, keepdims=True)
    shear = np.hypot(fields.rates[..., 0] - fields.rates[..., 1], fields.rates[..., 2])
    by_cell = [np.einsum("cq,cq...->c...", share, values) for values in (fields.stress, shear, fields.mobilised)]
    stress, strain, mobilised = (np.zeros((len(mesh.cells), *values.shape[1:])) for values in by_cell)
    stress[cells.cell], strain[cells.cell], mobilised[cells.cell] = by_cell
    velocity = np.zeros((len(mesh.points), 2))
    velocity[cells.corners] = fields.velocity[cells.dofs[:, :8]].reshape(-1, 4, 2)
    scale = 1.0 / max(float(np.hypot(*velocity.T).max()), 1e-300)
    return FieldState(
        f"mechanism, Kh = {kh:.3f}", kh, scale * velocity, stress, scale * strain, scale * strain, mobilised
    )
