"""`python -m docs.verify` on a folder with two cases."""

import json
import shutil
from pathlib import Path

import pytest

from docs.published_slopes import write_page
from docs.verify.__main__ import verify
from docs.verify.case import read_cases
from docs.verify.record import Answer, read_answers, write_answers
from meshes.errors import InputError
from tests.support.published import PUBLISHED


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Two cases."""
    for name in ("taylor_60_20", "taylor_30_10"):
        shutil.copy(PUBLISHED / f"{name}.toml", tmp_path)
    return tmp_path


def test_bounds_are_found_judged_kept_and_written(folder: Path, capsys: pytest.CaptureFixture[str]):
    """Taylor's circle of friction: c / γH = 0.097 at φ = 20° and 60°; log-spiral 0.0964."""
    verify(names=["taylor_60_20"], folder=folder, only=["bounds"])
    result = read_answers(folder / "answers.json", Answer)["taylor_60_20"]
    assert 0.97 < result.lower < 1.006 < result.upper < 1.03
    assert "right     taylor_60_20" in capsys.readouterr().out
    verify(folder=folder, judge=True, json=folder / "rows.json")
    assert "not run" in capsys.readouterr().out
    by_name = {row["name"]: row for row in json.loads((folder / "rows.json").read_text(encoding="utf-8"))}
    verify(folder=folder, judge=True, json=Path("-"))
    assert json.loads(capsys.readouterr().out) == list(by_name.values())
    assert by_name["taylor_60_20"]["verdict"] == "right"
    assert by_name["taylor_30_10"]["verdict"] == "not run"
    cases, answers = read_cases(folder), read_answers(folder / "answers.json", Answer)
    page = write_page(folder, cases, answers).read_text(encoding="utf-8")
    assert "1 right, 1 not run" in page or "1 not run, 1 right" in page
    assert (folder / "pictures" / "taylor_60_20.png").stat().st_size < 5000


def test_what_was_found_before_is_judged_without_computing(folder: Path, capsys: pytest.CaptureFixture[str]):
    write_answers(folder / "answers.json", {"taylor_60_20": Answer("taylor_60_20", lower=1.2, upper=1.25)})
    verify(names=["taylor"], folder=folder, judge=True)
    said = capsys.readouterr().out
    assert "wrong     taylor_60_20" in said
    assert "equilibrium: 1 published, 1.2 to 1.25 here" in said


def test_unknown_parts_and_spoiled_answers_are_told(folder: Path):
    with pytest.raises(InputError, match="expected one of bounds, associated, davis"):
        verify(folder=folder, only=["everything"])
    with pytest.raises(InputError, match="there is no folder"):
        verify(folder=folder, judge=True, json=folder / "nowhere" / "rows.json")
    (folder / "answers.json").write_text("[1]", encoding="utf-8")
    with pytest.raises(InputError, match="delete the file"):
        verify(folder=folder, judge=True)
