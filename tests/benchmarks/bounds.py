"""What the strict bounds of S-13 cost, mesh by mesh: `python -m tests.benchmarks.bounds [free-field|fixed] [gap]`."""

import resource
import sys
import time

from fem.limit.bounds import kh_bounds
from fem.limit.bracket import Bracket
from fem.settings import BoundsSettings, FemSettings
from meshes.section.section import Section
from tests.support import SECTIONS

S13 = SECTIONS / "s13.toml"


def main(sides: str = "fixed", gap: str = "0.01") -> None:
    """One line for every mesh, then the largest memory (MB)."""
    print("cells   lower   upper     gap  seconds  work (s)")

    start = time.perf_counter()

    def show(result: Bracket) -> None:
        meshes, took = result.meshes[-1], f"{time.perf_counter() - start:6.1f}  {result.meshes[-1].work:6.1f}"
        print(f"{meshes.cells:6d}  {result.lower:.4f}  {result.upper:.4f}  {100 * result.gap:5.2f} %  {took}")

    settings = FemSettings.model_validate({"sides": sides})
    kh_bounds(Section.read(S13), settings, BoundsSettings(gap=float(gap), davis=False), show)
    print(f"{resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MB")


if __name__ == "__main__":
    main(*sys.argv[1:])
