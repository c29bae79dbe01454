"""Kernels that are compiled ahead are those that a run asks for, and only once."""

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from dem import precompile
from meshes.executor import Executor

PROGRAM = """
from numba.core import event
from dem.precompile import precompile
from meshes.executor import SERIAL
told = []
precompile(SERIAL, told.append)
names = []
class Heard(event.Listener):
    def on_start(self, e): names.append(e.data["dispatcher"].py_func.__name__)
    def on_end(self, e): pass
event.register("numba:compile", Heard())
from dem.engine.engine import Engine
from tests.benchmarks.dem_throughput import model_of
for law in ("paper", "soil"):
    engine = Engine(dt=5e-4, energies=law == "paper", balance=float("inf"))
    engine.run(model_of(200, law == "paper", law), steps=2)
assert told and not {"take_steps", "energies", "find_pairs", "stable_step"} & set(names), names
"""


@pytest.mark.slow
def test_a_run_compiles_none_of_them_again(tmp_path: Path) -> None:
    config = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
    subprocess.run([sys.executable, "-c", PROGRAM], env=config, check=True)
    assert list(tmp_path.glob(f"*/{precompile.MARK_FILE}-*"))


def test_they_are_compiled_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(precompile, "kernel_folder", lambda: tmp_path)
    wanted: list[str] = []
    messages: list[str] = []

    class RecordingExecutor(Executor):
        def compute(self, work: object, inputs: Sequence[str], *_: object) -> list[None]:  # type: ignore[override]
            wanted.extend(inputs)
            return [None for _ in inputs]

    for _ in range(2):
        precompile.precompile(RecordingExecutor(), messages.append)
    assert wanted == ["steps", "energies"]
    assert len(messages) == 1
