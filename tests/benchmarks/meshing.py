"""Seconds and peak memory of meshing: S-13 in columns and rows, and a free mesh of about 100,000 quadrilaterals.

python -m tests.benchmarks.meshing [--repeats N] [--json FILE]

Every case runs in processes of its own, so that its memory is its own; the least time of the repeats counts, which
leaves out the first reading of the libraries from disk. Leaves with 1 if a limit is exceeded.
"""

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from tests.support import SECTIONS

S13 = SECTIONS / "s13.toml"
FREE_SIZE = 0.256  # m, which makes about 100,000 quadrilaterals of S-13's 200 m x 31.5 m

# generate() alone, timed inside its process: the settings, the file to write.
GENERATE = """
import sys, time
from meshes.gmsh_model import generate
from meshes.settings import MeshSettings
from meshes.section.section import Section
from tests.support import SECTIONS
section = Section.read(sys.argv[1])
settings = MeshSettings.model_validate_json(sys.argv[2])
start = time.perf_counter()
mesh = generate(section, settings, sys.argv[3])
print(time.perf_counter() - start, len(mesh.cells))
"""
MAPPED, FREE = '{"method": "mapped", "columns": 47, "rows": 13}', f'{{"method": "free", "size": {FREE_SIZE}}}'

CASES: dict[str, tuple[list[str], float]] = {
    "S-13 mapped, generate() alone": (["-c", GENERATE, str(S13), MAPPED, "{out}/s.msh"], 2.0),
    "S-13 mapped, the command with its pictures": (
        ["-m", "workflow.cli", "mesh", str(S13), "--out", "{out}"],
        2.0,
    ),
    "S-13 free, generate() alone": (["-c", GENERATE, str(S13), FREE, "{out}/s.msh"], 60.0),
    "S-13 free, the command with its pictures": (
        ["-m", "workflow.cli", "mesh", str(S13), "--free", "--size", str(FREE_SIZE), "--out", "{out}"],
        60.0,
    ),
}


def once(arguments: list[str]) -> dict[str, Any]:
    """Seconds, peak memory (MB) and quadrilaterals of one process."""
    with tempfile.TemporaryDirectory() as out:
        line = [sys.executable, *(text.replace("{out}", out) for text in arguments)]
        start = time.perf_counter()
        process = subprocess.Popen(line, stdout=subprocess.PIPE, text=True)
        assert process.stdout is not None
        messages = process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - start
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise RuntimeError(f"{line} left with {process.returncode}")
    if "-c" in arguments:
        seconds, cells = float(messages.split()[0]), int(messages.split()[1])
    else:
        cells = int(messages.split(" quadrilaterals")[0].split()[-1])
    return {"seconds": seconds, "peak_memory_mb": usage.ru_maxrss / 1024.0, "quadrilaterals": cells}


def measure(repeats: int) -> dict[str, dict[str, Any]]:
    """The least time of every case, with the memory of that run, and whether it keeps its limit."""
    values = {}
    for name, (arguments, limit) in CASES.items():
        best = min((once(arguments) for _ in range(repeats)), key=lambda result: result["seconds"])
        values[name] = {**best, "limit_seconds": limit, "kept": best["seconds"] < limit}
    return values


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--json", type=Path, help="write the numbers here, too")
    options = parser.parse_args()
    trial = measure(options.repeats)
    print(f"{'case':44}{'cells':>9}{'s':>8}{'limit s':>9}{'MB':>7}")
    for name, case in trial.items():
        print(
            f"{name:44}{case['quadrilaterals']:9}{case['seconds']:8.3f}{case['limit_seconds']:9.0f}"
            f"{case['peak_memory_mb']:7.0f}{'' if case['kept'] else '  exceeded'}"
        )
    if options.json:
        host = {"python": platform.python_version(), "machine": platform.machine(), "processors": os.cpu_count()}
        options.json.write_text(json.dumps({"host": host, "cases": trial}, indent=2) + "\n", encoding="utf-8")
    sys.exit(0 if all(case["kept"] for case in trial.values()) else 1)


if __name__ == "__main__":
    main()
