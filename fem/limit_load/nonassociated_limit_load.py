"""Computes the limit load of discretised ground that flows with its own dilation angle ψ, by a sequence of associated
problems.

The ground yields at t = c cos φ + p sin φ, where t is the radius of Mohr's circle and p the pressure in the plane, and
it flows with ψ. In each step of the iteration the ground is replaced by ground with associated flow and the strength t
<= k + p sin ψ with k = c cos φ + (sin φ - sin ψ) p*, where p* is the pressure of the last solution (Krabbenhoft, Karim,
Lyamin & Sloan 2012, Int. J. Numer. Meth. Engng 90, 1089). One elastoplastic step, with a prescribed displacement of 8
times the elastic displacement under Kh = 1, leads from rest to failure. p* is the mean over each cell: with a separate
pressure at every point the iteration does not settle at ψ = 0.

The result is no bound, and it depends on element and mesh by 5 to 15 %. The result counts as an answer only if the
pressures settle and another start of the iteration leads to the same result.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import linalg

from fem.limit_load.conic_limit_load import DiscreteEquilibrium, gathered
from fem.solvers.elastic_cone_program import ElasticConeProgram
from meshes.quad_mesh import QuadMesh

if TYPE_CHECKING:
    from fem.continuum.plane_strain import PlaneStrain

# Displacement of the step over the elastic displacement at Kh = 1; with a quarter of it, the step may end before the
# peak.
STEP_RATIO = 8.0
# Under-relaxation: share of the change of pressure that is applied, without which the iteration does not converge. It
# is smaller after this number of programs: of three meshes of a slope, one did not converge with either share alone.
RELAXATION_FACTOR, PROGRAMS_BEFORE_LATER, LATER_RELAXATION_FACTOR = 0.7, 8, 0.5
# Largest number of programs, and the relative change of pressures at which the iteration has converged.
MOST_PROGRAMS, PRESSURE_TOLERANCE = 20, 0.002
# Difference between the answers from two starting points up to which they count as equal.
ANSWER_TOLERANCE = 0.02
# Smallest strength k over the unit of stress.
LEAST_STRENGTH = 1e-4


@dataclass(frozen=True, eq=False)
class NonassociatedLimitLoad:
    """Holds the limit load of one mesh for non-associated flow.

    Attributes
    ----------
    kh : the critical Kh (-); None if the pressures did not settle, or two starts disagree
    reason : reason why there is no critical Kh; empty otherwise
    programs : number of cone programs that were solved
    work : computing work in seconds on the reference machine of ``cone_program``
    """

    kh: float | None
    reason: str
    programs: int
    work: float


def nonassociated_limit_load(
    problem: "PlaneStrain",
    mesh: QuadMesh,
    dead: np.ndarray,
    live: np.ndarray,
    associated: np.ndarray | None = None,
    most_work: float = np.inf,
) -> NonassociatedLimitLoad:
    """Return the Kh at which ground fails that flows with the dilation angles of its strata.

    Parameters
    ----------
    problem : the elements of ``mesh`` with ψ = φ and with their fixed components, on one MPI rank
    mesh : the mesh
    dead, live (dofs,) : nodal forces that are constant, and those of Kh = 1 (N/m)
    associated (cells, 4) : mean stress [xx, yy, ...] of every cell at the limit load with ψ = φ, tension positive (Pa),
        from which the iteration starts a second time; None to start from rest only
    most_work : computing work after which no program is begun (seconds on the reference machine of ``cone_program``)

    Returns
    -------
    The critical Kh; without a value, but with a reason, if the pressures do not settle or two starts disagree.
    """
    ground = gathered(problem, mesh, dead, live)
    step = _Step(problem, ground)
    step.bring_to_rest()
    first = step.settled(step.at_rest, most_work) if step.at_rest is not None else None
    if first is None or associated is None:
        return NonassociatedLimitLoad(first, "" if first is not None else step.reason, step.programs, step.work)
    pressure = -0.5 * associated[ground.cells.cell][:, :2].sum(axis=1) / ground.unit
    second = step.settled(pressure, most_work)
    if second is None or abs(first - second) > ANSWER_TOLERANCE * abs(first):
        reason = step.reason if second is None else f"two starts lead to {first:.4f} and {second:.4f}"
        return NonassociatedLimitLoad(None, reason, step.programs, step.work)
    return NonassociatedLimitLoad(first, "", step.programs, step.work)


class _Step:
    """Iterates on the pressures (cells,), over the unit of stress, of one elastoplastic step from rest."""

    def __init__(self, problem: "PlaneStrain", ground: DiscreteEquilibrium) -> None:
        self.ground, self.programs, self.reason = ground, 0, ""
        self.at_rest: np.ndarray | None = None
        cells, strength, strata = ground.cells, problem.strength, problem.strata
        material = cells.material.ravel()
        self._weight = ground.weight.ravel()
        self._share = cells.weights / cells.weights.sum(axis=1, keepdims=True)
        sine, cosine = np.sin(strength.friction)[material], np.cos(strength.friction)[material]
        dilation = np.minimum(np.array([s.dilation for s in strata])[material], strength.friction[material])
        self._sine, self._sine_of_flow = sine, np.sin(dilation)
        self._cohesion = strength.cohesion[material] / ground.unit * cosine
        modulus = np.array([s.youngs_modulus for s in strata])[material] / ground.unit
        poisson = np.array([s.poissons_ratio for s in strata])[material]
        compliance = np.zeros((len(material), 3, 3))
        compliance[:, 0, 0] = compliance[:, 1, 1] = 1.0 - poisson
        compliance[:, 0, 1] = compliance[:, 1, 0] = -poisson
        compliance[:, 2, 2] = 2.0
        self._compliance = compliance * ((1.0 + poisson) / modulus)[:, None, None]
        self._ratio = float(np.abs(ground.load(0)).sum() / np.abs(ground.load(1)).sum())
        self._loads = ground.load(0), self._ratio * ground.load(1)
        self._program: ElasticConeProgram | None = None
        self._spent = 0.0

    @property
    def work(self) -> float:
        """Return the computing work in seconds on the reference machine of ``cone_program``."""
        return self._spent + (self._program.work if self._program else 0.0)

    def bring_to_rest(self) -> None:
        """Compute the stress of the ground under its dead load, and set up the cone program of the step from there. The
        pressures of the stress under the dead load begin the iteration.
        """
        strain = self.ground.strain
        rest = ElasticConeProgram(
            strain, self._compliance, self._sine, self._loads, np.zeros((len(self._sine), 3)), 0.0
        )
        solution = rest.solve(self._weight * self._cohesion)
        self._spent, self.programs = rest.work, 1
        if solution is None:
            self.reason = "the solver found no stress at rest"
            return
        stiffness = np.linalg.inv(self._compliance)
        blocks = [stiffness[:, i, j] for i in range(3) for j in range(3)]
        rows = (3 * np.arange(len(stiffness))[:, None] + np.repeat([0, 1, 2], 3)).T.ravel()
        columns = (3 * np.arange(len(stiffness))[:, None] + np.tile([0, 1, 2], 3)).T.ravel()
        size = strain.shape[0]
        law = type(strain)((np.concatenate(blocks), (rows, columns)), shape=(size, size))
        moved = linalg.spsolve((strain.T @ law @ strain).tocsc(), self._loads[1])
        displacement = STEP_RATIO * float(self._loads[1] @ moved) / self._ratio
        self._program = ElasticConeProgram(
            strain, self._compliance, self._sine_of_flow, self._loads, solution[1], displacement
        )
        self.at_rest = self._pressure(solution[1])

    def settled(self, pressure: np.ndarray, most_work: float) -> float | None:
        """Return the Kh at which the ``pressure`` (cells,) no longer changes from iteration to iteration; None if it
        does not settle."""
        assert self._program is not None
        change_share = np.inf
        for number in range(MOST_PROGRAMS):
            if self.work > most_work:
                self.reason = "the allowed work is used up"
                return None
            mean = np.repeat(pressure, self._share.shape[1])
            strength = np.maximum(self._cohesion + (self._sine - self._sine_of_flow) * mean, LEAST_STRENGTH)
            solution = self._program.solve(self._weight * strength)
            self.programs += 1
            if solution is None:
                self.reason = "the solver ended without an answer"
                return None
            change = self._pressure(solution[1]) - pressure
            change_share = float(np.linalg.norm(change) / np.linalg.norm(pressure))
            if change_share < PRESSURE_TOLERANCE:
                return self._ratio * solution[0]
            pressure = (
                pressure + (RELAXATION_FACTOR if number < PROGRAMS_BEFORE_LATER else LATER_RELAXATION_FACTOR) * change
            )
        self.reason = f"pressures still change by {100.0 * change_share:.1f} %"
        return None

    def _pressure(self, stress: np.ndarray) -> np.ndarray:
        """Return the mean pressure of every cell (cells,) from a weighted ``stress`` (points, 3)."""
        points = -0.5 * stress[:, :2].sum(axis=1) / self._weight
        return np.einsum("cq,cq->c", self._share, points.reshape(self._share.shape))
