"""The search along a correction of Newton's method ends where a convex potential no longer falls much."""

import math

from hypothesis import example, given
from hypothesis import strategies as st

from fem.path.line_search import LONGEST_STEP, MOST_TRIALS, REMAINING_SLOPE, LineSearch


@given(
    kinks=st.lists(st.floats(0.01, 7.0), max_size=6),
    stiffer=st.lists(st.floats(0.0, 1e4), min_size=6, max_size=6),
    first=st.floats(0.2, 1.0),
)
def test_the_search_ends_where_the_potential_hardly_falls(kinks, stiffer, first) -> None:
    """The slope of a convex potential, 1 - ∫ stiffness, kinks where points yield or unload; the search ends with half
    of it, or with the longest step where it falls on."""

    def slope(part: float) -> float:
        return 1.0 - first * part - sum(k * max(part - at, 0.0) for at, k in zip(sorted(kinks), stiffer, strict=False))

    search, tried = LineSearch(slope(0.0)), 0
    while not search.ends(slope(search.step_length)):
        tried += 1
    assert tried < MOST_TRIALS
    assert 0.0 < search.step_length <= LONGEST_STEP
    if tried < MOST_TRIALS - 1:
        assert abs(slope(search.step_length)) <= REMAINING_SLOPE or math.isclose(search.step_length, LONGEST_STEP)


@given(slopes=st.lists(st.floats(-2.0, 2.0) | st.just(math.nan), min_size=MOST_TRIALS + 1, max_size=MOST_TRIALS + 1))
@example(slopes=[-1.0] * (MOST_TRIALS + 1))
def test_the_search_ends_whatever_the_slopes(slopes) -> None:
    search = LineSearch(slopes[0])
    tried = next(number for number, slope in enumerate(slopes[1:], 1) if search.ends(slope))
    assert tried <= MOST_TRIALS
    assert 0.0 < search.step_length <= LONGEST_STEP
