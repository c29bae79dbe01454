"""A river levee as a practitioner states it, with its borings and a record: through all commands without a stumble."""

import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.support import TOP
from tests.support.command_line import run

Ask = Callable[..., str]

FILES = TOP / "tests/support/levee"
UNCERTAIN = """
[uncertain]
"strata.Loose sand.friction_angle" = { normal = ["31 deg", "2 deg"], truncation = ["27 deg", "35 deg"] }
"strata.Levee fill.cohesion" = { uniform = ["0 kPa", "6 kPa"] }
"strata.Soft clay.cohesion" = { lognormal = ["40 kPa", "10 kPa"] }
"""
COARSE = {"mesh.size": "5 m", "fem.accuracy": "0", "fem.direction": "downhill"}
SMALL = {
    **COARSE, "mesh.size": "3 m", "bounds.max_cells": "1000", "bounds.seconds": "60", "variants.which": '["sides"]',
    "dem.elements": "250", "dem.resolution": "0.05", "dem.tolerance": "0.05", "dem.out_of_reach": "go on",
    "dem.element_tests": "false", "slide.seeds": "[]", "slide.duration": "2", "slide.frames": "2",
    "slide.mpm_cells": "200",
}  # fmt: skip


def options(settings: dict[str, str]) -> list[str]:
    return [word for key, value in settings.items() for word in ("--set", f"{key}={value}")]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where its files lie, and the commands are given."""
    for file in FILES.iterdir():
        shutil.copy(file, tmp_path / file.name)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def said(folder: Path, capsys: pytest.CaptureFixture[str]) -> Ask:
    """What a command says, in one line of text; it ends well, and in words that a person understands."""

    def ask(*arguments: str) -> str:
        code = run(*arguments)
        heard = capsys.readouterr()
        text = " ".join((heard.out + heard.err).split())
        assert code == 0, text
        for stumble in ("Traceback", "<sub>", "{{", "None of its", ", below water roll", '", below water'):
            assert stumble not in text
        return text

    return ask


def test_from_the_file_to_what_liquefies(said: Ask) -> None:
    message = said("check", "levee.toml")
    assert "The section is sound" in message
    assert 'strata 4 "Soft clay": the cohesion varies' in message  # its number in the file, which water cuts
    assert '"Levee fill, below water"' not in message
    message = said("liquefaction", "levee.toml")
    assert '"Loose sand" below water liquefies: F_L is below 1 in 100 % of it' in message
    assert '"Levee fill" was not assessed (above the water table).' in message
    assert '"Soft clay" was not assessed (plasticity index 35 % is at least 7 %: behaves as clay).' in message
    # One of its tests lies at the very level of the water; what lies below water was called "above the water table".
    clay = "plasticity index 25 % is at least 7 %: behaves as clay"
    assert f'"Clay crust" below water was not assessed ({clay}).' in message
    assert '"Loose sand" was not assessed (above the water table).' in message
    assert '"Dense sand" does not liquefy' in message
    assert "below 1 in 0 % of it;" not in message
    risks = dict(re.findall(r"(B-\d \w+): liquefaction potential index P_L = [\d.]+, risk ([a-z ]+)\.", message))
    assert risks == {"B-1 river": "very high", "B-2 crest": "high", "B-3 land": "very high"}
    message = said("run", "levee.toml", "--dry-run")
    assert "not run" in message


def test_from_the_borings_to_what_liquefies(said: Ask, folder: Path) -> None:
    """Three borings in a table, in which the ground is at a depth of "0.0 mm"."""
    message = said("section", "levee_borings.csv", "--out", "section.toml")
    assert "3 borings" in message
    message = said("check", "section.toml")
    assert "The section is sound" in message
    text = (folder / "section.toml").read_text(encoding="utf-8")
    head, sand = text.split('name = "Loose sand"')  # in the fill above it no blow count lies below the water
    text = head + 'name = "Loose sand"' + sand.replace('# liquefies_in = "triggered" ', 'liquefies_in = "triggered" ')
    text = re.sub(r"(?m)^# (\[earthquake\]|magnitude|peak_acceleration)", r"\1", text)
    (folder / "section.toml").write_text(text, encoding="utf-8")
    message = said("liquefaction", "section.toml")
    assert '"Loose sand" liquefies: F_L is below 1 in 100 % of it' in message
    assert '"Dense sand" does not liquefy' in message


@pytest.mark.slow
def test_samples_of_it_have_answers(said: Ask, folder: Path) -> None:
    """Layers left to the blow counts, water, a record, and a cohesion that may be next to nothing."""
    with (folder / "levee.toml").open("a", encoding="utf-8") as file:
        file.write(UNCERTAIN)
    message = said("study", "levee.toml", "--samples", "2", "--workers", "1", "--out", "study", *options(COARSE))
    assert "2 samples of 3 uncertain numbers" in message
    assert "all with an answer" in message
    answer = json.loads((folder / "study/study.json").read_text())
    assert (answer["failed"], answer["parts_without_answer"]) == (0, [])
    assert {item["name"]: item["samples"] for item in answer["results"]}["block_slide_m"] == 2


@pytest.mark.slow
def test_the_whole_run_and_once_more_with_other_frames(said: Ask, folder: Path) -> None:
    said("fem", "levee.toml", *options(SMALL), "--safety-factor")
    message = said("run", "levee.toml", *options(SMALL))
    assert "Report: " in message
    page = (folder / "runs/levee/report.html").read_text(encoding="utf-8")
    assert "&lt;sub" not in page
    assert "R-7, first issue" in page
    summary = json.loads((folder / "runs/levee/summary.json").read_text())
    assert summary["fem"]["kc"] > 0.0
    assert set(summary["cases"]) == {"1", "2"}
    again = said("run", "levee.toml", *options({**SMALL, "slide.frames": "3"}))
    assert "liquefied: no input has changed: the result of" in again
