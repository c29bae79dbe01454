"""Solves unconfined seepage on a fixed grid: the pressure head and the saturated share of the pores solve a
complementarity problem (kernel).

The equations are Darcy's law and continuity for water without capillary rise (Brezis, Kinderlehrer & Stampacchia 1978,
C. R. Acad. Sci. Paris 287, 711; of layered ground Alt 1979, J. reine angew. Math. 305, 89), with the pressure head p
and the saturated share θ of the pores:

    q = -K (∇p + θ e_z),   div q = 0,   p >= 0,   0 <= θ <= 1,   p (1 - θ) = 0

Below the phreatic line θ = 1. Above it p = 0, and the water there falls at the rate s = θ k_z, which is the same on
both sides of an interface: a dry shell sucks no water out of a core. On bare ground p = 0, and water flows out where θ
= 1.

Pressures are discretised by linear triangles. Each triangle has one vertical side on a grid line. The whole weight of
the water in a triangle acts along this side, from its upper end, which determines θ (upwind). An edge of obtuse
triangles may have a negative conductance; then conductance and fall along this edge are both raised until the
conductance is zero, so that still water stays still. So every equation rises with its own unknown and falls with all
others (an M-function), and the set of wet points is found by Newton's method, with one linear solution a step.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csr_array, diags_array
from scipy.sparse.linalg import splu

from meshes.section.flow_grid import FlowGrid

MOST_ITERATIONS = 300
# Share of Newton's step that is taken, and up to which iteration: sets that would follow each other for ever do not.
STEPS = ((20, 1.0), (60, 0.5), (150, 0.25), (MOST_ITERATIONS, 0.1))
# Of a permeability, a rate or a pressure head in m: smaller differences are rounding.
ROUNDING = 1e-9
# Change (m) of pressure heads below which they have come to rest, where points at the shore of the water keep
# changing sides.
HEAD_TOLERANCE = 1e-6


@dataclass(frozen=True, eq=False)
class FreeSurfaceFlow:
    """Holds the steady flow at the points of a grid.

    Attributes
    ----------
    pressure (n,) : pressure head (m), never negative
    full (n,) : mask of the points at which the pores of the ground are full; at an interface the pores of the least
        permeable ground count
    seeps (n,) : mask of the points of bare ground at which water leaves the ground
    inflow (n,) : flow that enters the ground at a point (m²/s), negative if it leaves
    converged : whether the set of wet points converged
    """

    pressure: np.ndarray
    full: np.ndarray
    seeps: np.ndarray
    inflow: np.ndarray
    converged: bool


@dataclass(frozen=True, eq=False)
class _FallingEdges:
    """Holds the edges (e,) along which water falls: upper and lower points, area (m) and permeability."""

    upper: np.ndarray
    lower: np.ndarray
    area: np.ndarray
    permeability: np.ndarray

    def matrix(self, weights: np.ndarray, size: int) -> csr_array:
        """Return the matrix of the net outflow from every point, if ``weights`` (e,) times the value at the upper end
        flows along each edge."""
        rows = np.concatenate([self.upper, self.lower])
        values = np.concatenate([weights, -weights])
        return coo_array((values, (rows, np.tile(self.upper, 2))), shape=(size, size)).tocsr()


def free_surface_flow(
    grid: FlowGrid, permeability: np.ndarray, pressure: np.ndarray, bare: np.ndarray
) -> FreeSurfaceFlow:
    """Compute the steady flow with a free surface.

    Parameters
    ----------
    grid : FlowGrid
    permeability : (strata, 2) ndarray
        Horizontal and vertical permeability (m/s).
    pressure : (n,) ndarray
        Prescribed pressure heads (m), above 0; NaN at other points.
    bare : (n,) ndarray of bool
        Points at which water can leave without pressure.
    """
    size, unit = len(grid.points), float(permeability.max())
    conductance, falls = _discretised(grid, permeability / unit)
    diagonal = conductance.diagonal()
    most = np.zeros(size)  # the rate at which water falls that fills the pores, and with it the share of its own that
    np.maximum.at(most, falls.upper, falls.permeability)  # a point's pressure takes to press as much out
    through = np.bincount(falls.upper, falls.area, minlength=size) / diagonal
    ends = through == 0.0  # of all falls: points of the base
    through[ends] = 1.0
    fixed = np.isfinite(pressure)

    # One unknown a point: the pressure, or, below 0, the rate less the most in terms of the pressure that it is worth.
    def state(unknown: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the points (n,) that are dry, the rates (n,) at which water falls from them, and the edges that can
        take more water."""
        dry = (unknown < -ROUNDING) & ~fixed
        rate = np.where(dry, np.minimum(most + unknown / through, (1.0 - ROUNDING) * most), most)
        return dry, rate, dry[falls.upper] & (rate[falls.upper] < falls.permeability)

    unknown = np.where(fixed, pressure, 0.0)
    step = iter(STEPS)
    until, share = next(step)
    for iteration in range(1, MOST_ITERATIONS + 1):
        dry, rate, spare = state(unknown)
        seeping = bare & ~dry
        prescribed = fixed | seeping | (dry & ends)
        wanted = np.where(fixed, pressure, 0.0)
        slopes = np.where(spare, falls.area / through[falls.upper], 0.0)
        constant = falls.area * np.where(spare, most[falls.upper], falls.permeability)
        matrix = (conductance @ diags_array((~dry).astype(float)) + falls.matrix(slopes, size)).tocsr()
        load = np.bincount(falls.lower, constant, minlength=size) - np.bincount(falls.upper, constant, minlength=size)
        free = np.flatnonzero(~prescribed)
        if len(free):
            right = (load - matrix @ wanted)[free]
            wanted[free] = splu(matrix[free][:, free].tocsc()).solve(right)
        inflow = matrix @ wanted - load
        outlets = seeping | (dry & ends)
        wanted[outlets] = -inflow[outlets] / diagonal[outlets]
        next_dry, _, next_spare = state(wanted)
        wanted[bare] = np.minimum(wanted[bare], 0.0)
        if np.array_equal(dry, next_dry) and np.array_equal(spare, next_spare):
            break
        if iteration > until:
            until, share = next(step)
        if share < 1.0 and np.abs(wanted - unknown).max() <= HEAD_TOLERANCE:
            break
        unknown = unknown + share * (wanted - unknown)
    converged = iteration < MOST_ITERATIONS
    least = np.full(size, np.inf)
    np.minimum.at(least, falls.upper, falls.permeability)
    full = ~dry | (~ends & (rate >= (1.0 - ROUNDING) * least))
    inflow = np.where(fixed | seeping, unit * inflow, 0.0)
    return FreeSurfaceFlow(np.where(dry, 0.0, np.maximum(wanted, 0.0)), full, seeping, inflow, converged)


def _discretised(grid: FlowGrid, permeability: np.ndarray) -> tuple[csr_array, _FallingEdges]:
    """Return conductances (n, n), none of them negative between two points, and the edges along which water falls."""
    size, cells, z = len(grid.points), grid.cells, grid.points[:, 1]
    blocks = element_conductances(grid, permeability)
    places = (np.repeat(cells, 3, axis=1).ravel(), np.tile(cells, 3).ravel())
    matrix = coo_array((blocks.ravel(), places), shape=(size, size)).tocsr()
    x = grid.points[cells, 0]
    row, first = np.arange(len(cells)), np.argmin(np.abs(x - np.roll(x, -1, axis=1)), axis=1)
    start, end, apex = (cells[row, (first + k) % 3] for k in range(3))
    upright = np.where(z[start] > z[end], start, end), np.where(z[start] > z[end], end, start)
    area, along = 0.5 * np.abs(grid.points[apex, 0] - grid.points[start, 0]), permeability[grid.stratum, 1]
    most = np.zeros(size)
    np.maximum.at(most, cells.ravel(), np.repeat(along, 3))
    falling = np.zeros(size)
    np.maximum.at(falling, upright[0], along)
    most = np.where(falling > 0.0, falling, most)
    entries = matrix.tocoo()
    below = (entries.row < entries.col) & (entries.data > 0.0)
    start, end, lacking = entries.row[below], entries.col[below], entries.data[below]
    upper, lower = np.where(z[start] > z[end], start, end), np.where(z[start] > z[end], end, start)
    places = (np.concatenate([start, end, start, end]), np.concatenate([start, end, end, start]))
    added = coo_array((np.concatenate([lacking, lacking, -lacking, -lacking]), places), shape=(size, size))
    return (matrix + added).tocsr(), _FallingEdges(
        np.concatenate([upright[0], upper]),
        np.concatenate([upright[1], lower]),
        np.concatenate([area, lacking * (z[upper] - z[lower]) / most[upper]]),
        np.concatenate([along, most[upper]]),
    )


def element_conductances(grid: FlowGrid, permeability: np.ndarray) -> np.ndarray:
    """Return the conductances (m, 3, 3) of the triangles (m/s): the integral of k ∇N_i ∇N_j."""
    x, z = (grid.points[grid.cells, axis] for axis in (0, 1))
    slope_x = z[:, [1, 2, 0]] - z[:, [2, 0, 1]]
    slope_z = x[:, [2, 0, 1]] - x[:, [1, 2, 0]]
    twice = (slope_x * x).sum(axis=1)
    k = permeability[grid.stratum]
    weight = 0.5 / twice
    along = np.einsum("m,mi,mj->mij", k[:, 0] * weight, slope_x, slope_x)
    return np.asarray(along + np.einsum("m,mi,mj->mij", k[:, 1] * weight, slope_z, slope_z))
