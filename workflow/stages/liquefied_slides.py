"""The work of the stage `slide`: every case of liquefaction, from the discs at rest to where the ground comes to lie.

It leaves dem/cases.json, history.csv, and for every case a .pvd with discs and pore springs in time. Checkpoints in
dem/slide_* let a stopped run go on.
"""

from dem.ground import Ground
from dem.model import DiscModel
from dem.slides.liquefaction import Row, Slide, Slider
from meshes.errors import InputError
from workflow.results.calibration import CalibrationAnswer
from workflow.results.cases import CaseAnswer, CasesAnswer, RandomPackings
from workflow.results.continuum import FemAnswer
from workflow.results.disc_grids import case_name, frame_file, frames, write_collection, write_frame
from workflow.results.history import SlideHistory, read_histories, write_histories
from workflow.run.progress import Progress
from workflow.run.store import Store
from workflow.settings import Input
from workflow.stages.discs_at_rest import PAPER, SETTLED, continuum_for, ground_for
from workflow.stages.random_packings import First, random_packings
from workflow.stages.sliding import ALONE, Task, liquefying, slide_all, task


def slide_stage(given: Input, store: Store, progress: Progress, cases: tuple[int, ...] | None) -> None:
    """Slides of the cases asked for, or of all. Raises InputError for cases that there are not."""
    wanted = _wanted(given, cases)
    starts = _starts(given, store)
    tasks = _tasks(given, starts, wanted)
    recorder = Recorder(given, store, progress, len(tasks))
    slides = dict(zip(tasks, slide_all(given, store, tasks, recorder.look, recorder.end), strict=True))
    random: RandomPackings | None = None
    if given.slide.packings(given.dem.model) and wanted:
        mine = {t.number: slide for t, slide in slides.items() if t.springs == "calibrated" and t.number in wanted}
        continuum = continuum_for(given, FemAnswer.read(store))
        random = random_packings(given, store, progress, continuum, First.of(given, mine, store))
    write_histories(store, (SlideHistory(t.springs, t.number, tuple(slide.rows)) for t, slide in slides.items()))
    CasesAnswer(sets={springs: _cases(slides, springs) for springs in starts}, random=random).write(store)
    for each in tasks:
        write_collection(store, case_name(each.springs, each.number))
    progress("pictures of the slides", None)
    slide_pictures(given, store)


def _wanted(given: Input, cases: tuple[int, ...] | None) -> list[int]:
    """The numbers of the cases to compute."""
    possible = list(liquefying(given))
    if cases is not None and (unknown := sorted(set(cases) - set(possible))):
        there = ", ".join(map(str, possible)) or "which there are none"
        told = f"expected cases in which a stratum liquefies, of {there}"
        raise InputError("--case", [f"{', '.join(map(str, unknown))}: {told}"])
    return [number for number in possible if cases is None or number in cases]


def _starts(given: Input, store: Store) -> dict[str, tuple[DiscModel, Ground]]:
    """Discs at rest to start from: the calibrated ones, and the paper's as printed where these were asked for."""
    calibrated = DiscModel.load(store.folder / "dem/calibrated.h5")
    starts = {"calibrated": (calibrated, ground_for(given, store, given.dem, calibrated))}
    paper = ""
    if given.dem.model == "soil" and given.dem.paper:
        paper = PAPER
    elif given.dem.model == "paper" and given.dem.springs == "table2" and CalibrationAnswer.read(store).value != 1.0:
        paper = SETTLED
    if paper:
        settled = DiscModel.load(store.folder / paper)
        starts["table2"] = settled, ground_for(given, store, given.dem.as_paper(), settled)
    return starts


def _tasks(given: Input, starts: dict[str, tuple[DiscModel, Ground]], wanted: list[int]) -> list[Task]:
    """The cases on every set of springs, the last ones first since they take longest, and Kh alone."""
    numbers = sorted({ALONE, *wanted}, reverse=True) if wanted else []
    return [task(given, springs, number, *start) for number in numbers for springs, start in starts.items()]


def _cases(slides: dict[Task, Slide], springs: str) -> dict[int, CaseAnswer]:
    """The cases of one set of springs, in the order of their numbers."""
    mine = {each.number: (each, slide) for each, slide in slides.items() if each.springs == springs}
    return {
        number: CaseAnswer.of(slide, mine[ALONE][1], each.case.stiffness)
        for number, (each, slide) in sorted(mine.items())
        if each.case is not None
    }


class Recorder:
    """Keeps the frames of the slides, and tells how far they are."""

    def __init__(self, given: Input, store: Store, progress: Progress, count: int) -> None:
        self.given, self.store, self.progress, self.count = given, store, progress, count
        self.done: dict[Task, float] = {}

    def look(self, task: Task, slider: Slider, row: Row, keep: bool) -> None:
        """Tell of a look at a slide, and keep the discs where a frame is due."""
        name = case_name(task.springs, task.number)
        self.done[task] = min(1.0, row.time_s / self.given.slide.duration)
        self.progress(
            f"{name}: {row.time_s:.1f} s, slide {row.slide_max_m:.2f} m, settlement "
            f"{row.settlement_uphill_m:.2f} m, {row.surface_speed_m_s:.2g} m/s",
            sum(self.done.values()) / self.count,
        )
        if keep and task.number != ALONE:
            file = frame_file(name, self._number(slider))
            write_frame(self.store, file, slider.model, task.start, task.ground, row.time_s)

    def end(self, task: Task, slider: Slider) -> None:
        """Remove the frames of a longer slide that was begun again with a smaller step."""
        there = frames(self.store, case_name(task.springs, task.number))
        self.store.remove([file for number, file in there.items() if number > self._number(slider)])
        self.done[task] = 1.0

    @staticmethod
    def _number(slider: Slider) -> int:
        return (len(slider.slide.rows) - 1) // slider.frame


def slide_pictures(given: Input, store: Store) -> None:
    """Draw every case at its end, its animation, and the histories, from what is stored."""
    from workflow.figures import slides as slide_figures

    answer = CasesAnswer.read(store)
    for springs, number, case in answer.each():
        name = case_name(springs, number)
        states = [store.folder / file for file in frames(store, name).values()]
        if not states:
            continue
        with store.writing(f"figures/{name}.png") as path:
            slide_figures.end(given, states[-1], case, springs, number, path)
        with store.writing(f"figures/{name}.webp") as path:
            slide_figures.animate(given, states, springs, number, path)
    if any(answer.sets.values()):
        with store.writing("figures/history.png") as path:
            slide_figures.history(given, read_histories(store), path)
