"""Kernels compiled ahead, side by side, where no earlier run has kept them.

Left to themselves, all processes of a team come to the step loop at once and each of them compiles it.
"""

import hashlib
import os
import pickle
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import numba
import numpy as np
from llvmlite.binding import get_host_cpu_name
from numba import config, typeof
from numba.core.types import Type

from dem.engine.engine import Engine, Run, largest_step
from dem.engine.packer import pack, unpack
from dem.kernels import stepping
from dem.kernels.stepping import take_steps
from dem.model import DiscModel
from dem.springs import LayerSprings
from dem.team import Team, Tell
from meshes.compiled import kept_kernels

MARK = "discs"  # file beside the kernels: those of the discs are there
SOIL = LayerSprings(
    "any", kn=1e7, ks=5e6, cn=1e4, ct=1e4, kpn=0.0, kps=0.0, density=2000.0, effective_density=2000.0, friction=0.5,
    cohesion=0.0, contact_cohesion=1.0, rolling_friction=0.1,
)  # fmt: skip


def compile_ahead(team: Team, tell: Tell) -> None:
    """Has the team compile the kernels that take long, some seconds each, unless that has been done."""
    mark = kept_kernels() / f"{MARK}-{_kept_for()}"
    if not config.DISABLE_JIT and not mark.exists():
        tell("the step loop of the discs is compiled, once for this version of the program")
        team(_compiled, ("steps", "energies"))
        with suppress(OSError):  # a hint for the next run, no more
            mark.touch()


def _kept_for() -> str:
    """What Numba's own files of the kernels hang on: its version, the processor, and the file of the step loop."""
    source = Path(stepping.__file__)
    kept = (numba.__version__, get_host_cpu_name(), str(source), source.stat().st_mtime_ns)
    return hashlib.sha256(repr(kept).encode()).hexdigest()[:16]


def _compiled(what: str, _: Tell) -> None:
    """Compiles the step loop, or all that is needed around it, and what measures energies."""
    if what == "steps":
        with suppress(subprocess.CalledProcessError):  # it is compiled where it is first called, then
            take_steps.compile(types_of_a_step())
        return
    model = three_discs()
    largest_step(model)
    layout = pack(model)
    Engine().measure_layout(model, layout)
    unpack(layout, model)


def types_of_a_step() -> tuple[Type, ...]:
    """Types of what the step loop is called with, of three discs in a process that compiles nothing.

    Here the lists of neighbours would be compiled for it, as they are by the rest of the team at the same time.
    """
    path = os.pathsep.join(folder for folder in sys.path if folder)
    # nor may a module beside what the user works on stand in for one of ours
    without_compiler = os.environ | {"NUMBA_DISABLE_JIT": "1", "PYTHONPATH": path, "PYTHONSAFEPATH": "1"}
    done = subprocess.run([sys.executable, "-m", __name__], env=without_compiler, capture_output=True, check=True)
    found: tuple[Type, ...] = pickle.loads(done.stdout)
    return found


def three_discs() -> DiscModel:
    """A row of discs that touch."""
    return DiscModel.create(np.array([0.0, 1.9, 3.8]), np.zeros(3), 1.0, [SOIL], law="soil")


if __name__ == "__main__":
    given = Run(Engine(), three_discs(), dt=1e-6).arguments(steps=1)[0]
    sys.stdout.buffer.write(pickle.dumps(tuple(typeof(one) for one in given)))
