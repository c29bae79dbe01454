"""Runs of single commands have no summary that could be compared; the message names the command that writes it."""

from pathlib import Path

import pytest
import tomli_w

from meshes.errors import InputError
from tests.support.sections import slope
from workflow.report.side_by_side import read


def test_runs_of_single_commands_are_told_how_to_get_a_summary(tmp_path: Path) -> None:
    (tmp_path / "section.toml").write_text(tomli_w.dumps(slope()), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read([tmp_path])
    assert "summary.json" in caught.value.problems[0]
    assert "noshiro report FOLDER" in caught.value.problems[-1]
