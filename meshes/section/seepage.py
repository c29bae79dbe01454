"""Computes steady seepage through a section: heads, phreatic line, seepage face, discharge.

The head h = z + u / γw is given where water stands on the ground, and on the sides below the ends of the water table.
The base and the rest of the sides are impermeable. On the rest of the ground either water leaves and u = 0, a seepage
face, or there is no flow: `free_surface_flow` determines which, and where the ground is wet. There is no suction above
the phreatic line.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from meshes.errors import NoAnswerError
from meshes.section.flow_grid import FlowGrid
from meshes.section.polyline import level_at
from meshes.section.sentences import coordinate
from meshes.section.simplified import needed

if TYPE_CHECKING:
    from meshes.section.free_surface import FreeSurfaceFlow

# Bounds of the fall of the pressure head with height up to the phreatic line; 1 is that of still water.
FALL = (0.2, 2.0)
# Discharge over the largest permeability times the height of the section that counts as rounding.
SMALLEST_DISCHARGE = 1e-12
# The line of the water may pass its points at this share of the distance of vertical lines.
LINE = 0.25


class SeepageError(NoAnswerError):
    """The phreatic line was not found."""

    MISSING = "No seepage"


@dataclass(frozen=True, eq=False)
class Seepage:
    """Holds a steady flow of water through the section.

    Attributes
    ----------
    grid : grid on which the flow was computed
    head (n,) : head at the points of the grid (m)
    inflow (n,) : flow that enters the ground at a point, per metre out of plane (m²/s); negative if it leaves
    seeps (n,) : mask of the points of seepage faces
    discharge : flow through the section, per metre out of plane (m²/s)
    table (k, 2) : water table that gave the heads (m); free water stands up to it
    tolerance : distance (m) within which points are merged
    """

    grid: FlowGrid
    head: np.ndarray
    inflow: np.ndarray
    seeps: np.ndarray
    discharge: float
    table: np.ndarray
    tolerance: float

    @cached_property
    def exit_gradient(self) -> tuple[float, float]:
        """Return the largest upward gradient (-) in triangles from which water leaves the ground, and its x (m)."""
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
    def description(self) -> str:
        """Describe in words the discharge, the seepage faces above free water, and the largest exit gradient."""
        if not self.discharge:
            return "Seepage: the water stands still."
        faces = " and ".join(f"x = {coordinate(start)} to {coordinate(end)} m" for start, end in self.seepage_faces)
        gradient, x = self.exit_gradient
        leaves = f"; it seeps out of the ground from {faces}" if faces else ""
        steep = f"; the largest upward gradient where it leaves is {gradient:.2g}, at x = {coordinate(x)} m"
        through = f"Seepage: {self.discharge:.3g} m²/s flow through a metre of the section"
        return f"{through}{leaves}{steep if gradient > 0.0 else ''}."

    def pressure_head(self, points: np.ndarray, near: np.ndarray) -> np.ndarray:
        """Return the pore pressure over γw (n,) in m at points (n, 2), 0 above the phreatic line; see
        `FlowGrid.interpolated`."""
        head = self.grid.interpolated(self.head, points, near, self.tolerance)
        return np.maximum(np.nan_to_num(head - points[:, 1], nan=0.0), 0.0)

    @cached_property
    def water_line(self) -> np.ndarray:
        """Return the phreatic line and the surface of free water (n, 2), from left to right (m), without points that
        make little difference. There are two points at one x if the sides of a vertical line differ. In dry ground the
        line lies on the base."""
        x = self.grid.x
        points: list[tuple[float, float]] = []
        pressure = self.head - self.grid.points[:, 1]
        middle = 0.5 * (x[1:] + x[:-1])
        for strip, side, chain in self.grid.chains():
            at = float(x[strip + side])
            free = float(level_at(self.table, x[[strip + side]], middle[[strip]])[0])
            level = _highest(self.grid.points[chain, 1], pressure[chain], self.tolerance) if len(chain) else free
            points.append((at, level if len(chain) and level < self.grid.points[chain[-1], 1] else max(level, free)))
        line = np.array(points)
        again = np.append(False, np.abs(np.diff(line, axis=0)).max(axis=1) <= self.tolerance)
        line = line[~again]
        return line[needed(line, LINE * float(np.median(np.diff(x))))]

    @cached_property
    def seepage_faces(self) -> list[tuple[float, float]]:
        """Return the ends (m) along x of the stretches of ground through which water leaves without standing on the
        ground."""
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
        """Return x (m) at which the pore pressure just below the ground changes its linear rule, and x of walls."""
        return np.array([*self.grid.walls, *(end for face in self.seepage_faces for end in face)])


def _highest(z: np.ndarray, pressure: np.ndarray, tolerance: float) -> float:
    """Return the elevation below which the highest water lies, from pressure heads at elevations that rise (m)."""
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
    """Compute the steady flow of water.

    Parameters
    ----------
    grid : FlowGrid
    permeability : (strata, 2) ndarray
        Horizontal and vertical permeability (m/s).
    heads : (n,) ndarray
        Prescribed heads (m); NaN if the head is unknown.
    table : (k, 2) ndarray
        Water table that gave the heads.
    tolerance : float
        Distance (m) within which points are merged.

    Raises
    ------
    SeepageError : if the set of wet points does not converge
    """
    from meshes.section.free_surface import free_surface_flow  # SciPy is loaded only where water flows

    prescribed = heads - grid.points[:, 1]
    under = prescribed > 1e-3 * tolerance  # not numbers are not
    bare = np.isfinite(heads)
    bare[grid.ground] = True
    flow = free_surface_flow(grid, permeability, np.where(under, prescribed, np.nan), bare & ~under)
    if not flow.converged:
        raise SeepageError(
            "the iteration of the phreatic line does not converge",
            "use permeabilities that differ less, or the pore pressure by a water table without flow = true",
        )
    # Water that enters and leaves by the same free water, as near its shore, does not flow through the section.
    _, pond = np.unique(np.round(heads[np.isfinite(heads)] / tolerance), return_inverse=True)
    discharge = float(np.maximum(np.bincount(pond, flow.inflow[np.isfinite(heads)]), 0.0).sum())
    if discharge <= SMALLEST_DISCHARGE * float(permeability.max() * np.ptp(grid.points[:, 1])):
        discharge = 0.0
    seeps = flow.seeps & ~np.isfinite(heads)
    head = _continued(grid, _below_highest_head(grid, flow, float(np.nanmax(heads)), tolerance))
    return Seepage(grid, head, flow.inflow, seeps, discharge, table, tolerance)


def _below_highest_head(grid: FlowGrid, flow: "FreeSurfaceFlow", highest: float, tolerance: float) -> "FreeSurfaceFlow":
    """Return the flow without heads above the ``highest`` that is given (m).

    No seepage without rain has any (maximum principle); where the phreatic line meets a core, cells make some of up to
    half their height.
    """
    z = grid.points[:, 1]
    pressure = np.minimum(flow.pressure, np.maximum(highest - z, 0.0))
    return replace(flow, pressure=pressure, full=flow.full & (z <= highest + 1e-3 * tolerance))


def _continued(grid: FlowGrid, flow: "FreeSurfaceFlow") -> np.ndarray:
    """Return heads (n,). In dry ground they are those of a pressure that continues below 0 from the nearest water on
    the same vertical line, so that the phreatic line lies where the pressure becomes 0."""
    z, wet = grid.points[:, 1], flow.full
    pressure = np.where(wet, flow.pressure, -np.inf)
    for _, _, chain in grid.chains():
        height, along, here = z[chain], flow.pressure[chain], wet[chain]
        last = np.maximum.accumulate(np.where(here, np.arange(len(chain)), -1))
        after = np.minimum.accumulate(np.where(here, np.arange(len(chain)), len(chain))[::-1])[::-1]
        for i in np.flatnonzero(~here):
            j, above = int(last[i]), int(after[i])
            beyond = -(height[i] - height[0]) if j < 0 else along[j] - _fall(height, along, j) * (height[i] - height[j])
            if above < len(chain):  # water hangs above: its pressure is 0 at the next dry point
                beyond = max(beyond, -(height[above - 1] - height[i]))
            pressure[chain[i]] = max(pressure[chain[i]], min(beyond, 0.0))
    return np.asarray(z + pressure)


def _fall(height: np.ndarray, pressure: np.ndarray, j: int) -> float:
    """Return the decrease of the pressure head with height, below the highest wet point ``j`` of a vertical line
    (-)."""
    if j == 0:
        return 1.0
    return float(np.clip((pressure[j - 1] - pressure[j]) / (height[j] - height[j - 1]), *FALL))
