"""`noshiro study` end to end: the same table whoever computed it, however often it was killed."""

import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import tomli_w

from tests.support import TOP
from tests.support.sections import slope
from workflow.cli import main

SAMPLES = 4
UNCERTAIN = {
    "strata.upper.friction_angle": {"normal": ["25 deg", "2 deg"]},
    "strata.*.cohesion": {"lognormal": [1.0, 0.3], "does": "factor"},
    "fem.sides": {"list": ["free-field", "fixed"]},
}


@pytest.fixture(scope="module")
def section(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("study") / "slope.toml"
    coarse = {"mesh": {"size": "5 m"}, "fem": {"accuracy": 0.0, "direction": "downhill"}}
    path.write_text(tomli_w.dumps({**slope(), **coarse, "uncertain": UNCERTAIN, "study": {"samples": SAMPLES}}))
    return path


def command(section: Path, folder: Path, workers: int) -> list[str]:
    return ["study", str(section), "--out", str(folder), "--workers", str(workers)]


@pytest.fixture(scope="module")
def alone(section: Path) -> str:
    """The table as one worker leaves it."""
    folder = section.parent / "alone"
    assert ended(command(section, folder, 1)) == 0
    return (folder / "samples.csv").read_text()


def ended(arguments: list[str]) -> int:
    """The exit code of a command."""
    try:
        main(arguments)
    except SystemExit as stop:
        return int(stop.code or 0)
    return 0


def test_a_study_leaves_a_table_an_answer_and_a_page(alone: str, section: Path) -> None:
    folder = section.parent / "alone"
    lines = alone.splitlines()
    assert lines[0] == (
        "sample,strata.upper.friction_angle (deg),strata.*.cohesion,fem.sides,"
        "kc,cells,verdict,direction,flow,failed"  # a block that Kh pushes for ever has no slide
    )
    assert [line.split(",")[0] for line in lines[1:]] == [str(k + 1) for k in range(SAMPLES)]
    answer = json.loads((folder / "study.json").read_text())
    assert (answer["samples"], answer["failed"]) == (SAMPLES, 0)
    groups = {group["value"]: group["spread"]["mean"] for group in answer["results"][0]["groups"]}
    assert groups["fixed"] > groups["free-field"]  # a rigid box holds more
    page = (folder / "study.html").read_text()
    assert "study of uncertain numbers" in page
    assert "which is also the yield coefficient of the blocks, is with ψ = φ." in page
    assert page.count("<img") == 4


@pytest.mark.slow
@pytest.mark.parametrize("workers", [2, 4])
def test_more_workers_leave_the_same_table_to_the_last_bit(
    workers: int, section: Path, alone: str, tmp_path: Path
) -> None:
    assert ended(command(section, tmp_path, workers)) == 0
    assert (tmp_path / "samples.csv").read_text() == alone


@pytest.mark.slow
def test_a_study_and_its_workers_killed_at_random_leave_the_same_table(
    section: Path, alone: str, tmp_path: Path
) -> None:
    chance, killed = random.Random(1), 0
    for _ in range(4):
        study = subprocess.Popen(
            [sys.executable, "-m", "workflow.cli", *command(section, tmp_path, 2)], cwd=TOP,
            env={**os.environ, "PYTHONPATH": str(TOP)}, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        until = time.monotonic() + 30.0
        while len(children(study.pid)) < 2 and time.monotonic() < until:
            time.sleep(0.05)
        time.sleep(4.0 * chance.random())
        if workers := children(study.pid):
            os.kill(chance.choice(workers), signal.SIGKILL)
            killed += 1
        time.sleep(2.0 * chance.random())
        study.kill()
        study.wait()
    assert killed
    assert ended(command(section, tmp_path, 2)) == 0
    assert (tmp_path / "samples.csv").read_text() == alone


def children(process: int) -> list[int]:
    """The processes that one has started, from any thread, to compute: Python with a program on its command line."""
    lists = Path(f"/proc/{process}/task").glob("*/children")
    values = [int(word) for path in lists for word in path.read_text().split()]
    return [item for item in values if "-c" in Path(f"/proc/{item}/cmdline").read_text().split("\0")]


@pytest.mark.slow
def test_a_longer_study_computes_only_what_is_new(section: Path, alone: str) -> None:
    folder = section.parent / "alone"
    before = {path.name: path.stat().st_mtime_ns for path in (folder / "tasks").glob("*.json")}
    assert ended([*command(section, folder, 1), "--samples", str(SAMPLES + 2)]) == 0
    after = {path.name: path.stat().st_mtime_ns for path in (folder / "tasks").glob("*.json")}
    assert (len(before), len(after)) == (SAMPLES, SAMPLES + 2)
    assert before.items() <= after.items()
    assert (folder / "samples.csv").read_text().splitlines()[: SAMPLES + 1] == alone.splitlines()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--only", "everything"], "expected one of fem, bounds, slide, block"),
        (["--method", "dice"], "study, method = 'dice'"),
        (["--method", "saltelli", "--samples", "12"], "expected a power of two"),
        (["--scheduler", "nowhere"], "no Dask scheduler answers"),
    ],
)
def test_bad_options_are_told(
    arguments: list[str], message: str, section: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert ended([*command(section, tmp_path, 1), *arguments]) == 2
    assert message in capsys.readouterr().err


def test_a_section_in_which_nothing_is_uncertain(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "slope.toml"
    path.write_text(tomli_w.dumps(slope()))
    assert ended(command(path, tmp_path, 1)) == 2
    assert "[uncertain]: no number is uncertain" in capsys.readouterr().err


def test_a_study_without_any_answer_ends_with_the_reason(
    section: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert ended([*command(section, tmp_path, 1), "--only", "slide"]) == 3
    err = capsys.readouterr().err
    assert f"slide: none of {SAMPLES} samples has an answer" in err
    assert "no stratum liquefies in any case" in err
    assert (tmp_path / "study.html").is_file()
