"""Steady seepage through a section by finite elements: heads, phreatic line, seepage face, discharge.

Darcy's law q = -k ∇h with h = z + u / γw, and div q = 0 (Bear 1972, Dynamics of Fluids in Porous Media), on linear
triangles. Where water stands on the ground, and on the sides below the ends of the table, the head is given; the base
and the rest of the sides are impermeable. On the rest of the ground either water comes out and u = 0, a seepage face,
or none passes and u <= 0: which, is found point by point. The mesh is fixed: above the phreatic line permeabilities are
a thousandth (Bathe & Khoshgoftaar 1979, Int. J. Num. Anal. Meth. Geomech. 3, 13), in triangles that it crosses in
proportion to what lies below it, so that no suction is taken into account and little water flows above.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from meshes.errors import NoAnswerError
from meshes.section.flow_grid import FlowGrid
from meshes.section.polyline import level_at
from meshes.section.simplified import needed

# Permeability above the phreatic line, over that below it.
DRY = 1e-3
# The iteration ends when no head changes by more than this share of the height of the section.
SAME_HEAD = 1e-5
MOST_ITERATIONS = 400
# A point of the ground that has changed from dry to seeping and back so often stays as it is.
MOST_CHANGES = 10
# Share of the change of permeabilities that an iteration takes on, and what it is when the changes do not fade.
STEP, LEAST_STEP = 0.7, 0.02
# The line of the water may pass its points at this share of the distance of vertical lines.
LINE = 0.25


class SeepageError(NoAnswerError):
    """The phreatic line was not found."""

    MISSING = "No seepage"


@dataclass(frozen=True, eq=False)
class Seepage:
    """Steady flow.

    Attributes
    ----------
    grid : FlowGrid
        Where it was found.
    head : (n,) ndarray
        Head at the points of the grid (m).
    inflow : (n,) ndarray
        Water that enters the ground at a point, per length of the section's third direction (m²/s); below 0 where it
        leaves.
    seeps : (n,) ndarray of bool
        Points of seepage faces.
    table : (k, 2) ndarray
        The water table that gave the heads (m): free water stands up to it.
    tolerance : float
        Points closer than this (m) are one.
    """

    grid: FlowGrid
    head: np.ndarray
    inflow: np.ndarray
    seeps: np.ndarray
    table: np.ndarray
    tolerance: float

    @property
    def discharge(self) -> float:
        """Water that flows through the section, per length of its third direction (m²/s)."""
        return float(np.maximum(self.inflow, 0.0).sum())

    @cached_property
    def exit_gradient(self) -> tuple[float, float]:
        """The largest upward gradient (-) in triangles from which water leaves the ground, and its x (m)."""
        grid, leaves = self.grid, np.zeros(len(self.head), dtype=bool)
        leaves[grid.ground] = self.inflow[grid.ground] < 0.0
        cells = grid.cells[leaves[grid.cells].sum(axis=1) >= 2]
        if not len(cells):
            return 0.0, float(grid.x[0])
        x, z = (grid.points[cells, axis] for axis in (0, 1))
        across = x[:, [2, 0, 1]] - x[:, [1, 2, 0]]
        twice = ((z[:, [1, 2, 0]] - z[:, [2, 0, 1]]) * x).sum(axis=1)
        upward = -(across * self.head[cells]).sum(axis=1) / twice
        worst = int(np.argmax(upward))
        return float(upward[worst]), float(x[worst].mean())

    @property
    def words(self) -> str:
        """How much flows, where it comes out above free water, and how steeply it rises there."""
        faces = " and ".join(f"x = {start:.4g} to {end:.4g} m" for start, end in self.seepage_faces)
        gradient, x = self.exit_gradient
        leaves = f"; it seeps out of the ground from {faces}" if faces else ""
        steep = f"; the largest upward gradient where it leaves is {gradient:.2g}, at x = {x:.4g} m"
        through = f"{self.discharge:.3g} m²/s seep through a metre of the section"
        return f"{through}{leaves}{steep if gradient > 0.0 else ''}"

    def pressure_head(self, points: np.ndarray, near: np.ndarray) -> np.ndarray:
        """Pore pressure over γw (n,) in m at points (n, 2), 0 above the phreatic line; see `FlowGrid.interpolated`."""
        head = self.grid.interpolated(self.head, points, near, self.tolerance)
        return np.maximum(np.nan_to_num(head - points[:, 1], nan=0.0), 0.0)

    @cached_property
    def water_line(self) -> np.ndarray:
        """The phreatic line and the surface of free water (n, 2), from the left to the right (m), without points that
        make little difference; two at one x where the sides of a vertical line differ. On the base where it is dry."""
        x = self.grid.x
        points: list[tuple[float, float]] = []
        pressure = self.head - self.grid.points[:, 1]
        middle = 0.5 * (x[1:] + x[:-1])
        for strip, rungs in enumerate(self.grid.rungs):
            for side in (0, 1):
                chain = (
                    rungs[np.append(True, rungs[1:, side] != rungs[:-1, side]), side] if len(rungs) else rungs[:, side]
                )
                at = float(x[strip + side])
                free = float(level_at(self.table, x[[strip + side]], middle[[strip]])[0])
                level = _highest(self.grid.points[chain, 1], pressure[chain], self.tolerance) if len(chain) else free
                points.append(
                    (at, level if len(chain) and level < self.grid.points[chain[-1], 1] else max(level, free))
                )
        line = np.array(points)
        again = np.append(False, np.abs(np.diff(line, axis=0)).max(axis=1) <= self.tolerance)
        line = line[~again]
        return line[needed(line, LINE * float(np.median(np.diff(x))))]

    @cached_property
    def seepage_faces(self) -> list[tuple[float, float]]:
        """Ends (m) along x of the stretches of ground through which water comes out without standing on it."""
        bare = np.abs(self.head - self.grid.points[:, 1])[self.grid.ground] <= 1e-3 * self.tolerance
        lines, ground = self.grid.x, self.grid.ground
        out = self.inflow[ground] < 0.0
        seeping, on_shore = (np.unique(np.searchsorted(lines, self.grid.points[ground[here], 0]))
                             for here in (out & self.seeps[ground], out & bare))  # fmt: skip
        runs = np.split(seeping, np.flatnonzero(np.diff(seeping) > 1) + 1) if len(seeping) else []
        return [(float(lines[run[0] - ((run[0] - 1) in on_shore)]), float(lines[run[-1] + ((run[-1] + 1) in on_shore)]))
                for run in runs]  # fmt: skip

    @cached_property
    def marks(self) -> np.ndarray:
        """x (m) at which the pore pressure just below the ground changes its rule, and of walls."""
        return np.array([*self.grid.walls, *(end for face in self.seepage_faces for end in face)])


def _highest(z: np.ndarray, pressure: np.ndarray, tolerance: float) -> float:
    """Elevation below which the highest water lies, of pressure heads at elevations that rise (m)."""
    wet = np.flatnonzero(pressure >= -1e-3 * tolerance)
    if not len(wet):
        return float(z[0])
    top = int(wet[-1])
    if top + 1 == len(z):
        return float(z[-1])
    share = max(pressure[top], 0.0) / (max(pressure[top], 0.0) - pressure[top + 1])
    return float(z[top] + share * (z[top + 1] - z[top]))


def steady_seepage(
    grid: FlowGrid, permeability: np.ndarray, heads: np.ndarray, table: np.ndarray, tolerance: float
) -> Seepage:
    """The steady flow of water.

    Parameters
    ----------
    grid : FlowGrid
    permeability : (strata, 2) ndarray
        Horizontal and vertical permeability (m/s).
    heads : (n,) ndarray
        Heads (m) that are given, not a number where they are found.
    table : (k, 2) ndarray
        The water table that gave them.
    tolerance : float
        Points closer than this (m) are one.

    Returns
    -------
    Seepage

    Raises
    ------
    SeepageError
        If the phreatic line does not come to rest.
    """
    z, fixed = grid.points[:, 1], np.isfinite(heads)
    blocks = _blocks(grid, permeability)
    height = float(np.ptp(z))
    shore = np.setdiff1d(grid.ground, np.flatnonzero(fixed))
    seeps, changes = np.zeros(len(z), dtype=bool), np.zeros(len(z), dtype=int)
    share, step, before = np.ones(len(grid.cells)), STEP, np.inf
    head = np.full(len(z), float(np.nanmax(heads)))
    for _ in range(MOST_ITERATIONS):
        known = fixed | seeps
        last, values = head, np.where(fixed, heads, z)
        head, inflow = _solved(blocks * (DRY + (1.0 - DRY) * share)[:, None, None], grid.cells, known, values)
        flips = shore[np.where(seeps[shore], inflow[shore] > 0.0, head[shore] > z[shore])]
        flips = flips[changes[flips] < MOST_CHANGES]
        seeps[flips], changes[flips] = ~seeps[flips], changes[flips] + 1
        moved = float(np.abs(head - last).max())
        wanted = wet_share((head - z)[grid.cells])
        if moved <= SAME_HEAD * height and not len(flips):
            return Seepage(grid, head, np.where(known, inflow, 0.0), seeps, table, tolerance)
        if moved > 0.95 * before and not len(flips):
            step = max(0.8 * step, LEAST_STEP)
        before = moved
        share = share + step * (wanted - share)
    raise SeepageError(
        f"the phreatic line does not come to rest: after {MOST_ITERATIONS} iterations heads change by {moved:.2g} m",
        "permeabilities that differ less, or a table in the place of flow = true",
    )


def _blocks(grid: FlowGrid, permeability: np.ndarray) -> np.ndarray:
    """Conductances (m, 3, 3) of the triangles (m/s): the integral of k ∇N_i ∇N_j."""
    x, z = (grid.points[grid.cells, axis] for axis in (0, 1))
    slope_x = z[:, [1, 2, 0]] - z[:, [2, 0, 1]]
    slope_z = x[:, [2, 0, 1]] - x[:, [1, 2, 0]]
    twice = (slope_x * x).sum(axis=1)
    k = permeability[grid.stratum]
    weight = 0.5 / twice
    along = np.einsum("m,mi,mj->mij", k[:, 0] * weight, slope_x, slope_x)
    return np.asarray(along + np.einsum("m,mi,mj->mij", k[:, 1] * weight, slope_z, slope_z))


def _solved(
    blocks: np.ndarray, cells: np.ndarray, known: np.ndarray, values: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Heads (n,), those ``known`` being of ``values``, and what flows in at every point (m²/s)."""
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import splu

    rows, columns = np.repeat(cells, 3, axis=1).ravel(), np.tile(cells, 3).ravel()
    matrix = coo_array((blocks.ravel(), (rows, columns)), shape=(len(known), len(known))).tocsr()
    free = np.flatnonzero(~known)
    head = np.where(known, values, 0.0)
    if len(free):
        factors = splu(matrix[free][:, free].tocsc(), diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        head[free] = factors.solve(-(matrix @ head)[free])
    return head, matrix @ head


def wet_share(pressure: np.ndarray) -> np.ndarray:
    """The share (m,) of triangles in which a pressure (m, 3), linear in each, is above 0."""
    least, middle, most = np.sort(pressure, axis=1).T
    with np.errstate(divide="ignore", invalid="ignore"):
        tip = most**2 / ((most - least) * (most - middle))
        rest = 1.0 - least**2 / ((least - most) * (least - middle))
    share = np.where(middle > 0.0, rest, tip)
    return np.asarray(np.where(least >= 0.0, 1.0, np.where(most <= 0.0, 0.0, share)))
