"""Times that are told before a run, scaled by a test of the machine."""

import pytest

from tests.support import SECTIONS
from workflow import stages
from workflow.run import pace
from workflow.settings import Input


def test_the_machine_is_tested_and_what_takes_long_is_scaled(monkeypatch: pytest.MonkeyPatch) -> None:
    assert pace.pace(0.2) > 0.0
    monkeypatch.setattr(pace, "pace", lambda: 0.5)
    assert pace.expected(10.0) == ""
    assert pace.expected(45.0).startswith("This takes about 90 s, give or take a factor of two,")
    assert "one core does 0.5 times" in pace.expected(600.0)
    assert pace.expected(600.0).startswith("This takes about 20 min,")


def test_more_discs_packings_and_cases_take_longer() -> None:
    cost = {stage.name: stage.seconds for stage in stages.STAGES}
    given = Input.load(SECTIONS / "slope_2to1.toml")
    more = given.model_copy(update={"dem": given.dem.model_copy(update={"elements": 10_000, "radius": None})})
    assert cost["calibrate"](more) == pytest.approx(8.0 * cost["calibrate"](given))
    alone = given.model_copy(update={"slide": given.slide.model_copy(update={"seeds": ()})})
    assert cost["slide"](alone) < cost["slide"](given)
    assert all(seconds(given) > 0.0 for seconds in cost.values())
