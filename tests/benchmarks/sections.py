"""Processor seconds of `noshiro fem` on twenty sections: `python -m tests.benchmarks.sections [NAME ...]`.

For each section the critical Kh with what stands beside it, then the factor of safety without shaking alone, then both
bounds; each by the interior-point method of our own and, with ``--both``, by Clarabel alone. Pictures are part
of the first. At the end the median and the slowest of each.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path
from typing import Any

import tomli_w

from tests.support import SECTIONS, TOP
from tests.support.random_sections import NUMBERS, random_data

SHIPPED = ("s13", "slope_2to1", "natural_slope", "river_bank", "moss_landing")
PUBLISHED = (
    "acads_1a", "acads_1c", "acads_2a", "acads_3a", "acads_4", "arai_tagyo_2", "cheng_bench", "fredlund_krahn_5",
    "greco_5",
)  # fmt: skip
RANDOM = NUMBERS[:6]
SOLVERS = {"own": "", "clarabel": "from fem.solvers import cone_program; cone_program.LEAST_VELOCITIES = 10**12; "}
COMMAND = "import sys; {}from workflow.cli import main; sys.argv[0] = 'noshiro'; sys.exit(main())"
FACTOR = """import sys; {}
from mpi4py import MPI
from fem.continuum.strength import flow_of
from fem.search.adaptive import AdaptiveSearch
from meshes.gmsh_model import generate
from workflow.config import Config
config = Config.load(sys.argv[1])
section, meshing = config.section, config.mesh
fem = config.fem.model_copy(update={{"flow": flow_of(section.strata, config.fem.flow)}})
AdaptiveSearch(section, meshing, generate(section, meshing), MPI.COMM_SELF, print).safety(fem, 0.0)
"""
# What is measured: a program, and its command.
PARTS = {"fem": (COMMAND, ["fem"]), "factor": (FACTOR, []), "bounds": (COMMAND, ["bounds"])}


def files(folder: Path) -> dict[str, Path]:
    """The sections by their names, others than the shipped ones written into a folder."""
    found = {name: SECTIONS / f"{name}.toml" for name in SHIPPED}
    written = {f"random_{number}": random_data(number) for number in RANDOM}
    for name in PUBLISHED:
        written[name] = tomllib.loads((TOP / "tests/verification/published" / f"{name}.toml").read_text())
        del written[name]["published"]
    for name, data in written.items():
        found[name] = folder / f"{name}.toml"
        found[name].write_text(tomli_w.dumps(data))
    return found


def seconds(path: Path, part: str, solver: str) -> float | None:
    """Processor seconds of one part in a process of its own; None where it failed."""
    program, command = PARTS[part]
    with tempfile.TemporaryDirectory() as out:
        line = [sys.executable, "-c", program.format(SOLVERS[solver]), *command, str(path), "--out", out]
        process = subprocess.Popen(line, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        _, status, usage = os.wait4(process.pid, 0)
    return round(usage.ru_utime + usage.ru_stime, 1) if os.waitstatus_to_exitcode(status) in (0, 3) else None


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=list(PARTS))
    parser.add_argument("--both", action="store_true")
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    rows: list[dict[str, Any]] = []
    with tempfile.TemporaryDirectory() as folder:
        for name, path in files(Path(folder)).items():
            if options.names and name not in options.names:
                continue
            row: dict[str, Any] = {"section": name}
            for part in options.parts:
                for solver in SOLVERS if options.both else ("own",):
                    row[f"{part}, {solver}"] = seconds(path, part, solver)
            rows.append(row)
            print(row, flush=True)
    for key in rows[0].keys() - {"section"}:
        known = [row[key] for row in rows if row[key] is not None]
        print(f"{key}: median {statistics.median(known):.1f} s, slowest {max(known):.1f} s, {len(known)} sections")
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
