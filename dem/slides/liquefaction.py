"""Slides: layers liquefy under a seismic coefficient that is held, and the ground goes where it goes (Sec. 4(3)).

What happens at the onset: pore springs of the liquefied layers are cut; their element springs, dashpots and friction
take the factors of the case, in steps if it takes time; Kh comes on. The paper does all of it at once.
"""

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from dem.engine.engine import Engine, largest_step
from dem.errors import DemError, EnergyBalanceError
from dem.ground import Ground
from dem.model import DiscModel
from dem.search.equilibrium import kinetic_ratio
from dem.settings import Case, SlideSettings
from dem.slides.slip import cracked_count
from dem.slides.surface import Surface, crack_opening, escaped
from dem.springs import LayerSprings

STEP = 0.3  # of the stable step; halved, and the slide begun again, where the energy does not balance
LEAST_STEP = STEP / 4.0
FADE = 20  # steps in which springs change at an onset that takes time
LOOK = 0.5  # s between two rows of the history
NO_LIMIT = 2.0  # overlap over radius: soft layers let discs go through each other
PATIENT = 4  # looks in a row at rest
MOVES = 2.0  # times what Kh alone does, beyond which a disc of the surface slides


@dataclass(frozen=True)
class Row:
    """One line of history.csv; energies in J per metre."""

    time_s: float
    settlement_uphill_m: float
    settlement_middle_m: float
    settlement_downhill_m: float
    slide_uphill_m: float
    slide_middle_m: float
    slide_downhill_m: float
    slide_max_m: float
    kinetic_J: float  # noqa: N815
    stored_J: float  # noqa: N815
    dissipated_J: float  # noqa: N815
    work_J: float  # noqa: N815
    cracked: int
    crack_opening_m: float
    surface_speed_m_s: float


OnLook = Callable[[DiscModel, Row, bool], None]


@dataclass
class Slide:
    """A slide as it went: its history, and how it ended.

    surface_*: tops of the discs that are the surface then (n, 2), m; step_share: time step over the stable one.
    """

    rows: list[Row] = field(default_factory=list)
    settled: bool = False
    reason: str = ""
    escaped: int = 0
    slide_max_at_x_m: float = 0.0
    slide: list[float] = field(default_factory=list)
    surface_before: list[list[float]] = field(default_factory=list)
    surface_after: list[list[float]] = field(default_factory=list)
    seconds_simulated: float = 0.0
    step_share: float = STEP

    def as_json(self, alone: "Slide | None" = None) -> dict[str, Any]:
        """The numbers of a case. alone: the same ground under Kh alone, to tell sliding from giving way."""
        last = asdict(self.rows[-1])
        kept = {key: last[key] for key in last if key.startswith(("settlement", "slide", "crack_"))}
        out = {
            **kept,
            "slide_max_at_x_m": self.slide_max_at_x_m,
            "settled": self.settled,
            "reason": self.reason,
            "escaped": self.escaped,
            "cracked_pore_springs": self.rows[-1].cracked,
            "seconds_simulated": self.seconds_simulated,
            "step_share": self.step_share,
            "surface_before": self.surface_before,
            "surface_after": self.surface_after,
        }
        if alone is not None:
            moving = np.array(self.slide) > MOVES * np.maximum(np.array(alone.slide), 0.0)
            half = len(moving) // 2
            out["slides_over_share"] = float(moving.mean())
            out["slides_over_share_uphill"] = float(moving[:half].mean())
            out["slides_over_share_downhill"] = float(moving[half:].mean())
        return out


def liquefied(
    layers: list[LayerSprings], which: list[int], case: Case | None, share: float = 1.0
) -> list[LayerSprings]:
    """The layers with some of them liquefied; share < 1: on the way, factors to that power. Overlap is not limited."""
    out = []
    for k, layer in enumerate(layers):
        if case is not None and k in which:
            power = [float(max(factor, 1e-12) ** share) if share < 1.0 else factor for factor in
                     (case.stiffness, case.damping, case.friction)]  # fmt: skip
            layer = layer.liquefied(*power)
        out.append(LayerSprings(**{**asdict(layer), "allowed_overlap": NO_LIMIT}))
    return out


class Slider:
    """One slide: `run` takes it to its end, from the last checkpoint if there is one.

    start: discs at rest with their pore springs; strata: numbers of those that liquefy; case: None for Kh alone.
    folder: for checkpoint.h5 and rows.json, or None.
    """

    def __init__(
        self,
        start: DiscModel,
        ground: Ground,
        strata: list[int],
        case: Case | None,
        settings: SlideSettings,
        folder: Path | None = None,
    ) -> None:
        self.ground, self.settings, self.case, self.strata = ground, settings, case, strata
        self.start, self.folder = start, folder
        self.surface = Surface.of(start, ground)
        self.slide = Slide(surface_before=self.surface.points(start, ground).tolist())
        self.layers = list(start.springs.layers)
        self.quiet = 0
        self.frame = max(1, round(settings.duration / LOOK / settings.frames))
        self.model = self._resumed() or self._begun()

    def run(self, on_look: OnLook | None = None, threads: int = 1) -> Slide:
        """Goes on until the ground has settled or the time is over. Raises no DemError: the reason says it."""
        slide, settings = self.slide, self.settings
        end = self.start.time + settings.duration
        while not slide.reason:
            self._liquefy()
            try:
                dt = slide.step_share * largest_step(self.model).seconds
                Engine(dt=dt, threads=threads).run(self.model, self._until())
            except DemError as error:
                if isinstance(error, EnergyBalanceError) and slide.step_share > LEAST_STEP:
                    self._begin_again()
                    continue
                slide.reason = f"stopped by {type(error).__name__}: {error}"
                break
            row = self._look()
            if self.quiet >= PATIENT:
                slide.settled, slide.reason = True, "the surface and the energy have come to rest"
            elif self.model.time >= end - 1e-9:
                slide.reason = f"still moving after {settings.duration:g} s"
            self._keep()
            if on_look is not None:
                on_look(self.model, row, bool(slide.reason) or (len(slide.rows) - 1) % self.frame == 0)
        return self._finished()

    def _begun(self) -> DiscModel:
        model = self.start.copy()
        if self.case is not None:
            model.cut_pore_springs(self.strata)
        rise = max(self.settings.onset, 1e-3)
        model.acceleration = self.ground.shaking(0.0, self.settings.kh, model.time, model.time + rise)
        return model

    def _begin_again(self) -> None:
        """From the onset, with half the step."""
        if self.folder is not None:
            (self.folder / "checkpoint.h5").unlink(missing_ok=True)
        self.slide.step_share *= 0.5
        self.slide.rows, self.quiet = [], 0
        self.model = self._begun()

    def _liquefy(self) -> None:
        """Springs as the time since the onset asks for."""
        since, onset = self.model.time - self.start.time, self.settings.onset
        share = 1.0 if onset == 0.0 else min(1.0, (np.floor(FADE * since / onset + 1e-6) + 1.0) / FADE)
        wanted = liquefied(self.layers, self.strata, self.case, share)
        if list(self.model.springs.layers) != wanted:
            self.model.set_springs(wanted)

    def _until(self) -> float:
        """Seconds to the next look or change of springs."""
        since, onset = self.model.time - self.start.time, self.settings.onset
        return LOOK if onset == 0.0 or since >= onset else min(LOOK, onset / FADE)

    def _look(self) -> Row:
        model, ground = self.model, self.ground
        slide, settlement = self.surface.movement(model, ground)
        smooth = self.surface.smoothed(slide)
        ledger = Engine().measure(model)
        speed = self.surface.smoothed(np.hypot(model.vx, model.vz)[self.surface.discs])
        by_third = {f"slide_{k}_m": v for k, v in self.surface.by_thirds(slide).items()}
        by_third |= {f"settlement_{k}_m": v for k, v in self.surface.by_thirds(settlement).items()}
        row = Row(
            time_s=model.time - self.start.time, **by_third, slide_max_m=float(smooth.max()),
            kinetic_J=ledger.kinetic, stored_J=ledger.stored, dissipated_J=ledger.dissipated,
            work_J=ledger.weight + ledger.external + ledger.boundary, cracked=cracked_count(model),
            crack_opening_m=crack_opening(model, ground, self.surface), surface_speed_m_s=float(speed.max()),
        )  # fmt: skip
        self.slide.rows.append(row)
        still = kinetic_ratio(model) < self.settings.kinetic and row.surface_speed_m_s < self.settings.velocity
        risen = row.time_s >= self.settings.onset
        self.quiet = self.quiet + 1 if still and risen else 0
        return row

    def _finished(self) -> Slide:
        slide, model = self.slide, self.model
        moved = self.surface.smoothed(self.surface.movement(model, self.ground)[0])
        slide.slide = moved.tolist()
        slide.slide_max_at_x_m = float(self.surface.x[int(np.argmax(moved))])
        slide.surface_after = Surface.of(model, self.ground).points(model, self.ground).tolist()
        slide.seconds_simulated = model.time - self.start.time
        slide.escaped = escaped(model)
        return slide

    def _keep(self) -> None:
        """Rows first: those that are later than the checkpoint are forgotten when it is read."""
        if self.folder is None:
            return
        self.folder.mkdir(parents=True, exist_ok=True)
        beside = self.folder / "rows.json.part"
        state = {"rows": [asdict(row) for row in self.slide.rows], "quiet": self.quiet, "reason": self.slide.reason,
                 "settled": self.slide.settled, "step_share": self.slide.step_share}  # fmt: skip
        beside.write_text(json.dumps(state))
        beside.replace(self.folder / "rows.json")
        self.model.save(self.folder / "checkpoint.h5")

    def _resumed(self) -> DiscModel | None:
        if self.folder is None or not (self.folder / "checkpoint.h5").exists():
            return None
        try:
            state = json.loads((self.folder / "rows.json").read_text())
            model = DiscModel.load(self.folder / "checkpoint.h5")
            self.slide.step_share = state["step_share"]
        except (OSError, KeyError, ValueError):
            return None
        since = model.time - self.start.time
        self.slide.rows = [Row(**row) for row in state["rows"] if row["time_s"] <= since + 1e-9]
        if len(self.slide.rows) == len(state["rows"]):
            self.quiet = state["quiet"]
            self.slide.reason, self.slide.settled = state["reason"], state["settled"]
        return model
