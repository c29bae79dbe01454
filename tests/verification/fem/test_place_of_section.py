"""A slide by material points does not depend on the axes of coordinates: on the datum, on x = 0, and on their sense.
Similar slopes slide alike."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fem.mpm import PointSlide
from workflow.config import Config
from workflow.stages.mpm import PointRun, at_rest, slide_of_points

LARGEST_DIFFERENCE = 1e-4  # m; rounding errors grow to some 1e-6 m
# Of the slide: in a mirrored section sums are rounded in another order, which over a slide of 18 m becomes 0.2 mm.
DIFFERENCE_SHARE = 2e-5
SHIFTS = ((1.0, 0.0, 0.4517), (1.0, -1003.3721, 312.7119), (-1.0, 17.03, -2.37))  # sense of x, and shifts (m)


def _line(points: list[list[float]], sense: float, dx: float, dz: float) -> list[list[float]]:
    return [[sense * x + dx, z + dz] for x, z in points][:: int(sense)]


def _slope(sense: float, dx: float, dz: float, scale: float = 1.0, **slide: Any) -> Config:
    """Return a slope with water, a dipping layer that liquefies and a lens, mirrored if ``sense`` is -1, shifted by
    ``dx`` and ``dz`` (m), and larger by a ``scale`` with its strengths and stiffness."""

    def soil(name: str, cohesion: float, friction: float, **more: Any) -> dict[str, Any]:
        return {
            "name": name, "youngs_modulus": f"{20.0 * scale} MPa", "poissons_ratio": 0.3, "density": "1.9 t/m^3",
            "density_saturated": "2.0 t/m^3", "cohesion": scale * cohesion, "friction_angle": f"{friction} deg",
        } | more  # fmt: skip

    def line(*points: list[float]) -> list[list[float]]:
        return _line([[scale * x, scale * z] for x, z in points], sense, dx, dz)

    def elevations(*points: list[float]) -> dict[str, Any]:
        return {"elevation": line(*points)}

    return Config.parse({
        "name": "slope",
        "surface": line([0.0, 18.0], [20.0, 18.0], [44.0, 8.0], [70.0, 8.0]),
        "base": {"elevation": dz},
        "strata": [
            soil("fill", 10e3, 30.0, bottom=elevations([0.0, 9.3], [70.0, 6.6])),
            soil("lens", 0.0, 31.0, bottom=elevations([8.0, 8.0], [38.0, 6.9]), liquefies_in=[1]),
            soil("crust", 8e3, 30.0, bottom=elevations([0.0, 6.4], [70.0, 5.1])),
            soil("loose", 0.0, 30.0, bottom=elevations([0.0, 3.9], [70.0, 2.6]), liquefies_in=[1, 2]),
            soil("firm", 20e3, 36.0),
        ],
        "water": {"table": line([0.0, 12.0], [44.0, 8.0], [70.0, 8.0])},
        "slide": {
            "mpm_cells": 350, "onset": 1.0, "duration": 12.0, "kh": 0.05, **slide,
            "cases": [
                {"name": "both", "residual_strength": 11e3 * scale},
                {"name": "loose", "residual_strength": 7e3 * scale},
            ],
        },
    })  # fmt: skip


def _slid(config: Config, case: int) -> PointSlide:
    slider, _ = at_rest(config)
    return slide_of_points(PointRun(config, slider, case, 10.0), lambda _: None)


def _same(slide: PointSlide, other: PointSlide, sense: float, dx: float, dz: float) -> None:
    """Check that a slide is that of the section before it was mirrored and shifted."""
    way = int(sense)
    largest = max(LARGEST_DIFFERENCE, DIFFERENCE_SHARE * other.slide_max)
    assert slide.times == other.times
    assert other.slide_max > 0.3
    assert slide.slide[-1] == pytest.approx(other.slide[-1][::way], abs=largest)
    assert slide.settlement[-1] == pytest.approx(other.settlement[-1][::way], abs=largest)
    moved = np.array([sense, 1.0]) * other.surface_after[::way] + np.array([dx, dz])
    order, expected = slide.surface_after[:, 0].argsort(), moved[moved[:, 0].argsort()]
    assert slide.surface_after[order] == pytest.approx(expected, abs=largest)


@pytest.mark.parametrize("sides", ["fixed", "free-field"])
def test_a_slide_does_not_depend_on_the_axes(sides: str) -> None:
    """A slope slid 4.8 to 6.6 m in 800 cells, by the datum: the grid began at a multiple of the size of the cells."""
    setting: dict[str, Any] = {"kh": 0.06, "mpm_sides": sides}
    slide = _slid(_slope(1.0, 0.0, 0.0, **setting), 1)
    for place in SHIFTS:
        _same(_slid(_slope(*place, **setting), 1), slide, *place)


def test_a_slide_under_a_record_does_not_depend_on_the_axes(tmp_path: Path) -> None:
    """The record has more of one sign, and lets a layer liquefy at 2 s."""
    times = np.arange(0.0, 6.0, 0.02)
    acceleration = 2.5 * np.sin(4.0 * np.pi * times) * np.exp(-0.5 * (times - 3.0) ** 2) + 0.4 * (times > 2.0)
    record = tmp_path / "record.csv"
    rows = [f"{time:.6f},{value:.6f}" for time, value in zip(times, acceleration, strict=True)]
    record.write_text("\n".join(["time (s),acceleration (m/s2)", *rows, ""]))
    setting: dict[str, Any] = {"accelerogram": str(record), "liquefies_at": 2.0}
    slide = _slid(_slope(1.0, 0.0, 0.0, **setting), 2)
    for place in SHIFTS:
        _same(_slid(_slope(*place, **setting), 2), slide, *place)


def test_a_slope_twice_as_large_slides_twice_as_far() -> None:
    """Froude's similarity: times are longer by the square root of the scale, and strains alike."""
    small, large = (
        _slid(_slope(1.0, 0.0, 0.0, scale, kh_seconds=root * 3.0, onset=root * 4.0, duration=root * 14.0), 1)
        for scale, root in ((1.0, 1.0), (2.0, np.sqrt(2.0)))
    )
    assert small.slide_max > 1.0
    assert large.slide_max == pytest.approx(2.0 * small.slide_max, rel=0.02)
