"""Settings of the command line that a command does not read are told; `noshiro fem` heeds bounds.run."""

import json
from pathlib import Path

import pytest

from tests.support.command_line import run
from tests.support.sections import written
from tests.support.settings_reads import KEYS
from workflow.cli.invocation import Invocation
from workflow.cli.study import _unread
from workflow.cli.unread_settings import in_words
from workflow.config import Config
from workflow.stages import command_of
from workflow.stages.declared import STAGES

NAMES = [stage.name for stage in STAGES]


def message(capsys: pytest.CaptureFixture[str]) -> str:
    return " ".join(capsys.readouterr().out.split())


def test_a_setting_that_a_command_does_not_read_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    requested = (
        "--set",
        "bounds.run=false",
        "--set",
        "fem.sides=fixed",
        "--set",
        "mesh.size='5 m'",
        "--set",
        "study.samples=3",
    )
    assert run("mesh", written(tmp_path), "--out", tmp_path / "out", *requested) == 0
    words = message(capsys)
    assert "noshiro mesh does not read bounds.run; it is read by noshiro faces and noshiro run." in words
    assert "noshiro mesh does not read fem.sides; it is read by noshiro fem, " in words
    assert "noshiro mesh does not read study.samples; it is read by noshiro study." in words
    assert "does not read mesh" not in words


@pytest.mark.parametrize("way", ["--quiet", "--json"])
def test_it_is_told_beside_an_output_without_sentences(
    way: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    requested = ("--set", "bounds.run=false", way)
    assert run("mesh", written(tmp_path), "--out", tmp_path / "out", *requested) == 0
    heard = capsys.readouterr()
    line = "Warning: noshiro mesh does not read bounds.run; it is read by noshiro faces and noshiro run."
    assert line in heard.err
    if way == "--json":
        assert line in json.loads(heard.out)["warnings"]
    else:
        assert heard.out == ""


def test_a_run_reads_all_but_the_settings_of_studies(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    requested = (
        "--dry-run",
        "--set",
        "bounds.gap=0.1",
        "--set",
        "figures.report_width=800",
        "--set",
        "study.samples=3",
    )
    assert run("run", written(tmp_path), "--out", tmp_path / "out", *requested) == 0
    words = message(capsys)
    assert "noshiro run does not read study.samples; it is read by noshiro study." in words
    assert words.count("does not read") == 1


@pytest.mark.parametrize("key", KEYS)
def test_every_setting_is_read_by_some_command(key: str) -> None:
    """Whatever is told not to be read has a command that does: none is left without."""
    commands = [command_of(name) for name in NAMES]
    [line] = in_words([key], "mesh", commands)
    assert "it is read by noshiro " in line


def test_what_follows_from_other_settings_counts_as_read(tmp_path: Path) -> None:
    """dem.workers is how many processes any command may take."""
    invocation = Invocation.of(written(tmp_path), tmp_path / "out", {}, ["dem.workers=1", "slide.kh=0.05"])
    assert invocation.unread(("mesh",)) == ["slide.kh"]
    assert invocation.unread(tuple(NAMES)) == []


def test_bounds_that_are_not_wanted_are_not_made_beside_a_factor_of_safety(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They took 87 of 180 s."""
    chosen = []
    monkeypatch.setattr("workflow.cli.terminal.execute", lambda _, choice, *__: chosen.append(choice.chosen))
    path = written(tmp_path)
    run("fem", path, "--out", tmp_path / "out", "--safety-factor")
    run("fem", path, "--out", tmp_path / "out", "--safety-factor", "--set", "bounds.run=false")
    assert chosen == [("mesh", "fem", "bounds"), ("mesh", "fem")]


def test_bounds_by_their_own_command_do_not_ask_whether_they_are_wanted(tmp_path: Path) -> None:
    """`noshiro bounds` computes them whatever bounds.run says; a run, and `noshiro fem`, heed it."""
    invocation = Invocation.of(written(tmp_path), tmp_path / "out", {}, ["bounds.run=false"])
    assert invocation.unread(["bounds"]) == ["bounds.run"]
    assert invocation.unread(NAMES) == invocation.unread(["mesh", "fem", "bounds"]) == []
    [line] = in_words(["bounds.run"], "bounds", [command_of(name) for name in NAMES])
    assert line == "Warning: noshiro bounds does not read bounds.run; it is read by noshiro faces and noshiro run."


@pytest.mark.parametrize(("options", "message"), [((), False), (("--set", "bounds.run=false"), True)])
def test_the_command_bounds_tells_of_bounds_run_where_it_was_set(
    options: tuple[str, ...],
    message: bool,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    configs: list[Config] = []
    monkeypatch.setattr("workflow.cli.terminal.execute", lambda job, *rest, **more: configs.append(job.config))
    assert run("bounds", written(tmp_path), "--out", tmp_path / "out", *options) == 0
    assert ("noshiro bounds does not read bounds.run" in capsys.readouterr().out) == message
    assert configs[0].bounds.run is True


def test_a_study_tells_what_its_parts_do_not_read() -> None:
    """The elements of a sample read no discs and no bounds; its slides do."""
    requested = {"bounds": {"gap": 0.1}, "dem": {"elements": 500}, "fem": {"sides": "fixed"}, "study": {"samples": 2}}
    messages = _unread(requested, "study", ["fem", "block"])
    assert [line.split(" does not read ")[1].split(";")[0] for line in messages] == ["bounds.gap", "dem.elements"]
    assert "noshiro bounds" in messages[0]
    assert _unread(requested, "study", ["bounds", "slide"]) == []
    assert [line.split(";")[0] for line in _unread(requested, "converge", ["slide"])] == [
        "Warning: noshiro converge does not read bounds.gap"
    ]
