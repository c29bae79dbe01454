"""When the surface of material points is at rest: its largest slide, and the rest of it, which may creep for longer."""

import numpy as np
import pytest

from fem.mpm.slide_record import PointSlide


@pytest.mark.parametrize(
    ("largest", "others", "rests"),
    [(0.0, 0.0, True), (0.0039, 0.0, True), (0.0041, 0.0, False), (0.0, 0.0195, True), (0.0, 0.0205, False)],
)
def test_a_surface_rests_when_no_part_creeps_by_more_than_its_share_of_the_slide(
    largest: float, others: float, rests: bool
) -> None:
    """A constant speed v changes the mean of a window of 5 s by 5 v: 0.2 % of 10 m is 0.004 m/s, 1 % is 0.02 m/s."""
    time = np.arange(0.0, 30.01, 0.5)
    slide = np.column_stack([10.0 + largest * (time - 30.0), 4.0 + others * (time - 30.0)])
    record = PointSlide(times=list(time), slide=list(slide), settlement=list(np.zeros_like(slide)))
    assert record.at_rest(0.01, 10.0) == rests
    assert not record.at_rest(0.01, 15.5), "three windows of 5 s have to be seen"


@pytest.mark.parametrize(("speed", "rests"), [(0.0019, True), (0.0021, False)])
def test_a_small_slide_rests_when_it_moves_by_less_than_what_counts_as_still(speed: float, rests: bool) -> None:
    time = np.arange(0.0, 30.01, 0.5)
    slide = (0.5 + speed * (time - 30.0))[:, np.newaxis]
    record = PointSlide(times=list(time), slide=list(slide), settlement=list(np.zeros_like(slide)))
    assert record.at_rest(0.01, 10.0) == rests


def test_what_creeps_to_the_other_side_is_not_at_rest() -> None:
    time = np.arange(0.0, 30.01, 0.5)
    slide = -10.0 - 0.0041 * (time - 30.0)[:, np.newaxis]
    record = PointSlide(times=list(time), slide=list(slide), settlement=list(np.zeros_like(slide)))
    assert not record.at_rest(0.01, 10.0)
