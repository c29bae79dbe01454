"""Tests of the warning of cohesionless faces that fall by their own weight."""

import pytest

from tests.support.sections import SOIL, analysed
from workflow.config import Config


def bank(**sand: object) -> Config:
    """Return a river bank of 51° whose lower half is in sand, below free water."""
    soil = {**SOIL, "cohesion": "0 kPa", "friction_angle": "33 deg", **sand}
    return analysed(
        {
            "name": "bank",
            "surface": [[0.0, 3.0], [90.0, 1.5], [94.0, -3.5], [120.0, -3.5]],
            "base": {"elevation": -14.0},
            "water": {"table": 0.0},
            "strata": [
                {"name": "Clay", **SOIL, "bottom": {"elevation": -1.0}},
                {"name": "Sand", **soil, "bottom": {"elevation": -6.0}},
                {"name": "Stiff clay", **SOIL},
            ],
        }
    )


def test_sand_on_a_face_steeper_than_its_friction_angle_is_told() -> None:
    """tan β = 5/4, β = 51.3°, φ = 33°, from elevation -1 (x = 92 m) to the toe (x = 94 m)."""
    (message,) = [text for text in bank().notices if "bare face" in text]
    assert message.startswith(
        'the bare face of "Sand" from x = 92 to 94 m cannot stand by itself: its slope is 51°, its friction angle 33°, '
    )
    assert any(line.startswith("Warning: the bare face") for line in bank().notice_lines)


@pytest.mark.parametrize("holds", [{"cohesion": "5 kPa"}, {"friction_angle": "55 deg"}])
def test_a_face_that_stands_is_not_told(holds: dict[str, str]) -> None:
    assert not any("bare face" in text for text in bank(**holds).notices)


@pytest.mark.parametrize("is_right", [True, False])
def test_a_vertical_wall_of_sand_is_told_on_either_side(is_right: bool) -> None:
    """A wall of no width has no slope, so that no face was found, and `check` called the section sound."""
    ground = [[0.0, 10.0], [20.0, 10.0], [20.0, 4.0], [50.0, 4.0]]
    surface = ground if is_right else [[50.0 - x, z] for x, z in reversed(ground)]
    strata = [
        {"name": "Clay", **SOIL, "bottom": {"elevation": 8.0}},
        {"name": "Sand", **SOIL, "cohesion": "0 kPa", "friction_angle": "35 deg"},
    ]
    walled = analysed({"name": "wall", "surface": surface, "base": {"elevation": 0.0}, "strata": strata})
    (message,) = [text for text in walled.notices if "bare wall" in text]
    x = 20 if is_right else 30
    assert message.startswith(f'the bare wall of "Sand" at x = {x} m, from elevation 4 to 8 m, cannot stand by itself')
