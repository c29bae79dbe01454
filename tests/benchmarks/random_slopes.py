"""Finite elements and strict bounds on 30 random slopes: `python -m tests.benchmarks.random_slopes [NUMBER ...]`.

For every slope: critical Kh by Davis's substitute (ψ = 0) and with ψ = φ, strict bounds of both, cells and seconds of
processor time; at the end what contradicts what.
"""

import argparse
import json
import time
from pathlib import Path
from typing import Any

from mpi4py import MPI

from fem import BoundsSettings, FemSettings, UnstableError, critical_coefficient, kh_bounds
from meshes.gmsh_model import generate
from meshes.settings import MeshSettings
from tests.support.random_sections import NUMBERS, random_section

SETTINGS = FemSettings(direction="downhill", kh=(9.0,))
BOUNDS = BoundsSettings(gap=0.05, seconds=60.0)


def measure(number: int, refine: int = 1) -> dict[str, Any]:
    """What is found for one slope."""
    section = random_section(number)
    row: dict[str, Any] = {"number": number}
    started = time.process_time()
    mesh = generate(section, MeshSettings(refine=refine))
    row["cells"] = len(mesh.cells)
    for flow in ("davis", "associated"):
        try:
            found = critical_coefficient(section, mesh, SETTINGS.model_copy(update={"flow": flow}), MPI.COMM_SELF)
            row[flow] = round(found.kc, 4)
        except UnstableError:
            row[flow] = None
    row["seconds"] = round(time.process_time() - started, 1)
    started = time.process_time()
    try:
        bounds = kh_bounds(section, SETTINGS, BOUNDS)
        row["bounds"] = [round(bounds.lower, 4), round(bounds.upper, 4)]
        if bounds.substitute is not None:
            row["davis_bounds"] = [round(bounds.substitute.lower, 4), round(bounds.substitute.upper, 4)]
    except UnstableError:
        row["bounds"] = None
    row["bounds_seconds"] = round(time.process_time() - started, 1)
    return row


def contradictions(row: dict[str, Any]) -> list[str]:
    """What must not be: Davis above ψ = φ, either above 1.02 of its upper bound, or below its lower one."""
    found = []
    davis, full = row["davis"], row["associated"]
    if davis is not None and full is not None and davis > 1.005 * full:
        found.append("Davis above ψ = φ")
    for kc, name in ((full, "bounds"), (davis, "davis_bounds")):
        if kc is None or row.get(name) is None:
            continue
        lower, upper = row[name]
        if kc > 1.02 * upper:
            found.append(f"{kc} is {100.0 * (kc / upper - 1.0):.0f} % above {name} {upper}")
        if kc < 0.995 * lower:
            found.append(f"{kc} is below {name} {lower}")
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("numbers", type=int, nargs="*", default=NUMBERS)
    parser.add_argument("--refine", type=int, default=1)
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    rows = []
    for number in arguments.numbers:
        rows.append(measure(number, arguments.refine))
        print(rows[-1], "; ".join(contradictions(rows[-1])), flush=True)
    print(f"{sum(not contradictions(row) for row in rows)} of {len(rows)} without a contradiction")
    if arguments.json:
        arguments.json.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
