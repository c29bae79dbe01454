"""Draws the discs of the stage `calibrate` from stored results."""

from dataclasses import dataclass

from dem.model import DiscModel
from meshes.executor import SERIAL, Executor, Tell
from meshes.section.recorded_kh import in_name
from workflow.config import Config
from workflow.results.discs import SETS, DiscsAnswer, RecordedDiscs, SetOfSprings
from workflow.run.store import Store
from workflow.stages.discs_at_rest import PAPER, SETTLED, ground_for

CALIBRATED = "dem/calibrated.npz"
STARTS: dict[SetOfSprings, str] = {"before": SETTLED, "after": CALIBRATED, "paper": PAPER}


def draw_discs(config: Config, store: Store, executor: Executor = SERIAL) -> None:
    """Draw the discs by layer, and the states at every recorded Kh, from what is stored."""
    executor.compute(_drawn, [StatePicture(config, store, state) for state in (None, *DiscsAnswer.read(store).states)])


@dataclass(frozen=True)
class StatePicture:
    """Describes a picture of the discs in a state; the state is None for the picture of the layers, at rest."""

    config: Config
    store: Store
    state: RecordedDiscs | None

    def placed(self, which: SetOfSprings, file: str) -> DiscModel:
        """Return the discs of a file, of one set of springs, at their places in the section."""
        from workflow.figures.discs import in_section

        config, store = self.config, self.store
        settled = DiscModel.load(store.folder / STARTS[which])
        dem = config.dem.as_paper() if which == "paper" else config.dem
        return in_section(DiscModel.load(store.folder / file), ground_for(config.section, store, dem, settled))


def _drawn(wanted: StatePicture, _: Tell) -> None:
    """Draw one picture."""
    from workflow.figures import discs as dem_figures

    store, state = wanted.store, wanted.state
    name = wanted.config.section.title or wanted.config.section.name
    if state is None:
        model = wanted.placed("before", SETTLED)
        title = f"{name}: discs by layer, at rest under their weight"
        store.save("figures/dem_model.png", dem_figures.layers(model, title))
        return
    before, model = (wanted.placed(state.set, file) for file in (STARTS[state.set], state.file))
    title = f"{name}: discs {SETS[state.set]}, Kh = {state.kh:g}: {state.verdict}"
    store.save(
        f"figures/dem_{state.set}_kh_{in_name(state.kh)}.png",
        dem_figures.state(model, before, title, wanted.config.section),
    )
