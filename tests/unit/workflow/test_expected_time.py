"""Before a run it says whether it takes a minute, some minutes or hours."""

from typing import Any

import pytest

from tests.support import SECTIONS
from tests.support.docs import program
from workflow import stages
from workflow.config.after_triggering import load_config
from workflow.run.plan import Action, Decision
from workflow.stages import declared
from workflow.stages.expected_time import SECONDS, announcement


def message(section: str, action: Action = "run", **tables: Any) -> str:
    config = load_config(SECTIONS / f"{section}.toml", tables)
    return announcement([Decision(s, action, "") for s in declared.STAGES if not s.unwanted(config)], config)


def test_every_stage_has_its_seconds() -> None:
    assert set(SECONDS) == set(stages.NAMES)


def test_ground_that_does_not_liquefy_takes_a_minute_or_two_and_slides_some_minutes() -> None:
    assert message("slope_2to1").startswith("The run takes a minute or two, and the critical Kh comes first. Most of ")
    assert message("s13").startswith(
        "The run takes some minutes, and the critical Kh comes first. Most of the time goes "
    )
    assert "calibrate" in message("s13")
    assert "slices" not in message("s13")
    assert message("s13", action="reuse") == ""


@pytest.mark.parametrize(
    ("tables", "words"),
    [({"slide": {"mpm_cells": 9000}}, "up to an hour"), ({"dem": {"elements": 40_000}}, "more than an hour")],
)
def test_finer_discs_and_cells_take_longer(tables: dict[str, Any], words: str) -> None:
    assert f"takes {words}" in message("river_bank", **tables)


def test_the_words_hold_for_the_runs_that_were_measured() -> None:
    """A newcomer's first runs, compilation included, on a machine with other work."""
    measured = program("generated").numbers()["first_run"]
    assert measured["section_seconds"] <= 120.0, "a minute or two"
    assert 120.0 < measured["seconds"] <= 900.0, "some minutes"
