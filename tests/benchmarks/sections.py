"""Processor seconds of `noshiro fem` on twenty sections: `python -m tests.benchmarks.sections [NAME ...]`.

For each section the critical Kh with what stands beside it and pictures; with ``--parts factor bounds together`` the
factor of safety without shaking alone, both bounds of Kh, and `noshiro fem --safety-factor` with all bounds; each by
the interior-point method of our own and, with ``--both``, by Clarabel alone. At the end the
median and the slowest of each. Modules are loaded as compiled bytecode, as in an installed program; a first run, which
does not count, writes the bytecode to a temporary folder.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import tomllib
from dataclasses import dataclass
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
SOLVERS = {"own": "", "clarabel": "from fem.solvers import cone_program; cone_program.FEWEST_VELOCITIES = 10**12; "}
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
PARTS = {
    "fem": (COMMAND, ["fem"]), "factor": (FACTOR, []), "bounds": (COMMAND, ["bounds"]),
    "together": (COMMAND, ["fem", "--safety-factor"]),
}  # fmt: skip


def files(folder: Path) -> dict[str, Path]:
    """The sections by their names, others than the shipped ones written into a folder."""
    values = {name: SECTIONS / f"{name}.toml" for name in SHIPPED}
    written = {f"random_{number}": random_data(number) for number in RANDOM}
    for name in PUBLISHED:
        written[name] = tomllib.loads((TOP / "tests/verification/published" / f"{name}.toml").read_text())
        del written[name]["published"]
    for name, data in written.items():
        values[name] = folder / f"{name}.toml"
        values[name].write_text(tomli_w.dumps(data))
    return values


@dataclass(frozen=True)
class Measured:
    """Holds processor seconds of one part in a process of its own, None where it failed, the critical Kh and factor of
    safety without shaking that it left, None where it left none, and lower and upper bounds of Kh, then of factors."""

    seconds: float | None
    kc: float | None
    factor: float | None
    bounds: list[tuple[float | None, float | None]]


def with_bytecode(folder: Path) -> dict[str, str]:
    """The environment of this program in which Python writes its bytecode to a folder, and reads it from there."""
    inherited = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    return inherited | {"PYTHONPYCACHEPREFIX": str(folder)}


def measured(path: Path, part: str, solver: str, environment: dict[str, str]) -> Measured:
    """One part of a section, run in an environment."""
    program, command = PARTS[part]
    with tempfile.TemporaryDirectory() as out:
        line = [sys.executable, "-c", program.format(SOLVERS[solver]), *command, str(path), "--out", out]
        process = subprocess.Popen(line, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment)
        _, status, usage = os.wait4(process.pid, 0)
        answer = Path(out) / "fem/critical.json"
        result = json.loads(answer.read_text()) if answer.exists() else {"kc": None, "safety_factors": []}
        bounds = Path(out) / "fem/bounds.json"
        bracket = json.loads(bounds.read_text()) if bounds.exists() else None
    seconds = round(usage.ru_utime + usage.ru_stime, 1) if os.waitstatus_to_exitcode(status) in (0, 3) else None
    factor = next((row["factor"] for row in result["safety_factors"]), None)
    brackets = [] if bracket is None else [bracket, *bracket["safety"]]
    return Measured(seconds, result["kc"], factor, [(each["lower"], each["upper"]) for each in brackets])


def quoted(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """What the documentation shows: seconds and answers of every section, the median and the slowest.

    A section without a critical Kh, which fails under its own weight, has no number there.
    """
    digits = {"seconds": 0, "kc": 3, "factor": 2}
    shown = [
        {"section": row["section"]} | {key: round(row[key], places) for key, places in digits.items() if row.get(key)}
        for row in rows
    ]
    times = [row["seconds"] for row in rows if row["seconds"] is not None]
    return {"median_seconds": round(statistics.median(times)), "slowest_seconds": round(max(times)), "rows": shown}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=["fem"])
    parser.add_argument("--both", action="store_true")
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    rows: list[dict[str, Any]] = []
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as bytecode:
        environment, sections = with_bytecode(Path(bytecode)), files(Path(folder))
        for part in options.parts:
            measured(sections[SHIPPED[0]], part, "own", environment)
        for name, path in sections.items():
            if options.names and name not in options.names:
                continue
            row: dict[str, Any] = {"section": name}
            for part in options.parts:
                for solver in SOLVERS if options.both else ("own",):
                    answer = measured(path, part, solver, environment)
                    row[f"{part}, {solver}"] = answer.seconds
                    if (part, solver) == ("fem", "own"):
                        row |= {key: value for key, value in vars(answer).items() if key != "bounds"}
                    elif answer.bounds:
                        row[f"{part}, {solver}: bounds"] = answer.bounds
            rows.append(row)
            print(row, flush=True)
    for key in (key for key in rows[0] if ", " in key and ":" not in key):
        known = [row[key] for row in rows if row[key] is not None]
        print(f"{key}: median {statistics.median(known):.1f} s, slowest {max(known):.1f} s, {len(known)} sections")
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
