"""Strict bounds of thirty random sections: `python -m tests.benchmarks.random_sections [gap] [sides]`."""

import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass

from fem.limit.bounds import KhBounds, kh_bounds
from fem.settings import LEAST_KH, BoundsSettings, FemSettings
from tests.support.random_sections import NUMBERS, random_section

# What counts as closed in time: the relative gap, and seconds of computing on all cores together.
CLOSED, SECONDS = 0.02, 60.0


@dataclass(frozen=True)
class Entry:
    """The bounds of one section, and the seconds of computing that they took."""

    number: int
    bounds: KhBounds
    seconds: float

    @property
    def good(self) -> bool:
        """Whether the gap was closed in time, as a share of the critical Kh or of `LEAST_KH` if that is larger."""
        return self.bounds.end_reason == "gap" and self.seconds <= SECONDS


def bounds_of_all(gap: float = CLOSED, sides: str = "fixed") -> Iterator[Entry]:
    """The bounds of all sections, one after the other."""
    for number in NUMBERS:
        started = time.process_time()
        settings = FemSettings.model_validate({"sides": sides})
        bounds = kh_bounds(random_section(number), settings, BoundsSettings(gap=gap, davis=False))
        yield Entry(number, bounds, time.process_time() - started)


def main(gap: str = str(CLOSED), sides: str = "fixed") -> None:
    """One line for every section, then how many were closed in time."""
    print("section   lower   upper     gap  triangles  seconds  ended by")
    good = 0
    for entry in bounds_of_all(float(gap), sides):
        result = entry.bounds
        least = min((face.kh for face in result.shallow_failures), default=None)
        shallow = "" if least is None else f", shallow failure {least:.4f}"
        print(
            f"{entry.number:7d}  {result.lower:.4f}  {result.upper:.4f}  {100 * result.gap:5.2f} %  "
            f"{result.meshes[-1].cells:9d}  {entry.seconds:7.1f}  {result.end_reason}{shallow}",
            flush=True,
        )
        good += entry.good
    print(
        f"{good} of {len(NUMBERS)} closed to {100 * float(gap):g} % of Kh, or of {LEAST_KH:g} if that is larger, in "
        f"{SECONDS:g} s of computing."
    )


if __name__ == "__main__":
    main(*sys.argv[1:])
