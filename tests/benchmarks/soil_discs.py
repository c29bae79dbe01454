"""How near soil discs come to the continuum by themselves: python -m tests.benchmarks.soil_discs [RUN...] [--seeds N].

RUN is a folder in which `noshiro fem` has left its answer; without any, S-13 is run first. Printed are the critical Kh
of the continuum that is like the discs, that of the discs without any factor, packing by packing, and
how far apart the slip surfaces of both lie; half a minute of CPU for each.
"""

import argparse
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from dem.laboratory.soil_layers import soil_layers
from dem.search.deposit import deposit
from dem.search.pushover import Continuum, pushover_critical_kh
from dem.slides.slip import compare, slip_surface
from tests.support import SECTIONS
from workflow.config import Config
from workflow.results.continuum import FemAnswer
from workflow.results.dem_counterpart import DemCounterpart
from workflow.run.store import Store
from workflow.stages.dem_counterpart import find_dem_counterpart


def main() -> None:
    """Prints a line for every packing, and the mean of each section."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("runs", nargs="*", type=Path)
    parser.add_argument("--seeds", type=int, default=3)
    options = parser.parse_args()
    for run in options.runs:
        predict(run, options.seeds)
    if not options.runs:
        with tempfile.TemporaryDirectory(prefix="noshiro-") as folder:
            command = [sys.executable, "-m", "workflow.cli", "fem", str(SECTIONS / "s13.toml"), "--out", folder]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
            predict(Path(folder), options.seeds)


def predict(run: Path, seeds: int) -> None:
    """All packings of one section."""
    given = Config.load(run / "section.toml")
    like, davis = find_dem_counterpart(given, Store(run), lambda _: None), DemCounterpart.of(FemAnswer.read(Store(run)))
    continuum = Continuum(like.kc, like.yielding_m)
    soil = soil_layers(given.section)
    ratios = []
    for seed in range(seeds):
        begin = time.process_time()
        settings = given.dem.model_copy(update={"seed": seed})
        found = deposit(given.section, settings, lambda radius, voids: [layer.springs(radius, voids) for layer in soil])
        search, pushed = pushover_critical_kh(found.settled, found.ground, settings, continuum)
        surface = slip_surface(pushed, found.settled, found.ground)
        apart = [
            compare(given.section, surface, np.array(line).reshape(-1, 2))
            for line in (like.slip_surface, davis.slip_surface)
        ]
        ratios.append(0.5 * (search.lower + (search.upper or 0.0)) / continuum.kc)
        print(
            f"{given.section.name}, seed {seed}: {search.verdict}, {search.lower:.4f} to {search.upper or 0.0:.4f}, "
            f"{ratios[-1]:.3f} of {continuum.kc:.4f}, slip surfaces "
            f"{' and '.join(f'{one.mean_distance_m if one else np.nan:.1f}' for one in apart)} m from that with "
            f"{like.terms} and with {davis.terms}, {time.process_time() - begin:.0f} s of CPU",
            flush=True,
        )
    print(
        f"{given.section.name}: the continuum bears {like.kc:.4f} with {like.terms}, {davis.kc:.4f} with {davis.terms}"
    )
    print(f"{given.section.name}: ratio {np.mean(ratios):.3f}, from {min(ratios):.3f} to {max(ratios):.3f}")


if __name__ == "__main__":
    main()
