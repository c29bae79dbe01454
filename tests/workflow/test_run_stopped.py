"""`noshiro run` killed, stopped, and in folders that cannot be written to: nothing is lost."""

import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from threading import Event
from typing import Any

import pytest

from meshes.executor import OneThread
from meshes.files import TEMPORARY
from tests.support.command_line import TOP, line, process, run
from tests.support.small_run import CONTINUUM, FEW_DISCS, SHORT_SLIDE, numbers, written
from workflow.run.store import Store


def killed_at(path: Path, out: Path, seconds: float, how: int, only: Sequence[str]) -> int:
    """Start a run and stop it after so many seconds; returns its exit code, negative for a signal."""
    started = subprocess.Popen(
        line("run", path, "--out", out, *only), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, cwd=TOP,
        stdin=subprocess.DEVNULL,
    )  # fmt: skip
    try:
        started.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        started.send_signal(how)
        started.communicate(timeout=60)
    return started.returncode


def finished_after_kills(
    tmp_path: Path, kills: int, seed: int, only: Sequence[str] = (), **more: Any
) -> tuple[Path, Path]:
    """A run that was killed so often, at moments drawn from all that it takes, and one that was left alone."""
    path = written(tmp_path, **more)
    start = time.monotonic()
    assert run("run", path, "--out", tmp_path / "alone", *only) == 0
    span = time.monotonic() - start
    draw = random.Random(seed)
    for _ in range(kills):
        killed_at(path, tmp_path / "killed", draw.uniform(0.2, 1.0) * span, signal.SIGKILL, only)
        for file in (tmp_path / "killed").rglob("*.json"):
            if not TEMPORARY.fullmatch(file.name):
                json.loads(file.read_text())  # whatever is there under its own name is whole
    assert run("run", path, "--out", tmp_path / "killed", *only) == 0
    return tmp_path / "alone", tmp_path / "killed"


@pytest.mark.slow
def test_killed_at_random_it_ends_with_the_same_numbers(tmp_path: Path) -> None:
    """Without what takes most of the time: element tests, more than one case, states that are kept, and the stages that
    bound, vary and estimate."""
    stages = [word for name in ("mesh", "fem", "calibrate", "slide", "report") for word in ("--only", name)]
    less: dict[str, Any] = {
        "fem": {"element": "bilinear", "kh": [], "accuracy": 0.0, "direction": "downhill", "tolerance": 1e-4},
        "dem": {**FEW_DISCS, "element_tests": False, "kh": []},
        "slide": {**SHORT_SLIDE, "cases": [{"stiffness": 0.1}]},
    }
    alone, killed = finished_after_kills(tmp_path, 1, 20260101, only=stages, **less)
    assert numbers(alone) == numbers(killed)
    names = [{str(path.relative_to(out)) for path in out.rglob("*")} for out in (alone, killed)]
    assert names[0] == names[1]  # nothing half-written is left


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_killed_again_and_again(seed: int, tmp_path: Path) -> None:
    alone, killed = finished_after_kills(tmp_path, 6, seed)
    assert numbers(alone) == numbers(killed)


def test_ctrl_c_while_it_computes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path, fem={"element": "quadratic"}, mesh={"size": 0.8})
    command = line("run", path, "--out", tmp_path / "out", *CONTINUUM)
    started = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=TOP)
    assert started.stderr is not None
    while (line_read := started.stderr.readline()) and not line_read.startswith("mesh: done"):
        pass  # `fem` comes next, and takes some 20 s
    time.sleep(1.0)
    started.send_signal(signal.SIGINT)
    _, messages = started.communicate(timeout=60)
    assert (started.returncode, messages.splitlines()[-1]) == (
        130,
        "Stopped. Finished results are kept; the same command continues.",
    )
    assert not (tmp_path / "out/fem/critical.json").exists()
    assert "stopped after" in (tmp_path / "out/log.txt").read_text()
    assert run("run", path, "--out", tmp_path / "out", "--dry-run") == 0
    assert "the stage was stopped, and begins again" in capsys.readouterr().out


def test_what_works_on_after_ctrl_c_writes_nothing(tmp_path: Path) -> None:
    store, stopped = Store(tmp_path), Event()

    def work() -> None:
        stopped.wait(timeout=60)
        store.write_text("answer.json", "{}")

    with OneThread() as thread:
        left = thread.begin_there(work)
    stopped.set()
    with pytest.raises(KeyboardInterrupt):
        left.result(timeout=60)
    assert not list(tmp_path.iterdir())


@pytest.fixture
def mounted(tmp_path: Path) -> Iterator[Path]:
    """A file system of its own of 400 kB."""
    place = tmp_path / "disk"
    place.mkdir()
    done = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=400k", "none", place], capture_output=True, check=False)
    if done.returncode:
        pytest.skip(f"mounting is not permitted here: {done.stderr.decode().strip()}")
    yield place
    subprocess.run(["umount", place], check=True)


def remount(place: Path, options: str) -> None:
    subprocess.run(["mount", "-o", f"remount,{options}", place], check=True)


def test_a_full_disk_and_then_a_larger_one(mounted: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path)
    assert run("run", path, "--out", mounted / "out", *CONTINUUM, painted=True) == 2
    assert "cannot be written: No space left on device" in " ".join(capsys.readouterr().err.split())
    assert not list(mounted.rglob(".[0-9]*"))  # nothing half-written
    remount(mounted, "size=40m")
    assert run("run", path, "--out", mounted / "out", *CONTINUUM) == 0
    assert "mesh: done" not in capsys.readouterr().err  # it is there, and its pictures at the most are drawn again
    assert (mounted / "out/figures/mesh.png").is_file()
    assert (mounted / "out/report.html").read_text().rstrip().endswith("</html>")


def test_a_read_only_folder(
    mounted: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The section lies where nothing can be written: so by default nothing can, and elsewhere all goes well."""
    path = written(mounted)
    remount(mounted, "ro")
    monkeypatch.chdir(mounted)
    for arguments in (("check", path), ("run", path, "--only", "mesh")):
        assert run(*arguments) == 2
        assert "cannot be written: Read-only file system" in " ".join(capsys.readouterr().err.split())
    assert run("run", path, "--only", "mesh", "--out", tmp_path / "out") == 0
    monkeypatch.undo()  # so that it can be unmounted


def nobody() -> None:
    """Give up all rights for good; root could write anywhere."""
    if os.geteuid() == 0:
        os.setgroups([])
        os.setgid(65534)
        os.setuid(65534)


def test_a_missing_permission() -> None:
    """As somebody who may read the section and not write the folder of its results."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        folder.chmod(0o755)
        path = written(folder)
        (folder / "out").mkdir(mode=0o555)
        trial = subprocess.run(
            [sys.executable, "-c", "import workflow.cli"], cwd=TOP, preexec_fn=nobody, capture_output=True, check=False
        )
        if trial.returncode:
            pytest.skip("nobody but the owner may read this copy of the program")
        done = process("run", path, "--out", folder / "out", before=nobody)
        assert done.returncode == 2
        assert "cannot be written: Permission denied" in done.stderr
        assert "Traceback" not in done.stderr
        assert list((folder / "out").iterdir()) == []
        path.chmod(0o200)
        done = process("run", path, "--out", folder / "out", before=nobody)
        assert done.returncode == 2
        assert "cannot be read: Permission denied" in done.stderr
