"""Finite elements and strict bounds on 30 random slopes: `python -m tests.benchmarks.random_slopes [NUMBER ...]`.

For every slope: critical Kh by Davis's substitute (ψ = 0) and with ψ = φ, strict bounds of both, cells, seconds of
processor time, and the work of each bracket in seconds of a reference machine; at the end what contradicts what.
"""

import argparse
import json
import time
from pathlib import Path
from typing import Any

from mpi4py import MPI

from fem import BoundsSettings, FemSettings, UnstableError, kh_bounds
from fem.limit.bracket import Bracket
from fem.limit_load.limit_load import LimitLoadResult
from fem.search.adaptive import AdaptiveSearch
from fem.search.mesh_sequence import AdaptiveResult
from meshes.gmsh_model import generate
from meshes.settings import MeshSettings
from tests.support.random_sections import NUMBERS, random_section

SETTINGS = FemSettings(direction="downhill")
BOUNDS = BoundsSettings(gap=0.02, davis=True)
# Work (s of a reference machine of two cores) within which the gap of a bracket is to be closed.
SECONDS = 60.0
# How far the elements may lie above the strict upper bound; how far below the lower one, since between their points
# they ask for nothing; by how much in Kh where that is more.
ABOVE, BELOW, SMALL = 1.02, 0.99, 0.002


def measure(number: int, refine: int = 1) -> dict[str, Any]:
    """What is found for one slope, on meshes made for it from one ``refine`` times as fine as by default."""
    section = random_section(number)
    row: dict[str, Any] = {"number": number}
    started = time.process_time()
    meshing = MeshSettings(refine=refine)
    mesh = generate(section, meshing)
    wish = SETTINGS.model_copy(update={"flow": "davis"})
    answers: dict[str, AdaptiveResult[LimitLoadResult] | None] = dict.fromkeys(("davis", "associated"))
    try:
        search = AdaptiveSearch(section, meshing, mesh, MPI.COMM_SELF)
        answers["davis"], answers["associated"] = search.with_full_dilation(search.critical(wish), wish)
    except UnstableError as error:  # by its substitute ground may fail under its weight that stands as it dilates
        row["failed"] = str(error)
        full = SETTINGS.model_copy(update={"flow": "associated"})
        answers["associated"] = AdaptiveSearch(section, meshing, mesh, MPI.COMM_SELF).critical(full)
    for flow, answer in answers.items():
        row[flow] = round(answer.result.kc, 4) if answer else None
        row[f"{flow}_meshes"] = [item.cells for item in answer.rounds] if answer else []
        row[f"{flow}_change"] = round(answer.rounds[-1].change, 4) if answer else None
    row["seconds"] = round(time.process_time() - started, 1)
    started = time.process_time()
    try:
        bounds = kh_bounds(section, SETTINGS, BOUNDS)
        row["bounds"] = [round(bounds.lower, 4), round(bounds.upper, 4)]
        row["gap"], row["ended"], row["work"] = round(bounds.gap, 4), bounds.end_reason, _work(bounds)
        if bounds.substitute is not None:
            row["davis_bounds"] = [round(bounds.substitute.lower, 4), round(bounds.substitute.upper, 4)]
            row["davis_work"] = _work(bounds.substitute)
    except UnstableError:
        row["bounds"] = None
    row["bounds_seconds"] = round(time.process_time() - started, 1)
    return row


def _work(outcome: Bracket) -> float:
    """Work of all meshes of a bracket, in seconds of the reference machine."""
    return round(sum(mesh.work for mesh in outcome.meshes), 1)


def contradictions(row: dict[str, Any]) -> list[str]:
    """What must not be: Davis above ψ = φ, either above its upper bound or below its lower one by more than allowed;
    no answer by Davis where its lower bound is above zero."""
    results = []
    davis, full = row["davis"], row["associated"]
    if davis is None and row["davis_bounds"][0] > 0.0:
        results.append(f"no answer by Davis, who bears {row['davis_bounds'][0]} at least")
    if davis is not None and full is not None and davis > full:
        results.append("Davis above ψ = φ")
    for kc, name in ((full, "bounds"), (davis, "davis_bounds")):
        if kc is None or row.get(name) is None:
            continue
        lower, upper = row[name]
        if kc > max(ABOVE * upper, upper + SMALL):
            results.append(f"{kc} is {100.0 * (kc / upper - 1.0):.1f} % above {name} {upper}")
        if kc < min(BELOW * lower, lower - SMALL):
            results.append(f"{kc} is {100.0 * (1.0 - kc / lower):.1f} % below {name} {lower}")
    return results


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
    closed = [row for row in rows if row.get("gap", 1.0) <= BOUNDS.gap and row["work"] <= SECONDS]
    print(f"{len(closed)} of {len(rows)} with a gap of {100.0 * BOUNDS.gap:g} % after {SECONDS:g} s")
    if arguments.json:
        arguments.json.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
