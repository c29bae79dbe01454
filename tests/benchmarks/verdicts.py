"""What the critical Kh of S-13's discs costs: python -m tests.benchmarks.verdicts [--json FILE].

Disc-steps, which are discs times time steps, and seconds of a core: of every Kh that the paper's discs are tried at,
and of the one push that finds that of soil discs, with what it goes on by until a slip surface has formed.
"""

import argparse
import json
import time
from pathlib import Path
from typing import Any

from dem.ground import ground_of, springs_of
from dem.laboratory.soil_layers import soil_layers
from dem.model import DiscModel
from dem.search.critical import critical_kh
from dem.search.deposit import deposit
from dem.search.equilibrium import Trial, settle
from dem.search.pushover import Continuum, pushover_critical_kh
from tests.support import SECTIONS
from workflow.config import Config

# Of the continuum between fixed sides with psi as given, and its mean displacement (m) once it yields.
CONTINUUM = Continuum(0.339, 0.243)


class Costs:
    """A line for every verdict."""

    def __init__(self, model: str, settled: DiscModel) -> None:
        self.model, self.steps, self.clock = model, settled.steps, time.process_time()
        self.rows: list[dict[str, Any]] = []

    def __call__(self, trial: Trial, discs: DiscModel) -> None:
        before = self.steps if discs.steps >= self.steps else 0
        cost = (discs.steps - before) * len(discs) / 1e6
        row = {"discs": self.model, "kh": round(trial.kh, 4), "verdict": trial.verdict, "million_disc_steps": cost}
        self.rows.append({**row, "seconds": round(time.process_time() - self.clock, 2)})
        self.clock = time.process_time()
        print(
            f"{self.model:6s} Kh {trial.kh:.4f} {trial.verdict:10s} {cost:7.1f} million disc-steps, "
            f"{self.rows[-1]['seconds']:5.2f} s",
            flush=True,
        )


class Trials(Costs):
    """Every trial begins from the discs that stood last."""

    def __call__(self, trial: Trial, discs: DiscModel) -> None:
        super().__call__(trial, discs)
        if trial.verdict == "stands":
            self.steps = discs.steps


class Points(Costs):
    """Every point follows the one before."""

    def __call__(self, trial: Trial, discs: DiscModel) -> None:
        super().__call__(trial, discs)
        self.steps = discs.steps


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    given = Config.load(SECTIONS / "s13.toml")
    rows: list[dict[str, Any]] = []

    paper = given.dem.as_paper()
    ground = ground_of(given.section, paper)
    settled = settle(ground, springs_of(given.section, paper, ground.radius), paper)
    trials = Trials("paper", settled)
    found = critical_kh(settled, ground, paper, on_trial=trials)
    total = sum(row["million_disc_steps"] for row in trials.rows)
    print(f"paper: {found.lower:.4f} to {found.upper or 0.0:.4f}, {len(trials.rows)} verdicts, {total:.0f} million")
    rows += trials.rows

    soil = soil_layers(given.section)
    box = deposit(given.section, given.dem, lambda radius, voids: [layer.springs(radius, voids) for layer in soil])
    points = Points("soil", box.settled)
    pushed, after = pushover_critical_kh(box.settled, box.ground, given.dem, CONTINUUM, on_trial=points)
    total = sum(row["million_disc_steps"] for row in points.rows)
    beyond = (after.steps - points.steps) * len(after) / 1e6
    print(
        f"soil: {pushed.lower:.4f} to {pushed.upper or 0.0:.4f}, one push of {len(points.rows)} points, {total:.0f} "
        f"million, and {beyond:.0f} on to where a band has formed"
    )
    rows += points.rows
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
