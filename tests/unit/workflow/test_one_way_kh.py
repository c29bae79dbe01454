"""A constant Kh acts to one side: which side can be given, and ground with another face has a notice."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from dem.ground import Ground
from dem.model import DiscModel
from dem.packing import Packing
from dem.slides.drive import constant_kh, recorded_motion
from meshes.errors import InputError
from meshes.section.polyline import downhill
from meshes.section.quantity import GRAVITY
from workflow.config import Config
from workflow.stages.mpm import programme_of
from workflow.stages.shaking import shaking_of
from workflow.texts.report_texts import Texts

LEVEE = [[0.0, 6.0], [30.0, 6.0], [50.0, 14.0], [56.0, 14.0], [76.0, 6.0], [106.0, 6.0]]
START = cast("DiscModel", SimpleNamespace(law="soil", time=0.0))
TIME_UNDER_KH = 9.0  # s: the constant Kh is complete


def _config(surface: list[list[float]], **slide: Any) -> Config:
    """Return a ground whose lower stratum liquefies."""
    soil = {
        "youngs_modulus": "20 MPa", "poissons_ratio": 0.3, "density": "19 kN/m^3", "cohesion": "5 kPa",
        "friction_angle": "32 deg",
    }  # fmt: skip
    strata = [
        soil | {"name": "Fill", "bottom": {"elevation": 5.0}},
        soil | {"name": "Loose", "liquefies_in": [1]},
    ]
    cases = [{"name": "r", "residual_strength": "9 kPa"}]
    return Config.parse(
        {
            "name": "levee", "surface": surface, "base": {"elevation": -2.0}, "strata": strata,
            "slide": {"kh": 0.1, "cases": cases, **slide},
        }
    )  # fmt: skip


def _ground(config: Config, fails_towards: int) -> Ground:
    """Return the ground of discs whose finite elements fail to the left (-1) or to the right (1)."""
    frame = cast("Packing", None), "random", 0.5, 0, 0.0, (0.0, 0.0)
    return Ground(*frame, downhill(config.section.ground), config.section, fails_towards)


@pytest.mark.parametrize("falls", ["left", "right", "level"])
@pytest.mark.parametrize("towards", [None, "left", "right"])
def test_a_constant_kh_acts_to_the_side_that_is_given(falls: str, towards: str | None) -> None:
    """By default to the lower end, and to the right of ground with equal ends; discs and points alike."""
    step = {"left": -2.0, "right": 2.0, "level": 0.0}[falls]
    config = _config([[x, z + step * (x < 40.0)] for x, z in LEVEE], **({"kh_towards": towards} if towards else {}))
    expected = {"left": -1, "right": 1, None: -1 if falls == "left" else 1}[towards]
    sign = downhill(config.section.ground)
    points = sign * programme_of(config, 1).shaking(np.array([TIME_UNDER_KH]))[0]
    discs = []
    for fails_towards in (-1, 1):
        ground = _ground(config, fails_towards)
        motion = constant_kh(START, ground, [1], config.slide)
        discs.append(np.interp(TIME_UNDER_KH, motion.acceleration.times, motion.acceleration.x))
    assert [points, *discs] == pytest.approx([expected * 0.1 * GRAVITY] * 3)


@pytest.mark.parametrize("falls", ["left", "right", "level"])
def test_a_record_acts_alike_on_discs_and_points(falls: str, tmp_path: Path) -> None:
    """A record of one sign acts towards the lower end, or to the right, in whichever direction the finite elements
    fail. Discs took the sign from the finite elements, and the points from the surface.
    """
    record = tmp_path / "record.csv"
    record.write_text("time (s),acceleration (m/s2)\n0.0,0.0\n1.0,2.0\n5.0,2.0\n6.0,-0.5\n")
    step = {"left": -2.0, "right": 2.0, "level": 0.0}[falls]
    surface = [[x, z + step * (x < 40.0)] for x, z in LEVEE]
    config = _config(surface, accelerogram=str(record), liquefies_at=0.5)
    shaking = shaking_of(config, [1])
    assert shaking is not None
    points = downhill(config.section.ground) * programme_of(config, 1).shaking(np.array([3.0]))[0]
    discs = []
    for fails_towards in (-1, 1):
        ground = _ground(config, fails_towards)
        motion = recorded_motion(START, ground, [1], config.slide, shaking)
        discs.append(np.interp(3.0, motion.acceleration.times, motion.acceleration.x))
        assert ground.steady(0.1).x[0] == pytest.approx(fails_towards * 0.1 * GRAVITY)  # of the search
    assert [points, *discs] == pytest.approx([-2.0 if falls == "left" else 2.0] * 3)


def test_the_other_face_of_a_levee_is_told() -> None:
    (notice,) = [text for text in _config(LEVEE).notices_of_slides if "acts towards the right alone" in text]
    assert "falls by 8.0 m towards the left" in notice
    translated = Texts("ja").page(f"<td>{notice[0].upper()}{notice[1:]}.</td>")
    assert "左向きにも8.0 m" in translated
    assert "acts" not in translated
    slope = [[0.0, 14.0], [40.0, 14.0], [60.0, 6.0], [90.0, 6.5]]
    for other in (
        _config(LEVEE, kh_towards="left"),
        _config(LEVEE, kh=0.0),
        _config(LEVEE, kh_cycles=5.0, kh_period=0.6),
        _config(slope),
    ):
        assert not [text for text in other.notices_of_slides if " alone, but the ground" in text]


def test_cycles_act_to_both_sides() -> None:
    with pytest.raises(InputError, match="kh_towards: expected with a constant Kh alone"):
        _config(LEVEE, kh_cycles=5.0, kh_period=0.6, kh_towards="left")
