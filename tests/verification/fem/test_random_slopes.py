"""Thirty random slopes: no smaller dilation bears more, and strict bounds hold what the finite elements find."""

import pytest

from tests.benchmarks.random_slopes import measure
from tests.support.random_sections import NUMBERS

# What the default mesh without adaptation is allowed above the strict upper bound.
COARSE = 1.20


@pytest.mark.slow
@pytest.mark.parametrize("number", NUMBERS)
def test_a_smaller_dilation_bears_no_more_and_bounds_hold_what_is_found(number):
    row = measure(number)
    davis, full = row["davis"], row["associated"]
    assert davis is None or full is not None
    if davis is not None:
        assert davis <= 1.005 * full
    for kc, bounds in ((full, row["bounds"]), (davis, row.get("davis_bounds"))):
        if kc is not None and bounds is not None:
            assert 0.995 * bounds[0] <= kc <= COARSE * bounds[1] + 0.005
