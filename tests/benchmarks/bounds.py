"""What the strict bounds of S-13 cost, mesh by mesh: `python -m tests.benchmarks.bounds [roller|fixed] [gap]`."""

import resource
import sys

from fem.limit.adaptive_bounds import Bracket
from fem.limit.bounds import kh_bounds
from fem.settings import BoundsSettings, FemSettings
from meshes.section.section import Section
from tests.support import SECTIONS

S13 = SECTIONS / "s13.toml"


def main(sides: str = "fixed", gap: str = "0.01") -> None:
    """One line for every mesh, then the largest memory (MB)."""
    print("cells   lower   upper     gap  seconds")

    def show(found: Bracket) -> None:
        one = found.meshes[-1]
        print(f"{one.cells:6d}  {found.lower:.4f}  {found.upper:.4f}  {100 * found.gap:5.2f} %  {one.seconds:6.1f}")

    settings = FemSettings.model_validate({"sides": sides})
    kh_bounds(Section.read(S13), settings, BoundsSettings(gap=float(gap), davis=False), show)
    print(f"{resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MB")


if __name__ == "__main__":
    main(*sys.argv[1:])
