"""Random difficult sections are read, or refused with a sentence; none ends in a traceback."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshes.errors import InputError
from tests.support.hostile_sections import hostile_data
from workflow.config import Config


@settings(max_examples=8, deadline=None, derandomize=True)
@given(number=st.integers(0, 10**6))
def test_a_section_is_read_or_refused_with_a_sentence(number: int) -> None:
    is_read_or_refused(number)


@pytest.mark.slow
@settings(max_examples=100, deadline=None)
@given(number=st.integers(0, 10**6))
def test_a_hundred_sections_are_read_or_refused_with_a_sentence(number: int) -> None:
    is_read_or_refused(number)


def is_read_or_refused(number: int) -> None:
    """Any other error than InputError is a traceback to a user, or seepage that was not found."""
    try:
        config = Config.parse(hostile_data(number))
    except InputError:
        return
    section = config.section
    assert section.layering.areas().min() > 0.0
    assert all(notice.strip() for notice in (*section.notices, *config.notices))


@pytest.mark.parametrize(("number", "base"), [(90, 15.1523), (99, None), (206, 3.65233), (639, 7.61284)])
def test_seepage_comes_to_rest_where_points_are_dry_to_rounding_alone(number: int, base: float | None) -> None:
    """Three waters that stand still and one of 1e-18 m²/s: pressures of 1e-14 m kept changing their sign."""
    data = hostile_data(number)
    if base is not None:  # where the wall closes the section
        data["water"]["cutoffs"][0]["bottom"] = base
    flow = Config.parse(data).section.water_pressure.flow
    assert flow is not None
    assert flow.discharge == 0.0
    assert flow.description == "Seepage: the water stands still."
