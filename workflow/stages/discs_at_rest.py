"""Brings discs of a section to rest under their weight, or reads them from a checkpoint if there is one: soil discs, or
the discs of the paper."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

from dem.ground import Ground, ground_of, springs_of
from dem.model import DiscModel
from dem.search.calibrator import Calibrator
from dem.search.deposit import Deposit, deposit, ground_at_rest
from dem.search.equilibrium import Trial, settle
from dem.search.pushover import Continuum
from dem.settings import DemSettings
from meshes.errors import InputError
from meshes.executor import SERIAL, Executor
from meshes.section.section import Section
from workflow.config import Config
from workflow.results.continuum import FemAnswer
from workflow.results.dem_counterpart import DemCounterpart
from workflow.results.journal import Journal
from workflow.run.store import Store

SETTLED = "dem/settled.npz"
PAPER = "dem/paper_settled.npz"


def discs_at_rest(config: Config, store: Store, dem: DemSettings, file: str, tell: Callable[[str], None]) -> Deposit:
    """Make the discs of a section and settle them under their weight, or read the stored ones.

    Raises InputError if no packing fits, NotSettledError if the discs do not come to rest, and DemError if a run fails.

    ``config``: config of the section; ``store``: the folder of the run; ``dem``: settings; ``file``: file in which the
    discs are stored; ``tell``: called with every step.
    """
    if dem.model == "paper":
        return _paper(config.section, store, dem, file, tell)
    return _soil(config.section, store, dem, file, tell, sides_of_discs(config) == "periodic")


def sides_of_discs(config: Config) -> Literal["periodic", "fixed"]:
    """Return the sides of the discs of a section. Soil discs have periodic sides if the finite elements have them;
    other discs are in a box.
    """
    repeat = config.fem.sides == "periodic" and config.dem.model == "soil"
    return "periodic" if repeat else "fixed"


def ground_for(section: Section, store: Store, dem: DemSettings, settled: DiscModel) -> Ground:
    """Return the ground of discs at rest, with the direction in which the finite elements fail.

    ``section``: the section of the ground; ``store``: the folder of the run; ``dem``: settings; ``settled``: discs at
    rest.
    """
    ground = ground_at_rest(section, dem, settled) if dem.model == "soil" else ground_of(section, dem)
    try:
        towards = FemAnswer.read(store).towards
    except InputError:  # no answer of the finite elements
        return ground
    return replace(ground, fails_towards=1 if towards == "right" else -1)


def calibrator_for(
    discs: Deposit,
    store: Store,
    dem: DemSettings,
    journal: str,
    on_trial: Callable[[Trial], None],
    continuum: Continuum | None = None,
    executor: Executor = SERIAL,
    until_failed: bool = True,
    threads: int = 1,
) -> Calibrator:
    """Return the calibrator of discs, which continues from the searches in a journal.

    ``store``: the folder of the run; ``dem``: settings; ``on_trial``: called with every trial; ``continuum``: critical
    Kh and yield displacement; ``executor``: computes in parallel; ``until_failed``: whether the test of soil discs
    continues until they have a slip surface; ``threads``: threads of a search that is done alone.
    """
    trials = Journal(store, journal)
    return Calibrator(
        discs.ground, discs.layers, discs.settled, dem, continuum=continuum, known=trials.known(),
        on_trial=lambda trial, _: on_trial(trial), on_search=trials.add, executor=executor,
        until_failed=until_failed, threads=threads,
    )  # fmt: skip


def continuum_for(config: Config, store: Store) -> Continuum:
    """Return the FEM model that discs are calibrated to. For discs with the law "paper" it has the sides of the
    section, as in the paper.
    """
    if config.dem.model == "soil":
        like = DemCounterpart.read(store)
        return Continuum(like.kc, like.yielding_m, like.kc_upper)
    fem = FemAnswer.read(store)
    return Continuum(fem.kc, DemCounterpart.of(fem).yielding_m)


@dataclass(frozen=True)
class StoredRounds:
    """Stores the discs before every round of a deposit beside the file in which its discs will be."""

    store: Store
    file: str

    def latest(self) -> tuple[int, DiscModel] | None:
        """Return the number of the latest stored round, and the discs before it; None if no round is stored."""
        if not (names := self._files()):
            return None
        number = int(names[-1].removeprefix(f"{self._stem}_round").removesuffix(".npz"))
        return number, DiscModel.load(self.store.folder / names[-1])

    def add(self, number: int, settled: DiscModel) -> None:
        """Store the discs before a round, in the place of those before the round before."""
        name = f"{self._stem}_round{number}.npz"
        if not self.store.has(name):
            self.store.save(name, settled)
        self.store.remove([other for other in self._files() if other != name])

    def remove(self) -> None:
        """Remove the stored rounds: the deposit has ended."""
        self.store.remove(self._files())

    @property
    def _stem(self) -> str:
        return self.file.removesuffix(".npz")

    def _files(self) -> list[str]:
        return self.store.matching([f"{self._stem}_round*.npz"])


def _soil(
    section: Section, store: Store, dem: DemSettings, file: str, tell: Callable[[str], None], periodic: bool
) -> Deposit:
    if not store.has(file):
        tell("soil discs are placed, settle, are cut to the surface of the section and settle again")
        rounds = StoredRounds(store, file)
        laid = deposit(section, dem, periodic=periodic, rounds=rounds)
        store.save(file, laid.settled)
        rounds.remove()
    settled = DiscModel.load(store.folder / file)
    return Deposit(ground_for(section, store, dem, settled), list(settled.springs.layers), settled)


def _paper(section: Section, store: Store, dem: DemSettings, file: str, tell: Callable[[str], None]) -> Deposit:
    ground = ground_of(section, dem)
    layers = springs_of(section, dem, ground.radius)
    if not store.has(file):
        tell(f"{int(ground.packing.free.sum())} discs settle under their weight")
        store.save(file, settle(ground, layers, dem))
    settled = DiscModel.load(store.folder / file)
    return Deposit(ground_for(section, store, dem, settled), layers, settled)
