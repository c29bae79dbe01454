"""Tests of the warning of cohesionless faces that fall by their own weight."""

from dataclasses import replace

import pytest

from fem.continuum.shallow_failure import ShallowFailure
from meshes.section.sentences import coordinate
from tests.support.sections import SOIL, analysed
from workflow.config import Config
from workflow.config.bare_faces import joined_slopes
from workflow.report.tables import strata_rows


def bank(origin: float = 0.0, **sand: object) -> Config:
    """Return a river bank of 51° whose lower half is in sand, below free water, with its left side at ``origin``."""
    soil = {**SOIL, "cohesion": "0 kPa", "friction_angle": "33 deg", **sand}
    return analysed(
        {
            "name": "bank",
            "surface": [[origin + x, z] for x, z in ((0.0, 3.0), (90.0, 1.5), (94.0, -3.5), (120.0, -3.5))],
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


def test_a_face_of_several_seepage_gradients_is_one_face() -> None:
    """The shell of a dam with seepage had two warnings, of 1.3 m and of 1.0 m of one slope."""
    faces = [ShallowFailure("Sand", start, end, 0.46, kh, 1.0, 0.2) for start, end, kh in
             ((415.3, 416.6, -0.01), (416.6, 417.6, -0.1), (417.6, 420.0, 0.2), (430.0, 432.0, -0.1))]  # fmt: skip
    joined = joined_slopes(faces)
    assert [(face.start, face.end) for face in joined] == [(415.3, 417.6), (430.0, 432.0)]
    steeper = [faces[0], replace(faces[1], angle=0.6)]
    assert joined_slopes(steeper) == steeper


def test_a_face_that_the_water_table_crosses_is_one_face() -> None:
    """A bank of sand of 34° had two warnings, of the parts above and below the water."""
    faces = [ShallowFailure(name, start, end, 0.59, -0.05, 1.0, 0.2)
             for name, start, end in (("Sand", 163.0, 163.8), ("Sand, below water", 163.8, 166.0))]  # fmt: skip
    assert [(face.start, face.end) for face in joined_slopes(faces)] == [(163.0, 166.0)]
    silt = [faces[0], replace(faces[1], stratum="Silt, below water")]
    assert joined_slopes(silt) == silt


def test_places_of_a_national_grid_have_all_their_digits() -> None:
    """They were at "x = 5.234e+05 m"."""
    ends = [coordinate(x) for x in (12.3456, -0.5, 1234.567, 523417.25, 523420.0, -6250400.0)]
    assert ends == ["12.35", "-0.5", "1234.57", "523417.25", "523420", "-6250400"]
    far = bank(523400.0)
    (message,) = [text for text in far.notices if "bare face" in text]
    assert 'of "Sand" from x = 523492 to 523494 m' in message
    (sand,) = [row for row in strata_rows(far.section) if row[0].startswith("Sand")]
    assert sand[3] == "523400-523520"


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


def test_cracks_whose_bottom_lies_above_the_ground_are_none() -> None:
    """A section with bottom = 100 was told how slip circles end at its cracks."""
    data = {
        "name": "slope", "surface": [[0.0, 9.0], [20.0, 9.0], [40.0, 0.0], [60.0, 0.0]], "base": {"elevation": -5.0},
        "strata": [{"name": "Clay", **SOIL}],
    }  # fmt: skip
    for bottom, words in ((100.0, "lies above all of the ground"), ({"depth": 2.0}, "slip circles end at cracks")):
        (message,) = [
            text for text in analysed({**data, "tension_crack": {"bottom": bottom}}).notices if "crack" in text
        ]
        assert words in message
