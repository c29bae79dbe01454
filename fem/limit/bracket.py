"""Keeps the best lower and upper bound of a sequence of meshes, and the limits at which the sequence ends."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from fem.limit.bound_checks import StressCheck, VelocityCheck, corner_rates, dissipation
from fem.limit.limit_problem import LimitProblem
from meshes.triangles import TriMesh

# Ratio of the numbers of cells of two meshes in succession.
CELL_RATIO = 2.0
# Largest ratio of these numbers if the second mesh is expected to close the gap, and ratio of the gap for which it is
# made to the required gap.
MOST_CELL_RATIO, GAP_RATIO_AIMED_AT = 3.0, 1.15
# Smallest ratio of these numbers with which a mesh is worth its work.
LEAST_CELL_RATIO = 1.2
# Exponent of the number of cells in the computing work.
COST_EXPONENT = 1.15
# Number of meshes in succession after which a search has stalled if more than this share of the gap is left.
STALLED_MESHES, STALLED_SHARE = 2, 0.9
# Number of meshes in succession on which the solver fails at the same bound that ends the search.
FAILED_MESHES = 2

# Why there is no finer mesh: the gap is closed as far as was asked, the upper bound is small enough, no more triangles
# or no more work are allowed, finer meshes no longer close the gap, or the solver fails on them.
OpenEnd = Literal["triangles", "time", "stalled", "solver"]
EndReason = Literal["gap", "enough"] | OpenEnd
BoundSide = Literal["lower", "upper"]


@dataclass(frozen=True, eq=False)
class StressField:
    """Holds a dimensionless stress field that was checked to be statically admissible.

    Attributes
    ----------
    problem : the problem that the stress belongs to
    multiplier : the load multiplier with which the stress is in equilibrium: a strict lower bound
    stress (m, 3 corners, [xx, yy, xy]) : the stress at the corners of every cell
    check : how well the stress fulfils its conditions
    """

    problem: LimitProblem
    multiplier: float
    stress: np.ndarray
    check: StressCheck


@dataclass(frozen=True, eq=False)
class Mechanism:
    """Holds a dimensionless velocity field that was checked to be kinematically admissible.

    Attributes
    ----------
    problem : the problem that the velocities belong to
    multiplier : the load multiplier at which the dissipation is equal to the work of the loads: a strict upper bound
    velocity (m, 6 nodes, 2) : velocities of every cell at its corners, then at the middles of its edges
    check : how well the velocities fulfil their conditions
    """

    problem: LimitProblem
    multiplier: float
    velocity: np.ndarray
    check: VelocityCheck

    @property
    def dissipation(self) -> np.ndarray:
        """Return the plastic dissipation (m,) of every cell."""
        return dissipation(self.problem, corner_rates(self.problem, self.velocity))


@dataclass(frozen=True)
class MeshBounds:
    """Holds the bounds on one mesh.

    Attributes
    ----------
    cells : number of triangles of the mesh
    lower, upper : the strict bounds of the load multiplier, None if there is none
    notes : reasons why a bound is missing
    work : computing work of both cone programs in seconds on the reference machine; it is computed from the number of
        iterations, not measured (``cone_program.py``)
    failed : bounds that are missing because the solver ended early, or because its answer did not pass the check
    fallback : bounds that Clarabel found after the built-in interior-point method had broken down
    mesh : the mesh, with lengths in m, if it is stored: the search for a factor of safety may begin on this mesh
    """

    cells: int
    lower: float | None
    upper: float | None
    notes: tuple[str, ...]
    work: float
    failed: tuple[BoundSide, ...] = ()
    fallback: tuple[BoundSide, ...] = ()
    mesh: TriMesh | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, eq=False)
class Bracket:
    """Holds the best lower and upper bound over all meshes so far.

    Attributes
    ----------
    stress : the stress field of the largest lower bound, None without one
    mechanism : the mechanism of the smallest upper bound, None without one
    meshes : the bounds on every mesh, in their order
    mesh : the last mesh, in m
    end_reason : reason why there is no finer mesh; None while the search continues
    open_at : where the bounds differ most, (x, y) in m, if the search ended before the gap was small enough
    """

    stress: StressField | None
    mechanism: Mechanism | None
    meshes: list[MeshBounds]
    mesh: TriMesh
    end_reason: EndReason | None = None
    open_at: tuple[float, float] | None = None

    @property
    def lower(self) -> float:
        """Return the lower bound, -inf without one."""
        return self.stress.multiplier if self.stress else -np.inf

    @property
    def upper(self) -> float:
        """Return the upper bound, inf without one."""
        return self.mechanism.multiplier if self.mechanism else np.inf

    @property
    def gap(self) -> float:
        """Return the upper less lower bound over the mean of their sizes; inf if a bound is missing."""
        if not (self.stress and self.mechanism):
            return np.inf
        return (self.upper - self.lower) / max(0.5 * (abs(self.upper) + abs(self.lower)), 1e-12)


@dataclass(frozen=True)
class Limits:
    """Holds the limits at which the search for bounds ends.

    Attributes
    ----------
    gap : required gap between the bounds, as a share of their mean, or of ``smallest_mean`` if the mean is smaller
    max_cells : largest number of triangles of any mesh
    seconds : largest computing work for all meshes, in seconds on the reference machine. A further mesh is begun if it
        is likely to be solved within this work. Work is computed from the number of iterations, not measured, so that
        the same input has the same meshes on a busy machine.
    sufficient_upper : load multiplier below which an upper bound needs no improvement
    smallest_mean : multiplier below which ``gap`` is a share of this constant instead of the mean; ``LEAST_KH`` for Kh
    """

    gap: float
    max_cells: int
    seconds: float = np.inf
    sufficient_upper: float = -np.inf
    smallest_mean: float = 0.0

    def open(self, lower: float, upper: float) -> float:
        """Return the gap of two bounds over the required gap; inf if a bound is missing."""
        if not (np.isfinite(lower) and np.isfinite(upper)):
            return np.inf
        return (upper - lower) / max(self.gap * max(0.5 * (abs(upper) + abs(lower)), self.smallest_mean), 1e-12)

    def growth(self, bracket: Bracket, cells: int) -> float:
        """Return the ratio of the number of cells of the next mesh to that of the last mesh. The ratio is large enough
        to close the gap, if one step can do that.

        The gap is about proportional to one over the number of cells, or falls a little faster.
        """
        needed = GAP_RATIO_AIMED_AT * self.open(bracket.lower, bracket.upper)
        return min(max(needed, LEAST_CELL_RATIO) if needed <= MOST_CELL_RATIO else CELL_RATIO, self.max_cells / cells)

    def reached(self, bracket: Bracket, cells: int, others: float = 0.0) -> EndReason | None:
        """Return the name of the limit that ends the search; ``others`` is the computing work of other searches, which
        counts towards the same limit of work."""
        if self.open(bracket.lower, bracket.upper) <= 1.0:
            return "gap"
        if bracket.upper < self.sufficient_upper:
            return "enough"
        if cells * LEAST_CELL_RATIO > self.max_cells:
            return "triangles"
        spent = others + sum(mesh.work for mesh in bracket.meshes)
        if spent + CELL_RATIO**COST_EXPONENT * bracket.meshes[-1].work > self.seconds:
            return "time"
        if _solver_fails(bracket.meshes):
            return "solver"
        return "stalled" if _stalled(bracket.meshes) else None


def _solver_fails(meshes: Sequence[MeshBounds]) -> bool:
    """Return whether the solver ended early at the same bound on each of the last few meshes."""
    last = [set(mesh.failed) for mesh in meshes[-FAILED_MESHES:]]
    return len(last) == FAILED_MESHES and bool(set.intersection(*last))


def _stalled(meshes: Sequence[MeshBounds]) -> bool:
    """Return whether the last two refinements hardly reduced the gap, or did not prove a bound."""
    if len(meshes) < 3 + STALLED_MESHES:
        return False
    best = []
    for count in (len(meshes) - STALLED_MESHES, len(meshes)):
        lower = max((m.lower for m in meshes[:count] if m.lower is not None), default=-np.inf)
        upper = min((m.upper for m in meshes[:count] if m.upper is not None), default=np.inf)
        best.append(upper - lower)
    before, now = best
    return bool(now > STALLED_SHARE * before or np.isinf(now))
