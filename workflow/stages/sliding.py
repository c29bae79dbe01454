"""Computes one slide, from the discs at rest or from its last checkpoint to its end."""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass

from dem.case import Case
from dem.ground import Ground
from dem.model import DiscModel
from dem.settings import PAPER_LOADING
from dem.slides.liquefaction import Slider
from dem.slides.liquefied_strength import effect_of
from dem.slides.slide import Row, Slide
from meshes.executor import Tell
from workflow.config import Config
from workflow.results.disc_grids import case_name, frame_file, frames, write_frame
from workflow.run.store import Store
from workflow.stages.liquefaction import first_equal, liquefying
from workflow.stages.shaking import shaking_of

KH_ALONE = 0  # the number of the case without liquefaction, Kh alone


@dataclass(frozen=True, eq=False)
class PlannedSlide:
    """Holds the input of one slide: discs, strata that liquefy, and springs.

    Attributes
    ----------
    springs : set of springs, "calibrated" or "table2", or name of the random packing
    number : number of the case; `KH_ALONE` for Kh without liquefaction
    start : discs at rest under their weight
    ground : place of the discs in the section
    strata : indices of the strata that liquefy
    case : stiffness and strength of these strata after liquefaction; None for Kh alone
    """

    springs: str
    number: int
    start: DiscModel
    ground: Ground
    strata: list[int]
    case: Case | None

    @property
    def folder(self) -> str:
        """Return the folder of the checkpoints, within the folder of the run."""
        return f"dem/slide_{self.springs}_{self.number}"

    def effect(self, config: Config) -> Hashable:
        """Return all inputs of this slide that may differ within a run. Two slides with equal inputs have equal
        results, so that only one is computed."""
        case = None if self.case is None else effect_of(self.case, config.section, self.strata, self.start.law)
        return self.springs, case


def first_alike(config: Config, tasks: Sequence[PlannedSlide]) -> dict[PlannedSlide, PlannedSlide]:
    """For every slide, return the first slide with the same inputs."""
    return first_equal({each: each.effect(config) for each in tasks})


def task(config: Config, springs: str, number: int, start: DiscModel, ground: Ground) -> PlannedSlide:
    """Return the input of the slide of a case, which starts from given discs at rest. The case is given by its number
    in the input, or is `KH_ALONE` for Kh without liquefaction.

    ``config``: config of the run; ``springs``: set of the discs; ``start``: discs at rest; ``ground``: the ground in
    which the discs lie.
    """
    case = None if number == KH_ALONE else config.cases[number - 1]
    return PlannedSlide(springs, number, start, ground, liquefying(config).get(number, []), case)


@dataclass(frozen=True, eq=False)
class SlideTask:
    """Holds a slide to be computed: input and folder of the run, whether its frames are stored, and whether a long
    slide is computed once more without shaking (``by_weight``)."""

    config: Config
    store: Store
    task: PlannedSlide
    frames: bool = False
    by_weight: bool = True


def slide_of_discs(run: SlideTask, tell: Tell) -> Slide:
    """Compute a slide to its end, from its last checkpoint if there is one; ``tell`` is called with time, slide,
    settlement and speed.

    Frames are written at their times. If a slide was begun again with a smaller step, later frames of the first attempt
    are removed.
    """
    task, store = run.task, run.store
    papers_own = task.springs == "table2" and run.config.dem.model == "soil"
    config = run.config.with_settings("slide", **PAPER_LOADING) if papers_own else run.config
    folder = store.folder / task.folder
    shaking = shaking_of(config, task.strata)
    slider = Slider(
        task.start, task.ground, task.strata, task.case, config.slide, folder, shaking,
        free_sides=config.sides_of_slides == "free-field", by_weight=run.by_weight,
    )  # fmt: skip
    name = case_name(task.springs, task.number)

    def frame() -> int:
        return (len(slider.slide.rows) - 1) // slider.frame

    def look(_model: DiscModel, row: Row, keep: bool) -> None:
        tell((row.time_s, row.slide_max_m, row.settlement_uphill_m, row.surface_speed_m_s))
        if run.frames and keep and task.number != KH_ALONE:
            write_frame(store, frame_file(name, frame()), slider.model, slider.start, task.ground, row.time_s)

    slide = slider.run(look)
    if run.frames:
        store.remove([file for number, file in frames(store, name).items() if number > frame()])
    return slide
