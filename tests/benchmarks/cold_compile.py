"""How long the kernels of the discs take to be compiled, where nothing is kept from an earlier run.

python -m tests.benchmarks.cold_compile [--json FILE]

A process of its own, with an empty folder for what it compiles, takes a few steps of the paper's discs and of soil
discs, with the energy balance and a new list of neighbours: CPU and clock, then both again from what is kept. Imports
are not counted. Then, with another empty folder, the clock of what a run waits for: two processes that compile ahead.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

PROGRAM = """
import json, math, time
from dem.engine.engine import Engine
from tests.benchmarks.dem_throughput import DT, model_of
begin = time.process_time(), time.perf_counter()
for law in ("paper", "soil"):
    model = model_of(500, law == "paper", law)
    Engine(dt=DT, balance=math.inf).run(model, steps=300)
    model.make_list()
print(json.dumps({"cpu_s": time.process_time() - begin[0], "clock_s": time.perf_counter() - begin[1]}))
"""

PRECOMPILED = """
import json, time
from dem.precompile import precompile
from meshes.executor import Processes
if __name__ == "__main__":
    with Processes(2) as executor:
        begin = time.perf_counter()
        precompile(executor, lambda _: None)
        print(json.dumps({"clock_s": time.perf_counter() - begin}))
"""


def once(folder: str, program: str = PROGRAM) -> dict[str, float]:
    """Seconds of CPU and on the clock, of a process that keeps in `folder` what it compiles."""
    run = subprocess.run(
        [sys.executable, "-c", program], env=os.environ | {"NUMBA_CACHE_DIR": folder}, capture_output=True, check=True,
        text=True,
    )  # fmt: skip
    data: dict[str, float] = json.loads(run.stdout)
    return {name: round(seconds, 2) for name, seconds in data.items()}


def main() -> None:
    """Prints both, and writes them."""
    parser = argparse.ArgumentParser(description="Time to compile the kernels of the discs.")
    parser.add_argument("--json", type=Path, help="write the rows to this file")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="noshiro-") as folder:
        rows = [{"what": what, **once(folder)} for what in ("compiled", "kept")]
    with tempfile.TemporaryDirectory(prefix="noshiro-") as folder:
        rows.append({"what": "compiled ahead by two processes", **once(folder, PRECOMPILED)})
    for row in rows:
        of_cpu = f"{row['cpu_s']} s of CPU, " if "cpu_s" in row else ""
        print(f"{row['what']}: {of_cpu}{row['clock_s']} s on the clock")
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
