"""Extrapolation of values whose limit is known."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from workflow.study.converge import RADII, fit

SIZES = [0.8 * share for share in RADII]


@given(
    order=st.floats(0.55, 2.9), limit=st.floats(0.5, 5.0), slope=st.floats(-2.0, 2.0).filter(lambda s: abs(s) > 1e-3)
)
def test_order_and_limit_are_found(order: float, limit: float, slope: float) -> None:
    result = fit(SIZES, [limit + slope * size**order for size in SIZES])
    assert result.order == pytest.approx(order, rel=1e-4)
    assert result.limit == pytest.approx(limit, abs=1e-5)
    assert result.remaining_error == pytest.approx(abs(slope) * SIZES[-1] ** order / limit, rel=1e-3)


def test_values_that_jump_about_have_no_order_and_are_no_better_than_they_jump() -> None:
    result = fit(SIZES, [3.0, 3.4, 3.1])
    assert result.order is None
    assert result.remaining_error > 0.05
    assert not result.converged(0.05)
    assert result.verdict(0.05).startswith("not converged")


def test_scatter_of_packings_counts() -> None:
    values = [1.0 + 0.01 * size for size in SIZES]
    sure, unsure = fit(SIZES, values), fit(SIZES, values, error=0.3)
    assert sure.converged(0.01)
    assert not unsure.converged(0.1)
    assert unsure.scatter == pytest.approx(0.3, rel=0.01)
    assert "by the scatter of packings" in unsure.verdict(0.1)
    assert sure.verdict(0.01) == f"converged within {100 * 0.01 * SIZES[-1]:.2g} %"


def test_what_does_not_change_has_converged() -> None:
    assert fit(SIZES, [2.0, 2.0, 2.0]).converged(0.0)
    assert math.isinf(fit(SIZES, [0.0, 0.0, 0.0], error=0.1).remaining_error)
