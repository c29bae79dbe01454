"""When a slide is over, and what drives it if it is not."""

import numpy as np
import pytest

from dem.slides.rest import at_rest, moved_lately, residual_motion_source

TIMES = np.arange(0.0, 12.5, 0.5)


def test_ground_that_has_lain_still_for_five_seconds_is_at_rest() -> None:
    moved = np.where(TIMES < 2.0, TIMES, 2.0)[:, None] * [1.0, 0.5]
    early = TIMES < 7.1
    assert at_rest(TIMES, moved, 0.01)
    assert at_rest(TIMES[early], moved[early], 0.01)
    assert not at_rest(TIMES[early][:-1], moved[early][:-1], 0.01)  # still for 4.5 s
    assert not at_rest(TIMES[TIMES > 7.9], moved[TIMES > 7.9], 0.01)  # watched for 4 s
    assert not at_rest([], [], 0.01)


@pytest.mark.parametrize(("period", "swings"), [(0.7, 0.014), (1.3, 0.014), (1.3, 0.016)])
def test_ground_may_swing_about_where_it_lies_but_not_while_it_moves_on(period: float, swings: float) -> None:
    """A swing of 2.8 cm is no slide, one of 3.2 cm is too much to tell; nothing slides on under cover of a swing."""
    swing = (swings * np.sin(2.0 * np.pi * TIMES / period))[:, None]
    assert at_rest(TIMES, swing, 0.01) == (swings < 0.015)
    creep = 0.0025 * TIMES[:, None]
    assert not at_rest(TIMES, swing + creep, 0.01)


@pytest.mark.parametrize("column", [0, 1])
def test_a_single_third_that_creeps_is_enough_to_go_on(column: int) -> None:
    moved = np.zeros((len(TIMES), 2))
    moved[:, column] = 0.0021 * TIMES  # 1.05 cm in 5 s
    assert not at_rest(TIMES, moved, 0.01)
    assert at_rest(TIMES, 0.9 * moved, 0.01)


def test_what_moved_lately_is_that_of_the_last_ten_seconds() -> None:
    assert moved_lately(TIMES, np.where(TIMES < 2.0, TIMES, 2.0)) == 0.0
    assert moved_lately(TIMES, 0.1 * TIMES) == pytest.approx(1.0)
    assert moved_lately([0.0, 3.0], [0.0, 0.2]) == pytest.approx(0.2)  # a slide of less than that


def test_what_drives_a_slide_is_told_by_its_last_five_seconds() -> None:
    weight = np.where(TIMES < 6.0, 0.0, 95.0 * (TIMES - 6.0))
    shaking = np.where(TIMES < 6.0, 1e6, 1e6 + 5.0 * (TIMES - 6.0))
    assert "95 % of the energy came from weight" in residual_motion_source(TIMES, weight, shaking)
    assert "would continue without" in residual_motion_source(TIMES, weight, shaking)
    assert "would continue without" not in residual_motion_source(TIMES, shaking - 1e6, weight)
    assert "slows down" in residual_motion_source(TIMES, -weight, np.zeros(len(TIMES)))


@pytest.mark.parametrize(("far", "speed", "rests"), [(10.0, 0.0039, True), (10.0, 0.0041, False), (4.0, 0.0021, False)])
def test_a_long_slide_rests_when_it_goes_on_by_less_than_its_share(far: float, speed: float, rests: bool) -> None:
    """Ground that creeps moves by 5 v in a window of five seconds: 0.2 % of 10 m are 20 mm, of 4 m less than 10 mm."""
    moved = (far + speed * (TIMES - TIMES[-1]))[:, np.newaxis]
    assert at_rest(TIMES, moved, 0.01) == rests
