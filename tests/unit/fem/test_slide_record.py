"""When the surface of material points is at rest: its largest slide, and the rest of it, which may creep for longer."""

import numpy as np
import pytest

from fem.mpm import BackgroundGrid, MaterialPointEngine, MaterialPoints, PointSoil
from fem.mpm.ground import ground_of
from fem.mpm.slide import PointSlider
from fem.mpm.slide_record import PointSlide
from meshes.section.section import Section
from tests.support.sections import slope


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
    moves = largest > 0.0 or others > 0.0
    assert record.at_rest(0.01, 15.5) != moves, "three windows of 5 s have to be seen of what moves"
    assert not record.at_rest(0.01, 25.5), "one window of 5 s has to be seen"


@pytest.mark.parametrize(("speed", "rests"), [(0.0019, True), (0.0021, False)])
def test_a_small_slide_rests_when_it_moves_by_less_than_what_counts_as_still(speed: float, rests: bool) -> None:
    time = np.arange(0.0, 30.01, 0.5)
    slide = (0.5 + speed * (time - 30.0))[:, np.newaxis]
    record = PointSlide(times=list(time), slide=list(slide), settlement=list(np.zeros_like(slide)))
    assert record.at_rest(0.01, 10.0) == rests


@pytest.mark.parametrize(("settles", "rests"), [(0.0, True), (0.0011, False)])
def test_a_surface_that_hardly_moves_is_at_rest_after_one_window(settles: float, rests: bool) -> None:
    """Half of what counts as still, 0.005 m in 5 s: by 0.0008 m/s and swings of 0.5 mm, but not by 0.0011 m/s."""
    time = np.arange(0.0, 30.01, 0.5)
    slide = (0.5 + 0.0008 * (time - 30.0) + 0.0002 * (-1.0) ** np.arange(len(time)))[:, np.newaxis]
    settlement = (settles * (time - 30.0))[:, np.newaxis]
    record = PointSlide(times=list(time), slide=list(slide), settlement=list(settlement))
    assert record.at_rest(0.01, 24.0) == rests


def test_what_creeps_to_the_other_side_is_not_at_rest() -> None:
    time = np.arange(0.0, 30.01, 0.5)
    slide = -10.0 - 0.0041 * (time - 30.0)[:, np.newaxis]
    record = PointSlide(times=list(time), slide=list(slide), settlement=list(np.zeros_like(slide)))
    assert not record.at_rest(0.01, 10.0)


@pytest.fixture
def slider() -> PointSlider:
    return PointSlider(ground_of(Section.parse(slope()), 300, "smooth"), 1)


def test_ground_that_lies_on_other_ground_is_the_surface(slider: PointSlider) -> None:
    """Debris of a bank covered the river bed, and the surface after the slide was drawn along the bed below it."""
    points, cell = slider.ground.points, slider.ground.grid.cell
    before = slider._highest_ground()
    assert np.interp(before[:, 0], *slider._surface().T) == pytest.approx(before[:, 1], abs=1e-9)
    x, z = (points.x + slider.ground.offset).T
    block = (points.stratum >= 0) & (x < 10.0)
    low = z[(points.stratum >= 0) & (x > 80.0) & (x < 90.0)].max()
    points.x[block] += [80.0, low + cell - z[block].min()]
    after = slider._highest_ground()
    assert np.interp(85.0, *after.T) - np.interp(85.0, *before.T) > 0.5 * np.ptp(z[block])


@pytest.mark.parametrize(("sign", "side"), [(1.0, "right"), (-1.0, "left")])
def test_a_slide_that_reaches_either_side_is_told(sign: float, side: str, slider: PointSlider) -> None:
    points, cell = slider.ground.points, slider.ground.grid.cell
    assert slider._side_reached() is None
    end = max(slider.ground.section.extent) if sign > 0 else min(slider.ground.section.extent)
    moving = np.flatnonzero(points.stratum >= 0)[:5]
    points.displacement[moving, 0] = sign * 3.0 * cell
    points.x[moving, 0] = end + sign * slider.ground.room - slider.ground.offset[0]
    assert slider._side_reached() == side


def test_a_point_alone_in_the_air_keeps_its_volume_and_no_side_presses_on_it() -> None:
    """Points shot out of a hillside at 36 m/s, which a free-field side had pressed on, and grew to 300 times their
    volume; the slide was 67 m, 51 m without them."""
    soil = PointSoil(1800.0, 1e7, 0.3, np.array([5e3]), np.array([0.5]))
    points = MaterialPoints.of(np.array([[10.0, 20.0]]), np.array([0.25]), soil, np.array([0]))
    points.side[:], points.affine[:] = -1e5, [3.0, 0.0, 0.0, 3.0]
    engine = MaterialPointEngine(points, BackgroundGrid.empty(1.0, 40, 40, floor=3), decay=1.0)
    engine.run(0.5)
    assert points.side[0] == 0.0
    assert abs(points.v[0, 0]) < 5.0  # 111 if pressed on all the time
    assert points.state[0, 0] == pytest.approx(0.25, rel=1e-2)


def test_single_points_in_the_air_are_no_surface(slider: PointSlider) -> None:
    points = slider.ground.points
    before = slider._highest_ground()
    points.x[np.flatnonzero(points.stratum >= 0)[:2], 1] += 30.0
    assert slider._highest_ground()[:, 1].max() <= before[:, 1].max()
