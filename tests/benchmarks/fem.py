"""Seconds and memory of `noshiro fem` on S-13: `python -m tests.benchmarks.fem [--refine N ...] [--json FILE]`.

Each case runs as a process of its own, pictures included, after a first run has filled the caches.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tests.support import SECTIONS

S13 = SECTIONS / "s13.toml"
CASES = (
    ("quadratic, psi = 0", ()),
    ("quadratic, psi = phi", ("--associated",)),
    ("bilinear, psi = 0", ("--element", "bilinear")),
)


def measure(options: tuple[str, ...]) -> dict[str, float | int]:
    """Wall and processor seconds, peak memory (MB), cells, linear solves and kc of one run."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "workflow.cli", "fem", str(S13), "--out", folder, *options]
        start = time.perf_counter()
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - start
        if os.waitstatus_to_exitcode(status) not in (0, 3):
            raise SystemExit(f"{' '.join(command)} failed")
        answer = json.loads((Path(folder) / "fem/critical.json").read_text())
    return {
        "cells": answer["mesh"]["quadrilaterals"],
        "seconds": round(seconds, 2),
        "processor_seconds": round(usage.ru_utime + usage.ru_stime, 2),
        "peak_MB": usage.ru_maxrss // 1000,
        "linear_solves": answer["linear_solves"],
        "median_iterations": sorted(step["iterations"] for step in answer["curve"])[len(answer["curve"]) // 2],
        "kc": round(answer["kc"], 4),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--refine", type=int, nargs="+", default=[1])
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    for _, options in CASES:
        measure(options)
    rows = []
    for refine in arguments.refine:
        for name, options in CASES:
            rows.append({"case": name, **measure((*options, "--refine", str(refine)))})
            print(rows[-1], flush=True)
    if arguments.json:
        arguments.json.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
