"""A large slide: `python -m tests.benchmarks.large_slide [--discs N ...] [--seconds S] [--threads N ...] [--json F]`.

The paper's discs of S-13 in their box, case 3, from the lattice as it is; stopped half-way and taken up again from its
checkpoint. Disc-steps a second and memory for each size, from which follows what more discs need.
"""

import argparse
import json
import resource
import tempfile
import time
from contextlib import suppress
from pathlib import Path

from dem.ground import ground_of, springs_of
from dem.model import DiscModel
from dem.search.equilibrium import settle
from dem.settings import DemSettings
from dem.slides.liquefaction import Row, Slider
from tests.support import SECTIONS
from workflow.settings import Input

LIQUEFIED = [3, 5]


class HalfwayError(Exception):
    """Ends a slide where its checkpoint has been written."""


def measure(given: Input, discs: int, seconds: float, threads: int) -> dict[str, float | int]:
    """One size. The lattice stands under its weight but for a swing; what is measured is the stepping."""
    dem = DemSettings(model="paper", packing="box", springs="table2", elements=discs, kh=(), patience=1.0)
    ground = ground_of(given, dem)
    start = settle(ground, springs_of(given, dem, ground.radius), dem)
    settings = given.slide.model_copy(update={"duration": seconds})

    def half(model: DiscModel, row: Row, _: bool) -> None:
        if row.time_s >= 0.5 * seconds:
            raise HalfwayError

    with tempfile.TemporaryDirectory() as folder:
        case = given.slide.cases[2]
        first = Slider(start, ground, LIQUEFIED, case, settings, Path(folder))
        begin, steps = time.perf_counter(), start.steps
        with suppress(HalfwayError):
            first.run(half, threads=threads)
        clock = time.perf_counter() - begin
        done = first.model.steps - steps
        again = Slider(start, ground, LIQUEFIED, case, settings, Path(folder))
        assert again.model.steps == first.model.steps
        again.run(threads=threads)
    return {
        "discs": len(start),
        "threads": threads,
        "million_disc_steps_per_s": round(len(start) * done / clock / 1e6, 2),
        "steps_per_simulated_s": round(done / (0.5 * seconds)),
        "memory_MB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1000,
        "slide_max_m": round(again.slide.rows[-1].slide_max_m, 3),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--discs", type=int, nargs="+", default=[3000, 12_000])
    parser.add_argument("--seconds", type=float, default=2.0)
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--json", type=Path, help="write the rows to this file")
    arguments = parser.parse_args()
    given = Input.load(SECTIONS / "s13.toml")
    rows = []
    for discs in arguments.discs:
        for threads in arguments.threads:
            rows.append(measure(given, discs, arguments.seconds, threads))
            print(rows[-1], flush=True)
    if arguments.json:
        arguments.json.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
