"""Slip circles of cracked level ground: heights that differ by rounding alone do not decide what slides."""

import pytest

from meshes.section.section import Section
from meshes.section.tension_crack import TensionCrack
from workflow.estimates.slices import LEFT, RIGHT
from workflow.estimates.slip_circles import critical_circle


def _loaded_level_ground(x: float, elevation: float, mirrored: bool = False) -> Section:
    """Return level ground under a strip load, beside a slope that falls away from it, with its left end at ``x``."""
    surface = [(0.0, 12.0), (30.0, 12.0), (42.0, 4.0), (70.0, 4.0)]
    load = (20.0, 26.0)
    if mirrored:
        surface, load = [(70.0 - a, b) for a, b in reversed(surface)], (44.0, 50.0)
    soil = {
        "name": "Soil", "youngs_modulus": "10 MPa", "poissons_ratio": 0.3, "cohesion": "10 kPa",
        "friction_angle": "28 deg", "density": "19 kN/m^3",
    }  # fmt: skip
    return Section.parse(
        {
            "name": "level",
            "surface": [[x + a, elevation + b] for a, b in surface],
            "base": {"elevation": elevation - 4.0},
            "surcharges": [{"from": x + load[0], "to": x + load[1], "pressure": "20 kPa"}],
            "strata": [soil],
        }
    )


@pytest.mark.parametrize("kh", [None, 0.3])
@pytest.mark.parametrize("ground", [(0.0, 0.0, True), (1000.0, 300.0, False), (33.3, 0.7, False)])
def test_cracked_level_ground_slides_alike_wherever_it_lies(
    ground: tuple[float, float, bool], kh: float | None
) -> None:
    """Circles between two points of equal height count, at any coordinates and towards either side; with
    cracks they are fewer, and hardly stronger."""
    crack = TensionCrack.model_validate({"bottom": {"depth": 1.5}, "water": "full"})
    first, moved = _loaded_level_ground(0.0, 0.0), _loaded_level_ground(*ground)
    cracked = critical_circle(first, LEFT, kh, 0.5, crack=crack)
    other = critical_circle(moved, RIGHT if ground[2] else LEFT, kh, 0.5, crack=crack)
    sound = critical_circle(first, LEFT, kh, 0.5)
    assert cracked is not None
    assert other is not None
    assert sound is not None
    assert other.bishop == pytest.approx(cracked.bishop, rel=1e-3)
    assert cracked.bishop < 1.03 * sound.bishop
