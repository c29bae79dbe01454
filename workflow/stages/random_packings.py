"""The cases once more on random packings that fail at the same Kh: does the lattice make the answer?"""

from collections.abc import Callable
from functools import partial
from threading import Event
from typing import Any

import numpy as np

from dem.ground import Ground, ground_of, springs_of
from dem.model import DiscModel
from dem.search.calibration import Calibrator, best, sensitivities
from dem.search.equilibrium import Trial, settle
from dem.side_by_side import StoppedError, side_by_side
from dem.slides.liquefaction import Row, Slide, Slider
from workflow.results.journal import Journal
from workflow.run.progress import Progress
from workflow.run.store import Store
from workflow.settings import Input

MEASURES = ("slide_max_m", "settlement_uphill_m", "settlement_middle_m")


def random_table(
    run: Input, store: Store, progress: Progress, target: float, strata: dict[int, list[int]]
) -> dict[str, Any]:
    """Mean, spread (standard deviation) and every value of slide and settlement over the seeds, for each case.

    Seeds whose packing does not come to the target are named with the reason, and not counted.
    """
    seeds: list[dict[str, Any]] = []
    values: dict[int, dict[str, list[float]]] = {n: {name: [] for name in MEASURES} for n in strata}
    parameter: str = "auto" if run.dem.parameter == "none" else run.dem.parameter
    for number, seed in enumerate(run.slide.seeds):
        share = number / len(run.slide.seeds)
        told = partial(_told, progress, seed, share)
        told("settles")
        dem = run.dem.model_copy(update={"packing": "random", "seed": seed, "parameter": parameter})
        ground = ground_of(run, dem)
        layers = springs_of(run, dem, ground.radius)
        settled = _kept(store, f"dem/slide_seed{seed}_settled.h5", partial(settle, ground, layers, dem))
        journal = Journal(store, f"dem/slide_seed{seed}_trials.jsonl")
        calibrator = Calibrator(
            ground, layers, settled, dem, known=journal.known(), on_search=journal.add,
            on_trial=partial(_tried, told),
        )  # fmt: skip
        table = sensitivities(calibrator) if parameter == "auto" else [("", 1.0, calibrator.search("", 1.0))]
        found = best(calibrator, target, parameter, table)
        parameter = found.parameter
        seeds.append(
            {
                "seed": seed,
                "kc_before": calibrator.searches["", 1.0].kc,
                "parameter": parameter,
                "value": found.value,
                "kc": found.search.kc,
                "verdict": found.verdict,
                "reason": found.reason,
            }
        )
        if found.verdict != "calibrated":
            continue
        start = calibrator.settled_with(parameter, found.value)
        told("slides")
        for n, slide in _slides(run, store, ground, start, strata, seed).items():
            for name in MEASURES:
                values[n][name].append(slide.as_json()[name])
    return {"seeds": seeds, "cases": {str(n): {k: _spread(v) for k, v in found.items()} for n, found in values.items()}}


def _told(progress: Progress, seed: int, share: float, what: str) -> None:
    progress(f"random packing, seed {seed}: {what}", share)


def _tried(told: Callable[[str], None], trial: Trial, _model: DiscModel) -> None:
    told(f"Kh = {trial.kh:.4f} {trial.verdict}")


def _slides(
    run: Input, store: Store, ground: Ground, start: DiscModel, strata: dict[int, list[int]], seed: int
) -> dict[int, Slide]:
    stop = Event()

    def look(_model: DiscModel, _row: Row, _frame: bool) -> None:
        if stop.is_set():
            raise StoppedError

    def work(n: int) -> Slide:
        folder = store.folder / "dem" / f"slide_seed{seed}_{n}"
        return Slider(start, ground, strata[n], run.slide.cases[n - 1], run.slide, folder).run(look)

    slides = side_by_side([partial(work, n) for n in strata], run.dem.workers, stop)
    return dict(zip(strata, slides, strict=True))


def _kept(store: Store, name: str, make: Callable[[], DiscModel]) -> DiscModel:
    if not store.has(name):
        model = make()
        with store.writing(name) as path:
            model.save(path)
    return DiscModel.load(store.folder / name)


def _spread(values: list[float]) -> dict[str, Any]:
    if not values:
        return {"mean": None, "spread": None, "values": []}
    spread = float(np.std(values, ddof=1)) if len(values) > 1 else None
    return {"mean": float(np.mean(values)), "spread": spread, "values": values}
