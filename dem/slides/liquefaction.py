"""Computes slides of ground whose layers liquefy under a seismic coefficient or a record (Sec. 4(3) of the paper). In
discs with the law "paper", pore springs of the liquefied layers are cut at the onset; contact springs, dashpots and
strength are multiplied by the factors of the case, in steps over the duration of the onset. Soil discs have the laws of
liquefied ground from the beginning (`before_liquefaction`): pore water carries their overburden, and the strength of
their bonds falls to the residual strength. In both models discs shrink by the volume that drains. The paper applies Kh
at the onset; on soil discs Kh acts before liquefaction, since shaking causes it.
"""

import json
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from dem.case import Case
from dem.disc_area import area_per_disc
from dem.engine.engine import Engine
from dem.engine.time_step import largest_step
from dem.errors import DemError, EnergyBalanceError, StepTooLargeError
from dem.ground import Ground
from dem.model import DiscModel
from dem.settings import SlideSettings
from dem.slides.balance import (
    AREA_TOLERANCE,
    LEAST_STEP,
    at_the_sides,
    both_sides,
    deepest_overlap,
    energy_tolerance,
    expected_loss,
    ground_area,
    on_energy,
    on_pressed_through,
    stopped_by,
    thin_crust,
    thin_layers,
    within_scatter,
)
from dem.slides.drive import TIME_TOLERANCE, Shaking, constant_kh, cycles, recorded_motion
from dem.slides.free_sides import FreeSides
from dem.slides.liquefied_strength import Weakening, liquefied
from dem.slides.rest import at_rest, residual_motion_source
from dem.slides.runout import loose_share, on_loose_mass
from dem.slides.slide import WEIGHT_ALONE_TIME, Row, Slide, stopped_at
from dem.slides.surface import Surface, crack_opening, escaped
from dem.slides.until_rest import UPDATE_INTERVAL
from dem.slides.volume import required_areas, undrained_strata, volume_change
from meshes.files import whole_file
from meshes.section.sentences import counted

LONG_SLIDE = 0.25  # of the height of the section: longer slides are also computed under the weight alone
FLOW_SLIDE = 0.25  # of the height of the ground's surface: a slide by weight alone that is longer is a flow failure
HISTORY_INTERVAL = 0.5  # s between two rows of the history
CHECKPOINT_INTERVAL = 2.0  # s of wall-clock time between two checkpoints

OnLook = Callable[[DiscModel, Row, bool], None]


class Slider:
    """Computes one slide; `run` continues it to its end, from the last checkpoint if there is one.

    Parameters
    ----------
    start
        Discs at rest, with pore springs if the law has them.
    ground
        Packing of the discs, and its place in the section.
    strata
        Numbers of the strata that liquefy.
    case
        Remaining stiffness and strength of these strata; None for Kh alone.
    settings
        Kh, its duration, and criteria for the end of a slide.
    folder
        Folder of checkpoint.npz and rows.json, or None.
    shaking
        A record of the base instead of Kh. Without a record, the settings decide whether Kh is constant or cyclic.
    free_sides
        Whether the ground continues beyond the sides (`dem.slides.free_sides`), or lies in a box, as the paper's discs.
    by_weight
        Whether a long slide is computed once more without shaking, to find out whether it is a flow failure.
    """

    def __init__(
        self,
        start: DiscModel,
        ground: Ground,
        strata: list[int],
        case: Case | None,
        settings: SlideSettings,
        folder: Path | None = None,
        shaking: Shaking | None = None,
        free_sides: bool = False,
        by_weight: bool = True,
    ) -> None:
        drained = None if case is None else case.volumetric_strain
        self.sides = FreeSides(start, ground, strata if free_sides and start.law == "soil" else [], drained)
        start = self.sides.with_thick_walls(start)
        self.buoyed = ground.buoyancy(start) if start.law == "soil" else None
        start = self.sides.before_shaking(start, strata, case)
        self.ground, self.settings, self.case, self.strata, self.by_weight = ground, settings, case, strata, by_weight
        self.start, self.folder = start, folder
        self.surface = Surface.of(start, ground)
        self.step = settings.step_of(start.law)
        self.slide = Slide(surface_before=self.surface.points(start, ground).tolist(), step_share=self.step)
        self.layers = list(start.springs.layers)
        self.weakening = None
        if case is not None and len(start.liquefied):  # a thin stratum may have no discs
            self.weakening = Weakening(start, ground, strata, case)
        setting = start, ground, strata, settings
        shaking = shaking or cycles(settings, strata, start.law)
        self.motion = constant_kh(*setting) if shaking is None else recorded_motion(*setting, shaking)
        self.sides.follow_free_field(self.motion, start.time, strata, case)
        gives_way = shaking is not None and not shaking.of_the_base and start.law == "soil"
        self.impedance = ground.base_impedance() if gives_way else 0.0
        self.cut: set[int] = set()
        self.frame = max(1, round(settings.duration / HISTORY_INTERVAL / settings.frames))
        self.saved_at = -np.inf  # when the last checkpoint was left (s)
        self.undrained = undrained_strata(start, strata if case is not None else [])
        self.area_per_disc = area_per_disc(start, start) if self.undrained else np.zeros(0)
        self.swelling: list[list[float]] = []  # before every look, of the discs of each undrained stratum
        self.model = self._resumed() or self._initial_model()

    def run(self, on_look: OnLook | None = None, threads: int = 1) -> Slide:
        """Continue until the ground has settled or the time is over. The function raises no DemError: an error ends the
        slide, and is its ``reason``.
        """
        slide = self.slide
        end = self.start.time + self.motion.end
        while not slide.reason:
            self._liquefy()
            self._keep_volume()
            self._float()
            try:
                self._advance(threads)
            except DemError as error:
                if isinstance(error, EnergyBalanceError) and slide.step_share > LEAST_STEP * self.step:
                    self._begin_again()
                    continue
                slide.reason = f"stopped by {type(error).__name__}: {error}"
                if not slide.rows:
                    self._look()  # no other state has been recorded
                break
            row = self._look()
            if (side := self.sides.left_through(self.model)) is not None:
                slide.reason = stopped_at(side)
            elif self._at_rest():
                slide.settled, slide.reason = True, "the surface has come to rest"
            elif self.model.time >= end - 1e-9:
                slide.reason = f"still moving after {self.motion.end:.3g} s; {self._driven_by()}"
            self._keep()
            if on_look is not None:
                on_look(self.model, row, bool(slide.reason) or (len(slide.rows) - 1) % self.frame == 0)
        return self._finished()

    def _advance(self, threads: int) -> None:
        """Continue to the next record or change of springs; a new neighbour list may require a shorter time step."""
        model = self.model
        end = model.time + self.motion.wait(model.time - self.start.time, HISTORY_INTERVAL)
        engine = self._engine(threads)
        while True:  # at least a step
            try:
                every, move = (UPDATE_INTERVAL, self._move_sides) if self.sides.strips else (None, None)
                engine.run(model, end - model.time, every=every, on_interval=move)
            except StepTooLargeError:
                engine = self._engine(threads)
            if end - model.time <= max(TIME_TOLERANCE, 0.5 * float(engine.dt)):
                break

    def _move_sides(self, model: DiscModel, force_x: np.ndarray) -> None:
        """Let the walls follow the ground where it continues; force_x (n,): see `FreeSides.follow`."""
        self.sides.follow(max(self.motion.share(k, model.time - self.start.time) for k in self.strata), model, force_x)

    def _engine(self, threads: int) -> Engine:
        """Return an engine with the time step for the present list of neighbours."""
        dt = self.slide.step_share * largest_step(self.model).seconds
        return Engine(dt=dt, threads=threads, balance=energy_tolerance(self.slide.step_share / self.step))

    def _initial_model(self) -> DiscModel:
        model = self.start.copy()
        self.cut = set()
        self._cut(model, [k for k in self.strata if self.motion.starts[k] == self.motion.first_onset])
        model.acceleration = self.motion.acceleration
        model.base_impedance = self.impedance
        model.rough_base = self.ground.section is not None and self.ground.kind == "random"
        return model

    def _cut(self, model: DiscModel, strata: list[int]) -> None:
        """Cut the pore springs of strata that liquefy, once for each stratum; of the first strata at the beginning."""
        new = [k for k in strata if k not in self.cut]
        if self.case is not None and new:
            model.cut_pore_springs(new)
            self.cut |= set(new)

    def _begin_again(self) -> None:
        """Repeat the slide from its onset with half the time step."""
        if self.folder is not None:
            (self.folder / "checkpoint.npz").unlink(missing_ok=True)
        self.slide.step_share *= 0.5
        self.slide.rows, self.swelling, self.slide.overlap = [], [], 0.0
        self.model = self._initial_model()

    def _liquefy(self) -> None:
        """Set the springs of the layers to the degree of liquefaction at the current time."""
        since = self.model.time - self.start.time
        if since < self.motion.first_onset - TIME_TOLERANCE:
            return
        model, case = self.model, self.case
        shares = {k: share for k in self.strata if (share := self.motion.share(k, since)) > 0.0}
        self._cut(model, list(shares))
        if self.weakening is not None:
            self.weakening.apply(model, shares)
        if model.law == "soil":
            return
        wanted = liquefied(self.layers, [], case)
        for share in sorted(set(shares.values())):
            wanted = liquefied(wanted, [k for k in shares if shares[k] == share], case, share)
        if list(model.springs.layers) != wanted:
            model.set_springs(wanted)

    def _drained(self) -> dict[int, float]:
        """Return the share of the volume of strata lost by drainage so far."""
        since = self.model.time - self.start.time
        if self.case is None or since < self.motion.first_onset - TIME_TOLERANCE:
            return {}
        return {k: self.motion.share(k, since) * self.case.volumetric_strain for k in self.strata}

    def _keep_volume(self) -> None:
        """Shrink the discs of liquefied strata by the drained volume, and swell the discs of strata that keep their
        volume, both at constant mass."""
        drained = self._drained()
        sizes = self.swelling[-1] if self.swelling else [1.0] * len(self.undrained)
        if sizes:
            sizes = required_areas(self.model, self.start, self.area_per_disc, self.undrained, sizes, drained)
        self.swelling.append(sizes)
        area = np.ones(len(self.start.springs.layers) + 1)  # the last entry is the boundary
        area[self.undrained] = sizes
        for k, share in drained.items():
            area[k] *= 1.0 - share
        factor = np.where(self.start.fixed, 1.0, np.sqrt(area)[self.start.layer])
        radius = factor * self.start.radius
        if not np.array_equal(radius, self.model.radius):
            self.model.set_radius(radius)

    def _float(self) -> None:
        """Set the buoyancy of soil discs that have crossed the water table, from the part of each disc below it."""
        if self.buoyed is None or (now := self.ground.buoyancy(self.model)) is None:
            return
        change_x, change_z = now - self.buoyed
        self.model.pore_acceleration_x = self.start.pore_acceleration_x + change_x
        self.model.pore_acceleration_z = self.start.pore_acceleration_z + change_z

    def _look(self) -> Row:
        model, ground = self.model, self.ground
        slide, settlement = self.surface.movement(model, ground)
        smooth = self.surface.smoothed(slide)
        energies = Engine().measure(model)
        speed = self.surface.smoothed(np.hypot(model.vx, model.vz)[self.surface.discs])
        by_third = {f"slide_{k}_m": v for k, v in self.surface.by_thirds(slide).items()}
        by_third |= {f"settlement_{k}_m": v for k, v in self.surface.by_thirds(settlement).items()}
        row = Row(
            time_s=model.time - self.start.time, **by_third, slide_max_m=float(np.abs(smooth).max()),
            kinetic_J=energies.kinetic, stored_J=energies.stored, dissipated_J=energies.dissipated,
            work_J=energies.weight + energies.external + energies.boundary, shaking_J=energies.external,
            cracked=int((model.pore_length < 0.0).sum()),
            crack_opening_m=crack_opening(model, ground, self.surface), surface_speed_m_s=float(speed.max()),
        )  # fmt: skip
        self.slide.rows.append(row)
        self.slide.overlap = max(self.slide.overlap, deepest_overlap(model))
        return row

    def _at_rest(self) -> bool:
        """Return whether the surface is at rest after the end of the onset and, if Kh ends, after the end of Kh."""
        rows = [row for row in self.slide.rows if row.time_s >= self.motion.rest_from - 1e-9]
        watched = [
            (row.slide_uphill_m, row.slide_middle_m, row.slide_downhill_m, row.settlement_uphill_m,
             row.settlement_middle_m, row.settlement_downhill_m, row.slide_max_m)
            for row in rows
        ]  # fmt: skip
        return at_rest([row.time_s for row in rows], watched, self.settings.still)

    def _driven_by(self) -> str:
        rows = self.slide.rows
        shaking = [row.shaking_J for row in rows]
        return residual_motion_source([r.time_s for r in rows], [r.work_J - r.shaking_J for r in rows], shaking)

    def _finished(self) -> Slide:
        slide, model = self.slide, self.model
        moved = self.surface.smoothed(self.surface.movement(model, self.ground)[0])
        slide.slide = moved.tolist()
        slide.slide_along = np.column_stack([self.surface.x, moved])[:: self.ground.downhill].tolist()
        slide.slide_max_at_x_m = float(self.surface.x[int(np.argmax(np.abs(moved)))])
        slide.surface_after = Surface.of(model, self.ground).points(model, self.ground).tolist()
        slide.seconds_simulated = model.time - self.start.time
        slide.escaped, slide.loose_share = escaped(model), loose_share(model)
        slide.notes = self._notes()
        if slide.settled and slide.stopped_by is not None:
            slide.settled, slide.reason = False, stopped_at(slide.stopped_by)
        return slide

    def _notes(self) -> list[str]:
        """Return notes on this slide, after computing its loss of area and finding the side that stopped it."""
        slide, model, start = self.slide, self.model, self.start
        height = float(np.ptp(start.z[~start.fixed]))
        far = max((row.slide_max_m for row in slide.rows), default=0.0)
        driven = self.by_weight and self.case is not None and self.settings.kh > 0.0 and far > LONG_SLIDE * height
        notes = self._flow() if driven else []
        sides = [side for side in both_sides(model, start, self.ground) if side.name in self.sides.stopped(model)]
        slide.stopped_by = self.sides.left_through(model) or stopped_by(sides)
        notes += at_the_sides(sides)
        notes += on_pressed_through(model)
        notes += on_loose_mass(slide.loose_share)
        notes += self._lost()
        notes += on_energy(Engine().measure(model))
        if self.case is not None:
            notes += thin_layers(start, self.ground, self.strata)
            notes += thin_crust(start, self.ground, self.strata) if start.law == "soil" else []
            notes += within_scatter(far, self.ground.radius) if start.law == "soil" else []
        return notes

    def _lost(self) -> list[str]:
        """Return a sentence on lost ground; empty if no ground is lost."""
        slide, model, start = self.slide, self.model, self.start
        before, after = ground_area(start, self.ground), ground_area(model, self.ground)
        softer = [] if start.law == "soil" else self.strata
        expected = expected_loss(start, model, softer, before, self._drained())
        slide.area_lost_share = (before - after - expected) / before
        if slide.area_lost_share <= AREA_TOLERANCE:
            return []
        change = 100.0 * volume_change(start, model)
        most = [f"{start.springs.layers[k].name} {change[k]:+.1f} %" for k in np.argsort(change)[:4]]
        left = f"; {counted(slide.escaped, 'disc has', 'discs have')} left the box" if slide.escaped else ""
        return [
            f"{100.0 * slide.area_lost_share:.1f} % of the area of the ground is lost, not counting {expected:.3g} m² "
            f"by drainage and softer springs: loose discs get denser as they shear ({', '.join(most)}){left}"
        ]

    def _flow(self) -> list[str]:
        """Return a sentence if the case slides without Kh as well (flow failure), else empty.

        Ground that is stable under its weight moves only by centimetres; ground without equilibrium moves until its
        face is flatter. To tell both apart, the displacement without Kh is compared with the height of the face. The
        slide under Kh is no measure: it depends on the duration of Kh, on the slope below, and on the sides of the box.
        """
        settings = self.settings.changed(kh=0.0, duration=WEIGHT_ALONE_TIME)
        alone = Slider(
            self.start, self.ground, self.strata, self.case, settings, free_sides=bool(self.sides.strips)
        ).run()
        far = alone.rows[-1].slide_max_m  # where it ends, as for the slide with shaking: a side pushes discs back
        self.slide.slide_by_weight_m = far
        self.slide.flows = far > FLOW_SLIDE * float(np.ptp(self.surface.z))
        if not self.slide.flows:
            return []
        case = self.case
        has_residual = case is not None and (case.residual or case.residual_strength)
        advice = "check the residual strength" if has_residual else "give a residual strength"
        return [
            f"without any shaking the surface slides {far:.2g} m within {alone.rows[-1].time_s:.0f} s, a flow failure "
            f"with a factor of safety below 1 after liquefaction: {advice} (slide.cases, residual)"
        ]

    def _keep(self) -> None:
        """Write a checkpoint, unless the last one is recent and the slide continues.

        The rows are written first: rows later than the checkpoint are dropped when it is read.
        """
        young = time.monotonic() - self.saved_at < CHECKPOINT_INTERVAL and not self.slide.reason
        if self.folder is None or young:
            return
        slide = self.slide
        state = {
            "rows": [vars(row) for row in slide.rows],
            "reason": slide.reason,
            "settled": slide.settled,
            "step_share": slide.step_share,
            "overlap": slide.overlap,
            "swelling": self.swelling,
        }
        with whole_file(self.folder / "rows.json") as temporary:
            temporary.write_text(json.dumps(state))
        self.model.save(self.folder / "checkpoint.npz")
        self.saved_at = time.monotonic()

    def _resumed(self) -> DiscModel | None:
        if self.folder is None or not (self.folder / "checkpoint.npz").exists():
            return None
        try:
            state = json.loads((self.folder / "rows.json").read_text())
            model = DiscModel.load(self.folder / "checkpoint.npz")
            self.slide.step_share, self.slide.overlap = state["step_share"], state["overlap"]
            swelling = state["swelling"]
        except (OSError, KeyError, TypeError, ValueError):
            return None
        since = model.time - self.start.time
        self.slide.rows = [Row(**row) for row in state["rows"] if row["time_s"] <= since + 1e-9]
        self.swelling = swelling[: len(self.slide.rows)]
        if len(self.slide.rows) == len(state["rows"]):
            self.slide.reason, self.slide.settled = state["reason"], state["settled"]
        return model
