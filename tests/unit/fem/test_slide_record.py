"""When a slide of material points has come to rest."""

import numpy as np
import pytest

from fem.mpm import PointSlide


def creeping(far: float, speed: float, until: float = 30.0) -> PointSlide:
    """A surface that slides so far (m) in 10 s, and creeps on at such a speed (m/s)."""
    slide = PointSlide()
    for time in np.arange(0.0, until + 0.1, 0.5):
        slide.times.append(float(time))
        slide.slide.append(np.array([0.0, far * min(1.0, time / 10.0) + speed * max(0.0, time - 10.0)]))
        slide.settlement.append(np.zeros(2))
    return slide


@pytest.mark.parametrize(
    ("far", "speed", "rests"), [(1.0, 1e-3, True), (1.0, 5e-3, False), (20.0, 5e-3, True), (20.0, 2e-2, False)]
)
def test_a_slide_rests_once_it_creeps_by_less_than_a_share_of_itself(far: float, speed: float, rests: bool) -> None:
    """2.5 cm in 5 s are a fortieth of a slide of 1 m, and a thousandth of one of 20 m."""
    assert creeping(far, speed).at_rest(0.01, 0.0) == rests


def test_a_slide_does_not_rest_before_the_ground_is_calm() -> None:
    assert creeping(1.0, 0.0).at_rest(0.01, 15.0)
    assert not creeping(1.0, 0.0).at_rest(0.01, 20.0)
    assert not creeping(1.0, 0.0, until=20.0).at_rest(0.01, 0.0)
