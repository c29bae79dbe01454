"""Surcharges whose ends press on ground that bears nothing there are told."""

from typing import Any

from meshes.section.section import Section
from tests.support.sections import layer, slope


def message(cohesion: str, *loads: dict[str, Any]) -> list[str]:
    data = slope()
    strata = [layer("sand", cohesion=cohesion, friction_angle="34 deg")]
    section = Section.parse({**data, "strata": strata, "surcharges": list(loads)})
    return [text for text in section.notices if text.startswith("surcharges")]


def test_a_load_that_ends_on_bare_sand_is_told_with_what_to_do() -> None:
    """Beside bare ground sand without cohesion bears no pressure: no stress is statically admissible there."""
    load = {"from": 20.0, "to": 60.0, "pressure": "15 kPa"}
    (notice,) = message("0 kPa", load)
    assert notice.startswith('surcharges: their ends at x = 20, 60 m lie on "sand", which has no cohesion')
    assert "elements and bounds give the ground within fem.least_depth of these ends a cohesion" in notice
    crane = {"from": 4.0, "to": 6.0, "pressure": "80 kPa"}
    assert message("0 kPa", load, crane)[0].startswith("surcharges: their ends at x = 4, 6, 20, 60 m lie"), "said once"
    assert message("1 kPa", load) == []
    assert message("0 kPa", {**load, "from": 0.0, "to": 100.0}) == [], "it goes on beyond the sides"


def test_a_load_that_falls_to_nothing_at_its_ends_is_not() -> None:
    ramp = {"from": 20.0, "to": 22.0, "pressure": ["0 kPa", "15 kPa"]}
    middle = {"from": 22.0, "to": 58.0, "pressure": "15 kPa"}
    assert message("0 kPa", ramp, middle, {"from": 58.0, "to": 60.0, "pressure": ["15 kPa", "0 kPa"]}) == []
