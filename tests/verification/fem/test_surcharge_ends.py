"""Elements and strict bounds where a surcharge ends on straight ground, or beside the edge of a crest."""

import pytest
from mpi4py import MPI

from fem import kh_bounds
from fem.search.adaptive import AdaptiveSearch
from fem.settings import BoundsSettings, FemSettings, Sides
from meshes.gmsh_model import generate
from meshes.section.section import Section
from meshes.settings import MeshSettings
from tests.support.water import section, soil


@pytest.mark.parametrize("sides", [pytest.param("free-field", marks=pytest.mark.slow), "smooth"])
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


def test_elements_of_an_embankment_of_sand_carry_a_load_up_to_its_edge() -> None:
    """Traffic half a metre from the edge of the crest: sand without cohesion bears nothing at the end of the load. The
    elements had no cohesion there, unlike the bounds, and 1 m of sand slipped at a factor of safety of 0.92: there was
    no answer for an embankment whose factor of safety is 1.75 (circles 1.73)."""
    sand = soil("Fill", cohesion="0 kPa", friction_angle="36 deg", density="19.3 kN/m^3", bottom={"elevation": 0.0})
    clay = soil("Clay", cohesion="40 kPa", friction_angle="0 deg", density="16 kN/m^3")
    surface = [[0.0, 0.0], [20.0, 0.0], [28.0, 4.0], [39.0, 4.0], [47.0, 0.0], [67.0, 0.0]]
    load = {"from": 28.5, "to": 38.5, "pressure": "10 kPa"}
    data = {"name": "fill", "surface": surface, "base": {"elevation": -6.0}, "strata": [sand, clay]}
    section, fem = Section.parse({**data, "surcharges": [load]}), FemSettings(direction="downhill", accuracy=0.0)
    mesh = generate(section, MeshSettings())
    factor = AdaptiveSearch(section, MeshSettings(), mesh, MPI.COMM_SELF).safety(fem, 0.0)
    assert 1.7 < factor.result.factor < 1.8
    bounds = kh_bounds(section, fem, BoundsSettings(gap=0.05, max_cells=4000, davis=False))
    critical = AdaptiveSearch(section, MeshSettings(), mesh, MPI.COMM_SELF).critical(fem)
    assert bounds.lower < critical.result.kc < 1.02 * bounds.upper
