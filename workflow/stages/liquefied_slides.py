"""Does the work of the stage `slide`: every case of liquefaction, from the discs at rest to the end of the slide.

The stage writes dem/cases.json, history.csv, and for every case a .pvd with discs and pore springs in time. With
checkpoints in dem/slide_* an interrupted run continues.
"""

from collections.abc import Sequence
from typing import Any

from dem.ground import Ground
from dem.model import DiscModel
from dem.slides.slide import Slide
from meshes.executor import SERIAL, Executor, Tell
from workflow.config import Config
from workflow.results.calibration import CalibrationAnswer
from workflow.results.cases import CaseAnswer, CasesAnswer, RandomPackings
from workflow.results.disc_grids import case_name, copy_frames, write_collection
from workflow.results.history import SlideHistory, read_histories, write_histories
from workflow.run.progress import Progress
from workflow.run.stage import Job
from workflow.run.store import Store
from workflow.stages.case_pictures import case_pictures, draw_cases
from workflow.stages.discs_at_rest import PAPER, SETTLED, ground_for
from workflow.stages.liquefaction import liquefying
from workflow.stages.random_packings import PackingTask, RandomPackingsRequest, calibrated_packing
from workflow.stages.sliding import KH_ALONE, PlannedSlide, SlideTask, first_alike, slide_of_discs, task

SLIDES_PER_PACKING = 6.0  # slides that take as long as a packing, which is calibrated before its slides
# Of the time that a slide may last, when it is at rest as a rule; what is done by then.
USUAL_SHARE, NEAR_END_SHARE = 0.4, 0.9


def slide_stage(job: Job) -> None:
    """Compute the slides of the requested cases, or of all."""
    config, store = job.config, job.store
    wanted = [number for number in liquefying(config) if job.cases is None or number in job.cases]
    starts = _starts(config, store)
    tasks = _tasks(config, starts, wanted)
    others: RandomPackingsRequest | None = None
    if config.slide.packings(config.dem.model) and wanted:
        others = RandomPackingsRequest.of(config, store, wanted)
    packings = others.first_packings() if others is not None else []  # these take longest, and so begin
    alike = first_alike(config, tasks)
    computed = list(dict.fromkeys(alike.values()))
    pieces: list[SlideTask | PackingTask] = [
        *packings,
        *(SlideTask(config, store, each, frames=True) for each in computed),
    ]
    hearer = SlideProgress(config, job.progress, pieces)
    outcomes = job.executor.compute(_computed, pieces, hearer, hearer.finish)
    outcome_of: dict[PlannedSlide, Slide] = dict(zip(computed, outcomes[len(packings) :], strict=True))
    slides = {each: outcome_of[alike[each]] for each in tasks}
    random: RandomPackings | None = None
    if others is not None:
        calibrated = {
            t.number: slide for t, slide in slides.items() if t.springs == "calibrated" and t.number in wanted
        }
        random = others.answer(job, outcomes[: len(packings)], calibrated)
    write_histories(store, (SlideHistory(t.springs, t.number, tuple(slide.rows)) for t, slide in slides.items()))
    CasesAnswer(sets={springs: _cases(slides, springs) for springs in starts}, random=random).write(store)
    for each, first in alike.items():
        name = case_name(each.springs, each.number)
        if each is not first:
            copy_frames(store, case_name(first.springs, first.number), name)
        write_collection(store, name)
    job.progress("pictures of the slides", None)
    slide_pictures(config, store, job.executor)


def _computed(piece: SlideTask | PackingTask, tell: Tell) -> Any:
    """Compute one slide, or one random packing with all of its slides."""
    return calibrated_packing(piece, tell) if isinstance(piece, PackingTask) else slide_of_discs(piece, tell)


def _starts(config: Config, store: Store) -> dict[str, tuple[DiscModel, Ground]]:
    """Return discs at rest from which slides start: the calibrated discs and, if the settings request them, those with
    the springs printed in the paper."""
    calibrated = DiscModel.load(store.folder / "dem/calibrated.npz")
    starts = {"calibrated": (calibrated, ground_for(config.section, store, config.dem, calibrated))}
    paper = ""
    if config.dem.model == "soil" and config.dem.paper:
        paper = PAPER
    elif config.dem.model == "paper" and config.dem.springs == "table2" and CalibrationAnswer.read(store).value != 1.0:
        paper = SETTLED
    if paper:
        settled = DiscModel.load(store.folder / paper)
        starts["table2"] = settled, ground_for(config.section, store, config.dem.as_paper(), settled)
    return starts


def _tasks(config: Config, starts: dict[str, tuple[DiscModel, Ground]], wanted: list[int]) -> list[PlannedSlide]:
    """Return the slides of all cases, and of Kh alone, on every set of springs. Discs with the law "paper", the
    slowest, come first."""
    numbers = sorted({KH_ALONE, *wanted}, reverse=True) if wanted else []
    return [task(config, springs, number, *starts[springs]) for springs in reversed(starts) for number in numbers]


def _cases(slides: dict[PlannedSlide, Slide], springs: str) -> dict[int, CaseAnswer]:
    """Return the cases of one set of springs, in the order of their numbers."""
    of_springs = {each.number: (each, slide) for each, slide in slides.items() if each.springs == springs}
    return {
        number: CaseAnswer.of(slide, of_springs[KH_ALONE][1], each.case.stiffness)
        for number, (each, slide) in sorted(of_springs.items())
        if each.case is not None
    }


class SlideProgress:
    """Reports the progress of the slides."""

    def __init__(self, config: Config, progress: Progress, pieces: Sequence[SlideTask | PackingTask]) -> None:
        self.config, self.progress, self.pieces = config, progress, pieces
        self.done = [0.0] * len(pieces)
        self.costs = [SLIDES_PER_PACKING if isinstance(piece, PackingTask) else 1.0 for piece in pieces]

    def __call__(self, place: int, message: Any) -> None:
        """Report the progress of one slide, or of one packing."""
        piece = self.pieces[place]
        if isinstance(piece, PackingTask):
            line = piece.message(message)
        else:
            seconds, slide, settlement, speed = message
            self.done[place] = _finished_share(seconds / self.config.slide.duration)
            line = (
                f"{self._name(piece.task)}: t = {seconds:.1f} s, slide {slide:.2f} m, settlement {settlement:z.2f} m, "
                f"{speed:.2g} m/s"
            )
        work = sum(done * cost for done, cost in zip(self.done, self.costs, strict=True))
        self.progress(line, work / sum(self.costs))

    def _name(self, task: PlannedSlide) -> str:
        name = "Kh without liquefaction" if task.number == KH_ALONE else self.config.called(task.number)
        return name if task.springs == "calibrated" else f"{name}, springs of Table 2"

    def finish(self, place: int, _: Any) -> None:
        """Report that a slide has ended, or a packing with all of its slides."""
        self.done[place] = 1.0


def _finished_share(of_duration: float) -> float:
    """Return the finished share of the work of a slide after a share of its longest duration. Most slides come to rest
    long before the longest duration.
    """
    late = max(0.0, of_duration - USUAL_SHARE) / (1.0 - USUAL_SHARE)
    return min(1.0, NEAR_END_SHARE * min(of_duration / USUAL_SHARE, 1.0) + (1.0 - NEAR_END_SHARE) * late)


def slide_pictures(config: Config, store: Store, executor: Executor = SERIAL) -> None:
    """Draw every case at its end, its animation, and the histories, from stored results."""
    from workflow.figures import slides as slide_figures

    answer = CasesAnswer.read(store)
    wanted = [each for springs, cases in answer.sets.items() for each in case_pictures(config, store, springs, cases)]
    executor.compute(draw_cases, wanted)
    if any(answer.sets.values()):
        store.save("figures/history.png", slide_figures.history(config, read_histories(store)))
    random_cases = answer.random.cases if answer.random is not None else {}
    bands = {number: case.profile for number, case in random_cases.items() if case.profile is not None}
    if bands:
        packings = max(len(case.slide_max_m.values) for case in random_cases.values())
        store.save("figures/profiles.png", slide_figures.profiles(config, bands, packings))
