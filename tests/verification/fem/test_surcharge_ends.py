"""Strict bounds where a surcharge ends on straight ground, with few triangles there."""

import pytest

from fem import kh_bounds
from fem.settings import BoundsSettings, FemSettings, Sides
from tests.support.water import section, soil


@pytest.mark.parametrize("sides", ["free-field", "smooth"])
def test_the_seismic_step_of_a_load_is_balanced_on_the_first_mesh(sides: Sides) -> None:
    """Two triangles at the end of a load on straight ground have six stresses there and six equations, of which one
    asks that the step of the load acts along the edge between them (the stresses are symmetric): no mesh had a lower
    bound on which two met, however fine, and "its stress is out of equilibrium by 4.2e-03" was told of all."""
    bank = section(
        soil("Loam", cohesion="5 kPa", friction_angle="30 deg", density="19 kN/m^3"),
        surface=[[0.0, 18.0], [30.0, 18.0], [50.0, 8.0], [90.0, 8.0]], base={"elevation": 0.0},
        water={"table": [[0.0, 14.0], [50.0, 8.0], [90.0, 8.0]]},
        surcharges=[{"from": 10.0, "to": 20.0, "pressure": "20 kPa"}],
    )  # fmt: skip
    settings = BoundsSettings(gap=0.05, max_cells=1500, davis=False)
    bounds = kh_bounds(bank, FemSettings(direction="downhill", sides=sides), settings)
    assert bounds.directions[0].meshes[0].lower is not None
    assert 0.95 * bounds.upper < bounds.lower < bounds.upper
