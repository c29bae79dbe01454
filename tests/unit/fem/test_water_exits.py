"""Water that comes out of a face of bare sand: the sand around that point is given a cohesion, and the bounds close."""

import numpy as np
import pytest

from fem.continuum.load_ends import POINT_SUFFIX, soil_of_strip, with_cohesion_around
from fem.continuum.shallow_failure import faces_at, shallow_failures
from fem.continuum.water_exits import exits_of_directions, water_exits
from fem.limit.bounds import LEAST_KH, kh_bounds
from fem.settings import BoundsSettings, FemSettings
from meshes.section.section import Section
from tests.support.water import soil

FEM = FemSettings(sides="smooth", direction="downhill")
POND = 22.0  # x where the pond meets the face (m)


def bank(slope_of_table: float = 0.3, **changes: object) -> Section:
    """Sand of φ = 35° with a face of 2:5 on soft clay, and a pond at 40 % of its height."""
    sand = soil("Sand", **{"cohesion": 0, "friction_angle": "35 deg", "bottom": {"elevation": 0.0}, **changes})
    clay = soil("Clay", cohesion="30 kPa", friction_angle=0)
    inside = 3.2 + slope_of_table * POND
    return Section.parse(
        {
            "name": "bank",
            "surface": [[0.0, 8.0], [10.0, 8.0], [30.0, 0.0], [50.0, 0.0]],
            "base": {"elevation": -5.0},
            "water": {"table": [[0.0, inside], [POND, 3.2], [50.0, 3.2]]},
            "strata": [sand, clay],
        }
    )


def test_the_sand_around_the_edge_of_the_pond_has_the_cohesion_of_a_strengthened_face() -> None:
    """γ d sin 2β / (2 cos² φ) of the face above the pond, the larger one. Below its middle 0.25 m are dry, and 0.25 m
    under water that stands there."""
    section = bank()
    faces = shallow_failures(section, FEM)
    exits = water_exits(section, faces, FEM.least_depth)
    [(x, cohesion)] = exits.items()
    slope, friction = np.arctan(0.4), np.radians(35.0)
    assert x == pytest.approx(POND)
    share = (18.0 + 20.0 - 9.80665) / (18.0 + 20.0)
    assert cohesion == pytest.approx(share * 18e3 * 0.5 * np.sin(2.0 * slope) / (2.0 * np.cos(friction) ** 2))
    strong = with_cohesion_around(section, exits, FEM.least_depth)
    names = [stratum.name for stratum in strong.strata if POINT_SUFFIX in stratum.name]
    assert names
    assert {soil_of_strip(name).removesuffix(", below water") for name in names} == {"Sand"}


@pytest.mark.parametrize("changes", [{"cohesion": "2 kPa"}, {"friction_angle": 0, "cohesion": "20 kPa"}])
def test_ground_with_cohesion_needs_none(changes: dict[str, object]) -> None:
    section = bank(**changes)
    exits = water_exits(section, faces_at(section, FEM, 0.1), FEM.least_depth)
    assert with_cohesion_around(section, exits, FEM.least_depth) is section


def test_the_bounds_close_although_water_comes_out_of_bare_sand() -> None:
    """The few triangles at the edge of the pond kept the lower bound at -0.03 with 809 to 3,986 of them."""
    bounds = kh_bounds(bank(0.36), FEM, BoundsSettings(gap=0.06, max_cells=3000, davis=False))
    assert bounds.shallow_failures == ()
    assert bounds.water_exits == pytest.approx((POND,))
    assert bounds.end_reason == "gap"
    assert bounds.upper - bounds.lower < 0.06 * LEAST_KH
    assert bounds.lower > 0.0


def test_water_that_comes_out_of_the_other_face_leaves_a_lower_bound() -> None:
    """A dam of sand: with the force downslope no stress was in equilibrium at the edge of its pond, at any size of the
    triangles, and all bounds were lost with this one."""
    shell = soil("Shell", **{"cohesion": 0, "friction_angle": "36 deg", "bottom": {"elevation": 0.0}})
    ground = soil("Ground", cohesion="20 kPa", friction_angle="30 deg")
    dam = Section.parse(
        {
            "name": "dam",
            "surface": [[0.0, 0.0], [12.0, 0.0], [32.0, 10.0], [36.0, 10.0], [56.0, 0.0], [70.0, 0.0]],
            "base": {"elevation": -4.0},
            "water": {"table": [[0.0, 8.0], [28.0, 8.0], [36.0, 4.0], [54.0, 1.0], [70.0, 1.0]]},
            "strata": [shell, ground],
        }
    )
    exits, opposite = exits_of_directions(dam, FEM)
    assert (list(exits), list(opposite)) == ([pytest.approx(54.0)], [pytest.approx(28.0)])
    other = exits_of_directions(dam, FEM.changed(direction="uphill"))
    assert other == (opposite, exits)
    bounds = kh_bounds(dam, FEM, BoundsSettings(gap=0.5, max_cells=1500, davis=False))
    assert bounds.lower > 0.0
