"""What is changed to see on what the critical Kh hangs."""

import pytest

from tests.support.sections import slope
from workflow.settings import Input
from workflow.stages.variants import changed


@pytest.mark.parametrize(
    ("settings", "name", "words"),
    [
        ({}, "mesh", "cells of half the size"),
        ({}, "element", "bilinear element instead of quadratic"),
        ({}, "step", "first step of Kh 0.04 instead of 0.02"),
        ({}, "sides", "sides fixed instead of roller"),
        ({"fem": {"sides": "fixed"}}, "sides", "sides roller instead of fixed"),
        ({}, "dilation", "the non-associated path with ψ as given instead of Davis's substitute"),
        ({"fem": {"flow": "associated"}}, "dilation", "Davis's substitute instead of ψ = φ"),
    ],
)
def test_one_thing_is_changed(settings: dict[str, object], name: str, words: str) -> None:
    run = Input.parse({**slope(), **settings})
    found = changed(run, name, "quadratic")
    assert found is not None
    assert found[:2] == (name, words)
    tables = [table for table in ("mesh", "fem") if getattr(found[2], table) != getattr(run, table)]
    assert tables == ["mesh" if name == "mesh" else "fem"]
    before, after = (getattr(one, tables[0]).model_dump() for one in (run, found[2]))
    assert len([key for key in before if before[key] != after[key]]) == 1


def test_what_would_change_nothing_is_left_out() -> None:
    tied = Input.parse(
        {**slope(), "surface": [[0.0, 20.0], [100.0, 20.0]], "fem": {"sides": "tied", "first_step": 0.1}}
    )
    assert changed(tied, "sides", "quadratic") is None
    assert changed(tied, "step", "quadratic") is None
    data = slope()
    for stratum in data["strata"]:
        stratum["dilation_angle"] = stratum["friction_angle"]
    assert changed(Input.parse(data), "dilation", "reduced") is None
