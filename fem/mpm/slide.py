"""Computes a slide of material points: from rest through shaking and liquefaction until the surface no longer moves."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from fem.kernels import grid_motion
from fem.kernels import point_stress as law
from fem.mpm.changes import CHANGED_COLUMNS, KNEE, SIDE, changes_of, properties_at
from fem.mpm.engine import MaterialPointEngine, ShakingHistory
from fem.mpm.ground import ROOM_BEYOND_SIDES, PointGround, with_free_sides
from fem.mpm.side_pressure import SidePressure
from fem.mpm.slide_record import PointSlide
from fem.mpm.weak_edges import in_columns
from meshes.files import read_checkpoint, write_checkpoint
from meshes.section.liquefies import RemainingStrength
from meshes.slip_line import running_median

DAMPING = 0.7  # with which the ground comes to rest under its weight
SETTLING_CHECK_INTERVAL, LONGEST_SETTLING = (
    0.5,
    30.0,
)  # s between two checks of equilibrium under weight, and until the search for it is given up
REST_DISPLACEMENT = 1e-4  # m: movement between two checks up to which the ground is at rest
CHECK_INTERVAL = 0.5  # s between two checks
ONSET_STEPS = 20  # in which strength changes as ground liquefies
# 1/s: with which velocities of points decay that the grid cannot resolve. The first one counts. The smaller one keeps
# more noise; the difference of the two, in coarse cells, is part of the method's interval.
DECAY_RATES = (10.0, 1.0)
# The surface after a slide is at a point with this number of points of its column within this number of cells below it.
POINTS_BELOW, REACH_BELOW = 3, 2.0
CHECKPOINT_INTERVAL = 10.0  # s of wall-clock time between two checkpoints
ENERGY_TOLERANCE = 0.02  # of the total energy exchanged: imbalance above which there is a warning
ENGINE_PREFIX, START_PREFIX = "engine_", "began_"  # begin the names of arrays in a checkpoint
RECORDED_LISTS, END_FIELDS = ("times", "slide", "settlement"), ("reason", "stopped_by", "settled")
SMOOTHING_LENGTH = 2.0  # m of the surface over which movement is averaged, and three points at least


@dataclass(frozen=True, eq=False)
class SlideProgramme:
    """Holds the times of a slide's events: shaking, onset of liquefaction, end (s since the beginning of the slide).

    Attributes
    ----------
    shaking : horizontal acceleration of the ground (m/s²) at times (n,) in s, positive downslope
    starts : time at which each liquefying stratum begins to liquefy, by the number of the stratum
    remains : share of strength and stiffness that each liquefied stratum retains
    onset : time in which a stratum liquefies (s)
    rest_from : time before which the computation does not end, even if the ground is at rest (s)
    duration : time at which the computation ends (s)
    rest_displacement : the surface counts as at rest if its mean displacement changes by less than this length (m), or
        by less than 0.2 % of the slide, from one window of 5 s to the next, twice in a row, or if it moves
        by less than half of this length within one window
    drained : volumetric strain by drainage while a stratum liquefies (-)
    base_impedance : impedance of a compliant base times its length (kg/s per metre), see
        `meshes.section.base_impedance`; 0 for a rigid base
    """

    shaking: ShakingHistory
    starts: Mapping[int, float]
    remains: Mapping[int, RemainingStrength]
    onset: float
    rest_from: float
    duration: float
    rest_displacement: float = 0.01
    drained: float = 0.0
    base_impedance: float = 0.0


class PointSlider:
    """Computes the slide of a ground of material points, from rest to rest.

    Parameters
    ----------
    ground : the section as material points; the slide changes the points
    downslope : +1 if the slide's positive direction is to the right, -1 if to the left
    threads : number of threads of the engine; the result is the same to the last bit for any number
    """

    def __init__(self, ground: PointGround, downslope: int, threads: int = 1) -> None:
        self.ground, self.sign = ground, downslope
        self.engine = MaterialPointEngine(ground.points, ground.grid, threads=threads)
        self.began: dict[str, np.ndarray] = {}

    def settle(self) -> float:
        """Bring the ground to equilibrium under its weight, and return the largest movement of its surface (m). Later
        displacements are counted from the state of equilibrium.

        Free-field sides are rigid at first; then the pressure on each side is replaced by a constant force, and the
        ground comes to rest once more. Raises FloatingPointError if no equilibrium is reached within
        ``LONGEST_SETTLING``.
        """
        self._come_to_rest()
        points = self.ground.points
        largest_movement = float(np.abs(points.displacement[points.stratum >= 0]).max())
        if self.ground.sides == "free-field":
            self.ground = with_free_sides(self.ground, self.engine.order)
            self.engine = MaterialPointEngine(self.ground.points, self.ground.grid, threads=self.engine.threads)
            self._come_to_rest()
            points = self.ground.points
        points.start[:] = points.x
        points.v[:], points.affine[:] = 0.0, 0.0
        points.state[:, law.PLASTIC_STRAIN] = 0.0
        self.engine.begin_again()
        return largest_movement

    def _come_to_rest(self) -> None:
        """Continue with damping until the ground is at rest; raises FloatingPointError as `settle` does."""
        points, moved = self.ground.points, np.inf
        while moved >= REST_DISPLACEMENT:
            if self.engine.time > LONGEST_SETTLING:
                raise FloatingPointError(
                    f"the ground does not come to rest under its weight within {LONGEST_SETTLING:g} s: it moved "
                    f"{moved:.2g} m in the last {SETTLING_CHECK_INTERVAL:g} s"
                )
            before, order = points.x.copy(), self.engine.order.copy()
            self.engine.run(SETTLING_CHECK_INTERVAL, damping=DAMPING)
            moved = float(np.abs(self.engine.original(points.x)[order] - before).max())

    def run(
        self,
        programme: SlideProgramme,
        on_look: Callable[[float, np.ndarray], None] | None = None,
        decay: float = DECAY_RATES[0],
        checkpoint: Path | None = None,
    ) -> PointSlide:
        """Continue until the surface is at rest or the time is over. The function ``on_look`` is called regularly with
        the time and the slide so far.

        ``decay`` (1/s) is the rate at which velocities that the grid cannot resolve are damped, see ``DECAY_RATES``.
        ``checkpoint`` is a file from which an interrupted slide continues. ``programme`` gives the times of shaking and
        liquefaction.
        """
        slide = PointSlide(surface_before=self._surface(), cell=self.ground.grid.cell)
        self.engine.decay = decay
        self.engine.base[grid_motion.IMPEDANCE] = programme.base_impedance
        pressure = self.begin(programme)
        shares: dict[int, float] = dict.fromkeys(programme.starts, 0.0)
        if checkpoint is not None:
            self._resume(checkpoint, slide, shares, pressure)
        saved_at = time.monotonic()
        while not slide.reason:
            self._liquefy(programme, shares, pressure)
            under_way = any(-1e-9 <= self.engine.time - start < programme.onset for start in programme.starts.values())
            seconds = min(CHECK_INTERVAL, programme.onset / ONSET_STEPS) if under_way else CHECK_INTERVAL
            self.engine.run(seconds, partial(self._felt, programme), before_batch=pressure.follow)
            self._look(slide)
            if on_look is not None:
                on_look(self.engine.time, slide.slide[-1])
            slide.stopped_by = self._side_reached()
            if slide.at_rest(programme.rest_displacement, programme.rest_from):
                slide.settled, slide.reason = True, "the surface has come to rest"
            elif slide.stopped_by and slide.slide_max > ROOM_BEYOND_SIDES * float(np.ptp(self.ground.section.extent)):
                side_words = "out of the section at" if self.ground.room > 0.0 else "across the section to"
                slide.reason = f"the ground has moved {side_words} the {slide.stopped_by} side"
            elif self.engine.time >= programme.duration - 1e-9:
                slide.reason = f"still moving after {programme.duration:.3g} s"
            if checkpoint is not None and (slide.reason or time.monotonic() - saved_at > CHECKPOINT_INTERVAL):
                self._keep(checkpoint, slide, shares)
                saved_at = time.monotonic()
        slide.surface_after = self._highest_ground()
        energy = self.engine.energy
        slide.transfer_loss_share, slide.energy_lost_share = energy.transfer_loss_share, energy.imbalance_share
        return slide

    def begin(self, programme: SlideProgramme) -> SidePressure:
        """Compute how the ground at rest changes in a slide, and the pressure of the ground beyond its sides."""
        self.began = changes_of(self.ground, self.engine, programme.remains)
        return SidePressure(
            self.ground, self.engine, programme.starts, programme.remains, programme.onset, programme.duration,
            partial(self._felt, programme),
        )  # fmt: skip

    def _felt(self, programme: SlideProgramme, times: np.ndarray) -> np.ndarray:
        """Return the acceleration (m/s²) of the ground at times (n,), positive to the right."""
        return self.sign * programme.shaking(times)

    def _keep(self, path: Path, slide: PointSlide, shares: Mapping[int, float]) -> None:
        """Write a checkpoint: the engine, the slide so far, and the ``shares`` of strength that the strata have
        lost."""
        arrays = {ENGINE_PREFIX + name: array for name, array in self.engine.snapshot().items()}
        arrays |= {name: np.array(getattr(slide, name)) for name in (*RECORDED_LISTS, "surface_before")}
        plain = {
            "shares": [*shares.values()],
            **{name: getattr(slide, name) for name in END_FIELDS},
        }
        write_checkpoint(path, arrays | {START_PREFIX + name: array for name, array in self.began.items()}, plain)

    def _resume(self, path: Path, slide: PointSlide, shares: dict[int, float], pressure: SidePressure) -> None:
        """If there is a checkpoint, restore engine, slide and shares from it, so that the computation continues with
        the same bits.
        """
        try:
            arrays, plain = read_checkpoint(path)
        except OSError:
            return
        self.engine.restore(_unprefixed(arrays, ENGINE_PREFIX))
        self.began |= _unprefixed(arrays, START_PREFIX)
        shares.update(zip(list(shares), plain["shares"], strict=True))
        for k, share in shares.items():
            in_stratum = self.began["liquefies"] == k
            now = properties_at(self.began["before"][in_stratum], self.began["after"][in_stratum], share)
            pressure.at_rest[in_stratum] = now[:, SIDE]
        slide.times = [float(time) for time in arrays["times"]]
        slide.slide, slide.settlement, slide.surface_before = (
            list(arrays["slide"]),
            list(arrays["settlement"]),
            arrays["surface_before"],
        )
        for name in END_FIELDS:
            setattr(slide, name, plain[name])

    def _liquefy(self, programme: SlideProgramme, shares: dict[int, float], pressure: SidePressure) -> None:
        """Set strength, stiffness and the drained volume of the current time."""
        points, order = self.ground.points, self.engine.order
        now_at = {
            k: _liquefied_share(self.engine.time - start, programme.onset) for k, start in programme.starts.items()
        }
        changes = {k: share for k, share in now_at.items() if share != shares[k]}
        if not changes:
            return
        stored = points.elastic()
        for k, share in changes.items():
            in_stratum = self.began["liquefies"][order] == k
            before, after = (self.began[name][order][in_stratum] for name in ("before", "after"))
            values = properties_at(before, after, share)
            strains = after[:, KNEE] > 0.0
            if strains.any():
                points.scale_shear(np.flatnonzero(in_stratum)[strains], (1.0 - share) / (1.0 - shares[k]))
            points.properties[np.ix_(in_stratum, CHANGED_COLUMNS)] = values[:, :SIDE]
            pressure.change(np.flatnonzero(in_stratum), values[:, SIDE])
            draining = programme.drained / programme.onset if 0.0 < share < 1.0 else 0.0
            points.properties[points.stratum == k, law.DRAINAGE_RATE] = draining
            shares[k] = share
        self.engine.dissipate(stored - points.elastic())

    def _look(self, slide: PointSlide) -> None:
        moved = self.engine.original(self.ground.points.displacement)[self.ground.surface]
        slide.times.append(self.engine.time)
        slide.slide.append(self._smoothed(self.sign * moved[:, 0]))
        slide.settlement.append(self._smoothed(-moved[:, 1]))

    def _smoothed(self, values: np.ndarray) -> np.ndarray:
        """Return the running median over a length of ``SMOOTHING_LENGTH`` along the surface, so that single points that
        roll away do not count as a slide.
        """
        return running_median(values, max(1, round(0.5 * SMOOTHING_LENGTH / (0.5 * self.ground.grid.cell))))

    def _surface(self) -> np.ndarray:
        """Return the positions (k, 2) of the top of the points at the surface, from left to right, in the section
        (m)."""
        top = np.array([0.0, 0.25 * self.ground.grid.cell])
        return self.engine.original(self.ground.points.x)[self.ground.surface] + self.ground.offset + top

    def _highest_ground(self) -> np.ndarray:
        """Return the tops (k, 2) of the ground in all columns as wide as a cell, from left to right, in the section
        (m). Ground that has slid over other ground hides the surface there; single points in the air are no ground.
        """
        if self.ground.grid.periodic:
            return self._surface()
        cell, points = self.ground.grid.cell, self.ground.points
        places = points.x[points.stratum >= 0] + self.ground.offset
        column = np.floor((places[:, 0] - self.ground.section.extent[0]) / cell).astype(int)
        tops = []
        for of_column in in_columns(places, column):
            z = places[of_column, 1]
            supported = np.flatnonzero(z[:-POINTS_BELOW] - z[POINTS_BELOW:] < REACH_BELOW * cell)
            tops.append(of_column[supported[0] if len(supported) else -1])
        return np.asarray(places[tops] + [0.0, 0.25 * cell])

    def _side_reached(self) -> str | None:
        """Return the side at which the slide is stopped: ground that moved towards this side lies within two cells of
        it, or of the end of the floor beyond it. The downhill side comes first.
        """
        points, grid = self.ground.points, self.ground.grid
        if grid.periodic:
            return None
        left, right = self.ground.section.extent
        x = points.x[:, 0] + self.ground.offset[0]
        room = self.ground.room - 2.0 * grid.cell
        for sign in (self.sign, -self.sign):
            moved = (points.stratum >= 0) & (sign * points.displacement[:, 0] > 2.0 * grid.cell)
            beyond = moved & (x > right + room if sign > 0 else x < left - room)
            if beyond.any():
                return "right" if sign > 0 else "left"
        return None


def _liquefied_share(since: float, onset: float) -> float:
    """Return the degree of liquefaction (0 to 1), in the middle of the step that begins at a time ``since`` its onset
    (s)."""
    if since < -1e-9:
        return 0.0
    return 1.0 if since >= onset - 1e-9 else (since + 0.5 * onset / ONSET_STEPS) / onset


def _unprefixed(arrays: Mapping[str, np.ndarray], begin: str) -> dict[str, np.ndarray]:
    """Return the arrays whose names begin with a prefix, under names without the prefix."""
    return {name.removeprefix(begin): array for name, array in arrays.items() if name.startswith(begin)}
