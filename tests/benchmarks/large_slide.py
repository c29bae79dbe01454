"""A large slide: `python -m tests.benchmarks.large_slide [--discs N ...] [--seconds S] [--threads N ...] [--folder D]`.

Soil discs of S-13 from nothing to rest, then case 3. The checkpoint half-way is set aside and the slide taken up again
from there: it ends in the same bits. With a folder the discs at rest and the slide are kept in it, and a benchmark
that was stopped goes on from there. Seconds, disc-steps a second and memory, from which follows what more discs need.
"""

import argparse
import json
import resource
import shutil
import tempfile
import time
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import numpy as np

from dem.laboratory.soil_contacts import soil_layers
from dem.model import DiscModel
from dem.search.deposit import deposit, ground_at_rest
from dem.settings import DemSettings
from dem.slides.liquefaction import Slider
from dem.slides.slide import Row
from tests.support import SECTIONS
from workflow.config import Config

LIQUEFIED = [3, 5]


@dataclass(frozen=True)
class Measured:
    """One slide; a speed is that of the part after the last interruption."""

    discs: int
    threads: int
    rest_s: float
    slide_s: float
    million_disc_steps_per_s: float
    steps_per_simulated_s: int
    memory_mb: int
    checkpoint_mb: float
    slide_max_m: float
    same_when_resumed: bool


def at_rest(inputs: Config, dem: DemSettings, folder: Path) -> tuple[DiscModel, float]:
    """Discs at rest, and the seconds that took; 0 if they were in the folder."""
    file, begin = folder / "settled.npz", time.perf_counter()
    if file.exists():
        return DiscModel.load(file), 0.0
    soil = soil_layers(inputs.section)
    deposit(inputs.section, dem, soil).settled.save(file)
    return DiscModel.load(file), time.perf_counter() - begin


def same(item: DiscModel, other: DiscModel) -> bool:
    """Whether two models are the same to the last bit."""
    values = [(getattr(item, field.name), getattr(other, field.name)) for field in fields(item)]
    arrays = [(a, b) for a, b in values if isinstance(a, np.ndarray)]
    return item.time == other.time and all(np.array_equal(a, b, equal_nan=True) for a, b in arrays)


def measure(inputs: Config, discs: int, seconds: float, threads: int, folder: Path) -> Measured:
    """One size."""
    dem = DemSettings(elements=discs)
    folder.mkdir(parents=True, exist_ok=True)
    start, rest = at_rest(inputs, dem, folder)
    print(f"{len(start)} discs at rest after {rest:.0f} s", flush=True)
    settings = inputs.slide.model_copy(update={"duration": seconds})
    whole, half = folder / f"whole_{threads}", folder / f"half_{threads}"

    def slider(where: Path) -> Slider:
        return Slider(
            start, ground_at_rest(inputs.section, dem, start), LIQUEFIED, inputs.slide.cases[2], settings, where
        )

    def look(_: DiscModel, row: Row, __: bool) -> None:
        print(f"{row.time_s:.1f} s: {row.slide_max_m:.3f} m, {time.perf_counter() - begin:.0f} s", flush=True)
        if row.time_s < 0.5 * seconds:
            shutil.copytree(whole, half, dirs_exist_ok=True)

    first = slider(whole)
    begin, steps, since = time.perf_counter(), first.model.steps, first.model.time
    first.run(look, threads=threads)
    clock, done = time.perf_counter() - begin, first.model.steps - steps
    again = slider(half)
    again.run(threads=threads)
    return Measured(
        discs=len(start), threads=threads, rest_s=round(rest, 1), slide_s=round(clock, 1),
        million_disc_steps_per_s=round(len(start) * done / max(clock, 1e-9) / 1e6, 1),
        steps_per_simulated_s=round(done / max(first.model.time - since, 1e-9)),
        memory_mb=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1000,
        checkpoint_mb=round((whole / "checkpoint.npz").stat().st_size / 1e6, 1),
        slide_max_m=round(first.slide.rows[-1].slide_max_m, 3),
        same_when_resumed=same(first.model, again.model) and first.slide.rows == again.slide.rows,
    )  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--discs", type=int, nargs="+", default=[2500, 10_000])
    parser.add_argument("--seconds", type=float, default=4.0)
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--folder", type=Path, help="where discs and slides are kept; nowhere if not given")
    parser.add_argument("--json", type=Path, help="write the rows to this file")
    arguments = parser.parse_args()
    config = Config.load(SECTIONS / "s13.toml")
    rows = []
    with tempfile.TemporaryDirectory() as nowhere:
        for discs in arguments.discs:
            for threads in arguments.threads:
                stored = (arguments.folder or Path(nowhere)) / str(discs)
                rows.append(measure(config, discs, arguments.seconds, threads, stored))
                print(rows[-1], flush=True)
                if not rows[-1].same_when_resumed:
                    raise SystemExit("a slide that was taken up again has ended elsewhere")
    if arguments.json:
        arguments.json.write_text(json.dumps([asdict(row) for row in rows], indent=1) + "\n")


if __name__ == "__main__":
    main()
