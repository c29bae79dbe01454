"""Slides side by side: each from its discs at rest, or from its last checkpoint, to its end."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from threading import Event

from dem.ground import Ground
from dem.model import DiscModel
from dem.settings import Case
from dem.side_by_side import StoppedError, side_by_side
from dem.slides.liquefaction import Row, Slide, Slider
from workflow.run.store import Store
from workflow.settings import Input

ALONE = 0  # the number of the case without liquefaction, Kh alone


@dataclass(frozen=True, eq=False)
class Task:
    """One slide.

    Attributes
    ----------
    springs : the set of springs, "calibrated" or "table2", or the random packing it is on
    number : of the case; `ALONE` for Kh without liquefaction
    start : discs at rest under their weight
    ground : where they are in the section
    strata : indices of the strata that liquefy
    case : what liquefaction does to them; None for Kh alone
    """

    springs: str
    number: int
    start: DiscModel
    ground: Ground
    strata: list[int]
    case: Case | None

    @property
    def folder(self) -> str:
        """Where the checkpoints are, within the folder of the run."""
        return f"dem/slide_{self.springs}_{self.number}"


# Hears of every look at a slide: the task, the slide so far, the row of this look, and whether a frame is due.
OnLook = Callable[[Task, Slider, Row, bool], None]
OnEnd = Callable[[Task, Slider], None]


def liquefying(given: Input) -> dict[int, list[int]]:
    """For every case the indices of the strata that liquefy in it; cases without any are left out."""
    numbers = range(1, len(given.cases) + 1)
    found = {n: [k for k, stratum in enumerate(given.strata) if n in stratum.liquefies_in] for n in numbers}
    return {n: strata for n, strata in found.items() if strata}


def task(given: Input, springs: str, number: int, start: DiscModel, ground: Ground) -> Task:
    """A case of the input by its number, or `ALONE`, from some discs at rest."""
    case = None if number == ALONE else given.cases[number - 1]
    return Task(springs, number, start, ground, liquefying(given).get(number, []), case)


def slide_all(
    given: Input, store: Store, tasks: Sequence[Task], on_look: OnLook | None = None, on_end: OnEnd | None = None
) -> list[Slide]:
    """All slides in the order of the tasks, as many at a time as there are workers.

    On an interrupt, or when one fails, all stop at their next look.
    """
    stop = Event()

    def work(task: Task) -> Slide:
        slider = Slider(task.start, task.ground, task.strata, task.case, given.slide, store.folder / task.folder)

        def look(_model: DiscModel, row: Row, keep: bool) -> None:
            if stop.is_set():
                raise StoppedError
            if on_look is not None:
                on_look(task, slider, row, keep)

        slide = slider.run(look)
        if on_end is not None:
            on_end(task, slider)
        return slide

    return side_by_side([partial(work, each) for each in tasks], given.dem.workers, stop)
