"""Layers that are thinner than cells, one on the other, cut by water, or ending in a step: no cell is a sliver."""

from pathlib import Path

import pytest

from meshes.gmsh_model import generate
from meshes.quality import corner_angles
from meshes.section.section import Section
from meshes.settings import MeshSettings
from tests.support.water import section, soil

LEVEE = Path(__file__).parents[2] / "support/levee/levee.toml"


def narrowest(inputs: Section) -> float:
    mesh = generate(inputs, MeshSettings(method="free"))
    assert mesh.stratum_areas().sum() == pytest.approx(inputs.layering.areas().sum(), rel=1e-3)
    return float(corner_angles(mesh.points, mesh.cells).min())


def test_the_levee_has_no_sliver_where_its_water_meets_the_crust() -> None:
    """Half a metre of crust above the water and half a metre below it: 12.9 degrees before."""
    assert narrowest(Section.read(LEVEE)) > 15.0


def test_the_short_end_of_a_wedge_beside_a_side_is_left_out_and_told() -> None:
    """A wedge that comes up 60 cm before the right side, 2 cm thick there: 4 degrees before."""
    wedge = soil("Crust", bottom={"elevation": [[0.0, 8.0], [41.0, 2.02], [59.4, 2.02], [60.0, 1.98]]})
    ground = section(wedge, soil("Clay"))
    assert narrowest(ground) > 15.0
    assert any("Crust" in text for text in MeshSettings(method="free").notices(ground))
