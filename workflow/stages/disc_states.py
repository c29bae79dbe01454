"""Computes and stores states of the discs: at the recorded Kh, and after failure."""

from dataclasses import dataclass, field

import numpy as np

from dem.ground import Ground
from dem.model import DiscModel
from dem.search.critical import Search
from dem.search.equilibrium import KhRise, try_kh
from dem.search.pushover import Continuum, pushover_critical_kh
from dem.settings import DemSettings
from dem.slides.slip import cracked_shares, slip_surface
from meshes.executor import Executor, Tell
from workflow.config import Config
from workflow.results.answer import line
from workflow.results.discs import RecordedDiscs, SetOfSprings
from workflow.run.store import Store

NO_LINE = np.zeros((0, 2))
FAILING = "failing"


def state_file(which: SetOfSprings, label: str) -> str:
    """Return the file of a stored state in the folder."""
    return f"dem/state_{which}_{label}.npz"


@dataclass(frozen=True)
class DiscsAtRest:
    """Holds discs at rest, to be brought to the recorded Kh.

    Attributes
    ----------
    settled : the discs at rest
    ground : place of the discs in the section
    search : search for the critical Kh of the discs
    dem : settings with which the discs were made
    continuum : the FEM model that soil discs are calibrated to; its yield displacement limits that of the discs
    """

    settled: DiscModel
    ground: Ground
    search: Search
    dem: DemSettings
    continuum: Continuum | None = None


Sets = dict[SetOfSprings, DiscsAtRest]


@dataclass(frozen=True)
class StoredStates:
    """Holds the states of the discs that are stored, and for each set of springs the slip surface (k, 2) in m."""

    states: tuple[RecordedDiscs, ...] = ()
    surfaces: dict[SetOfSprings, np.ndarray] = field(default_factory=dict)

    def surface(self, which: SetOfSprings) -> np.ndarray:
        """Return the slip surface of one set of springs; an array without points if there is no slip surface."""
        return self.surfaces.get(which, NO_LINE)


def keep_states(config: Config, store: Store, sets: Sets, executor: Executor) -> StoredStates:
    """Compute and store the discs at every recorded Kh, each from rest, until they stand or fail. Also store the slip
    surface of every set at the upper end of its bracket. ``config``: config of the run; ``store``: store of the folder
    with the results; ``sets``: discs before and after calibration; ``executor``: computes in parallel.
    """
    first = {which: next(other for other in sets if is_alike(sets[other], sets[which])) for which in sets}
    goals = [
        StateAtKh(which, start, kh, label, store)
        for which, start in sets.items()
        if first[which] == which
        for label, kh in _labels(config, start.search).items()
    ]
    states = dict(zip(((goal.springs, goal.label) for goal in goals), executor.compute(_reached, goals), strict=True))
    for which, other in first.items():
        if other != which:
            labels = [label for springs, label in states if springs == other]
            states |= {(which, label): _copied(states[other, label], which, label, store) for label in labels}
    recorded = [states[which, f"{kh:g}"] for which in sets for kh in config.dem.kh]
    failing = {
        which: np.array(states[which, FAILING].slip_surface).reshape(-1, 2)
        for which in sets
        if (which, FAILING) in states
    }
    return StoredStates(tuple(recorded), failing)


def _labels(config: Config, search: Search) -> dict[str, float]:
    """Return every Kh to which discs are brought, by the label of the state."""
    labels = {f"{kh:g}": kh for kh in config.dem.kh}
    if search.kc_upper is not None and search.flexibility_m:
        labels[FAILING] = search.kc_upper
    return labels


def is_alike(discs: "DiscsAtRest", other: "DiscsAtRest") -> bool:
    """Return whether two sets of discs are the same and fail at the same Kh, as before and after a calibration that
    leaves the strength as it is."""
    if discs is other:
        return True
    if discs.dem != other.dem or discs.search.trials != other.search.trials:
        return False
    if discs.search.kc_upper != other.search.kc_upper:
        return False
    first, second = vars(discs.settled), vars(other.settled)
    arrays = [name for name, value in first.items() if isinstance(value, np.ndarray)]
    same_springs = discs.settled.springs.layers == other.settled.springs.layers
    return same_springs and all(np.array_equal(first[name], second[name]) for name in arrays)


def _copied(state: RecordedDiscs, which: SetOfSprings, label: str, store: Store) -> RecordedDiscs:
    """Store a state under the name of another set of discs, which is the same."""
    file = state_file(which, label)
    store.copy(state.file, file)
    return state.model_copy(update={"set": which, "file": file})


@dataclass(frozen=True)
class StateAtKh:
    """Holds a Kh to which one set of discs is brought from rest, and the name of the state in the store."""

    springs: SetOfSprings
    start: DiscsAtRest
    kh: float
    label: str
    store: Store


def _at_the_end(goal: StateAtKh, continuum: Continuum, file: str) -> DiscModel:
    """Return the discs at the end of the test for their critical Kh, from the test itself or from its repetition."""
    start = goal.start
    if goal.store.has(file):
        return DiscModel.load(goal.store.folder / file)
    model = pushover_critical_kh(start.settled, start.ground, start.dem, continuum)[1]
    goal.store.save(file, model)
    return model


def _reached(goal: StateAtKh, _: Tell) -> RecordedDiscs:
    """Compute the state at this Kh, or at failure of the discs, and store it in a file."""
    start = goal.start
    before, ground = start.settled, start.ground
    file = state_file(goal.springs, goal.label)
    if goal.label == FAILING and start.continuum is not None:
        model, trial = _at_the_end(goal, start.continuum, file), start.search.trials[-1]
    else:
        model = before.copy()
        trial = try_kh(model, before, ground, start.dem, KhRise(0.0, goal.kh, start.search.flexibility_m))
        goal.store.save(file, model)
    far = np.hypot(model.x - before.x, model.z - before.z)[~model.fixed]
    return RecordedDiscs.taken(
        trial,
        set=goal.springs,
        file=file,
        cracked_share_by_stratum=cracked_shares(model),
        slip_surface=line(slip_surface(model, before, ground)),
        largest_displacement_m=float(far.max()),
    )
