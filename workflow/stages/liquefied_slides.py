"""The work of the stage `slide`: every case of liquefaction, from the discs at rest to where the ground comes to lie.

It leaves dem/cases.json, history.csv, and for every case a .pvd with discs and pore springs in time. Checkpoints in
dem/slide_* let a stopped run go on.
"""

import csv
import io
from collections.abc import Iterator
from dataclasses import asdict, dataclass, fields
from functools import partial
from threading import Event
from typing import Any

from dem.ground import ground_of
from dem.model import DiscModel
from dem.side_by_side import StoppedError, side_by_side
from dem.slides.liquefaction import Row, Slide, Slider
from meshes.errors import InputError
from workflow.results.disc_grids import frame_file, frames, write_collection, write_frame
from workflow.run.progress import Progress
from workflow.run.store import Store
from workflow.settings import Input
from workflow.stages.random_packings import random_table

ALONE = 0  # the number of the case without liquefaction, Kh alone


@dataclass(frozen=True)
class Task:
    """One slide: which springs, which case."""

    springs: str
    case: int

    @property
    def name(self) -> str:
        """What its files are called: calibrated discs have the plain names."""
        return f"case{self.case}" if self.springs == "calibrated" else f"case{self.case}_{self.springs}"


def slide_stage(run: Input, store: Store, progress: Progress, cases: tuple[int, ...] | None) -> None:
    """Slides of the cases asked for, or of all. Raises InputError for cases that there are not."""
    strata = liquefying(run)
    if cases is not None and (unknown := sorted(set(cases) - set(strata))):
        told = (
            f"expected cases in which a stratum liquefies, of {', '.join(map(str, strata)) or 'which there are none'}"
        )
        raise InputError("--case", [f"{', '.join(map(str, unknown))}: {told}"])
    wanted = [n for n in strata if cases is None or n in cases]
    starts = _starts(run, store)
    tasks = [Task(springs, n) for n in sorted({ALONE, *wanted}, reverse=True) for springs in starts] if wanted else []
    slides = _run_all(run, store, progress, tasks, starts, strata)
    answer: dict[str, Any] = {"sets": {name: {} for name in starts}, "random": None}
    if run.slide.seeds and wanted:
        target = store.read_json("fem/critical.json")["kc"]
        answer["random"] = random_table(run, store, progress, target, {n: strata[n] for n in wanted})
    for task, slide in slides.items():
        if task.case != ALONE:
            alone = slides[Task(task.springs, ALONE)]
            stiffness = run.slide.cases[task.case - 1].stiffness
            answer["sets"][task.springs][str(task.case)] = {"stiffness": stiffness, **slide.as_json(alone)}
    answer["sets"] = {name: dict(sorted(found.items())) for name, found in answer["sets"].items()}
    store.write_text("dem/history.csv", _history(slides))
    store.write_json("dem/cases.json", answer)
    for task in slides:
        write_collection(store, task.name)
    progress("pictures of the slides", None)
    slide_pictures(run, store)


def liquefying(run: Input) -> dict[int, list[int]]:
    """For every case the numbers of the strata that liquefy in it; cases without any are left out."""
    numbers = range(1, len(run.slide.cases) + 1)
    found = {n: [k for k, stratum in enumerate(run.strata) if n in stratum.liquefies_in] for n in numbers}
    return {n: strata for n, strata in found.items() if strata}


def _starts(run: Input, store: Store) -> dict[str, DiscModel]:
    """Discs at rest to start from: the calibrated ones, and those with Table 2 as printed where it was asked for."""
    starts = {"calibrated": DiscModel.load(store.folder / "dem/calibrated.h5")}
    if run.dem.springs == "table2" and store.read_json("dem/calibration.json")["value"] != 1.0:
        starts["table2"] = DiscModel.load(store.folder / "dem/settled.h5")
    return starts


def _run_all(
    run: Input,
    store: Store,
    progress: Progress,
    tasks: list[Task],
    starts: dict[str, DiscModel],
    strata: dict[int, list[int]],
) -> dict[Task, Slide]:
    """All slides, side by side."""
    ground = ground_of(run, run.dem)
    stop = Event()
    done = dict.fromkeys(tasks, 0.0)

    def work(task: Task) -> Slide:
        case = run.slide.cases[task.case - 1] if task.case != ALONE else None
        folder = store.folder / "dem" / f"slide_{task.springs}_{task.case}"
        start = starts[task.springs]
        slider = Slider(start, ground, strata.get(task.case, []), case, run.slide, folder)

        def on_look(model: DiscModel, row: Row, frame: bool) -> None:
            if stop.is_set():
                raise StoppedError
            done[task] = min(1.0, row.time_s / run.slide.duration)
            progress(
                f"{task.name}: {row.time_s:.1f} s, slide {row.slide_max_m:.2f} m, settlement "
                f"{row.settlement_uphill_m:.2f} m, {row.surface_speed_m_s:.2g} m/s",
                sum(done.values()) / len(done),
            )
            if frame and task.case != ALONE:
                write_frame(store, frame_file(task.name, number()), model, start, ground, row.time_s)

        def number() -> int:
            return (len(slider.slide.rows) - 1) // slider.frame

        slide = slider.run(on_look)
        # of a longer slide that was begun again with a smaller step
        store.remove([file for k, file in frames(store, task.name).items() if k > number()])
        done[task] = 1.0
        return slide

    slides = side_by_side([partial(work, task) for task in tasks], run.dem.workers, stop)
    return dict(zip(tasks, slides, strict=True))


def _history(slides: dict[Task, Slide]) -> str:
    """history.csv: a line for every look at every slide."""
    text = io.StringIO()
    names = [field.name for field in fields(Row)]
    table = csv.writer(text, lineterminator="\n")
    table.writerow(["set", "case", *names])
    for task, slide in sorted(slides.items(), key=lambda item: (item[0].springs, item[0].case)):
        for row in slide.rows:
            table.writerow([task.springs, task.case, *(f"{v:.6g}" for v in asdict(row).values())])
    return text.getvalue()


def tasks_of(answer: dict[str, Any]) -> Iterator[tuple[Task, dict[str, Any]]]:
    """The cases of dem/cases.json."""
    for springs, cases in answer["sets"].items():
        for number, case in cases.items():
            yield Task(springs, int(number)), case


def slide_pictures(run: Input, store: Store) -> None:
    """Draw every case at its end, its animation, and the histories, from what is stored."""
    from workflow.figures import slides as slide_figures

    answer = store.read_json("dem/cases.json")
    for task, case in tasks_of(answer):
        states = [store.folder / file for file in frames(store, task.name).values()]
        if not states:
            continue
        with store.writing(f"figures/{task.name}.png") as path:
            slide_figures.end(run, states[-1], case, task.springs, task.case, path)
        with store.writing(f"figures/{task.name}.gif") as path:
            slide_figures.animate(run, states, task.springs, task.case, path)
    if any(answer["sets"].values()):
        with store.writing("figures/history.png") as path:
            slide_figures.history(run, store.folder / "dem/history.csv", path)
