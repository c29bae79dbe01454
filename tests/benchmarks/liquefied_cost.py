"""What liquefied ground costs: a step of soil discs of which a share has liquefied, over one of which none has.

python -m tests.benchmarks.liquefied_cost [--elements N ...] [--share S ...]

The box of `dem_throughput`, soil discs, its lower part liquefied, below water. CPU of the step loop alone on one
thread, the least of some runs of each.
"""

import argparse
import time
from dataclasses import replace

import numpy as np

from dem.assembly import DiscBoundary, DiscGeometry, DiscMaterials
from dem.engine.engine import Engine, EngineRun
from dem.engine.time_step import largest_step
from dem.liquefied_ground import SMALLEST_STRAIN, Onset, liquefy, set_share
from dem.model import DiscModel
from tests.benchmarks.dem_throughput import box
from tests.support.liquefied import GRAVITY, sand, with_voids

RADIUS = 0.75
ROUNDS = 5
WORK = 1.0e6  # disc-steps of a round
RATIO, BUOYANT = 0.1, 900.0  # residual strength over effective overburden; kg/m3


def model_of(elements: int, share: float) -> DiscModel:
    """Discs of sand in a box; those of the lowest share of them have liquefied."""
    packing = box(elements)
    free = packing.layer >= 0
    level = float(np.quantile(packing.z[free], share)) if share > 0.0 else -np.inf
    layer = np.where(free, np.where(packing.z <= level, 1, 0), -1)
    layers = [sand(1.0e8, RADIUS), replace(sand(1.0e8, RADIUS), faded=1.0)]
    model = DiscModel.create(
        DiscGeometry(packing.x, packing.z, packing.radius, layer),
        DiscMaterials(layers, law="soil", turns=False),
        DiscBoundary(packing.lines),
        gravity=(0.0, -GRAVITY),
    )
    if share > 0.0:
        depth = model.z[free].max() - model.z
        pressure = np.maximum(BUOYANT * GRAVITY * depth, 0.0)
        n = len(model)
        liquefy(model, Onset(layer == 1, with_voids(model), pressure, RATIO * pressure, np.full(n, SMALLEST_STRAIN)))
        set_share(model, np.ones(n))
    return model


def seconds_a_step(run: EngineRun, steps: int) -> float:
    """CPU of a step of the kernel, with whatever lists it wants not counted."""
    begin = time.process_time()
    before = run.model.steps
    run.call_kernel(steps)
    return (time.process_time() - begin) / max(1, run.model.steps - before)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--elements", type=int, nargs="+", default=[3180, 31800])
    parser.add_argument("--share", type=float, nargs="+", default=[0.1, 1.0 / 3.0])
    requested = parser.parse_args()
    for elements in requested.elements:
        models = [model_of(elements, share) for share in (0.0, *requested.share)]
        dt = 0.6 * min(largest_step(model).seconds for model in models)
        runs = [EngineRun(Engine(dt=dt, energies=False), model, dt) for model in models]
        steps = max(40, int(WORK / len(models[0]))) // 4 * 4
        for run in runs:
            run.call_kernel(8)
        least = [min(seconds_a_step(run, steps) for run in runs[k : k + 1] * ROUNDS) for k in range(len(runs))]
        for run in runs:
            run.close()
        for share, item, run in zip((0.0, *requested.share), least, runs, strict=True):
            text = f"{elements} discs, {100.0 * share:.0f} % liquefied, held for {run.model.steps_between_looks} steps"
            print(f"{text}: {1e9 * item / len(run.model):.1f} ns a disc and step, {item / least[0]:.2f} times dry")


if __name__ == "__main__":
    main()
