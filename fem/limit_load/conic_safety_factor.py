"""Computes the factor of safety of discretised ground by finite element limit analysis. The factor is the divisor of
the strength at which nodal forces are just resisted.

At a trial factor F the reserve of strength is computed: the largest λ for which stresses at the quadrature points are
in equilibrium with the forces within

    |s| <= R(F, σm) - λ S,    R = c cos φ - sin φ σm,    S = -∂R/∂ln F at a σm of the step before,

s and σm being deviator and mean of the stress in the plane, c and φ those at F. The largest λ is the answer of one cone
program (``cone_program.py``). The program always has a solution, since enough strength resists any load. F is too small
if λ > 0 and too large if λ < 0. S is about the decrease of the strength per unit of ln F, so that λ is about the
correction of ln F. By the envelope theorem the decrease of λ per unit of ln F is the mean of -∂R/∂ln F at the computed
stress, weighted by the shear rates of the mechanism, plus a term of the opening at a tension cut-off T, where -∂T/∂ln F
= T. Newton's method with this rate gives the share λ' of the strength that is not needed at F. As the strength is about
proportional to 1/F, the correction of ln F is -ln(1 - λ'). The search takes one to three cone programs for every kind
of failure: a slope to one side, an embankment that spreads to both sides, or the ground below a footing, which no Kh
brings to failure.
"""

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from fem.continuum.fields import FieldState
from fem.continuum.strength import strength_of
from fem.errors import UnstableError
from fem.limit_load.conic_limit_load import DiscreteEquilibrium, gathered, of_first_rank
from fem.solvers import cone_program
from fem.solvers.program_accuracy import accuracy_of_elements
from meshes.errors import NoAnswerError
from meshes.quad_mesh import QuadMesh

if TYPE_CHECKING:
    from fem.continuum.plane_strain import PlaneStrain

LARGEST_FACTOR = 20.0
# Largest number of trials; largest ratio of two consecutive factors; change of ln F after which the remaining error of
# Newton's method, which converges quadratically, is below 0.1 % (measured: 0.09 % after 0.034).
MOST_TRIALS, LARGEST_STEP, NEWTON_STEP = 20, 3.0, 0.04
# Largest share of the strength that is assumed not to be needed.
LARGEST_SPARE_SHARE = 0.95
# Number of steps for the prediction of the factor with another flow rule from the resistance of the same mechanism.
PREDICTION_STEPS = 4
# Step of ln F over which the strength is differentiated.
LOG_DIFFERENCE = 1e-4
# Smallest softening of a point over the mean, so that ground without softening has an answer, too.
LEAST_SOFTENING = 1e-3


@dataclass(frozen=True, eq=False)
class FactorStart:
    """Holds the starting point of a search for another factor of safety of the same elements under the same forces.

    Attributes
    ----------
    log_factor : logarithm of the factor of safety (-)
    shear (points,) : shear rates of the mechanism times the weight of the points (-)
    mean (points,) : mean stress in the plane in Pa, tension positive
    resisted : dissipation of the mechanism at the factor, by the yield condition without tension cut-offs
    """

    log_factor: float
    shear: np.ndarray
    mean: np.ndarray
    resisted: float


@dataclass(frozen=True, eq=False)
class ConicSafetyFactor:
    """Holds the divisor of c and tan φ at which ground fails, its mechanism, and the start of a search for another
    factor (None on ranks other than the first).
    """

    factor: float
    mechanism: FieldState
    start: FactorStart | None


def conic_safety_factor(
    problem: "PlaneStrain",
    mesh: QuadMesh,
    forces: np.ndarray,
    kh: float,
    guess: float = 1.0,
    start: FactorStart | None = None,
) -> ConicSafetyFactor:
    """Find the divisor of c and tan φ at which the ground just resists nodal forces, and the mechanism.

    The flow is associated, the element "reduced". The strength of the problem is divided by the factor afterwards.

    Parameters
    ----------
    problem : the elements of the mesh, with their fixed components
    mesh : the mesh
    forces (dofs,) : nodal forces (N/m)
    kh : seismic coefficient of the forces, which labels the mechanism (-)
    guess : factor at which the search begins (-)
    start : start from the factor by another flow rule, which replaces the guess

    Returns
    -------
    The factor of safety (-), its mechanism, and a start for another flow rule.

    Raises
    ------
    UnstableError
        If the factor is below 1/20.
    NoAnswerError
        If the factor is above 20, or the solver leaves no answer.
    """
    grid = problem.grid
    mean = _elastic_mean(problem, forces)
    ground = gathered(problem, mesh, forces)
    means = grid.comm.gather(mean) or [mean]
    answer: tuple[float, FieldState] | NoAnswerError | None = None
    next_start = None  # on the first rank only: it is not sent to other ranks
    if grid.comm.rank == 0:
        try:
            factor, mechanism, next_start = _FactorSearch(problem, mesh, ground, np.concatenate(means), start).find(
                guess, kh
            )
            answer = factor, mechanism
        except NoAnswerError as error:
            answer = error
    factor, mechanism = of_first_rank(problem, answer)
    problem.use_strength(factor)
    return ConicSafetyFactor(factor, mechanism, next_start)


def too_weak(kh: float, moving: np.ndarray | None = None) -> UnstableError:
    """Return the error for a factor of safety below the smallest factor that is searched for.

    Parameters
    ----------
    kh : seismic coefficient (-)
    moving (n, 2) : points that move most in the mechanism (m); without them the error names no place

    Returns
    -------
    The error, to be raised.
    """
    load_words = "its own weight" + (f" and Kh = {kh:g}" if kh else "")
    failure_words = f"the section fails under {load_words} even at {LARGEST_FACTOR:g} times its strength"
    if moving is None:
        return UnstableError(failure_words)
    (left, low), (right, high) = moving.min(axis=0), moving.max(axis=0)
    ends = f"x = {left:.1f} to {right:.1f} m and z = {low:.1f} to {high:.1f} m"
    return UnstableError(f"{failure_words}; it moves between {ends}", "check outline and strength of this ground")


def _elastic_mean(problem: "PlaneStrain", forces: np.ndarray) -> np.ndarray:
    """Return the mean stress in the plane (points,) of elastic ground under nodal forces, in Pa, tension positive."""
    grid, laws = problem.grid, problem.elastic_stiffness()
    problem.use_elastic_tangent()
    problem.factorise()
    moved = problem.exchange.to_local(problem.solve(forces))[grid.dofs]
    strain = np.einsum("cqin,cn->cqi", grid.matrix, moved).reshape(-1, 4)
    return 0.5 * np.einsum("pij,pj->pi", laws[problem.material][:, :2], strain).sum(axis=1)


class _FactorSearch:
    """Finds the logarithm of the factor of safety by Newton's method, between factors known to be too small and too
    large."""

    def __init__(
        self,
        problem: "PlaneStrain",
        mesh: QuadMesh,
        ground: DiscreteEquilibrium,
        mean: np.ndarray,
        start: FactorStart | None = None,
    ) -> None:
        self.problem, self.mesh, self.ground, self.start = problem, mesh, ground, start
        self.elastic = mean  # mean of the elastic stress in the plane (points,) in Pa, tension positive
        self.material = ground.cells.material.ravel()
        # What the solver knows of the elements: only that, since from the iterate of another factor it breaks down in
        # sand, and saves one iteration of ten in other ground.
        self.warm_start: cone_program.Warm | None = None

    def find(self, guess: float, kh: float) -> tuple[float, FieldState, FactorStart]:
        """Find the factor of safety, its mechanism, and the start of a search by another flow rule."""
        low, high, log_factor = (
            -math.inf,
            math.inf,
            math.log(guess) if self.start is None else self.next_from(self.start),
        )
        solution = None
        for _ in range(MOST_TRIALS):
            if log_factor < -math.log(LARGEST_FACTOR):
                raise too_weak(kh, None if solution is None else self.moving(solution, kh))
            if log_factor > math.log(LARGEST_FACTOR):
                raise NoAnswerError(f"the section stands even with its strength divided by {LARGEST_FACTOR:g}", "")
            step, solution = self.step(log_factor)
            low, high = (log_factor, high) if step >= 0.0 else (low, log_factor)
            if abs(step) < NEWTON_STEP:
                factor = math.exp(log_factor + step)
                self.problem.use_strength(factor)  # whose shares follow from the mechanism
                mechanism = self.ground.mechanism(self.problem, self.mesh, solution, kh)
                mean = self.ground.stress(solution)[:, :2].mean(axis=1)
                resisted = float(solution.shear @ self.resistance(log_factor + step, mean))
                return factor, mechanism, FactorStart(log_factor + step, solution.shear, mean, resisted)
            step = float(np.clip(step, -math.log(LARGEST_STEP), math.log(LARGEST_STEP)))
            log_factor = log_factor + step if low < log_factor + step < high else 0.5 * (low + high)
        reason = f"the factor of safety still changes by {100.0 * abs(step):.2g} % after {MOST_TRIALS} corrections"
        raise NoAnswerError(reason, "use another mesh")

    def moving(self, solution: cone_program.Solution, kh: float) -> np.ndarray:
        """Return the nodes (n, 2) in m that move at more than half of the largest velocity in the mechanism."""
        mechanism = self.ground.mechanism(self.problem, self.mesh, solution, kh)
        speed = np.linalg.norm(mechanism.displacement, axis=1)
        return self.mesh.points[speed > 0.5 * speed.max()]

    def step(self, at: float) -> tuple[float, cone_program.Solution]:
        """Return the Newton correction of the logarithm of the factor of safety at the value ``at``, and the solution
        there."""
        self.problem.use_strength(math.exp(at))
        strength, softening = self.problem.strength, self.softening(at, self.elastic)
        softening = np.maximum(softening, LEAST_SOFTENING * softening.mean())

        def program(ground: DiscreteEquilibrium) -> cone_program.ConeProgram:
            dead = ground.load(0)
            return ground.program(strength, dead, np.zeros_like(dead), softening)

        self.ground, solution = self.ground.solved(program, accuracy_of_elements(), self.warm_start)
        self.warm_start = None if solution.warm is None else replace(solution.warm, place=None)
        if solution.none or not solution.sure:
            reason = solution.end_status or solution.none
            raise NoAnswerError(f"the factor of safety by finite elements was not found ({reason})", "use another mesh")
        mean_stress = self.ground.stress(solution)[:, :2].mean(axis=1)
        slope = float(solution.shear @ self.softening(at, mean_stress)) / self.ground.unit + solution.torn
        spare = solution.multiplier / slope if slope > 0.0 else solution.multiplier
        return -math.log1p(-min(spare, LARGEST_SPARE_SHARE)), solution

    def next_from(self, start: FactorStart) -> float:
        """Return the logarithm of the factor at which the mechanism of ``start`` meets the same resistance by this flow
        rule as by the other one."""
        log_factor = start.log_factor
        for _ in range(PREDICTION_STEPS):
            resisted = float(start.shear @ self.resistance(log_factor, start.mean))
            if not resisted > 0.0 or not start.resisted > 0.0:
                return start.log_factor
            log_factor += math.log(resisted / start.resisted)
        return log_factor

    def softening(self, at: float, mean: np.ndarray) -> np.ndarray:
        """Return the decrease of the strength R (points,) at ``mean`` stresses in Pa per unit of the logarithm of the
        factor."""
        ends = [self.resistance(log, mean) for log in (at - LOG_DIFFERENCE, at + LOG_DIFFERENCE)]
        return (ends[0] - ends[1]) / (2.0 * LOG_DIFFERENCE)

    def resistance(self, at: float, mean: np.ndarray) -> np.ndarray:
        """Return the strength R (points,) in Pa under ``mean`` stresses in Pa where the logarithm of the factor is
        ``at``."""
        weak = strength_of(self.problem.strata, self.problem.flow, math.exp(at), self.problem.form)
        sin, cos = np.sin(weak.friction), np.cos(weak.friction)
        return (weak.cohesion * cos)[self.material] - sin[self.material] * mean
