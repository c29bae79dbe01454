"""Recomputes the maps of `dem.laboratory.strength_map`: python -m docs.strength_map [FILE] [--workers N].

All patches are tested at one pressure, since only the two dimensionless numbers matter, and kappa = kn / p is 400.
Rotating discs without cohesion are tested with more seeds than those with cohesion. The computation takes three
quarters of an hour of CPU time.
"""

import argparse
import csv
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np

from dem.errors import ConfinementError, EscapeError
from dem.laboratory import strength_map
from dem.laboratory.compression import PatchStrength, compress
from dem.laboratory.contact_numbers import PRESSURE, ContactNumbers

FRICTION = (-0.45, -0.3, -0.2, -0.1, 0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8)
COHESION = (0.0, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2, 6.4, 12.8, 25.6)
CLAY = 0.2  # largest friction of clay, whose discs do not rotate and have some cohesion
SEEDS, SAND_SEEDS, CLAY_SEEDS = 6, 24, 48
HEADS = ("turns", "friction", "cohesion_number", "after", "peak", "scatter", "modulus", "dilation", "seeds")


def places() -> list[tuple[bool, float, float, int]]:
    """Yield the points of the map: whether discs rotate, friction, cohesion number, seeds."""
    turning = [(True, mu, c, SEEDS if c > 0.0 else SAND_SEEDS) for mu in FRICTION for c in COHESION]
    clay = [(False, mu, c, CLAY_SEEDS) for mu in FRICTION if mu <= CLAY for c in COHESION if c > 0.0]
    return turning + clay


def patch_strength(place: tuple[bool, float, float, int]) -> PatchStrength | None:
    """Return the strength of one patch, given whether its discs rotate, friction, cohesion number and seed. Return None
    if a disc leaves the frame or the patch does not come to rest, as frictionless patches may."""
    turns, friction, cohesion_number, seed = place
    if cohesion_number == 0.0:  # what holds nothing without any push cannot hold less with one
        friction = max(friction, 0.0)
    try:
        return compress(ContactNumbers(turns, friction, cohesion_number, strength_map.KAPPA).sample(seed), PRESSURE)
    except (ConfinementError, EscapeError):
        return None


def row_of(cohesion_number: float, patches: Sequence[PatchStrength]) -> list[str]:
    """Return the values of the map at one of its points, from the patches tested there."""
    after = np.array([patch.post_peak for patch in patches]) / PRESSURE
    peak = np.mean([patch.course for patch in patches], axis=0).max() / PRESSURE
    stiffness = ContactNumbers(True, 0.0, cohesion_number, strength_map.KAPPA).stiffness * PRESSURE
    modulus = np.mean([patch.E for patch in patches]) / stiffness
    dilation = np.degrees(np.mean([patch.dilation for patch in patches]))
    return [f"{value:.4g}" for value in (after.mean(), peak, after.std(ddof=1), modulus, dilation)]


def main() -> None:
    """Compute the maps, and write their file."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", nargs="?", type=Path, default=Path(strength_map.__file__).with_name(strength_map.MAP))
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    wanted = [(turns, mu, c, seed) for turns, mu, c, seeds in places() for seed in range(seeds)]
    with ProcessPoolExecutor(options.workers) as pool:
        strengths = dict(zip(wanted, pool.map(patch_strength, wanted), strict=True))
    with options.file.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(HEADS)
        for turns, mu, c, seeds in places():
            known = [strength for seed in range(seeds) if (strength := strengths[turns, mu, c, seed]) is not None]
            table.writerow([int(turns), mu, c, *row_of(c, known), len(known)])


if __name__ == "__main__":
    main()
