"""Kernels compiled ahead, side by side, where no earlier run has kept them.

Left to themselves, all processes of a team come to the step loop at once and each of them compiles it.
"""

import hashlib
from contextlib import suppress
from pathlib import Path

import numba
import numpy as np
from llvmlite.binding import get_host_cpu_name
from numba import config

from dem.engine.engine import Engine
from dem.kernels import stepping
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
    """Compiles the step loop, or what measures energies, by calling it on three discs."""
    x = np.array([0.0, 1.9, 3.8])
    model = DiscModel.create(x, np.zeros(3), 1.0, [SOIL], law="soil")
    if what == "steps":
        Engine(ledger=False).run(model, steps=1)
    else:
        Engine().measure(model)
