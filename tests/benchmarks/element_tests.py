"""What the discs of each layer stand for, beside the soil they were made from, and how long that takes to find out.

python -m tests.benchmarks.element_tests [SECTION.toml] [--radius M] [--scale S] [--seed N] [--json FILE]
"""

import argparse
import json
import time
from pathlib import Path

import numpy as np

from dem.element_test import ElementTest, element_test
from dem.springs import from_strata
from meshes.section import Section

SHARES = (0.5, 1.0, 2.0)  # of the vertical effective stress in the middle of a layer
G = 9.80665


def middle_stresses(section: Section, columns: int = 41, points: int = 4001) -> np.ndarray:
    """Vertical effective stress (Pa) in the middle of each stratum where it is thickest."""
    left, right = section.extent
    outline = section.outline()
    found = np.zeros((len(section.strata), 2))  # thickness, stress
    density = np.array([s.density_ordinary for s in section.strata])
    for x in np.linspace(left, right, columns + 2)[1:-1]:
        z = np.linspace(outline[:, 1].max(), outline[:, 1].min(), points)
        layer = section.stratum_at(np.full(points, x), z)
        weight = np.where(layer >= 0, density[layer], 0.0) * G * (z[0] - z[1])
        stress = np.cumsum(weight)
        for k in np.unique(layer[layer >= 0]):
            here = np.flatnonzero(layer == k)
            if len(here) > found[k, 0]:
                found[k] = len(here), stress[here[len(here) // 2]]
    return found[:, 1]


def line(name: str, what: str, e: float, nu: float, c: float, phi: float, rest: str) -> str:
    """A row of the table."""
    return f"| {name} | {what} | {e / 1e6:.2f} | {nu:.2f} | {c / 1e3:.1f} | {phi:.1f} | {rest} |"


def rest(test: ElementTest) -> str:
    """The columns that soil has not."""
    verdicts = [t.biaxial_strength.verdict for t in test.tests]
    shown = verdicts[0] if len(set(verdicts)) == 1 else " / ".join(verdicts)
    return (
        f"{np.degrees(test.dilation):.0f} | {shown} | {np.degrees(test.phi_last):.1f} | {test.G / 1e6:.2f} | "
        f"{test.c_shear / 1e3:.1f} | {np.degrees(test.phi_shear):.1f}"
    )


def main() -> None:
    """Reads the arguments, prints the table, writes the results."""
    parser = argparse.ArgumentParser(description="Element tests of every layer's discs, lattice and random packing.")
    parser.add_argument("section", type=Path, nargs="?", default=Path("meshes/s13.toml"))
    parser.add_argument("--radius", type=float, default=0.75, help="of the discs (m)")
    parser.add_argument("--scale", type=float, default=0.01, help="stiffness scale")
    parser.add_argument("--seed", type=int, default=0, help="of the random packing")
    parser.add_argument("--json", type=Path, help="write the results to this file")
    options = parser.parse_args()
    section = Section.read(options.section)
    layers = from_strata(section.strata, options.radius, stiffness_scale=options.scale)
    stresses = middle_stresses(section)
    print("| layer | | E (MPa) | nu | c (kPa) | phi | dilation | biaxial | phi at the end | G (MPa) | c shear | phi shear |")
    print("|---|---|---|---|---|---|---|---|---|---|---|---|")
    results = []
    begin = time.perf_counter()
    for stratum, layer, stress in zip(section.strata, layers, stresses, strict=True):
        soil = stratum.youngs_modulus / (2.0 * (1.0 + stratum.poissons_ratio)) / 1e6
        print(
            line(stratum.name, "soil", stratum.youngs_modulus, stratum.poissons_ratio, stratum.cohesion,
                 np.degrees(stratum.friction_angle), f" | at {stress / 1e3:.0f} kPa | | {soil:.2f} | | ")
        )  # fmt: skip
        for packing in ("lattice", "random"):
            pressures = [share * stress for share in SHARES]
            test = element_test(layer, packing, options.radius, pressures, seed=options.seed)  # type: ignore[arg-type]
            print(line("", packing, test.E, test.nu, test.c, float(np.degrees(test.phi)), rest(test)), flush=True)
            results.append(test.as_json(stratum))
    print(f"\n{time.perf_counter() - begin:.1f} s")
    if options.json:
        options.json.write_text(json.dumps(results, indent=1) + "\n")


if __name__ == "__main__":
    main()
