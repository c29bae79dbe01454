"""What the discs of each layer stand for, beside the soil they were made from, and how long that takes to find out.

python -m tests.benchmarks.element_tests [SECTION.toml] [--radius M] [--scale S] [--seed N] [--json FILE]
"""

import argparse
import json
import time
from pathlib import Path

import numpy as np

from dem.laboratory.element_table import SHARES, middle_stresses
from dem.laboratory.element_test import ElementTest, element_test
from dem.laboratory.patch import PackingKind, Sample
from dem.springs import from_strata
from meshes.section.section import Section, Stratum


def strengths(c: float, phi: float, sure: bool) -> str:
    """c (Pa) and phi (rad) as two columns, in brackets if a test did not come to its peak."""
    shown = f"{c / 1e3:.0f}" if abs(c) > 2e4 else f"{c / 1e3:.1f}"
    angle = f"{np.degrees(phi):.0f}"
    return f"{shown} | {angle}" if sure else f"({shown}) | ({angle})"


def soil_row(stratum: Stratum, stress: float) -> str:
    """What the layer is made from."""
    e, nu = stratum.youngs_modulus, stratum.poissons_ratio
    strength = strengths(stratum.cohesion, stratum.friction_angle, True)
    return (
        f"| {stratum.name}, {stress / 1e3:.0f} kPa | soil | {e / 1e6:.1f} | {nu:.2f} | {e / 2e6 / (1.0 + nu):.1f} | "
        f"{strength} | {np.degrees(stratum.dilation_angle):.0f} | {strength} |"
    )


def disc_row(test: ElementTest) -> str:
    """What its discs are."""
    reached = [
        all(s.verdict in ("peak", "levels off") for s in results)
        for results in zip(*((t.biaxial_strength, t.shear_strength) for t in test.tests), strict=True)
    ]
    return (
        f"| | {test.sample.packing} | {test.E / 1e6:.1f} | {test.nu:.2f} | {test.G / 1e6:.1f} | "
        f"{strengths(test.c, test.phi, reached[0])} | {np.degrees(test.dilation):.0f} | "
        f"{strengths(test.c_shear, test.phi_shear, reached[1])} |"
    )


def main() -> None:
    """Reads the arguments, prints the table, writes the results."""
    parser = argparse.ArgumentParser(description="Element tests of every layer's discs, lattice and random packing.")
    parser.add_argument("section", type=Path, nargs="?", default=Path("meshes/sections/s13.toml"))
    parser.add_argument("--radius", type=float, default=0.75, help="of the discs (m)")
    parser.add_argument("--scale", type=float, default=0.01, help="stiffness scale")
    parser.add_argument("--seed", type=int, default=0, help="of the random packing")
    parser.add_argument("--json", type=Path, help="write the results to this file")
    options = parser.parse_args()
    section = Section.read(options.section)
    layers = from_strata(section.strata, options.radius, stiffness_scale=options.scale)
    print("| layer, stress | | E (MPa) | nu | G (MPa) | c (kPa) | phi | dilation | c, shear | phi, shear |")
    print("|" + "---|" * 10)
    results = []
    begin, busy = time.perf_counter(), time.process_time()
    packings: tuple[PackingKind, ...] = ("lattice", "random")
    for stratum, layer, stress in zip(section.strata, layers, middle_stresses(section), strict=True):
        print(soil_row(stratum, stress))
        for packing in packings:
            pressures = [float(share * stress) for share in SHARES]
            test = element_test(Sample(layer, packing, options.radius, options.seed), pressures)
            print(disc_row(test), flush=True)
            results.append(test.as_json(stratum))
    wall, cpu = time.perf_counter() - begin, time.process_time() - busy
    unbalanced, inertial = (
        max(r["quality"][f"{key}_largest"] for r in results) for key in ("unbalanced", "inertial_number")
    )
    print(f"\n{wall:.1f} s, {cpu:.1f} of CPU; unbalanced ratio up to {unbalanced:.2g}, inertial number {inertial:.2g}")
    for result in results:
        for verdict in result["verdicts"]:
            print(f"{result['stratum']}, {result['packing']}: {verdict}")
    if options.json:
        options.json.write_text(json.dumps(results, indent=1) + "\n")


if __name__ == "__main__":
    main()
