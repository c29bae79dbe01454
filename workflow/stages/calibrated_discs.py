"""The work of the stage `calibrate`: discs of the section, brought to fail at the Kh that the finite elements found.

It leaves dem/settled.h5 and calibrated.h5 (discs at rest before and after), trials.jsonl (a line for every search for
a critical Kh, from which a stopped run goes on), critical.json, calibration.json and the states that are drawn.
"""

from dataclasses import dataclass, field
from functools import partial
from threading import Event

import numpy as np

from dem.ground import Ground, ground_of, springs_of
from dem.laboratory.element_table import element_tests
from dem.model import DiscModel
from dem.search.calibration import ONE_AT_A_TIME, Calibration, Calibrator, best, changed, sensitivities
from dem.search.critical import Search
from dem.search.equilibrium import Rest, Trial, settle, try_kh, unbalanced_ratio
from dem.side_by_side import StoppedError, side_by_side
from dem.slides.slip import compare, cracked_shares, slip_surface
from dem.springs import LayerSprings
from meshes.section.recorded_kh import in_name
from workflow.results.answer import SectionLabel, line
from workflow.results.calibration import CalibrationAnswer, LayerTest
from workflow.results.continuum import FemAnswer
from workflow.results.discs import (
    SETS,
    DiscModelAnswer,
    DiscsAnswer,
    DiscSearch,
    DiscState,
    Parameters,
    SetOfSprings,
    SlipSurfaces,
)
from workflow.results.journal import Journal
from workflow.run.errors import NoAnswerError
from workflow.run.progress import Progress
from workflow.run.store import Store
from workflow.settings import Input

JOURNAL = "dem/trials.jsonl"
BRENT = 7  # searches that choosing the parameter and finding the factor takes, more or less


@dataclass(frozen=True)
class Discs:
    """The discs of a section at rest, with their springs before calibration."""

    ground: Ground
    layers: list[LayerSprings]
    settled: DiscModel


def calibrate_stage(run: Input, store: Store, progress: Progress) -> None:
    """Discs that fail where the finite elements do. Raises InputError, NoAnswerError, DemError."""
    fem = FemAnswer.read(store)
    discs = settled_discs(run, store, progress)
    calibrator = _calibrator(run, store, discs, progress)
    base = calibrator.search("", 1.0, run.dem.workers)
    if base.kc is None:
        discs_answer(run, discs, base, base, {}, Kept(), fem).write(store)
        CalibrationAnswer.not_asked_for(base, run.dem.tolerance).write(store)
        raise NoAnswerError(
            f"the discs have no critical Kh before calibration: {base.verdict}, {base.reason}",
            "other springs, or another packing in [dem], may have one",
        )
    found = _solve(run, calibrator, fem.kc)
    parameter, value, after = (found.parameter, found.value, found.search) if found else ("none", 1.0, base)
    calibrated = calibrator.settled_with(parameter, value)
    _save(store, "dem/calibrated.h5", calibrated)
    progress("states of the discs at the recorded Kh", None)
    kept = _keep_states(run, store, discs.ground, {"before": (discs.settled, base), "after": (calibrated, after)})
    factor = {parameter: value} if found else {}
    discs_answer(run, discs, base, after, factor, kept, fem).write(store)
    if found is None:
        CalibrationAnswer.not_asked_for(base, run.dem.tolerance).write(store)
    else:
        CalibrationAnswer.of(found).write(store)
        if run.dem.element_tests:
            progress("element tests of the discs of every layer", None)
            CalibrationAnswer.of(found, _layer_tests(run, discs, parameter, value)).write(store)
    calibrate_pictures(run, store)
    if found is not None and found.verdict != "calibrated" and run.dem.out_of_reach == "stop":
        raise NoAnswerError(
            found.reason, 'choose another parameter, widen its range, or set dem.out_of_reach = "go on" for the closest'
        )


def settled_discs(run: Input, store: Store, progress: Progress) -> Discs:
    """Discs at rest under their weight, from the checkpoint if there is one."""
    ground = ground_of(run, run.dem)
    layers = springs_of(run, run.dem, ground.radius)
    if store.has("dem/settled.h5"):
        return Discs(ground, layers, DiscModel.load(store.folder / "dem/settled.h5"))
    progress(f"{int(ground.packing.free.sum())} discs settle under their weight", None)
    settled = settle(ground, layers, run.dem)
    _save(store, "dem/settled.h5", settled)
    return Discs(ground, layers, settled)


def _calibrator(run: Input, store: Store, discs: Discs, progress: Progress) -> Calibrator:
    journal = Journal(store, JOURNAL)
    wanted = 1 if run.dem.parameter == "none" else 1 + 2 * len(ONE_AT_A_TIME) + BRENT

    def on_trial(trial: Trial, _model: DiscModel) -> None:
        share = min(0.99, len(calibrator.searches) / wanted)
        progress(f"Kh = {trial.kh:.4f} {trial.verdict}, unbalanced force ratio {trial.unbalanced_ratio:.1e}", share)

    calibrator = Calibrator(
        discs.ground,
        discs.layers,
        discs.settled,
        run.dem,
        known=journal.known(),
        on_trial=on_trial,
        on_search=journal.add,
    )
    return calibrator


def _solve(run: Input, calibrator: Calibrator, target: float) -> Calibration | None:
    if run.dem.parameter == "none":
        return None
    return best(calibrator, target, run.dem.parameter, sensitivities(calibrator))


def _layer_tests(run: Input, discs: Discs, parameter: str, value: float) -> tuple[LayerTest, ...]:
    """Patches of the calibrated discs of every layer, tested as soil samples are."""
    springs = changed(discs.layers, parameter, value)
    tests = element_tests(run, springs, discs.ground.radius, seed=run.dem.seed, workers=run.dem.workers)
    return tuple(LayerTest.model_validate(test) for test in tests)


@dataclass(frozen=True)
class Kept:
    """The states that are kept, and for each set of springs the slip surface where it is seen to fail (k, 2), in m."""

    states: tuple[DiscState, ...] = ()
    surfaces: dict[SetOfSprings, np.ndarray] = field(default_factory=dict)

    def surface(self, which: SetOfSprings) -> np.ndarray:
        """The slip surface of one set; without points where there is none."""
        return self.surfaces.get(which, np.zeros((0, 2)))


def _keep_states(run: Input, store: Store, ground: Ground, sets: dict[SetOfSprings, tuple[DiscModel, Search]]) -> Kept:
    """Discs at every recorded Kh, each from rest, as they stand or as they are when they are seen to fail; and the slip
    surface of every set at the upper end of its bracket.
    """
    recorded = [(which, kh, f"{kh:g}") for which in sets for kh in run.dem.kh]
    ends = [(which, s.upper, "failing") for which, (_, s) in sets.items() if s.upper is not None and s.flexibility]
    stop = Event()

    def watch(_: Rest) -> None:
        if stop.is_set():
            raise StoppedError

    def reached(which: SetOfSprings, kh: float, label: str) -> DiscState:
        start, search = sets[which]
        model = start.copy()
        trial = try_kh(model, start, ground, run.dem, 0.0, kh, search.flexibility, watch=watch)
        file = f"dem/state_{which}_{label}.h5"
        _save(store, file, model)
        far = np.hypot(model.x - start.x, model.z - start.z)[~model.fixed]
        return DiscState.of(
            trial,
            set=which,
            file=file,
            cracked_share_by_stratum=cracked_shares(model),
            slip_surface=line(slip_surface(model, start, ground)),
            largest_displacement_m=float(far.max()),
        )

    found = side_by_side([partial(reached, *wanted) for wanted in (*recorded, *ends)], run.dem.workers, stop)
    failing = {state.set: np.array(state.slip_surface).reshape(-1, 2) for state in found[len(recorded) :]}
    return Kept(tuple(found[: len(recorded)]), failing)


def discs_answer(
    run: Input,
    discs: Discs,
    base: Search,
    after: Search,
    factor: dict[str, float],
    kept: Kept,
    fem: FemAnswer,
) -> DiscsAnswer:
    """What dem/critical.json holds; ``base`` is the search before calibration, ``after`` that with the ``factor``."""
    chosen = {"springs": run.dem.springs, "stiffness_scale": run.dem.stiffness_scale, "mean": run.dem.mean}
    return DiscsAnswer(
        section=SectionLabel.of(run),
        model=_model_answer(run, discs),
        before=DiscSearch.of(base, Parameters.model_validate(chosen)),
        after=DiscSearch.of(after, Parameters.model_validate({**chosen, **factor})),
        states=kept.states,
        slip_surface=_slip_surfaces(run, kept, fem),
    )


def _model_answer(run: Input, discs: Discs) -> DiscModelAnswer:
    ground, packing, settled = discs.ground, discs.ground.packing, discs.settled
    solid = float(np.sum(np.pi * packing.radius[packing.free] ** 2))
    return DiscModelAnswer(
        packing=ground.kind,
        rows=ground.rows,
        radius_m=ground.radius,
        elements=int(packing.free.sum()),
        boundary_elements=int((~packing.free).sum()),
        tilt_deg=float(np.degrees(ground.tilt)),
        seed=run.dem.seed if ground.kind == "random" else None,
        porosity=1.0 - solid / float(run.layering.areas().sum()),
        unbalanced_ratio=unbalanced_ratio(settled),
        settling_seconds=settled.time,
        pore_springs=int((settled.pore_length != 0.0).sum()),
    )


def _slip_surfaces(run: Input, kept: Kept, fem: FemAnswer) -> SlipSurfaces:
    """The slip surfaces of the discs, and of the continuum at the last state of its path."""
    of_fem = [state.slip_surface for state in fem.states if state.slip_surface]
    continuum = np.array(of_fem[-1] if of_fem else ()).reshape(-1, 2)
    agreement = compare(run, kept.surface("after"), continuum)
    return SlipSurfaces(
        dem=line(kept.surface("after")),
        dem_before=line(kept.surface("before")),
        fem=line(continuum),
        mean_distance_m=agreement.mean_distance_m if agreement else None,
        same_stratum_share=agreement.same_stratum_share if agreement else None,
        columns=agreement.columns if agreement else None,
    )


def _save(store: Store, name: str, model: DiscModel) -> None:
    with store.writing(name) as path:
        model.save(path)


def calibrate_pictures(run: Input, store: Store) -> None:
    """Draw the discs by layer, and the states at every recorded Kh, from what is stored."""
    from workflow.figures import discs as dem_figures

    ground = ground_of(run, run.dem)
    start: dict[SetOfSprings, str] = {"before": "dem/settled.h5", "after": "dem/calibrated.h5"}
    with store.writing("figures/dem_model.png") as path:
        settled = dem_figures.in_section(DiscModel.load(store.folder / start["before"]), ground)
        dem_figures.layers(settled, path, f"{run.title or run.name}: discs by layer, at rest under their weight")
    for state in DiscsAnswer.read(store).states:
        before, model = (
            dem_figures.in_section(DiscModel.load(store.folder / name), ground)
            for name in (start[state.set], state.file)
        )
        title = f"{run.title or run.name}: discs {SETS[state.set]}, Kh = {state.kh:g}: {state.verdict}"
        with store.writing(f"figures/dem_{state.set}_kh_{in_name(state.kh)}.png") as path:
            dem_figures.state(model, before, path, title)
