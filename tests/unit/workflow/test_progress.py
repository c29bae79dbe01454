"""How long a stage still needs, as it is told."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from workflow.run.progress import SearchShare, TimeLeft


def test_time_left() -> None:
    assert TimeLeft(0.0).seconds(30.0, 0.25) == pytest.approx(90.0)
    assert TimeLeft(10.0).description(40.0, 0.25) == "1 min 30 s left"
    assert TimeLeft(0.0).seconds(30.0, 1.0) == 0.0
    assert TimeLeft(0.0).seconds(30.0, None) is None
    assert TimeLeft(0.0).description(30.0, 0.0) == ""


def test_the_start_of_a_stage_is_not_taken_for_its_speed() -> None:
    """25 s of compilation and 0.02 % of the work would come to 35 h; 40 s later 40 % are done. Points that waited 5 min
    for a processor and had done 8 % half a minute later were told to need another hour."""
    left = TimeLeft(0.0)
    assert left.description(25.0, 0.0002) == ""
    assert left.description(65.0, 0.4) == "1 min 0 s left"
    left = TimeLeft(0.0)
    assert left.description(300.0, 0.005) == ""
    assert left.description(310.0, 0.03) == ""
    assert left.description(330.0, 0.08) == "6 min 8 s left"


@given(st.lists(st.tuples(st.floats(0.1, 100.0), st.floats(0.0, 0.2)), min_size=1, max_size=40))
def test_time_left_never_rises(steps: list[tuple[float, float]]) -> None:
    left, now, share, inf = TimeLeft(0.0), 0.0, 0.0, math.inf
    for seconds, more in steps:
        now, share = now + seconds, min(1.0, share + more)
        value = left.seconds(now, share)
        if value is not None:
            assert 0.0 <= value <= inf
            inf = value


def test_time_left_counts_down_while_a_piece_lasts_and_holds_where_it_takes_too_long() -> None:
    left = TimeLeft(0.0)
    assert left.description(10.0, 0.1) == "1 min 30 s left"
    assert (
        left.description(40.0, 0.1) == "more than 1 min 30 s left"
    )  # this piece takes four times as long as the first
    left = TimeLeft(0.0)
    assert left.seconds(100.0, 0.5) == pytest.approx(100.0)
    assert left.seconds(120.0, 0.5) == pytest.approx(80.0)
    assert left.seconds(150.0, 0.75) == pytest.approx(50.0)


def test_trials_tell_how_far_searches_are() -> None:
    """Three searches of eight, four and two trials: the share never falls, and is whole at the end of each."""
    share, messages = SearchShare(3), [0.0]
    for done, trials in enumerate((8, 4, 2)):
        messages += [share.after_trial(done) for _ in range(trials)]
    assert messages == sorted(messages)
    assert messages[1] == pytest.approx(1 / 24)
    assert messages[9] > 1 / 3
    assert messages[-1] < 1.0
