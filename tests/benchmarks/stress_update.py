"""Time of the Mohr-Coulomb stress update, per point, by the part of the surface the stress returns to.

python -m tests.benchmarks.stress_update [--points N] [--threads N ...] [--repeats N] [--json FILE]
"""

import argparse
import json
import math
import platform
import time
from pathlib import Path

import numpy as np

from fem.kernels import mohr_coulomb as mc
from tests.support.stress_updates import REGIONS

# Material (the second has a tension cut-off) and trial principal stresses (Pa) that return to the region.
TRIALS = {
    "elastic": (0, (-1.0e5, -1.2e5, -1.5e5)),
    "shear plane": (0, (-1.0e5, -2.5e5, -6.0e5)),
    "left edge": (0, (-1.0e5, -1.1e5, -6.0e5)),
    "right edge": (0, (-1.0e5, -5.8e5, -6.0e5)),
    "apex": (0, (6.0e5, 5.0e5, 4.0e5)),
    "tension plane": (1, (1.5e4, 0.0, -5.0e3)),
    "shear-tension line": (1, (2.5e4, -5.0e3, -2.0e4)),
}
MATERIALS = mc.table(5e7, 0.3, 1e4, math.radians(35), math.radians(5), tension=[math.nan, 5e3])


def points(names: list[str], n: int) -> tuple[np.ndarray, ...]:
    """Strain increments, old stresses and materials of n points that return to these regions."""
    random = np.random.default_rng(7)
    pick = random.integers(len(names), size=n)
    material = np.array([TRIALS[name][0] for name in names])[pick]
    principal = np.array([TRIALS[name][1] for name in names])[pick] * random.uniform(0.98, 1.02, size=(n, 1))
    a, b, z = random.permuted(principal, axis=1).T
    mean, half, angle = (a + b) / 2, (a - b) / 2, random.uniform(0, 2 * math.pi, n)
    stress = np.column_stack([mean + half * np.cos(angle), mean - half * np.cos(angle), z, half * np.sin(angle)])

    region = np.empty(n, np.int8)
    mc.update(np.zeros((n, 4)), stress, material, MATERIALS, np.empty((n, 4)), region=region)
    if {REGIONS[r] for r in np.unique(region)} != set(names):
        raise RuntimeError(f"the trial stresses of {names} return to {np.unique(region)}")
    return np.zeros((n, 4)), stress, material


def microseconds(case: tuple[np.ndarray, ...], threads: int, repeats: int, with_tangent: bool) -> float:
    """Least wall time per point of `repeats` updates."""
    n = len(case[0])
    stress, tangent = np.empty((n, 4)), np.empty((n, 4, 4)) if with_tangent else None

    def once() -> float:
        start = time.perf_counter()
        mc.update(*case, MATERIALS, stress, tangent, threads=threads)
        return time.perf_counter() - start

    once()  # fresh memory and a kernel not yet compiled are no part of the time
    return 1e6 * min(once() for _ in range(repeats)) / n


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, default=200_000)
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--repeats", type=int, default=15)
    parser.add_argument("--json", type=Path, metavar="FILE")
    options = parser.parse_args()

    columns = {
        f"{threads} thread(s), {what}": (threads, options.repeats, what == "tangent")
        for threads in options.threads
        for what in ("tangent", "stress")
    }
    print(f"microseconds per point, {options.points} points, least of {options.repeats}")
    print(f"{'':20}" + "".join(f"{head:>24}" for head in columns))
    rows = {}
    for name in (*TRIALS, "mixed"):
        case = points(list(TRIALS) if name == "mixed" else [name], options.points)
        rows[name] = {head: microseconds(case, *arguments) for head, arguments in columns.items()}
        print(f"{name:20}" + "".join(f"{value:24.4f}" for value in rows[name].values()), flush=True)
    if options.json:
        record = {"points": options.points, "machine": platform.machine(), "microseconds_per_point": rows}
        options.json.write_text(json.dumps(record, indent=2) + "\n")


if __name__ == "__main__":
    main()
