"""Large FEM under MPI: `python -m tests.benchmarks.large_fem [--refine N ...] [--ranks N ...]`.

S-13 with bilinear elements, the path to one side and nothing beside it. Cells divided by 29 in each direction make
10^6 unknowns. Each case is a process of its own; kc of all ranks stands beside that of one, with seconds and memory.
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

COLUMNS, ROWS = 47, 13  # of S-13 as it is
SAME = 1e-6  # by which kc may differ between numbers of ranks
OPTIONS = (
    "--element", "bilinear", "--direction", "downhill", "--set", "fem.flow=section", "--set", "fem.rigid_box=false",
    "--set", "fem.safety_factor_at=[]", "--set", "fem.accuracy=0",
)  # fmt: skip


def measure(refine: int, ranks: int) -> dict[str, float | int]:
    """Unknowns, seconds on the clock, memory of the largest rank (MB), and kc."""
    with tempfile.TemporaryDirectory() as folder:
        section = str(SECTIONS / "s13.toml")
        command = [sys.executable, "-m", "workflow.cli", "fem", section, "--out", folder, "--refine", str(refine)]
        start = time.perf_counter()
        process = subprocess.Popen(
            ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", str(ranks), *command, *OPTIONS],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env={**os.environ, "OMP_NUM_THREADS": "1"},
        )  # fmt: skip
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - start
        if os.waitstatus_to_exitcode(status) not in (0, 3):
            raise SystemExit(f"refine = {refine}, {ranks} ranks failed")
        answer = json.loads((Path(folder) / "fem/critical.json").read_text())
    return {
        "unknowns": 2 * (COLUMNS * refine + 1) * (ROWS * refine + 1),
        "ranks": ranks,
        "seconds": round(seconds, 1),
        "largest_rank_MB": usage.ru_maxrss // 1000,
        "linear_solves": answer["linear_solves"],
        "kc": answer["kc"],
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--refine", type=int, nargs="+", default=[2, 4])
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2])
    arguments = parser.parse_args()
    for refine in arguments.refine:
        rows = [measure(refine, ranks) for ranks in arguments.ranks]
        for row in rows:
            print(row, f"kc differs by {abs(row['kc'] - rows[0]['kc']):.1e} (allowed {SAME:g})", flush=True)


if __name__ == "__main__":
    main()
