"""The time that a run takes is told before it, and is right within a factor of two or three."""

import re
from typing import Any

import pytest

from tests.support import SECTIONS
from tests.support.docs import program
from workflow import stages
from workflow.config.after_triggering import load_config
from workflow.run.plan import Action, Decision
from workflow.stages.expected_time import SECONDS, announcement


def message(monkeypatch: pytest.MonkeyPatch, section: str = "s13", action: Action = "run", **tables: Any) -> str:
    monkeypatch.setattr("os.cpu_count", lambda: 2)
    config = load_config(SECTIONS / f"{section}.toml", tables)
    return announcement([Decision(stage, action, "") for stage in stages.STAGES], config)


def test_every_stage_has_its_seconds() -> None:
    assert set(SECONDS) == set(stages.NAMES)


def test_a_run_of_s13_takes_some_minutes(monkeypatch: pytest.MonkeyPatch) -> None:
    """In full it takes 532 s of processors."""
    words = message(monkeypatch)
    assert re.match(
        r"The run takes about [45] min on 2 free processors, within a factor of two. The longest stages are ", words
    )
    assert words.index("calibrate") < words.index("bounds")
    assert "slices" not in words


def test_what_is_reused_takes_no_time(monkeypatch: pytest.MonkeyPatch) -> None:
    assert message(monkeypatch, action="reuse") == ""


def test_elements_and_bounds_alone_are_not_foretold(monkeypatch: pytest.MonkeyPatch) -> None:
    """With factors of safety twenty sections took 14 to 104 s of a processor, where 86 to 100 s had been expected."""
    monkeypatch.setattr("os.cpu_count", lambda: 2)
    config = load_config(SECTIONS / "s13.toml", {})
    alone = [stage for stage in stages.STAGES if stage.name in ("mesh", "fem", "bounds")]
    assert announcement([Decision(stage, "run", "") for stage in alone], config) == ""


def test_finer_discs_and_cells_take_longer(monkeypatch: pytest.MonkeyPatch) -> None:
    fine = message(monkeypatch, "river_bank", dem={"elements": 40_000}, slide={"mpm_cells": 12_000})
    assert "h on 2 free processors" in fine
    messages = message(
        monkeypatch, "river_bank", dem={"workers": 1, "elements": 200}, slide={"mpm_cells": 200, "seeds": []}
    )
    assert "min on a free processor" in messages


def test_elements_take_as_long_as_they_do_on_the_sections_of_the_benchmark() -> None:
    config = load_config(SECTIONS / "river_bank.toml", {})
    rows = program("generated").numbers()["sections"]["rows"]
    assert all(SECONDS["fem"](config) / 3.5 < row["seconds"] < 3.5 * SECONDS["fem"](config) for row in rows)
