"""Material points between free-field sides slide as ground that continues beyond the sides."""

from pathlib import Path

import numpy as np
import pytest

from fem.mpm import PointSlider, SlideProgramme, ground_of
from fem.mpm.slide_record import PointSlide
from meshes.section.quantity import GRAVITY
from tests.support.ground_with_a_step import ground_with_a_step
from tests.support.newmark import newmark_slide_speed
from workflow.config import Config
from workflow.stages.mpm import programme_of

DENSITY, CRUST, LOOSE = 1900.0, 3.0, 3.0  # kg/m³, m


def slide_of(config: Config, cells: int, checkpoint: Path | None = None) -> PointSlide:
    slider = PointSlider(ground_of(config.section, cells, "free-field"), 1)
    slider.settle()
    return slider.run(programme_of(config, 1), checkpoint=checkpoint)


def slide_at_a_step(width: float) -> np.ndarray:
    """Slides (m) at the crest and at the toe of a step in gentle ground of some width (m) on both sides of it."""
    slide = slide_of(ground_with_a_step(width), round(12.0 * (2.0 * width + 4.0)))
    assert slide.settled
    return np.interp([-3.0, 7.0], slide.surface_before[:, 0], slide.slide[-1])


def test_a_slide_does_not_depend_on_how_far_the_section_reaches() -> None:
    """With a pressure that does not depend on motion 9.2 m between sides at 15 m, and 2.9 m between sides at 90 m."""
    assert slide_at_a_step(15.0) == pytest.approx(slide_at_a_step(60.0), rel=0.1)


@pytest.mark.parametrize("kh", [0.045, 0.06])
def test_a_slope_between_free_sides_slides_as_an_endless_one(kh: float) -> None:
    """Newmark's block on the foot of the layer; the ground slides out onto the ground beyond the side."""
    slope, width = 0.035, 60.0
    soil = {"density": f"{DENSITY} kg/m^3", "youngs_modulus": "30 MPa", "poissons_ratio": 0.33}
    firm = soil | {"cohesion": "40 kPa", "friction_angle": "20 deg"}
    config = Config.parse({
        "name": "slope", "surface": [[0.0, 0.0], [width, -slope * width]], "base": {"depth": CRUST + LOOSE + 3.0},
        "strata": [
            firm | {"name": "crust", "bottom": {"depth": CRUST}},
            soil
            | {
                "name": "loose", "cohesion": "2 kPa", "friction_angle": "33 deg", "bottom": {"depth": CRUST + LOOSE},
                "liquefies_in": [1],
            },
            firm | {"name": "firm"},
        ],
        "fem": {"sides": "free-field"},
        "slide": {"kh": kh, "kh_seconds": 2.0, "duration": 60.0, "cases": [{"residual_strength": "6 kPa"}]},
    })  # fmt: skip
    slide = slide_of(config, 500)
    angle, programme, time = np.arctan(slope), programme_of(config, 1), np.linspace(0.0, 60.0, 6001)
    ratio = 6e3 / (DENSITY * GRAVITY * (CRUST + LOOSE) * np.cos(angle) ** 2)
    before, driving = np.tan(np.radians(33.0)) + 2e3 / 6e3 * ratio, slope + kh
    fails_at = (before - driving) / (before - ratio)  # of the onset, in which the strength falls in proportion to time
    since = max(programme.starts.values()) + 0.5 * (1.0 + fails_at) * programme.onset
    felt = np.where(time > since, programme.shaking(time), 0.0)
    assert np.median(slide.slide[-1]) == pytest.approx(newmark_slide_speed(angle, ratio, time, felt), rel=0.15)


def test_a_slide_between_free_sides_continues_from_its_checkpoint_with_the_same_bits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    config = ground_with_a_step(15.0)
    whole, file = slide_of(config, 150), tmp_path / "points.npz"
    slider = PointSlider(ground_of(config.section, 150, "free-field"), 1)
    slider.settle()

    class StoppedError(Exception):
        pass

    def stop(time: float, _: np.ndarray) -> None:
        if time > 4.0:
            raise StoppedError

    monkeypatch.setattr("fem.mpm.slide.CHECKPOINT_INTERVAL", 0.0)
    with pytest.raises(StoppedError):
        slider.run(programme_of(config, 1), stop, checkpoint=file)
    assert file.exists()
    continued = slide_of(config, 150, file)
    assert continued.times == whole.times
    assert np.array_equal(continued.slide[-1], whole.slide[-1])


def test_a_side_does_not_pull() -> None:
    """Ground that leaves a side faster than waves of its pressure at rest is not held back by it."""
    config = ground_with_a_step(15.0)
    slider = PointSlider(ground_of(config.section, 150, "free-field"), 1)
    slider.settle()
    pressure = slider.begin(SlideProgramme(np.zeros_like, {1: 0.0}, {}, 0.5, 0.5, 0.5))
    points = slider.ground.points
    left = points.side > 0.0
    points.v[left, 0] = 5.0
    for _ in range(10):
        pressure.follow()
    assert (points.side[left] >= 0.0).all()
    points.v[left, 0] = -50.0
    for _ in range(20):
        pressure.follow()
    passive = dict(zip(pressure.numbers, pressure.passive, strict=True))
    most = np.array([passive[number] for number in slider.engine.order[left]])
    assert points.side[left] == pytest.approx(most, rel=1e-3)  # ground beyond yields
    points.v[left, 0] = 5.0
    for _ in range(20):
        pressure.follow()
    points.v[left, 0] = -0.1
    at_rest = points.side[left].sum()
    for _ in range(10):
        pressure.follow()
    assert points.side[left].sum() > at_rest
