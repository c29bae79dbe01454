"""Moving water draws on inclined ground: bare sand there fails at any Kh, which a notice states."""

from typing import Any

import pytest

from meshes.section.section import Section
from workflow.texts.report_texts import Texts


def _dam(mirrored: bool, moves: bool = True, **sand: Any) -> Section:
    """Return a dam of loam on sand, with a reservoir at its left, or, in the mirror image, at its right."""
    soil = {"youngs_modulus": "20 MPa", "poissons_ratio": 0.3, "density": "19 kN/m^3", "friction_angle": "33 deg"}
    surface = [[0.0, 6.0], [30.0, 6.0], [54.0, 16.0], [60.0, 16.0], [80.0, 6.0], [110.0, 6.0]]
    table = [[0.0, 13.0], [46.8, 13.0], [80.0, 6.0], [110.0, 6.0]]
    if mirrored:
        surface, table = ([[110.0 - x, z] for x, z in reversed(line)] for line in (surface, table))
    return Section.parse(
        {
            "name": "dam",
            "surface": surface,
            "base": {"elevation": -2.0},
            "water": {"table": table, "westergaard": moves},
            "strata": [
                soil | {"name": "Loam", "cohesion": "6 kPa", "bottom": {"elevation": 6.0}},
                soil | {"name": "Sand", "cohesion": 0.0} | sand,
            ],
        }
    )


@pytest.mark.parametrize(("mirrored", "x"), [(False, "30"), (True, "80")])
def test_bare_sand_at_the_foot_of_a_face_under_moving_water_is_told(mirrored: bool, x: str) -> None:
    """Its upper bound of Kh is below 0.04 where the slope has 0.16; at the dry foot no water draws."""
    (notice,) = [text for text in _dam(mirrored).notices if "westergaard" in text]
    assert f'"Sand" at x = {x} m, a little' in notice
    assert "moving" not in Texts("ja").page(f"<td>{notice[0].upper()}{notice[1:]}.</td>")


def test_ground_with_cohesion_and_still_water_have_no_such_notice() -> None:
    for section in (_dam(False, cohesion="2 kPa"), _dam(False, moves=False)):
        assert not [text for text in section.notices if "westergaard" in text]
