"""Does the work of the stage `calibrate`: discs of the section are calibrated to the critical Kh of the finite
elements.

The stage writes dem/settled.npz and calibrated.npz (discs at rest before and after), trials.jsonl (a line for every
search for a critical Kh, from which a stopped run continues), critical.json, calibration.json and the states that are
drawn.
"""

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass
from typing import Any

import numpy as np

from dem.ground import Ground
from dem.laboratory.element_table import element_tests
from dem.laboratory.element_test_programme import ElementTestProgramme, compressed
from dem.laboratory.layer_check import LayerCheck
from dem.laboratory.soil_contacts import soil_layers
from dem.model import DiscModel
from dem.precompile import precompile
from dem.search.calibration import SINGLE_PARAMETERS, Calibration, calibrated
from dem.search.calibrator import Key, changed, key_of, middle
from dem.search.critical import Search
from dem.search.deposit import Deposit
from dem.search.equilibrium import Trial, unbalanced_ratio
from dem.search.levelling import misfit
from dem.search.pushover import Continuum
from dem.settings import DemSettings
from dem.slides.slip import compare
from meshes.errors import NoAnswerError
from meshes.executor import SERIAL, Executor, Tell
from workflow.config import Config
from workflow.results.answer import SectionLabel, line
from workflow.results.calibration import CalibrationAnswer, LayerTest
from workflow.results.continuum import FemAnswer
from workflow.results.dem_counterpart import DemCounterpart
from workflow.results.discs import (
    DiscModelAnswer,
    DiscsAnswer,
    DiscSearch,
    PaperDiscs,
    Parameters,
    SetOfSprings,
    SlipSurfaces,
)
from workflow.results.stored_mesh import fem_mesh
from workflow.run.progress import Progress, SearchShare
from workflow.run.store import Store
from workflow.stages.dem_counterpart import dem_counterpart_piece
from workflow.stages.disc_pictures import CALIBRATED, draw_discs
from workflow.stages.disc_states import FAILING, NO_LINE, DiscsAtRest, Sets, StoredStates, keep_states, state_file
from workflow.stages.discs_at_rest import (
    PAPER,
    SETTLED,
    calibrator_for,
    continuum_for,
    discs_at_rest,
)

JOURNAL = "dem/trials.jsonl"
PAPER_JOURNAL = "dem/paper_trials.jsonl"
USUAL_SEARCHES = 5  # searches that finding the factor takes, more or less
# Of soil discs, more or less: searches, with the factor; points on the curve of one; element tests that take as long.
PUSHOVERS, POINTS, TESTS = 3, 22, 30
PACKING_SCATTER = 0.1  # of the critical Kh: scatter of soil discs over packings
FIRST_TIME_SHARE = 0.5  # share of the time before these searches and tests


def calibrate_stage(config: Config, store: Store, progress: Progress, executor: Executor) -> None:
    """Calibrate discs to the critical Kh of the finite elements. Raises InputError, NoAnswerError, DemError.

    ``config``: config of the run; ``store``: store of the folder with the results; ``progress``: called with every
    step; ``executor``: computes in parallel.
    """
    fem = FemAnswer.read(store)
    precompile(executor, lambda what: progress(what, None))
    searched, paper, layers = _all_searches(config, store, progress, executor)
    discs = discs_at_rest(config, store, config.dem, SETTLED, lambda what: progress(what, None))
    if searched.base.kc is None:
        none = slip_surfaces(config, store, NO_LINE, NO_LINE, fem)
        discs_answer(config, discs, searched, StoredStates(), none, discs.settled).write(store)
        CalibrationAnswer.of(searched.base, None, config.dem.tolerance).write(store)
        raise NoAnswerError(
            f"the discs have no critical Kh before calibration: {searched.base.verdict}, {searched.base.reason}",
            "try other springs, or another packing in [dem]",
        )
    progress("states of the discs at the recorded Kh", None)
    continuum = continuum_for(config, store) if config.dem.model == "soil" else None
    sets: Sets = {
        "before": DiscsAtRest(discs.settled, discs.ground, searched.base, config.dem, continuum),
        "after": DiscsAtRest(
            DiscModel.load(store.folder / CALIBRATED), discs.ground, searched.after, config.dem, continuum
        ),
    }
    papers_own = None
    if paper is not None:
        papers_own, sets["paper"] = _paper_answer(config, store, paper)
    stored = keep_states(config, store, sets, executor)
    progress("slip surfaces", None)
    surfaces = slip_surfaces(config, store, stored.surface("before"), stored.surface("after"), fem)
    discs_answer(config, discs, searched, stored, surfaces, sets["after"].settled, papers_own).write(store)
    calibration_answer(config, searched, continuum, layers=layers).write(store)
    if tests := _layer_tests(config, discs, searched, progress, executor):
        calibration_answer(config, searched, continuum, layers=layers, element_tests=tests).write(store)
    draw_discs(config, store, executor)
    calibration = searched.calibration
    if config.dem.out_of_reach == "stop" and calibration is not None and not is_near_target(calibration, config.dem):
        raise NoAnswerError(
            calibration.reason,
            f"take another packing, dem.seed = {config.dem.seed + 1}, since the critical Kh differs by about a "
            "tenth from packing to packing, or take more discs if the sliding ground is only a few discs thick; widen "
            'dem.range, or set dem.out_of_reach = "go on" to continue with the closest factor',
        )


def is_near_target(calibration: Calibration, dem: DemSettings) -> bool:
    """Return whether discs are calibrated, or soil discs miss the target by no more than other packings of the same
    discs would. Their slides are then computed, with a warning."""
    missing = abs(middle(calibration.search) - calibration.target)
    near = dem.model == "soil" and missing <= PACKING_SCATTER * calibration.target
    return calibration.verdict == "calibrated" or near


@dataclass(frozen=True)
class DiscSearches:
    """Holds the searches of one set of discs: uncalibrated, and calibrated (None if not computed)."""

    base: Search
    calibration: Calibration | None = None

    @property
    def after(self) -> Search:
        """Return the search with the calibration factor, or the uncalibrated search if there is no factor."""
        return self.calibration.search if self.calibration else self.base

    @property
    def factor(self) -> dict[str, float]:
        """Return the parameter of the calibration and the factor on it."""
        return {self.calibration.parameter: self.calibration.value} if self.calibration else {}


def _all_searches(
    config: Config, store: Store, progress: Progress, executor: Executor
) -> tuple[DiscSearches, Search | None, tuple[LayerCheck, ...]]:
    """Return the searches of the discs. Concurrently, the search of the paper's own discs, if the settings request
    them, and element tests of the discs of every layer are computed. The FEM counterpart is computed first, while the
    discs settle. Threads of one search wait for each other at every step, and so a search has several threads only
    while nothing else is computed.
    """
    if config.dem.model != "soil":
        alone = _calibrated(config, store, executor.count, lambda message: progress(*message), executor)
        return alone, None, ()
    searched, ended = 0.0, 0

    def tell(words: str) -> None:
        work = TESTS * PUSHOVERS
        share = FIRST_TIME_SHARE + (1.0 - FIRST_TIME_SHARE) * (ended + work * searched) / (len(tests) + work)
        progress(words, share if ended or searched else None)

    def heard(_: int, message: tuple[str, float | None]) -> None:
        nonlocal searched
        words, share = message
        searched = searched if share is None else share
        tell(words)

    tests_wanted = config.dem.element_tests  # clay has no contacts that could be tested
    soils = [soil for soil in soil_layers(config.section) if soil.turns] if tests_wanted else []
    programme = ElementTestProgramme(soils, config.dem.mean_radius(config.section))
    tests: list[Piece] = [(compressed, (task,)) for task in programme.tasks]
    threads = max(1, executor.count // (1 + config.dem.paper)) if programme.is_stored else 1
    searches: list[Piece] = [(_calibrated, (config, store, threads))]
    searches += [(_paper, (config, store, threads))] if config.dem.paper else []

    def one_more(place: int, _: Any) -> None:
        nonlocal ended
        if place >= len(searches):
            ended += 1
            tell(f"element tests of the discs of every layer: {ended} of {len(tests)}")

    executor.compute(_done, [(dem_counterpart_piece, (config, store)), (_at_rest, (config, store))], heard)
    outcomes = executor.compute(_done, [*searches, *tests], heard, one_more)
    done, tested = outcomes[: len(searches)], outcomes[len(searches) :]
    return done[0], done[1] if config.dem.paper else None, tuple(programme.checks(tested))


Piece = tuple[Callable[..., Any], tuple[Any, ...]]  # a function and its arguments


def _done(piece: Piece, tell: Tell) -> Any:
    """Do one task of the stage, such as a search for the critical Kh of discs."""
    work, config = piece
    return work(*config, tell)


def _at_rest(config: Config, store: Store, tell: Tell) -> None:
    """Compute and store the discs of the section at rest."""
    discs_at_rest(config, store, config.dem, SETTLED, lambda what: tell((what, None)))


def _calibrated(config: Config, store: Store, threads: int, tell: Tell, executor: Executor = SERIAL) -> DiscSearches:
    """Return the discs of the section at rest, their critical Kh, and the factor with which their critical Kh is equal
    to the critical Kh of the continuum; ``threads`` is the number of threads of a search.
    """
    discs = discs_at_rest(config, store, config.dem, SETTLED, lambda what: tell((what, None)))
    continuum = continuum_for(config, store)
    soil, calibrates = config.dem.model == "soil", config.dem.parameter != "none"
    wanted = (PUSHOVERS if soil else 1 + USUAL_SEARCHES + 2 * len(SINGLE_PARAMETERS)) if calibrates else 1
    share_of = SearchShare(wanted, POINTS if soil else 8)

    def on_trial(trial: Trial) -> None:
        share = share_of.after_trial(len(calibrator.searches))
        tell((f"Kh = {trial.kh:.4f} {trial.verdict}, unbalanced force ratio {trial.unbalanced_ratio:.1e}", share))

    calibrator = calibrator_for(discs, store, config.dem, JOURNAL, on_trial, continuum, executor, threads=threads)
    base = calibrator.search("", 1.0)
    if base.kc is None:
        return DiscSearches(base)
    searched = DiscSearches(base, calibrated(calibrator, continuum, one_at_a_time=not soil) if calibrates else None)
    parameter, factor = next(iter(searched.factor.items()), ("", 1.0))
    store.save(CALIBRATED, calibrator.settled_with(parameter, factor))
    keys: dict[SetOfSprings, Key] = {"before": key_of("", 1.0), "after": key_of(parameter, factor)}
    for which, key in keys.items():
        if key in calibrator.displaced:
            store.save(state_file(which, FAILING), calibrator.displaced[key])
    return searched


def calibration_answer(
    config: Config, searched: DiscSearches, continuum: Continuum | None, **more: Any
) -> CalibrationAnswer:
    """Return the calibration with its searches ``searched`` as an answer. For soil discs the answer includes their
    uncalibrated critical Kh compared with that of the ``continuum``. ``more`` are tests of the layers;
    ``config``: inputs of the run.
    """
    kc = searched.base.kc
    if continuum is not None and kc is not None and searched.calibration is not None:
        more["continuum_kc"] = (continuum.kc, continuum.nearest(np.inf))
        more |= {"predicted_kc": kc, "predicted_ratio": kc / continuum.kc}
    return CalibrationAnswer.of(searched.base, searched.calibration, config.dem.tolerance, **more)


def _paper(config: Config, store: Store, threads: int, tell: Tell) -> Search:
    """Search the Kh at which discs with the springs and the law of the paper fail, without calibration; ``threads`` is
    the number of threads."""
    dem = config.dem.as_paper()
    discs = discs_at_rest(config, store, dem, PAPER, lambda what: tell((f"the paper's discs: {what}", None)))

    def on_trial(trial: Trial) -> None:
        tell((f"the paper's discs: Kh = {trial.kh:.4f} {trial.verdict}", None))

    calibrator = calibrator_for(discs, store, dem, PAPER_JOURNAL, on_trial, threads=threads)
    return calibrator.search("", 1.0)


def _paper_answer(config: Config, store: Store, search: Search) -> tuple[PaperDiscs, DiscsAtRest]:
    """Return the critical Kh of discs with the law "paper" and their properties, and these discs at rest."""
    dem = config.dem.as_paper()
    discs = discs_at_rest(config, store, dem, PAPER, lambda _: None)
    answer = PaperDiscs(
        model=_model_answer(config, dem, discs, discs.settled),
        search=DiscSearch.taken(search, parameters=_parameters(dem, {})),
    )
    return answer, DiscsAtRest(discs.settled, discs.ground, search, dem)


def _layer_tests(
    config: Config, discs: Deposit, searched: DiscSearches, progress: Progress, executor: Executor
) -> tuple[LayerTest, ...]:
    """Return the element tests of discs with the law "paper" of every layer after calibration, if the settings request
    them."""
    if config.dem.model == "soil" or not config.dem.element_tests or searched.calibration is None:
        return ()
    progress("element tests of the discs of every layer", None)
    springs = changed(discs.layers, searched.calibration.parameter, searched.calibration.value)
    tests = element_tests(config.section, springs, discs.ground.radius, seed=config.dem.seed, executor=executor)
    return tuple(LayerTest.model_validate(test) for test in tests)


def discs_answer(
    config: Config,
    discs: Deposit,
    searched: DiscSearches,
    stored: StoredStates,
    surfaces: SlipSurfaces,
    sliding: DiscModel,
    paper: PaperDiscs | None = None,
) -> DiscsAnswer:
    """Return the content of dem/critical.json; ``sliding`` are the discs at rest from which slides start.

    ``config``: config of the run; ``discs``: discs at rest; ``searched``: critical Kh before and after calibration;
    ``stored``: states at recorded Kh; ``surfaces``: slip surfaces; ``paper``: answer of discs with the law "paper".
    """
    return DiscsAnswer(
        section=SectionLabel.of(config.section),
        model=_model_answer(config, config.dem, discs, sliding),
        before=DiscSearch.taken(searched.base, parameters=_parameters(config.dem, {})),
        after=DiscSearch.taken(searched.after, parameters=_parameters(config.dem, searched.factor)),
        states=stored.states,
        slip_surface=surfaces,
        paper=paper,
    )


def _parameters(dem: DemSettings, factor: dict[str, float]) -> Parameters:
    springs = "element tests" if dem.model == "soil" else dem.springs
    chosen = {"springs": springs, "stiffness_scale": dem.stiffness_scale, "mean": dem.mean}
    return Parameters.model_validate({**chosen, **factor})


def _model_answer(config: Config, dem: DemSettings, discs: Deposit, sliding: DiscModel) -> DiscModelAnswer:
    ground, packing, settled = discs.ground, discs.ground.packing, discs.settled
    solid = float(np.sum(np.pi * packing.radius[packing.free] ** 2))
    return DiscModelAnswer(
        discs=dem.model,
        packing=ground.kind,
        rows=ground.rows,
        radius_m=ground.radius,
        elements=int(packing.free.sum()),
        boundary_elements=int((~packing.free).sum()),
        tilt_deg=float(np.degrees(ground.tilt)),
        seed=dem.seed if ground.kind == "random" else None,
        porosity=1.0 - solid / float(config.section.layering.areas().sum()),
        unbalanced_ratio=unbalanced_ratio(settled),
        settling_seconds=settled.time,
        pore_springs=int((settled.pore_length != 0.0).sum()),
        **_off(config, ground, sliding),
    )


def _off(config: Config, ground: Ground, model: DiscModel) -> dict[str, float]:
    """Return the distances of the surface of discs at rest from the surface of the section (m), as fields of the
    answer."""
    placed = copy(model)
    placed.x, placed.z = ground.to_section(model.x, model.z)
    off = np.abs(misfit(config.section, placed, ground.radius))
    return {"surface_off_mean_m": float(off.mean()), "surface_off_worst_m": float(off.max())} if len(off) else {}


def slip_surfaces(config: Config, store: Store, before: np.ndarray, after: np.ndarray, fem: FemAnswer) -> SlipSurfaces:
    """Return the slip surfaces of the discs and of the continuum, and their agreement.

    ``before``, ``after``: slip surfaces of the discs before and after calibration, (k, 2) points [x, elevation] in m.
    The slip surface of the continuum is taken from the FEM counterpart of soil discs or, without one, from the last
    state of the equilibrium path. ``config``: config of the run; ``store``: store of the folder with the results;
    ``fem``: answer of the finite elements.
    """
    soil = config.dem.model == "soil"
    of_fem = [state.slip_surface for state in fem.states if state.slip_surface]
    surface = DemCounterpart.read(store).slip_surface if soil else of_fem[-1] if of_fem else ()
    continuum = np.array(surface).reshape(-1, 2)
    agreement = compare(config.section, after, continuum)
    deeper = agreement is not None and agreement.mean_height_m > 0.0
    return SlipSurfaces(
        dem=line(after),
        dem_before=line(before),
        fem=line(continuum),
        mean_distance_m=agreement.mean_distance_m if agreement else None,
        same_stratum_share=agreement.same_stratum_share if agreement else None,
        columns=agreement.columns if agreement else None,
        excess_above=_excess_above(config, store, after, fem) if deeper else None,
    )


def _excess_above(config: Config, store: Store, line: np.ndarray, fem: FemAnswer) -> float | None:
    """Return the relative increase of the critical Kh of the continuum if it can fail only above the slip surface of
    the discs; None if no critical Kh is found so."""
    from fem.search.slip_surface import critical_above

    mesh = fem_mesh(config.section, store, fem.mesh.method)
    like = DemCounterpart.read(store) if config.dem.model == "soil" else DemCounterpart.of(fem)
    depth = like.deeper_than_m or config.fem.least_depth
    settings = config.fem.changed(sides=like.sides, direction=fem.direction, least_depth=depth)
    try:
        kc, kc_above = critical_above(config.section, mesh, settings, line)
    except NoAnswerError:
        return None
    return kc_above / kc - 1.0 if np.isfinite(kc_above) else None
