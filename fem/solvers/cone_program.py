"""The second-order cone program behind both bounds, and its solution by Clarabel (Goulart & Chen 2024).

Both bounds are one problem, seen from two sides. Stresses at corners k, [xx, yy, xy], balance the loads,

    max λ  such that  Gᵀ σ = b0 + λ b1,  |((σxx - σyy)/2, σxy)| <= c cos φ - sin φ (σxx + σyy)/2,

and its dual works with rates x and strain rates ε = G x, [xx, yy, engineering xy],

    min D(ε) - b0·x  such that  b1·x = 1,  εxx + εyy >= sin φ |(εxx - εyy, εxy)|,

where D sums c cot φ (εxx + εyy), or c |(εxx - εyy, εxy)| with εxx + εyy = 0 where φ = 0, over the corners. A tension
cut-off, σm + |((σxx - σyy)/2, σxy)| <= T, is a second cone at a corner; in the dual the ground may open: ε is the
sum of such a rate and one whose volume is at least its shear rate (φ = 90°), which dissipates T times that. Corners may
have a weight w: D sums w times these, and the stress of the first problem is that of the corner times w. Clarabel
solves the second one, which is the smaller, and gives the stress as its multipliers.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Literal

import clarabel
import numpy as np
from scipy import sparse

from fem.solvers.blas_threads import use_one_thread
from fem.solvers.meanwhile import interruptible

use_one_thread()

# Relative gap at which the solver stops: each bound may lie this far from the best one of its mesh. And the residual of
# its equations: at 1e-8 what corrects it led out of the yield surface by more than the margin.
SOLVER_GAP, FEASIBILITY = 5e-6, 1e-9
# The residual where a cut-off leaves a bare surface no room for a margin.
FEASIBILITY_TORN = 1e-11
# Ends with tolerances met, the second time those of 1e-4 and 5e-5; whether the answer is a bound is checked anyhow.
MET = ("Solved", "AlmostSolved")
# The ends that prove that there is no solution.
NoSolution = Literal["no stress", "no mechanism"]
INFEASIBLE: Mapping[str, NoSolution] = {"PrimalInfeasible": "no mechanism", "DualInfeasible": "no stress"}
# Of the pivots, for mechanisms the solver's own first. Where ground next to rock has hardly any strength, which of many
# mechanisms goes is open, factorisations break down, and more of it helps; iterative refinement takes it out of the
# answer. For stress fields 1e-8 is too little from the start: of 180 programs of benches with seams, random slopes and
# layers of clay a quarter ended in "NumericalError" or met their tolerances only almost, with 1e-7 none, in as many
# iterations.
REGULARISATIONS, REGULARISATIONS_OF_STRESS = (1e-8, 1e-7, 1e-6), (1e-7, 1e-6)
# The same for elements, whose answer is no bound: at 1e-8 they often break down, and a residual of 1e-7 is met in three
# quarters of the iterations and changes the answer by 0.03 % at most, as a rule (0.1 % in 1 of 10 published cases).
REGULARISATIONS_OF_ELEMENTS, FEASIBILITY_OF_ELEMENTS = (1e-7, 1e-6), 1e-7
# Tolerances met almost will do where the equations are met to this.
NEARLY = 1e-6
MOST_ITERATIONS = 120
# Work is counted in seconds of a reference machine, so that its clock and its load decide nothing: an iteration whose
# factors have so many nonzeros takes so long, and goes with this power of them (measured from 0.2 to 2.5 million of
# them, and a fifth more for all around it). However little work is left, a program is given so many iterations: most
# need 16 to 35.
COST_NONZEROS, COST_SECONDS, COST_EXPONENT = 1e6, 0.065, 1.13
LEAST_ITERATIONS = 40


@dataclass(frozen=True, eq=False)
class ConeProgram:
    """The data of both problems, for k corners and n velocities, dimensionless.

    Attributes
    ----------
    strain : sparse matrix (3 k, n)
        G, from velocities to strain rates [xx, yy, engineering xy], corner by corner.
    cohesion, friction : ndarray (k,)
        c over the unit of stress and φ in rad.
    weight : ndarray (k,)
        w, the share of the area that a corner stands for.
    dead, live : ndarray (n,)
        b0 and b1, work of the loads on a unit velocity.
    stress_margin : ndarray (k,) or float
        Distance that the stress keeps from the yield surface, so that rounding does not lead beyond it; not from the
        cut-off, below which there may be no room.
    strain_margin : ndarray (k,) or float
        Where φ > 0, volumetric strain rate that is kept beyond that of the flow rule, for the same reason.
    strain_share : float
        The same as a share of the shear rate.
    tension : ndarray (k,) or float
        Tension cut-off over the unit of stress, inf for none.
    bare : ndarray (k,) of bool
        Corners on a bare surface, where one principal stress is zero by balance: there the cut-off is one of the other,
        which is all of the trace.
    softening : ndarray (k,) or None
        s > 0 where λ is asked of the strength and of no load: the right-hand side of the yield condition less λ s. Then
        b1 is zero, and the dual has Σ w s |(εxx - εyy, εxy)| = 1 in place of b1·x = 1.
    """

    strain: sparse.csr_matrix
    cohesion: np.ndarray
    friction: np.ndarray
    weight: np.ndarray
    dead: np.ndarray
    live: np.ndarray
    stress_margin: np.ndarray | float = 0.0
    strain_margin: np.ndarray | float = 0.0
    strain_share: float = 0.0
    tension: np.ndarray | float = np.inf
    bare: np.ndarray | bool = False
    softening: np.ndarray | None = None

    @cached_property
    def torn(self) -> np.ndarray:
        """Numbers of the corners with a tension cut-off that lies before the apex of their cone."""
        tension = np.broadcast_to(self.tension, self.cohesion.shape)
        given = np.where(np.isfinite(tension), tension, 0.0)
        return np.flatnonzero(np.isfinite(tension) & (given * np.tan(self.friction) < self.cohesion))


@dataclass(frozen=True, eq=False)
class Solution:
    """What the solver left.

    Attributes
    ----------
    multiplier : float
        The load multiplier λ.
    rates : ndarray (n,)
        The velocities x.
    stress : ndarray (k, 3)
        The stress σ at the corners, [xx, yy, xy].
    ended : str
        Empty where the solver met its tolerances, otherwise its status.
    shear : ndarray (k,)
        The shear rate |(εxx - εyy, εxy)| at the corners that their yield condition, without the cut-off, is to blame
        for, times their weight.
    torn : float
        What the opening of corners dissipates at their tension cut-off.
    none : str
        Not empty where it proved that there is no solution: "no stress" is in equilibrium with the loads, whatever the
        multiplier, or in "no mechanism" does the live load do work.
    sure : bool
        Whether it met its tolerances, at least almost, or proved that there is no solution, and not only almost.
    iterations : int
        Iterations of the interior point method, over all regularisations.
    work : float
        Their work in seconds of the reference machine, counted and not measured.
    seconds : float
        Time it took.
    """

    multiplier: float
    rates: np.ndarray
    stress: np.ndarray
    shear: np.ndarray
    torn: float
    ended: str
    none: NoSolution | Literal[""]
    sure: bool
    iterations: int
    work: float
    seconds: float


def solve(
    program: ConeProgram,
    regularisations: Sequence[float] = REGULARISATIONS,
    magnified: float = 1.0,
    most_work: float = math.inf,
) -> Solution:
    """Stress, velocities and multiplier of a program of bounds.

    A solver that ends without an answer, or meets its tolerances only almost and its equations badly, is asked again
    with the next of the ``regularisations``. Forces are handed to it ``magnified`` times as large: its residuals count
    as absolute below one. After ``most_work`` (s of the reference machine) it ends with what it has.
    """
    feasibility = FEASIBILITY_TORN if len(program.torn) else FEASIBILITY
    return _solve(program, regularisations, feasibility, magnified, most_work)


def solve_for_elements(program: ConeProgram) -> Solution:
    """The same of a program of elements, less exactly; asked again as well."""
    return _solve(program, REGULARISATIONS_OF_ELEMENTS, FEASIBILITY_OF_ELEMENTS)


def _solve(
    program: ConeProgram,
    regularisations: Sequence[float],
    feasibility: float,
    magnified: float = 1.0,
    most_work: float = math.inf,
) -> Solution:
    """The solution by the first of some regularisations that leads to one, or by the best of them."""
    corners, n = len(program.cohesion), len(program.live)
    clay = np.flatnonzero(program.friction == 0.0)
    data = _assembled(program, clay)
    ends: list[clarabel.DefaultSolution] = []
    work = 0.0
    for regularisation in regularisations:
        settings = _settings(regularisation, feasibility)
        end, cost = interruptible(partial(_solved, data, magnified, settings, most_work - work))
        ends.append(end)
        work += cost * end.iterations
        if _poorness(end) == 0 or work >= most_work:
            break
    found = min(ends, key=_poorness)
    status = str(found.status)
    x, z = np.asarray(found.x), np.asarray(found.z) / magnified
    first = 1 + len(clay)
    stress = _stress(program, -z[0], z[1:first], z[first : first + 3 * corners].reshape(corners, 3), clay)
    none = INFEASIBLE.get(status.removeprefix("Almost")) or ""
    return Solution(
        multiplier=-float(z[0]),
        rates=x[:n],
        stress=stress,
        shear=data.shear @ x,
        torn=float(data.torn @ x),
        ended="" if status in MET else status,
        none=none,
        sure=_poorness(found) <= 1,
        iterations=sum(end.iterations for end in ends),
        work=work,
        seconds=found.solve_time,
    )


def _solved(
    data: "_Assembled", magnified: float, settings: clarabel.DefaultSettings, most_work: float
) -> tuple[clarabel.DefaultSolution, float]:
    """What the solver finds in so much work, and the work of an iteration; with a callback it would keep Python's
    lock."""
    none = sparse.csc_matrix((len(data.cost), len(data.cost)))
    data_of_solver = none, magnified * data.cost, data.matrix.tocsc(), data.offset, data.cones
    solver = clarabel.DefaultSolver(*data_of_solver, settings)
    cost = COST_SECONDS * (solver.get_info().linsolver.nnzL / COST_NONZEROS) ** COST_EXPONENT
    if most_work < settings.max_iter * cost:
        settings.max_iter = max(LEAST_ITERATIONS, int(most_work / cost))
        solver.update(settings=settings)
    return solver.solve(), cost


def _poorness(found: clarabel.DefaultSolution) -> int:
    """0 where the solver met its tolerances, or almost and its equations well, or proved that there is no solution; 1
    where it met them almost; 2 where it almost proved that, and 3 where it ended otherwise."""
    status = str(found.status)
    if status == "AlmostSolved":
        return int(max(found.r_prim, found.r_dual) > NEARLY)
    if status.endswith("Infeasible"):
        return 2 if status.startswith("Almost") else 0
    return 0 if status == "Solved" else 3


@dataclass(frozen=True, eq=False)
class _Assembled:
    """min cost·y with matrix y + s = offset and s in the ``cones``: y are the rates, for each corner of φ = 0 its
    dissipation over c, and how torn corners open. ``shear`` and ``torn`` make those of the ``Solution`` from y."""

    cost: np.ndarray
    matrix: sparse.csr_matrix
    offset: np.ndarray
    cones: list
    shear: sparse.csr_matrix
    torn: np.ndarray


def _assembled(program: ConeProgram, clay: np.ndarray) -> _Assembled:
    """The second problem as the solver wants it; ``clay`` are the numbers of the corners of φ = 0."""
    corners = len(program.cohesion)
    sin, cos = np.sin(program.friction), np.cos(program.friction)
    steeper = sin * (1.0 + program.strain_share)
    opening, tears, no_tears, torn_cones = _opening(program)
    volume = _volumetric(corners)
    across = sparse.hstack(
        [volume @ program.strain, sparse.csr_matrix((corners, len(clay))), -volume @ opening]
    ).tocsr()
    shear = _shear_of(program, across, clay)
    torn = np.pad(opening.T @ (volume.T @ _tension_of(program)), (len(program.live) + len(clay), 0))
    cost = shear.T @ (np.where(sin > 0.0, program.cohesion * cos, program.cohesion) - program.stress_margin) + torn
    cost[: len(program.live)] -= program.dead
    extra = sparse.csr_matrix((np.ones(len(clay)), (3 * clay, np.arange(len(clay)))), shape=(3 * corners, len(clay)))
    turned = _cone_map(steeper)
    cone = sparse.hstack([turned @ program.strain, extra, -turned @ opening])
    load = np.pad(program.live, (0, cone.shape[1] - len(program.live)))
    if program.softening is not None:
        load = shear.T @ program.softening
    before = sparse.csr_matrix((tears.shape[0], cone.shape[1] - tears.shape[1]))
    margin = np.zeros((corners, 3))
    margin[:, 0] = np.where(sin > 0.0, program.strain_margin, 0.0)
    offset = np.concatenate([[1.0], np.zeros(len(clay)), -margin.ravel(), no_tears])
    cones = [clarabel.ZeroConeT(1 + len(clay)), *[clarabel.SecondOrderConeT(3)] * corners, *torn_cones]
    rows = [sparse.csr_matrix(load), across[clay], -cone, sparse.hstack([before, -tears])]
    return _Assembled(cost, sparse.vstack(rows).tocsr(), offset, cones, shear, torn)


def _shear_of(program: ConeProgram, across: sparse.csr_matrix, clay: np.ndarray) -> sparse.csr_matrix:
    """From the unknowns to the weighted shear rates (k,): volume over sin φ, or the unknown of a corner of φ = 0."""
    corners, sin = len(program.cohesion), np.sin(program.friction)
    of_volume = sparse.diags(np.divide(program.weight, sin, out=np.zeros(corners), where=sin > 0.0)) @ across
    own = (clay, len(program.live) + np.arange(len(clay)))
    return (of_volume + sparse.csr_matrix((program.weight[clay], own), shape=across.shape)).tocsr()


def _tension_of(program: ConeProgram) -> np.ndarray:
    """What a corner (k,) dissipates per volume that it opens by: weight times T; 0 for no cut-off.

    On a bare surface, half of it: the stress that T ends is the whole trace there, twice the mean.
    """
    torn = program.torn
    tension = np.zeros(len(program.cohesion))
    bare, given = (np.broadcast_to(value, tension.shape)[torn] for value in (program.bare, program.tension))
    tension[torn] = program.weight[torn] * np.where(bare, 0.5 * given, given)
    return tension


def _opening(program: ConeProgram) -> tuple[sparse.csr_matrix, sparse.csr_matrix, np.ndarray, list]:
    """How torn corners open: strain rates (3 k, p) of p unknowns, and a matrix, offset and cones that these lie in.

    Three unknowns a corner, a strain rate whose volume is at least its shear; on a bare surface one, half the volume.
    """
    torn, corners = program.torn, len(program.cohesion)
    bare = np.broadcast_to(program.bare, corners)[torn]
    one, three = torn[bare], torn[~bare]
    single = np.arange(len(one))
    rows = np.concatenate([3 * one, 3 * one + 1, (3 * three[:, None] + [0, 1, 2]).ravel()])
    columns = np.concatenate([single, single, len(one) + np.arange(3 * len(three))])
    opening = sparse.csr_matrix((np.ones(len(rows)), (rows, columns)), shape=(3 * corners, len(one) + 3 * len(three)))
    margins = np.where(program.friction > 0.0, 0.0, program.strain_margin)
    least = np.zeros((len(three), 3))
    least[:, 0] = margins[three]
    tears = sparse.block_diag(
        [sparse.identity(len(one)), _cone_map(np.full(len(three), 1.0 + program.strain_share))], format="csr"
    )
    offset = np.concatenate([-0.5 * margins[one], -least.ravel()])
    cones = [clarabel.NonnegativeConeT(len(one))] if len(one) else []
    return opening, tears, offset, [*cones, *[clarabel.SecondOrderConeT(3)] * len(three)]


def _volumetric(corners: int) -> sparse.csr_matrix:
    """From strain rates (3 k,) to their volumetric part (k,)."""
    rows = np.repeat(np.arange(corners), 2)
    columns = (3 * np.arange(corners)[:, None] + [0, 1]).ravel()
    return sparse.csr_matrix((np.ones(2 * corners), (rows, columns)), shape=(corners, 3 * corners))


def _cone_map(sin: np.ndarray) -> sparse.csr_matrix:
    """From strain rates (3 k,) to what lies in a cone: [volume, sin φ (xx - yy), sin φ xy], or [0, xx - yy, xy]."""
    corners = len(sin)
    first = 3 * np.arange(corners)
    much = np.where(sin > 0.0, sin, 1.0)
    dilates = np.where(sin > 0.0, 1.0, 0.0)
    rows = np.concatenate([first, first, first + 1, first + 1, first + 2])
    columns = np.concatenate([first, first + 1, first, first + 1, first + 2])
    values = np.concatenate([dilates, dilates, much, -much, much])
    return sparse.csr_matrix((values, (rows, columns)), shape=(3 * corners, 3 * corners))


def _stress(
    program: ConeProgram, multiplier: float, pressure: np.ndarray, z: np.ndarray, clay: np.ndarray
) -> np.ndarray:
    """The stress (k, 3) that the multipliers of the cones and of the volume of clay stand for."""
    sin, cos = np.sin(program.friction), np.cos(program.friction)
    radius = np.where(sin > 0.0, program.cohesion * cos, program.cohesion) - program.stress_margin
    if program.softening is not None:
        radius = radius - multiplier * program.softening
    z = z / program.weight[:, None]
    mean = np.divide(radius, sin, out=np.zeros(len(sin)), where=sin > 0.0) - z[:, 0]
    mean[clay] = pressure / program.weight[clay]
    much = np.where(sin > 0.0, sin * (1.0 + program.strain_share), 1.0)
    half, shear = -much * z[:, 1], -much * z[:, 2]
    return np.stack([mean + half, mean - half, shear], axis=1)


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
