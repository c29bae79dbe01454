"""Zones cut a soil in parts: a boring in one of them is one of the soil."""

import tomllib
from types import SimpleNamespace
from typing import Any, cast

from meshes.gmsh_model import generate
from meshes.section.cutting import unknown_strata, value_of_stratum
from tests.support.sections import SOIL, analysed
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


def test_the_input_of_a_run_is_read_again_where_no_stratum_has_the_name_of_its_soil() -> None:
    """The core of a dam parts sand whose first part lies below water alone: section.toml of the run named "Sand" in
    settings, of which it had "Sand, below water" and "Sand, part 2": report, plot and compare refused the folder."""
    data = {
        "name": "dam", "surface": [[0, 0], [40, 0], [60, 10], [66, 10], [90, 0], [130, 0]], "base": {"elevation": -12},
        "water": {"table": [[0, 7], [54, 7], [64, 3], [90, -0.5], [130, -0.5]]},
        "strata": [{"name": "Shell", **SOIL, "bottom": {"elevation": 0}},
                   {"name": "Sand", **SOIL, "bottom": {"elevation": -5}, "liquefies_in": [1]},
                   {"name": "Till", **SOIL}],
        "zones": [{"name": "Core", **SOIL, "points": [[58, -2], [68, -2], [64.5, 10], [61.5, 10]]}],
        "slide": {"cases": [{"residual_strength": {"Sand": "9 kPa"}}]},
        "mesh": {"method": "free", "sizes": {"Sand": "1 m"}},
    }  # fmt: skip
    first = analysed(data)
    names = [stratum.name for stratum in first.section.strata]
    assert "Sand" not in names
    assert [name for name in names if name.startswith("Sand")] == [
        "Sand, below water", "Sand, part 2", "Sand, part 2, below water"
    ]  # fmt: skip
    again = analysed(tomllib.loads(first.to_toml()))
    assert [stratum.name for stratum in again.section.strata] == names
    values = [value_of_stratum(run.cases[0].residual_strength, names[-2]) for run in (first, again)]
    assert values[0] == values[1] == 9e3
    assert set(again.mesh.sizes_in(again.section)) == set(first.mesh.sizes_in(first.section))
    assert unknown_strata(["Sand", "Till", "Snad"], names) == ["Snad"]
    generate(again.section, again.mesh)
