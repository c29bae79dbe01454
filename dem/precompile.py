"""Compiles the kernels before a run, concurrently, unless an earlier run has compiled them.

Without compiling beforehand, all processes of a run would reach the step loop at the same time, and each would compile
it.
"""

import hashlib
import os
from contextlib import suppress

import numba
import numpy as np
from llvmlite.binding import get_host_cpu_name
from numba import config, typeof
from numba.core.types import Type

from dem.assembly import DiscGeometry, DiscMaterials
from dem.engine.engine import Engine, EngineRun
from dem.engine.packer import pack, unpack
from dem.engine.time_step import largest_step
from dem.kernels.stepping import take_steps
from dem.model import DiscModel
from dem.springs import LayerSprings
from meshes.compiled import kernel_folder
from meshes.executor import Executor, LostError, Processes, Tell

MARK_FILE = "discs"  # name of the file that marks compiled kernels of the discs
SOIL = LayerSprings(
    "any", kn=1e7, ks=5e6, cn=1e4, ct=1e4, kpn=0.0, kps=0.0, density=2000.0, effective_density=2000.0, friction=0.5,
    cohesion=0.0, contact_cohesion=1.0, rolling_friction=0.1,
)  # fmt: skip


def precompile(executor: Executor, tell: Tell) -> None:
    """Compile the kernels that take some seconds each, unless they are already compiled.

    Parameters
    ----------
    executor : computes the two compilations side by side
    tell : is called with one sentence before the compilation
    """
    mark = kernel_folder() / f"{MARK_FILE}-{_conditions()}"
    if not config.DISABLE_JIT and not mark.exists():
        tell("the step loop of the discs is compiled, once for this version of the program")
        executor.compute(_compiled, ("steps", "energies"))
        with suppress(OSError):  # the file is only a hint for the next run
            mark.touch()


def _conditions() -> str:
    """Return the fingerprint of the conditions on which Numba's compiled files depend beside their sources: Numba's
    version and the processor."""
    return hashlib.sha256(repr((numba.__version__, get_host_cpu_name())).encode()).hexdigest()[:16]


def _compiled(what: str, _: Tell) -> None:
    """Compile the step loop, or the kernels around the step loop, or the kernels of the energies."""
    if what == "steps":
        # In a process that compiles nothing: here the lists of neighbours would be compiled for it, as they are by
        # another process at the same time.
        with suppress(LostError), Processes(1, os.environ | {"NUMBA_DISABLE_JIT": "1"}) as without_compiler:
            take_steps.compile(without_compiler.submit(types_of_a_step).result())
        return  # where that process was lost, it is compiled where it is first called
    model = three_discs()
    largest_step(model)
    layout = pack(model)
    Engine().measure_layout(model, layout)
    unpack(layout, model)


def types_of_a_step() -> tuple[Type, ...]:
    """Return the types of the arguments of the step loop, for a model of three discs."""
    arguments = EngineRun(Engine(), three_discs(), dt=1e-6).arguments(steps=1)[0]
    return tuple(typeof(argument) for argument in arguments)


def three_discs() -> DiscModel:
    """Return a row of three discs that touch."""
    return DiscModel.create(
        DiscGeometry(np.array([0.0, 1.9, 3.8]), np.zeros(3), 1.0), DiscMaterials([SOIL], law="soil")
    )
