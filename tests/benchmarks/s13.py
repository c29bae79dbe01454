"""A whole run of S-13 and strict bounds of it to 1 %: `python -m tests.benchmarks.s13 [--folder RUN] [--json FILE]`.

README and documentation quote these numbers. With a folder that holds a finished run, only the bounds are computed.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from dem.search.pushover import pushover_critical_kh
from fem.limit.bounds import kh_bounds
from fem.settings import BoundsSettings, FemSettings
from meshes.section.section import Section
from tests.support import SECTIONS
from workflow.config.after_triggering import load_config
from workflow.results.dem_counterpart import DemCounterpart
from workflow.run.store import Store
from workflow.stages.discs_at_rest import SETTLED, continuum_for, discs_at_rest

S13 = SECTIONS / "s13.toml"

Row = dict[str, Any]


def run(folder: Path) -> None:
    """All stages, into a folder; what is there already is reused."""
    command = [sys.executable, "-m", "workflow.cli", "run", str(S13), "--out", str(folder), "--quiet"]
    subprocess.run(command, check=True)


def uncalibrated(folder: Path, seeds: Sequence[int]) -> dict[int, float]:
    """The critical Kh of every random packing of a run before its calibration, of which a run computes only that of
    its own."""
    config, store = load_config(S13), Store(folder)
    values = {}
    for seed in seeds:
        dem = config.dem.changed(packing="random", seed=seed)
        file = SETTLED if seed == config.dem.seed else f"dem/slide_seed{seed}_settled.npz"
        discs = discs_at_rest(config, store, dem, file, lambda _: None)
        search, _ = pushover_critical_kh(
            discs.settled, discs.ground, dem, continuum_for(config, store), until_failed=False
        )
        assert search.kc is not None
        values[seed] = search.kc
    return values


def rows_of(folder: Path) -> list[Row]:
    """The numbers of a run, and its bounds to 1 %."""
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    fem, dem = summary["fem"], summary["dem"]
    seeds = summary["cases_random"]["seeds"] if summary["cases_random"] else []
    packings = sorted(uncalibrated(folder, [seed["seed"] for seed in seeds]).values()) or [dem["kc_uncalibrated"]]
    slides = [case["slide_max_m_mean"] or case["slide_max_m"] for case in summary["cases"].values()]
    box = DemCounterpart.read(Store(folder))
    bounds = kh_bounds(Section.read(S13), FemSettings(), BoundsSettings(gap=0.01, davis=False))
    row = {
        "kc_headline": float(summary["headlines"][0]["value"]),
        "kc": fem["kc"],
        "kc_associated": fem["kc_associated"],
        "lower": bounds.lower,
        "upper": bounds.upper,
        "kc_discs": dem["kc"],
        "kc_discs_of_packings": packings,
        "kc_target": dem["kc_target"],
        "kc_box": box.kc,
        "kc_box_upper": box.kc_upper,
        "strength_factor": dem["strength_factor"],
        "kc_paper_discs": summary["paper_model"]["kc"],
        "slide_least_m": min(slides),
        "slide_most_m": max(slides),
        "slide_points_m": max(case["slide_max_m"] for case in summary["cases_mpm"].values()),
        "paper": summary["paper"],
    }
    return [row]


def quoted(rows: list[Row]) -> Row:
    """What the documentation shows, in the digits that it shows."""
    row = rows[0]
    packings = [round(kc, 3) for kc in row["kc_discs_of_packings"]]
    digits = {
        "slide_least_m": 1,
        "slide_most_m": 1,
        "slide_points_m": 2,
        "strength_factor": 2,
        "kc_paper_discs": 3,
        "kc": 3,
    }
    numbers = {name: round(value, digits.get(name, 4)) for name, value in row.items() if isinstance(value, float)}
    messages = ("quantity", "paper", "ours", "agrees")
    compared = [{name: "" if line[name] is None else line[name] for name in messages} for line in row["paper"]]
    return {**numbers, "kc_discs_of_packings": packings, "paper": compared}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", type=Path, help="of a run; a new one if not given")
    parser.add_argument("--json", type=Path, help="write the rows to this file")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="noshiro-") as new:
        folder = options.folder or Path(new)
        if not (folder / "summary.json").exists():
            run(folder)
        rows = rows_of(folder)
    print(quoted(rows))
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
