"""Zones cut a soil in parts: a boring in one of them is one of the soil."""

from types import SimpleNamespace
from typing import Any, cast

from workflow.earthquake.triggering.assessment import TestResult, judged_in_stratum


def test_a_part_without_tests_has_those_of_its_soil_on_the_same_side_of_the_water() -> None:
    """Reclaimed sand on both sides of a caisson, with a boring behind it: refused until now."""
    names = ["Sand", "Sand, below water", "Caisson", "Sand, part 2", "Sand, part 2, below water", "Clay"]
    tests = cast(
        list[TestResult], [cast(Any, SimpleNamespace(overburden=SimpleNamespace(stratum=k))) for k in (4, 4, 5)]
    )
    assert judged_in_stratum(names, 4, tests) == tests[:2]
    assert judged_in_stratum(names, 1, tests) == tests[:2]
    assert judged_in_stratum(names, 0, tests) == []
    assert judged_in_stratum(names, 2, tests) == []
    assert judged_in_stratum(names, 5, tests) == tests[2:]
