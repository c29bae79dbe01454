"""Loads that end on bare sand: what bears nothing is given a cohesion, and the slope has strict bounds."""

import pytest

from fem.continuum.load_ends import POINT_SUFFIX, soil_of_strip, with_strengthened_load_ends
from fem.limit.bounds import kh_bounds
from fem.limit.safety_bounds import safety_bounds
from fem.settings import BoundsSettings, FemSettings
from meshes.section.section import Section
from tests.support.water import soil

FEM = FemSettings(sides="smooth", direction="downhill")


def bank(load: tuple[float, float], **changes: object) -> Section:
    """Sand of φ = 34° with a face of 5:12 and a road of 30 kPa behind its crest."""
    sand = soil("Sand", **{"cohesion": 0, "friction_angle": "34 deg", "density_saturated": None, **changes})
    return Section.parse(
        {
            "name": "road",
            "surface": [[0.0, 5.0], [30.0, 5.0], [42.0, 0.0], [70.0, 0.0]],
            "base": {"elevation": -8.0},
            "surcharges": [{"from": load[0], "to": load[1], "pressure": "30 kPa"}],
            "strata": [sand],
        }
    )


def test_only_bare_ends_on_sand_are_held() -> None:
    ground = with_strengthened_load_ends(bank((0.0, 20.0)), 0.5)
    [strip, sand] = ground.strata
    assert strip.name == f"Sand{POINT_SUFFIX}20 m"
    assert (strip.cohesion, strip.friction_angle) == (15e3, sand.friction_angle)
    assert soil_of_strip(strip.name) == sand.name == soil_of_strip(sand.name) == "Sand"
    assert ground.layering.areas()[0] == pytest.approx(1.0 * 0.5)
    clay = bank((0.0, 20.0), cohesion="5 kPa")
    assert with_strengthened_load_ends(clay, 0.5) is clay


@pytest.mark.slow
def test_a_road_on_bare_sand_has_bounds_on_either_side_of_what_elements_find() -> None:
    """Elements: Kh = 0.259, factor of safety 1.781; no stress balanced the end of the load before, on any mesh."""
    wish = BoundsSettings(gap=0.1, max_cells=2000, seconds=30)
    bounds = kh_bounds(bank((5.0, 20.0)), FEM, wish)
    assert 0.24 < bounds.lower < 0.259 < bounds.upper < 0.285
    factor = safety_bounds(bank((5.0, 20.0)), FEM, wish.changed(gap=0.05), smooth_sides=True)
    assert 1.68 < factor.lower < 1.781 < factor.upper < 1.85
