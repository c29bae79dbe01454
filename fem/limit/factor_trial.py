"""Defines trials of a factor of safety, their starting points, and the computing work that they may take."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from fem.continuum.loads import Direction
from fem.limit.bounds import KhBounds
from meshes.triangles import TriMesh

# What is bounded: the Kh that weakened ground resists, or the share of all loads, the given Kh among them.
LoadMultiplier = Literal["kh", "loads"]
# Share of the logarithm of the open interval within which, at either end of it, no secant is followed.
END_SHARE = 0.05


@dataclass(frozen=True)
class BoundsTrial:
    """Holds the bounds for ground weakened by ``factor``, proven on ``cells`` triangles; None if no bound was proven.

    The bounds are those of Kh, or of the share of all loads that the ground resists (inf if friction alone resists any
    load), as ``multiplier_kind`` says. ``no_equilibrium`` means that no stress balances the weight at any Kh. ``work``
    is the computing work in seconds on the reference machine of ``cone_program``.
    """

    factor: float
    cells: int
    multiplier_kind: LoadMultiplier
    lower: float | None
    upper: float | None
    no_equilibrium: bool
    work: float


@dataclass(frozen=True)
class TrialStart:
    """Holds the given Kh, the first factor, whether sides are smooth, and when a search may end early: once the lower
    bound is at least ``lower_suffices``, or the upper bound is below ``upper_suffices``. ``kh_bounds`` are bounds of
    the critical Kh, if they were computed before. The search may begin on one of the meshes of these bounds, which are
    fine where the ground fails.
    """

    kh: float
    factor: float
    smooth_sides: bool
    lower_suffices: float = math.inf
    upper_suffices: float = 0.0
    kh_bounds: KhBounds | None = None


def known_at_full_strength(start: TrialStart, mesh: TriMesh, direction: Direction) -> BoundsTrial | None:
    """Return the bounds of Kh on a mesh that were computed before for the ground of full strength, as a trial of the
    factor 1 without work; None if there are none for this mesh and direction of the seismic force.

    They may be those of other sides, and serve to estimate a factor, not to prove it.
    """
    if start.kh_bounds is None or start.kh_bounds.directions[0].direction != direction:
        return None
    for bounds in start.kh_bounds.directions[0].meshes:
        if bounds.mesh is mesh:
            return BoundsTrial(1.0, len(mesh.cells), "kh", bounds.lower, bounds.upper, False, 0.0)
    return None


@dataclass
class FactorWork:
    """Holds the computing work allowed and spent (seconds on the reference machine of ``cone_program``), and whether
    the search ended because no work was left."""

    allowed: float
    spent: float = 0.0
    ran_out: bool = False

    @property
    def left(self) -> float:
        return max(self.allowed - self.spent, 0.0)

    def part(self, share: float) -> "FactorWork":
        """Return a new budget that is a ``share`` of the work left."""
        return FactorWork(share * self.left)

    def allows(self, more: float) -> bool:
        """Return whether at least ``more`` work is left."""
        enough = 0.0 < self.left >= more
        self.ran_out = self.ran_out or not enough
        return enough


def gap_of_factors(lower: float, upper: float) -> float:
    """Return the upper less lower factor over their mean, inf if a factor is missing."""
    if lower <= 0.0 or not math.isfinite(upper):
        return math.inf
    return (upper - lower) / (0.5 * (upper + lower))


def within_interval(factor: float, safe: float, unsafe: float) -> float:
    """Return ``factor`` if it lies well between a stable and an unstable factor, else the middle of these two.

    ``safe`` and ``unsafe`` are the factors at which the ground stands and fails.
    """
    if not 0.0 < safe < unsafe < math.inf:
        return factor
    share = math.log(factor / safe) / math.log(unsafe / safe)
    return factor if END_SHARE <= share <= 1.0 - END_SHARE else math.sqrt(safe * unsafe)


def root_of(points: Sequence[tuple[float, float]], slope: float | None, furthest: float) -> float:
    """Return the factor of safety at which a function is zero; the function falls as the logarithm of the factor rises.

    ``points`` are pairs of the logarithm of a factor and the function, in the order of the factors. The zero is
    interpolated from the nearest points, or extrapolated from one point with ``slope``, by at most ``furthest`` in the
    logarithm; two points at one factor, which differ by the accuracy of the solver, count as one. The result is NaN if
    there is no point, or if there is only one point and ``slope`` is None.
    """
    stand, fail = [point for point in points if point[1] >= 0.0], [point for point in points if point[1] < 0.0]
    ends = [stand[-1], fail[0]] if stand and fail else stand[-2:] or fail[:2]
    if len(ends) == 2 and ends[1][1] < ends[0][1] and ends[1][0] > ends[0][0]:
        slope = (ends[1][1] - ends[0][1]) / (ends[1][0] - ends[0][0])
    if not ends or slope is None:
        return math.nan
    at, excess = min(ends, key=lambda point: abs(point[1]))
    return math.exp(at + float(np.clip(-excess / slope, -furthest, furthest)))
