"""Integrates the motion of the material points in time; the result has the same bits for any number of threads."""

from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np

from fem.kernels import grid_motion
from fem.kernels import material_points as kernel
from fem.kernels import point_stress as law
from fem.mpm.grid import BackgroundGrid
from fem.mpm.points import MaterialPoints
from meshes.section.quantity import GRAVITY

COURANT = 0.7  # time step over the time in which the fastest wave crosses a cell
STRIPE_WIDTH = 8  # columns of cells that belong together
SORTING_DISTANCE = 0.5  # of a cell: movement of points after which they are sorted again
BATCH_TIME = 0.02  # s, after which the time step follows the fastest point
FILTER_POWER = 3  # power of the operator that removes velocities which the grid cannot resolve
FILTER_STEPS = 25  # after which velocities are filtered at the end of a batch: the filter costs as much as three steps

POINT_ARRAYS = ("x", "v", "affine", "stress", "state", "properties", "start", "stratum", "side")  # of the points

ShakingHistory = Callable[[np.ndarray], np.ndarray]
Each = Callable[..., Iterable[Any]]  # applies a kernel to the parts of all threads, as `map` does


@dataclass
class MaterialPointEnergy:
    """Holds energies since the beginning (J per metre out of plane).

    Attributes
    ----------
    external : work of weight, shaking and pore water
    dissipated : energy dissipated by shear, opening and drainage, and energy of waves that left through a compliant
        base
    kinetic_gained : kinetic energy that forces gave to the nodes of the grid
    kinetic, elastic : kinetic and elastic energy of the points at present
    kinetic_began, elastic_began : kinetic and elastic energy of the points at the beginning
    """

    external: float = 0.0
    dissipated: float = 0.0
    kinetic_gained: float = 0.0
    kinetic: float = 0.0
    elastic: float = 0.0
    kinetic_began: float = 0.0
    elastic_began: float = 0.0

    @property
    def energy_scale(self) -> float:
        """Return the reference for relative energy errors (J/m): the work done on the ground or the energy dissipated,
        whichever is larger.
        """
        return max(abs(self.external), self.dissipated, 1e-300)

    @property
    def transfer_loss(self) -> float:
        """Return the energy lost between points and grid (J/m): kinetic energy that forces gave to the nodes and that
        did not reach the points.
        """
        return self.kinetic_gained + self.kinetic_began - self.kinetic

    @property
    def transfer_loss_share(self) -> float:
        """Return the energy lost in transfers between points and grid over the total energy exchanged (-)."""
        return self.transfer_loss / self.energy_scale

    @property
    def imbalance_share(self) -> float:
        """Return the energy that is neither dissipated nor stored in the points, over the total energy exchanged (-).

        Transfers between points and grid, and the time steps, cause this loss.
        """
        stored = self.dissipated + self.elastic - self.elastic_began + self.kinetic - self.kinetic_began
        return (self.external - stored) / self.energy_scale


class MaterialPointEngine:
    """Integrates the motion of material points on a background grid.

    Parameters
    ----------
    points : the ground as material points; the engine changes the arrays of the points
    grid : the grid on which the points move
    gravity : gravitational acceleration (m/s²), components x and z
    threads : number of threads; the result is the same to the last bit for any number
    decay : rate (1/s) at which velocities that the grid cannot resolve are damped; with inf they are removed in every
        step (APIC)
    """

    def __init__(
        self,
        points: MaterialPoints,
        grid: BackgroundGrid,
        gravity: tuple[float, float] = (0.0, -GRAVITY),
        threads: int = 1,
        decay: float = np.inf,
    ) -> None:
        self.points, self.grid, self.gravity, self.threads, self.decay = points, grid, gravity, threads, decay
        self.time, self.steps = 0.0, 0
        self._filtered = 0.0, 0  # time and step at which velocities were filtered
        self.order = np.arange(len(points.x))  # numbers, as handed over, of the points as they lie now
        self._began = points.kinetic(grid.cell), points.elastic()
        columns, rows = grid.shape
        self._nodes, self._spans = np.zeros((columns, rows, kernel.NODE)), np.zeros((columns, rows, kernel.SPAN))
        self._velocity = np.zeros((columns, rows, kernel.VELOCITIES))
        self._gained = np.zeros((columns, 2))
        stripes = 1 if grid.periodic and columns < 2 * STRIPE_WIDTH else -(-columns // STRIPE_WIDTH)
        if grid.periodic and stripes % 2 and stripes > 1:
            stripes -= 1  # even, so that the last one is no neighbour of its like
        self._stripes = np.arange(stripes, dtype=np.int64)
        self._sums = np.zeros((stripes, 2))
        self.base = np.zeros(grid_motion.BASE_FIELDS)  # rigid; see `grid_motion.move_base`
        self._sort()

    @property
    def energy(self) -> MaterialPointEnergy:
        """Return the energy balance since the beginning."""
        (external, dissipated), (gained, buoyed) = self._sums.sum(axis=0), self._gained.sum(axis=0)
        energies = self.points.kinetic(self.grid.cell), self.points.elastic()
        dissipated += self.base[grid_motion.RADIATED]
        return MaterialPointEnergy(float(external + buoyed), float(dissipated), float(gained), *energies, *self._began)

    def run(
        self,
        seconds: float,
        shaking: ShakingHistory | None = None,
        damping: float = 0.0,
        before_batch: Callable[[], None] | None = None,
    ) -> None:
        """Continue the motion for some seconds; ``shaking`` returns the acceleration by shaking (m/s²) at times (s).

        ``before_batch`` is called before every batch of steps, at most `BATCH_TIME` long. ``damping`` is the local
        non-viscous damping of Cundall (1987), 0 to 1, which brings the ground to rest. Raises FloatingPointError if the
        motion is no longer finite.
        """
        end = self.time + seconds
        while self.time < end - 1e-9:
            batch = min(BATCH_TIME, end - self.time)
            if before_batch is not None:
                before_batch()
            fastest = float(np.sqrt((self.points.v**2).sum(axis=1).max(initial=0.0)))
            if not np.isfinite(fastest):
                raise FloatingPointError(f"the material points have no finite velocity at {self.time:.2f} s")
            speed = self.grid.stretch * (self.points.wave_speed + fastest)
            steps = max(1, int(np.ceil(batch * speed / (COURANT * self.grid.cell))))
            dt = batch / steps
            middles = self.time + dt * (np.arange(steps) + 0.5)
            accelerations = np.zeros(steps) if shaking is None else np.asarray(shaking(middles), dtype=float)
            with ThreadPoolExecutor(self.threads, thread_name_prefix="material-points") as pool:
                each: Each = map if self.threads == 1 else pool.map
                self._advance(each, dt, accelerations, damping)
                self.time += batch
                self.steps += steps
                if self.steps - self._filtered[1] >= FILTER_STEPS:
                    self._filter(each, self.time - self._filtered[0])
                    self._filtered = self.time, self.steps
            if np.abs(self.points.x - self._sorted_at).max() > SORTING_DISTANCE * self.grid.cell:
                self._sort()

    def original(self, values: np.ndarray) -> np.ndarray:
        """Return values (n, ...) of the points in the order that the points had before the engine sorted them."""
        out = np.empty_like(values)
        out[self.order] = values
        return out

    def begin_again(self) -> None:
        """Set time and energies to zero."""
        self.time, self.steps, self._filtered = 0.0, 0, (0.0, 0)
        self._gained[:], self._sums[:], self.base[grid_motion.OLD_VELOCITY :] = 0.0, 0.0, 0.0
        self._began = self.points.kinetic(self.grid.cell), self.points.elastic()

    def dissipate(self, energy: float) -> None:
        """Add to the dissipated energy the elastic energy (J/m) that the ground lost when its stiffness changed."""
        self._sums[0, kernel.DISSIPATED] += energy

    def snapshot(self) -> dict[str, np.ndarray]:
        """Return the state of the engine as a mapping of names to arrays, from which `restore` continues."""
        state = {name: getattr(self.points, name) for name in POINT_ARRAYS}
        state |= {
            "order": self.order,
            "gained": self._gained,
            "sums": self._sums,
            "base": self.base,
            "offsets": self._offsets,
        }
        clock = np.array([self.time, self.steps, *self._filtered, *self._began])
        return state | {"sorted_at": self._sorted_at, "clock": clock}

    def restore(self, state: Mapping[str, np.ndarray]) -> None:
        """Restore a state that `snapshot` of an engine with the same ground returned."""
        for name in POINT_ARRAYS:
            getattr(self.points, name)[:] = state[name]
        self.order, self._offsets, self._sorted_at = state["order"], state["offsets"], state["sorted_at"]
        self._gained[:], self._sums[:], self.base[:] = state["gained"], state["sums"], state["base"]
        self.time, steps, filtered, at_step, *began = (float(value) for value in state["clock"])
        self.steps, self._filtered, self._began = int(steps), (filtered, int(at_step)), (began[0], began[1])
        self._share()

    def _advance(self, each: Each, dt: float, accelerations: np.ndarray, damping: float) -> None:
        points, grid = self.points, self.grid
        keep = float(np.isfinite(self.decay))
        moving = points.x, points.v, points.affine, points.stress, points.state
        if self.threads == 1:
            kernel.advance(
                len(accelerations), self._stripes, self._offsets, grid.cell, grid.slope, grid.periodic,
                dt, keep, accelerations,
                *self.gravity, damping, self.base, grid.uplift, grid.support, *moving, points.side, points.properties,
                self._nodes, self._spans, self._velocity, self._gained, self._sums,
            )  # fmt: skip
            return
        for acceleration in accelerations:
            self._scatter(each, points.v, points.affine, acceleration)
            grid_motion.move_base(self._nodes, grid.uplift, grid.support, dt, acceleration, self.base)
            self._move_grid(each, dt, damping, self.base)
            list(each(lambda stripe, acceleration=acceleration: kernel.gather(
                stripe, self._offsets, self._nodes, self._spans, self._velocity, grid.cell, grid.slope, grid.periodic,
                dt, keep, acceleration,
                *self.gravity, self.base[grid_motion.NEW_VELOCITY], *moving, points.side, points.properties, self._sums,
            ), self._all))  # fmt: skip

    def _scatter(self, each: Each, v: np.ndarray, affine: np.ndarray, acceleration: float) -> None:
        """Compute mass, momentum and forces of the nodes from velocities (n, 2), (n, 4) of the points."""
        points, grid = self.points, self.grid
        heavy = points.properties[:, law.WEIGHT_RATIO].copy()
        self._nodes[:], self._spans[:] = 0.0, 0.0
        for shares in self._even, self._odd:
            list(each(lambda stripe: kernel.scatter(
                stripe, self._offsets, points.x, v, affine, points.stress, points.state, heavy, points.side,
                points.properties, grid.cell, grid.slope, grid.periodic, acceleration, *self.gravity, self._nodes,
                self._spans,
            ), shares))  # fmt: skip

    def _move_grid(self, each: Each, dt: float, damping: float, base: np.ndarray) -> None:
        """Compute the velocities of the nodes before and after a step of ``dt`` (s)."""
        grid = self.grid
        edges = np.linspace(0, grid.shape[0], self.threads + 1).astype(int)
        list(each(lambda first, last: grid_motion.move_grid(
            first, last, self._nodes, grid.uplift, grid.support, dt, damping, base, self._velocity, self._gained
        ), edges[:-1], edges[1:]))  # fmt: skip

    def _filter(self, each: Each, seconds: float) -> None:
        """Let velocities that the grid cannot resolve decay for some seconds."""
        points, grid = self.points, self.grid
        if self.decay == 0.0 or np.isinf(self.decay):
            return
        v, affine, at_rest = points.v.copy(), points.affine.copy(), np.zeros(grid_motion.BASE_FIELDS)
        v[:, 0] -= self.base[grid_motion.NEW_VELOCITY]
        for _ in range(FILTER_POWER):
            self._scatter(each, v, affine, 0.0)
            self._move_grid(each, 0.0, 0.0, at_rest)
            list(each(lambda stripe: kernel.take_off(
                stripe, self._offsets, self._velocity, grid.cell, grid.slope, grid.periodic, points.x, v, affine
            ), self._all))  # fmt: skip
        share = -np.expm1(-self.decay * seconds)
        points.v[:] -= share * v
        points.affine[:] -= share * affine

    def _sort(self) -> None:
        """Sort the points by stripes, columns and rows, and assign the stripes to the threads."""
        points, columns = self.points, self.grid.shape[0]
        i, j = (np.floor(self.grid.level(points.x) / self.grid.cell - 0.5)).astype(np.int64).T
        i = i % columns if self.grid.periodic else i
        width = -(-columns // len(self._stripes))
        stripe = np.minimum(i // width, len(self._stripes) - 1)
        order = np.lexsort((j, i, stripe))
        if not np.array_equal(order, np.arange(len(order))):
            for name in POINT_ARRAYS:
                array = getattr(points, name)
                array[:] = array[order]
            self.order = self.order[order]
        self._offsets = np.searchsorted(stripe[order], np.arange(len(self._stripes) + 1))
        self._sorted_at = points.x.copy()
        self._share()

    def _share(self) -> None:
        """Assign the stripes to threads."""
        counts = np.diff(self._offsets)
        every = self._stripes
        self._even, self._odd, self._all = (
            _stripe_ranges(stripes, counts, self.threads) for stripes in (every[::2], every[1::2], every)
        )


def _stripe_ranges(stripes: np.ndarray, counts: np.ndarray, threads: int) -> list[np.ndarray]:
    """Return for each thread a range of consecutive stripes, so that threads have about equal numbers of points."""
    done = np.cumsum(counts[stripes])
    total = done[-1] if len(done) else 0
    return [stripes[(done > total * k / threads) & (done <= total * (k + 1) / threads)] for k in range(threads)]
