"""Solves the second-order cone program of both bounds by the built-in interior-point method or by Clarabel (Goulart &
Chen 2024).

Both bounds are dual to each other. In the first problem stresses at corners k, [xx, yy, xy], are in equilibrium with
the loads,

    max λ  such that  Gᵀ σ = b0 + λ b1,  |((σxx - σyy)/2, σxy)| <= c cos φ - sin φ (σxx + σyy)/2,

and its dual has velocities x and strain rates ε = G x, [xx, yy, engineering xy],

    min D(ε) - b0·x  such that  b1·x = 1,  εxx + εyy >= sin φ |(εxx - εyy, εxy)|,

where D sums c cot φ (εxx + εyy), or c |(εxx - εyy, εxy)| with εxx + εyy = 0 where φ = 0, over the corners. A tension
cut-off, σm + |((σxx - σyy)/2, σxy)| <= T, is a second cone at a corner; in the dual the ground may open: ε is the sum
of a rate as above and a rate whose volumetric part is at least its shear part (φ = 90°), which dissipates T times its
volumetric part. Corners may have a weight w: each term of D is multiplied by w, and the stress of the first problem is
that of the corner times w. Clarabel solves the second problem, which is smaller, and returns the stress as its
multipliers.
"""

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

import clarabel
import numpy as np
from scipy import sparse

from fem.solvers import cholmod, interior_point
from fem.solvers.blas_threads import use_one_thread
from fem.solvers.cone_matrices import Assembled, ConeProgram, assembled, standard, stress_of
from fem.solvers.convergence import Place, Tolerance
from fem.solvers.corner_matrix import CornerMatrix
from fem.solvers.interior_point import Standard
from fem.solvers.program_accuracy import BOUNDS, ProgramAccuracy
from meshes.executor import interruptible

use_one_thread()

# Relative gap at which Clarabel stops: each bound may lie this far from the best one of its mesh.
SOLVER_GAP = 5e-6
# Statuses with which the tolerances are met, in the second case those of 1e-4 and 5e-5; bounds are checked separately.
CONVERGED_STATUSES = ("Solved", "AlmostSolved")
# The ends that prove that there is no solution.
NoSolution = Literal["no stress", "no mechanism"]
INFEASIBLE: Mapping[str, NoSolution] = {"PrimalInfeasible": "no mechanism", "DualInfeasible": "no stress"}
# Tolerances met almost will do where the equations are met to this.
ACCEPTED_RESIDUAL = 1e-6
MOST_ITERATIONS = 120
# Computing work is the time that the iterations would take on the machine on which these constants were measured, the
# reference machine. It is computed and not measured, so that the results do not depend on the speed or the load of the
# machine in use. An iteration whose factors have COST_NONZEROS nonzeros takes COST_SECONDS, and its time is
# proportional to this power of the number of nonzeros (measured from 0.2 to 2.5 million, and a fifth more for all else
# in an iteration). SETUP_SECONDS for every unknown are added for all before the first iteration and after the last:
# the equations, the correction of the solution, its check, and the triangles.
COST_NONZEROS, COST_SECONDS, COST_EXPONENT = 1e6, 0.065, 1.13
SETUP_SECONDS = 1.4e-5
# Multiple of its gap that will do where the built-in interior-point method breaks down, and the number of velocities
# below which Clarabel is as quick.
ACCEPTED_GAP_RATIO, FEWEST_VELOCITIES = 2.5, 2000
# Computing work of the built-in method: time (s) of an iteration whose stiffness matrix has INTERIOR_ENTRIES entries,
# and the power of their number that the time is proportional to.
INTERIOR_ENTRIES, INTERIOR_SECONDS, INTERIOR_EXPONENT = 1e6, 0.35, 1.1


@dataclass(frozen=True, eq=False)
class Solution:
    """Holds the solution of a cone program as the solver returned it.

    Attributes
    ----------
    multiplier : the load multiplier λ
    rates (n,) : the velocities x
    stress (k, 3) : the stress σ at the corners, [xx, yy, xy]
    end_status : status of the solver; empty if the solver met its tolerances
    out_of_work : whether the solver ended early because the allowed work was used up
    shear (k,) : shear rate |(εxx - εyy, εxy)| at the corners by the yield condition without the tension cut-off, times
        their weight
    torn : dissipation of corners that open at their tension cut-off
    none : not empty if the solver proved that there is no solution: "no stress" (none is in equilibrium with the loads,
        whatever the multiplier) or "no mechanism" (the live load does no work in any mechanism)
    sure : whether the solver met its tolerances, at least almost, or proved fully that there is no solution
    iterations : iterations of the interior point method, over all regularisations
    work : work in seconds on the reference machine, computed from number and size of the iterations, not measured
    seconds : processor time of the solver
    fallback : whether the solution is that of Clarabel, because the built-in interior-point method broke down or there
        is no solution
    bracket : lower and upper multiplier at which the solver stopped
    warm : starting point for programs of the same mesh with another strength
    """

    multiplier: float
    rates: np.ndarray
    stress: np.ndarray
    shear: np.ndarray
    torn: float
    end_status: str
    out_of_work: bool
    none: NoSolution | Literal[""]
    sure: bool
    iterations: int
    work: float
    seconds: float
    fallback: bool
    bracket: tuple[float, float]
    warm: "Warm | None" = None


# Largest relative difference of strength with which the solution of one ground is the starting point for another.
NEAR = 0.2


@dataclass(frozen=True, eq=False)
class Warm:
    """Holds a starting point for programs with equal matrices of strain rates, and the factors' order of elimination.

    Attributes
    ----------
    place : iterate (y, z, s) well inside the cones from which the method starts; None to start as without it
    matrix : stiffness matrix Σ Bᵀ D B of the corners, whose analysed pattern is used again
    form : program in standard form of which ``matrix`` holds the strain rates; `suits` compares other programs with it
    """

    place: Place | None
    matrix: CornerMatrix
    form: Standard

    def suits(self, form: Standard) -> bool:
        """Return whether a program has the same corners and strain rates as this starting point."""
        present, other = self.form, form
        return present.matrix.shape == other.matrix.shape and all(
            np.array_equal(first, second)
            for first, second in (
                (present.rates.indptr, other.rates.indptr),
                (present.rates.indices, other.rates.indices),
                (present.rates.data, other.rates.data),
                *(
                    (getattr(present.corners, name), getattr(other.corners, name))
                    for name in ("clay", "single", "triple")
                ),
            )
        )


def solve(
    program: ConeProgram,
    accuracy: ProgramAccuracy = BOUNDS,
    magnified: float = 1.0,
    most_work: float = math.inf,
    start: Warm | None = None,
) -> Solution:
    """Solve a cone program by the built-in interior-point method, or by Clarabel if this method finds no solution.

    Parameters
    ----------
    program : the cone program, with forces and strengths over the units of force and stress
    accuracy : tolerances and regularisation, for bounds or for elements
    magnified : factor on forces, since the tolerances of Clarabel are relative to one where forces are smaller than one
    most_work : computing work after which both methods end with their last iterate (seconds on the reference machine)
    start : starting point, used if it suits the program; it changes only the computing time

    Returns
    -------
    Stress, velocities and multiplier, with the status of the solver.
    """
    corners, n = len(program.cohesion), len(program.live)
    clay = np.flatnonzero(program.friction == 0.0)
    data = assembled(program, clay)
    started, built_in = time.thread_time(), None
    around = SETUP_SECONDS * n
    most_work -= around
    if n >= FEWEST_VELOCITIES and cholmod.available():
        built_in = _by_interior_point(program, data, magnified, accuracy.tolerance, most_work, start)
    if built_in is not None and (built_in.sure or built_in.out_of_work):
        end = built_in
    else:
        rest = most_work - (built_in.work if built_in is not None else 0.0)
        feasibility = accuracy.feasibility_at_cut_off if len(program.torn) else accuracy.feasibility
        end = _by_clarabel(accuracy.regularisations, feasibility, data, magnified, rest)
    if built_in is not None and end is not built_in:
        end = replace(
            end, work=end.work + built_in.work, iterations=end.iterations + built_in.iterations, fallback=True
        )
    x, z = end.x, end.z
    first = 1 + len(clay)
    stress = stress_of(program, -z[0], z[1:first], z[first : first + 3 * corners].reshape(corners, 3), clay)
    own_multiplier = -float(z[0])
    bracket = end.bracket or (own_multiplier, own_multiplier)
    return Solution(
        multiplier=0.5 * sum(bracket) if accuracy.in_the_middle else own_multiplier,
        rates=x[:n],
        stress=stress,
        shear=data.shear @ x,
        torn=float(data.torn @ x),
        end_status="" if end.status in CONVERGED_STATUSES else end.status,
        out_of_work=end.out_of_work,
        none=INFEASIBLE.get(end.status.removeprefix("Almost")) or "",
        sure=end.sure,
        iterations=end.iterations,
        work=end.work + around,
        seconds=time.thread_time() - started,
        fallback=end.fallback,
        bracket=bracket,
        warm=end.warm,
    )


@dataclass(frozen=True, eq=False)
class _End:
    """Holds the state at the end of a solver: status, unknowns and multipliers, whether it is certain, and work."""

    status: str
    x: np.ndarray
    z: np.ndarray
    sure: bool
    iterations: int
    work: float
    bracket: tuple[float, float] | None = None
    fallback: bool = False
    warm: Warm | None = None
    out_of_work: bool = False


def _by_interior_point(
    program: ConeProgram,
    data: Assembled,
    magnified: float,
    tolerance: Tolerance,
    most_work: float,
    start: Warm | None = None,
) -> _End:
    """Solve by the built-in interior-point method. If the method breaks down, solve again without the warm
    ``start``."""
    form, order = standard(program, data, magnified)
    warm = start if start is not None and start.suits(form) else None
    try:
        matrix = warm.matrix if warm else CornerMatrix(form.rates)
        cost = INTERIOR_SECONDS * (matrix.entries / INTERIOR_ENTRIES) ** INTERIOR_EXPONENT
        most = iterations_within(most_work, cost, interior_point.MOST_ITERATIONS)
        iterations, spent = 0, False
        for place in (warm.place, None) if warm and warm.place else (None,):
            solution = interior_point.InteriorPointMethod(form, magnified, tolerance, matrix).run(place, most)
            iterations += solution.iterations
            met = solution.residual <= tolerance.stalled_residual and solution.gap <= ACCEPTED_GAP_RATIO * tolerance.gap
            met = met or solution.below_floor
            most = iterations_within(most_work - cost * iterations, cost, interior_point.MOST_ITERATIONS)
            spent = most_work < cost * (iterations + 1)
            if met or spent:
                break
    except (MemoryError, ArithmeticError) as error:  # the second where there is no place to begin
        return _End(type(error).__name__, np.empty(0), np.empty(0), False, 0, 0.0)
    z = np.empty(len(solution.z))
    z[order] = solution.z / magnified
    work = cost * iterations
    low, high = sorted((solution.primal / magnified, solution.dual / magnified))
    warm_start = Warm(solution.warm, matrix, form) if solution.warm else None
    status = "Solved" if met else "NumericalError"
    status = "DualInfeasible" if solution.below_floor else status
    out_of_work = not met and spent
    return _End(status, solution.y, z, met, iterations, work, (low, high), warm=warm_start, out_of_work=out_of_work)


def iterations_within(most_work: float, cost: float, most: int) -> int:
    """Return the number of iterations, each of ``cost`` (seconds on the reference machine), within
    ``most_work``, from 1 to ``most``."""
    return most if most_work >= most * cost else max(1, int(most_work / cost))


def _by_clarabel(
    regularisations: Sequence[float], feasibility: float, data: Assembled, magnified: float, most_work: float
) -> _End:
    """Solve by Clarabel with the first regularisation that gives a solution, or else with the best of them."""
    ends: list[clarabel.DefaultSolution] = []
    work, spent = 0.0, False
    for regularisation in regularisations:
        settings = _settings(regularisation, feasibility)
        end, cost = interruptible(partial(_clarabel_solution, data, magnified, settings, most_work - work))
        ends.append(end)
        work += cost * end.iterations
        spent = most_work < work + cost
        if _poorness(end) == 0 or spent:
            break
    best = min(ends, key=_poorness)
    x, z = np.asarray(best.x), np.asarray(best.z) / magnified
    iterations = sum(end.iterations for end in ends)
    poorness = _poorness(best)
    return _End(str(best.status), x, z, poorness <= 1, iterations, work, out_of_work=poorness > 0 and spent)


def _clarabel_solution(
    data: Assembled, magnified: float, settings: clarabel.DefaultSettings, most_work: float
) -> tuple[clarabel.DefaultSolution, float]:
    """Return the result of Clarabel within a limit of work, and the work of one iteration. The limit is set before the
    call, since a callback would hold Python's global lock.
    """
    none = sparse.csc_matrix((len(data.cost), len(data.cost)))
    data_of_solver = none, magnified * data.cost, data.matrix.tocsc(), data.offset, data.cones
    solver = clarabel.DefaultSolver(*data_of_solver, settings)
    cost = COST_SECONDS * (solver.get_info().linsolver.nnzL / COST_NONZEROS) ** COST_EXPONENT
    settings.max_iter = iterations_within(most_work, cost, settings.max_iter)
    solver.update(settings=settings)
    return solver.solve(), cost


def _poorness(solution: clarabel.DefaultSolution) -> int:
    """Return the rank of a solution by its status, from 0 (within the tolerances) to 3 (without a solution).

    0: tolerances met (or almost, with well-met equations), or infeasibility proven; 1: tolerances almost met; 2:
    infeasibility almost proven; 3: anything else.
    """
    status = str(solution.status)
    if status == "AlmostSolved":
        return int(max(solution.r_prim, solution.r_dual) > ACCEPTED_RESIDUAL)
    if status.endswith("Infeasible"):
        return 2 if status.startswith("Almost") else 0
    return 0 if status == "Solved" else 3


def _settings(regularisation: float, feasibility: float) -> clarabel.DefaultSettings:
    settings = clarabel.DefaultSettings()
    settings.static_regularization_constant = regularisation
    settings.verbose = False
    settings.max_iter = MOST_ITERATIONS
    settings.tol_gap_abs = settings.tol_gap_rel = SOLVER_GAP
    settings.tol_feas = feasibility
    # Refinements stay the ten that are its own choice: with one, or none, it may end with all tolerances met at an
    # answer that is 3 % off (the test of a footing on a weightless slope), for a quarter of the time less.
    settings.presolve_enable = False
    settings.direct_solve_method = "qdldl"  # faster on such matrices than the multithreaded one
    return settings
