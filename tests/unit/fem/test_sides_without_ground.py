"""Ground that ends before its sides: no stress at rest acts there, and its last face is in the open."""

import pytest
from mpi4py import MPI

from fem.limit.bounds import kh_bounds
from fem.limit_load.limit_load import critical_limit_load
from fem.search.strength_reduction import limit_load_safety_factor
from fem.settings import BoundsSettings, FemSettings
from meshes.gmsh_model import generate
from meshes.section.section import Section
from meshes.settings import MeshSettings
from tests.support.water import soil


@pytest.mark.parametrize("direction", ["downhill", pytest.param("uphill", marks=pytest.mark.slow)])
def test_a_mound_on_rock_has_a_critical_kh_within_its_bounds(direction: str) -> None:
    """Both ways it is the same; free-field sides, which have no height, ended in an IndexError."""
    mound = {"surface": [[0.0, 0.0], [12.0, 5.0], [18.0, 5.0], [30.0, 0.0]], "base": {"elevation": 0.0}}
    clay = soil("Clay", cohesion="15 kPa", friction_angle="0 deg", density="1.8 t/m^3")
    section = Section.parse({"name": "mound", **mound, "strata": [clay]})
    fem = FemSettings(direction=direction, flow="associated")
    bounds = kh_bounds(section, fem, BoundsSettings(gap=0.05, max_cells=2500, davis=False))
    mesh = generate(section, MeshSettings(method="free", size=0.4))
    kh = critical_limit_load(section, mesh, fem, MPI.COMM_SELF).kc
    assert bounds.lower < kh < 1.03 * bounds.upper
    assert bounds.upper < 1.08 * bounds.lower


def test_a_vertical_cut_on_bare_rock_has_the_factor_of_a_vertical_cut() -> None:
    """γ H / c = 3.776 (upper bound 3.786 and lower 3.772, Pastor, Thore & Pastor 2009); its face was held as a side."""
    cut = {"surface": [[0.0, 4.0], [14.0, 4.0], [14.0, 0.0], [20.0, 0.0]], "base": {"elevation": 0.0}}
    clay = soil("Clay", cohesion="20 kPa", friction_angle="0 deg", density="18 kN/m^3")
    section = Section.parse({"name": "cut", **cut, "strata": [clay]})
    mesh = generate(section, MeshSettings(size=0.25))
    assert not len(mesh.boundaries["right"])
    safety_factor = limit_load_safety_factor(section, mesh, FemSettings(flow="associated"), 0.0, MPI.COMM_SELF)
    assert safety_factor.factor == pytest.approx(3.776 * 20.0 / (18.0 * 4.0), rel=0.04)
