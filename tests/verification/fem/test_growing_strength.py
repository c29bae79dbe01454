"""Cohesion that grows with depth against a closed form."""

import numpy as np
import pytest
from mpi4py import MPI

from dem.laboratory.soil_layers import soil_layers
from fem.limit.bracket import Limits
from fem.limit.limit_problem import RigidPlasticBody, Side
from fem.limit.safety_bounds import safety_bounds
from fem.search.strength_reduction import safety_factor
from fem.settings import BoundsSettings, FemSettings
from meshes.gmsh_model import generate
from meshes.section.growth import evened
from meshes.section.section import Section
from meshes.settings import MeshSettings
from meshes.triangles import triangulate
from tests.support.bound_problems import FIXED, bracket
from tests.support.sections import layer, problems


def cut(**soil: object) -> dict[str, object]:
    """A vertical cut of 6 m down to rock, in clay with c = 5 kPa + 11 kPa/m z below its crest."""
    clay = {"cohesion": "5 kPa", "cohesion_increase": "11 kPa/m", "cohesion_from": 6.0, "friction_angle": 0,
            "bottom": {"elevation": 0.0}}  # fmt: skip
    rock = layer("rock", cohesion="5 MPa", friction_angle="0 deg")
    return {
        "name": "cut",
        "surface": [[-4.0, 0.0], [0.0, 0.0], [0.0, 6.0], [14.0, 6.0]],
        "base": {"elevation": -1.0},
        "strata": [layer("clay", **(clay | soil)), rock],
    }


def test_a_vertical_cut_in_ground_with_c_of_k_z_fails_at_gamma_of_2_k() -> None:
    """σv = γ z with no horizontal stress is carried while γ z <= 2 (c0 + k z); a wedge at 45° through the toe slides at
    γ = 2 k + 4 c0 / H: ∫ c ds = (c0 H + k H²/2) / sin 45° against γ H²/2 cos 45°. With c0 = 0 that is exact; a
    thousandth of kH is left here, for stress at a point without strength has no room. Measured: 2.0036 to 2.0043."""
    soil = layer("clay", cohesion=1.0, friction_angle="0 deg")
    body = {"name": "body", "surface": [[0.0, 1.0], [2.0, 1.0]], "base": {"elevation": 0.0}, "strata": [soil]}
    ground = RigidPlasticBody(
        cohesion=np.array([1.001]),
        friction=np.array([0.0]),
        dead_force=np.zeros((1, 2)),
        live_force=np.array([[0.0, -1.0]]),
        sides={"surface": Side(), "base": FIXED, "left": Side(), "right": FIXED},
        growth=np.array([1.0]),
    )
    found = bracket(triangulate(Section.parse({**body, "unusual": True}), 0.25), ground, Limits(0.02, 4000))
    assert 1.98 < found.lower <= 2.004
    assert 2.0 <= found.upper < 2.02


def test_elements_and_bounds_of_a_section_find_the_same() -> None:
    """k = 11 kPa/m, c0 = 5 kPa, H = 6 m, γ = 18.63 kN/m³: the wedge gives (2 k + 4 c0 / H) / γ = 1.3597, and what is
    best is hardly less. Measured: 1.355 to 1.383, and 1.3598 by elements."""
    section = Section.parse(cut())
    wedge = (22.0 + 20.0 / 6.0) / (1.9 * 9.80665)
    settings = FemSettings(sides="fixed", flow="associated")
    strict = safety_bounds(section, settings, BoundsSettings(gap=0.03, max_cells=3000))
    assert 0.97 * wedge < strict.lower <= wedge
    assert strict.upper < 1.03 * wedge
    mesh = generate(section, MeshSettings(size=0.5))
    assert safety_factor(section, mesh, settings, 0.0, MPI.COMM_SELF).factor == pytest.approx(wedge, rel=0.005)


def test_discs_have_the_cohesion_of_the_middle() -> None:
    """The clay is a rectangle, its middle 3 m below the crest."""
    section = Section.parse(cut())
    assert evened(section.strata, section.layering)[0].cohesion == pytest.approx(38e3)
    assert soil_layers(section)[0].stratum.cohesion == pytest.approx(38e3)
    assert any("its cohesion grows with depth" in text for text in section.notices)


@pytest.mark.parametrize(
    ("soil", "told"),
    [
        ({"cohesion_from": None}, "cohesion_increase without cohesion_from"),
        ({"cohesion_from": 4.0}, "cohesion_from = 4: expected an elevation that the stratum does not reach above"),
        ({"cohesion_increase": "5 kPa"}, "has the wrong dimension"),
    ],
)
def test_bad_growth(soil: dict[str, object], told: str) -> None:
    data = cut(**soil)
    data["strata"][0] = {key: value for key, value in data["strata"][0].items() if value is not None}
    assert told in "\n".join(problems(data))
