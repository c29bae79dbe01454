"""What is said of tension cracks of a section."""

from typing import Any

import pytest

from tests.support.sections import analysed, layer

SLOPE: dict[str, Any] = {
    "name": "cracked",
    "surface": [[0.0, 10.0], [30.0, 10.0], [50.0, 4.0], [80.0, 4.0]],
    "base": {"elevation": -6.0},
    "strata": [layer("clay")],
}


@pytest.mark.parametrize(
    ("bottom", "message"),
    [
        ({"depth": 6.5}, "cracks are 6.5 m deep, and the ground rises by 6 m"),
        ({"elevation": [[0.0, 2.0], [30.0, 2.0], [40.0, 7.0]]}, "cracks are 8 m deep"),
        ({"depth": 6.0}, ""),
        ({"elevation": 8.0}, ""),
    ],
)
def test_cracks_deeper_than_the_slope_is_high_are_told(bottom: dict[str, Any], message: str) -> None:
    notices = [t for t in analysed({**SLOPE, "tension_crack": {"bottom": bottom}}).notices if "below the toe" in t]
    assert len(notices) == bool(message)
    assert not message or message in notices[0]


def test_level_ground_has_no_slope_that_a_crack_could_be_deeper_than() -> None:
    level = {**SLOPE, "surface": [[0.0, 4.0], [80.0, 4.0]], "tension_crack": {"bottom": {"depth": 2.0}}}
    assert not [text for text in analysed(level).notices if "below the toe" in text]
