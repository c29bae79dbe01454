"""Large FEM under MPI: `python -m tests.benchmarks.large_fem [--refine N ...] [--ranks N ...] [--steps N] [--json F]`.

S-13 with bilinear elements and Davis's substitute, pushed downhill along a path in long steps, to a plateau or so many
steps. Cells divided by 29 in each direction make 10^6 unknowns. Each case is a process group of its own; seconds and
memory stand beside it, and Kh step by step beside that of the first number of ranks.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from mpi4py import MPI

from fem.continuum.loads import sign_of
from fem.limit_load.limit_load import loaded_ground
from fem.path.equilibrium_path import EquilibriumPath
from fem.path.newton import NewtonSettings
from fem.path.plateau import growth_per_doubling
from fem.search.critical import seismic_path
from fem.settings import FemSettings
from meshes.gmsh_model import generate
from tests.support import SECTIONS
from workflow.config import Config

SAME = 1e-6  # by which Kh may differ between numbers of ranks
GROWTH = 0.01  # of Kh while the displacement doubles, below which it is a plateau
# Steps that grow fast and may take many iterations: half as many factorisations as with those of a run.
FIRST_STEP, LARGEST_STEP, MOST_ITERATIONS = 0.4, 10.0, 30
CORE = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")}  # a rank has one core


@dataclass(frozen=True)
class Row:
    """One case: seconds on the clock, and memory at the worst moment, of the largest rank and of all (MB)."""

    unknowns: int
    ranks: int
    factorisations: int
    seconds_set_up: float
    seconds_gravity: float
    seconds_path: float
    largest_rank_mb: int
    all_ranks_mb: int
    plateau: bool
    kh: list[float]


def follow(path: EquilibriumPath, steps: int) -> bool:
    """Follows a path to a plateau, or so many steps; whether it is one."""
    while len(path.steps) < steps and path.advance():
        if path.problem.grid.comm.rank == 0:
            print(f"step {len(path.steps)}, {path.solves} systems, Kh = {path.factor:.6f}", file=sys.stderr, flush=True)
        if len(path.steps) > 2 and growth_per_doubling(path) < GROWTH:
            return True
    return False


def solve(refine: int, steps: int) -> Row:
    """What every rank does."""
    comm, begin = MPI.COMM_WORLD, time.perf_counter()
    config = Config.load(SECTIONS / "s13.toml")
    settings = FemSettings(element="bilinear", direction="downhill")
    mesh = generate(config.section, config.mesh.model_copy(update={"refine": refine}))
    made = time.perf_counter()
    ground = loaded_ground(config.section, mesh, settings, comm)
    assert ground.gravity is not None
    stood = time.perf_counter()
    path = seismic_path(ground.problem, ground.constant, ground.load, sign_of(config.section, "downhill"), settings)
    newton = NewtonSettings(tolerance=settings.tolerance, iterations=MOST_ITERATIONS)
    longer = replace(path.settings, newton=newton, first_step=FIRST_STEP, largest_step=LARGEST_STEP)
    path = replace(path, settings=longer)
    plateau = follow(path, steps)
    end = time.perf_counter()
    memory = comm.allgather(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1000)
    return Row(
        ground.problem.grid.size, comm.size, path.solves + ground.gravity.solves, round(made - begin, 1),
        round(stood - made, 1), round(end - stood, 1), max(memory), sum(memory), plateau,
        [step.factor for step in path.steps],
    )  # fmt: skip


def measure(refine: int, ranks: int, steps: int) -> Row:
    """One case in processes of its own."""
    command = [sys.executable, "-m", "tests.benchmarks.large_fem", "--inside", "--refine", str(refine)]
    done = subprocess.run(
        ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", str(ranks), *command, "--steps", str(steps)],
        stdout=subprocess.PIPE, text=True, env={**os.environ, **CORE}, check=True,
    )  # fmt: skip
    lines = [line for line in done.stdout.splitlines() if "{" in line]
    return Row(**json.loads(lines[0][lines[0].index("{") : lines[0].rindex("}") + 1]))


def difference(item: Row, other: Row) -> float:
    """By how much Kh differs at most, over the steps that both took."""
    return max(abs(a - b) for a, b in zip(item.kh, other.kh, strict=False))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--refine", type=int, nargs="+", default=[2, 4])
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--steps", type=int, default=100, help="after which the path is not followed further")
    parser.add_argument("--json", type=Path, help="write the rows to this file")
    parser.add_argument("--inside", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.inside:
        row = solve(arguments.refine[0], arguments.steps)
        if MPI.COMM_WORLD.rank == 0:
            print(json.dumps(asdict(row)), flush=True)
        return
    rows: list[Row] = []
    for refine in arguments.refine:
        for ranks in arguments.ranks:
            row = measure(refine, ranks, arguments.steps)
            rows.append(row)
            first = next(other for other in rows if other.unknowns == row.unknowns)
            print(row, f"Kh differs by {difference(row, first):.1e} (allowed {SAME:g})", flush=True)
            if arguments.json:
                arguments.json.write_text(json.dumps([asdict(r) for r in rows], indent=1) + "\n")
            if not difference(row, first) <= SAME:
                raise SystemExit(f"{row.ranks} ranks differ from {first.ranks} by more than {SAME:g}")


if __name__ == "__main__":
    main()
