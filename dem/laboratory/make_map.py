"""Computes the map of `strength_map` anew: python -m dem.laboratory.make_map [FILE] [--seeds N] [--workers N].

All patches at one pressure: what counts are the two groups, and that kappa = kn / p is 400. Forty minutes of
CPU with forty-eight seeds.
"""

import argparse
import csv
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np

from dem.errors import ConfinementError, EscapeError
from dem.laboratory.compression import PatchStrength, compress
from dem.laboratory.patch import Sample
from dem.laboratory.strength_map import KAPPA, MAP
from dem.springs import ATTRACTION, Strength, soil_discs

FRICTION = (-0.45, -0.3, -0.2, -0.1, 0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8)
COHESION = (0.0, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2, 6.4, 12.8, 25.6)
PRESSURE = 1e5  # Pa
RADIUS = 0.75  # m
DENSITY = 2000.0  # kg/m3


def stiffness_of(cohesion_number: float) -> float:
    """kn (N/m) that is `KAPPA` times what presses contacts together, attraction among it."""
    return KAPPA * (1.0 + ATTRACTION * cohesion_number) * PRESSURE


def patch_strength(place: tuple[float, float, int]) -> PatchStrength | None:
    """One patch by friction, cohesion number and seed, confined and compressed.

    None where a disc slipped out of its frame or the patch went on rearranging, as frictionless ones may.
    """
    friction, cohesion_number, seed = place
    if cohesion_number == 0.0:  # what holds nothing without any push cannot hold less with one
        friction = max(friction, 0.0)
    strength = Strength(friction, cohesion_number * 2.0 * RADIUS * PRESSURE)
    layer = soil_discs(
        "map", stiffness_of(cohesion_number), strength, DENSITY, DENSITY, RADIUS, 0.0, allowed_overlap=1.0
    )
    try:
        return compress(Sample(layer, "random", RADIUS, seed, law="soil"), PRESSURE)
    except (ConfinementError, EscapeError):
        return None


def main() -> None:
    """Writes the file."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", nargs="?", type=Path, default=Path(__file__).with_name(MAP))
    parser.add_argument("--seeds", type=int, default=48)
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    places = [(mu, c) for mu in FRICTION for c in COHESION]
    with ProcessPoolExecutor(options.workers) as pool:
        found = list(pool.map(patch_strength, [(mu, c, seed) for mu, c in places for seed in range(options.seeds)]))
    with options.file.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["friction", "cohesion_number", "after", "peak", "scatter", "modulus", "dilation", "seeds"])
        for k, (mu, c) in enumerate(places):
            seeds = [one for one in found[k * options.seeds : (k + 1) * options.seeds] if one is not None]
            after, peak = (np.array([getattr(one, key) / PRESSURE for one in seeds]) for key in ("after", "peak"))
            modulus = float(np.mean([one.E for one in seeds])) / stiffness_of(c)
            dilation = float(np.degrees(np.mean([one.dilation for one in seeds])))
            row = (float(after.mean()), float(peak.mean()), float(after.std(ddof=1)), modulus, dilation)
            table.writerow([mu, c, *(f"{value:.4g}" for value in row), len(seeds)])


if __name__ == "__main__":
    main()
