"""A strength that grows from a least value: triangles end at its kink, and strict bounds lose nothing there."""

import numpy as np
import pytest

from fem.limit.bounds import as_analysed
from fem.limit.first_mesh import first_mesh
from fem.limit.safety_bounds import safety_bounds
from fem.settings import BoundsSettings, FemSettings
from meshes.section.cutting import LEAST_STRENGTH, without_film
from meshes.section.least_strength import cut_at_least_strength
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section
from tests.support.water import soil

FEM = FemSettings(sides="smooth")


def slope(**changes: object) -> Section:
    """Soft clay of 16 kN/m³ with a face of 3:8 that is 6 m high, below water."""
    clay = {
        "cohesion": 0,
        "friction_angle": 0,
        "cohesion_minimum": "3 kPa",
        "density": "16 kN/m^3",
        "density_saturated": "16 kN/m^3",
        **changes,
    }
    return Section.parse(
        {
            "name": "delta",
            "surface": [[0.0, 6.0], [20.0, 6.0], [36.0, 0.0], [60.0, 0.0]],
            "base": {"elevation": -8.0},
            "water": {"table": 10.0},
            "strata": [soil("Clay", **clay)],
        }
    )


@pytest.mark.parametrize(
    ("growth", "depth"),
    [
        ({"strength_ratio": 0.25}, 3.0 / (0.25 * (16.0 - GRAVITY))),
        ({"cohesion_increase": "2 kPa/m", "cohesion_from": {"depth": 0.0}}, 1.5),
        ({"strength_ratio": 0.25, "cohesion": "1 kPa"}, 2.0 / (0.25 * (16.0 - GRAVITY))),
    ],
)
def test_clay_is_cut_where_it_has_more_than_its_least_strength(growth: dict[str, object], depth: float) -> None:
    section = slope(**growth)
    cut = cut_at_least_strength(section)
    upper, lower = cut.strata
    assert (upper.name, lower.name) == (f"Clay{LEAST_STRENGTH}", "Clay")
    assert without_film(upper.name) == "Clay"
    x = np.array([3.0, 25.0, 31.0, 55.0])
    levels = cut.layering.interfaces(x)
    assert levels[:, 0] - levels[:, 1] == pytest.approx(np.full(4, depth), abs=1e-4)


def test_ground_without_a_kink_is_left_as_it_is() -> None:
    for section in (slope(cohesion="5 kPa", strength_ratio=0.25), slope(cohesion="5 kPa", cohesion_minimum=None)):
        assert cut_at_least_strength(section) is section


def test_no_triangle_loses_strength_at_the_kink() -> None:
    """Across the kink a linear cohesion that is nowhere above the true one was 0 at the ground, or the least one."""
    cut = as_analysed(slope(strength_ratio=0.25), FEM)
    mesh = first_mesh(cut, 400, "smooth")
    corners = mesh.points[mesh.cells]
    low, high = (cut.cohesion_field.corners(corners, mesh.stratum, above) for above in (False, True))
    assert low == pytest.approx(high, rel=1e-3)


@pytest.mark.slow
def test_bounds_of_the_factor_of_tailings_are_close() -> None:
    """Elements: 1.363. On 5,126 triangles across the kink they were 0.533 and 1.362."""
    starter = {
        "cohesion": "2 kPa",
        "friction_angle": "36 deg",
        "density": "19 kN/m^3",
        "density_saturated": "20.5 kN/m^3",
    }
    tailings = {
        "cohesion": 0,
        "friction_angle": 0,
        "strength_ratio": 0.26,
        "cohesion_minimum": "3 kPa",
        "density": "17 kN/m^3",
        "density_saturated": "18.5 kN/m^3",
    }
    section = Section.parse(
        {
            "name": "tailings",
            "surface": [[0, 12], [20, 12], [64, 4], [72, 4], [84, 0], [120, 0]],
            "base": {"elevation": -6},
            "water": {"table": [[0, 11], [20, 8], [64, 1], [84, 0], [120, 0]]},
            "strata": [
                soil("Tailings", bottom={"elevation": 0}, **tailings),
                soil("Foundation", cohesion="20 kPa", friction_angle="30 deg", density="20 kN/m^3"),
            ],
            "zones": [{**soil("Starter", **starter), "points": [[64, 4], [72, 4], [84, 0], [55, 0]]}],
        }
    )
    bounds = safety_bounds(section, FEM, BoundsSettings(gap=0.05, max_cells=2000, seconds=30), smooth_sides=True)
    assert bounds.gap < 0.06
    assert 1.3 < bounds.lower < 1.363 < bounds.upper
