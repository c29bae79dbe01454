"""Strict bounds and finite elements beside closed forms: `python -m tests.benchmarks.closed_forms [--json FILE]`.

Each row is a problem with its known answer, the bracket of limit analysis, and the limit load of reduced elements on
two meshes.
"""

import argparse
import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

from fem.limit.bracket import Bracket
from tests.support import bound_problems, fem_problems

Row = dict[str, Any]
Factor = Callable[[int], float]

GAP = 0.02


def _elements(phi: float) -> Factor:
    """Nc of a rough footing by reduced elements, by the number of cells below half of it."""
    return lambda cells: float(fem_problems.footing("reduced", phi, cells)[0])


PROBLEMS: tuple[tuple[str, str, str, Callable[[], Bracket], Factor | None], ...] = (
    ("strip footing on clay, Nc", f"{2.0 + math.pi:.4f}", "Prandtl 1920",
     lambda: bound_problems.footing(0.0, gap=GAP), _elements(0.0)),
    ("strip footing, φ = 30°, Nc", "30.140", "Prandtl 1920",
     lambda: bound_problems.footing(30.0, gap=GAP), _elements(30.0)),
    ("vertical cut, φ = 0, γH/c", "3.7752 to 3.7776", "Kammoun et al. 2010",
     lambda: bound_problems.vertical_cut(0.0, gap=GAP), None),
    ("vertical cut, φ = 20°, γH/c", "5.505 at most", "log-spiral, Chen 1975",
     lambda: bound_problems.vertical_cut(20.0, gap=GAP), None),
    ("vertical cut without tension, φ = 0, γH/c", "2", "Drucker & Prager 1952",
     lambda: bound_problems.vertical_cut(0.0, gap=0.05, max_cells=1500, tension=0.0), None),
    ("slope of 45°, φ = 20°, γH/c", "15.93 to 16.39", "limit analysis elsewhere",
     lambda: bound_problems.slope_45(20.0, gap=GAP), None),
    ("slope box, φ = 30°, γH/c", "6.619 to 6.687", "limit analysis elsewhere",
     lambda: bound_problems.slope_box(30.0, gap=GAP), None),
)  # fmt: skip


def row(problem: str, answer: str, source: str, bounds: Callable[[], Bracket], elements: Factor | None) -> Row:
    """One problem with what is found for it."""
    direction_bounds = bounds()
    line = {"problem": problem, "answer": answer, "source": source}
    line |= {"lower": float(f"{direction_bounds.lower:.4g}"), "upper": float(f"{direction_bounds.upper:.4g}")}
    if elements is not None:
        line |= {f"elements_{cells}": float(f"{elements(cells):.4g}") for cells in (4, 8)}
    return line


def quoted(rows: list[Row]) -> dict[str, list[Row]]:
    """What the documentation shows."""
    return {"rows": rows}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write the rows to this file")
    options = parser.parse_args()
    rows = []
    for problem in PROBLEMS:
        rows.append(row(*problem))
        print(rows[-1], flush=True)
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
