"""Ground that water under pressure lifts: bounds and elements against a block that is punched out, and what is told."""

from typing import Any

import pytest
from mpi4py import MPI

from fem.continuum.loads import soils
from fem.errors import NoEquilibriumError, UnstableError
from fem.limit.bounds import kh_bounds
from fem.limit.safety_bounds import safety_bounds
from fem.search import critical
from fem.search.assessment import assess
from fem.search.strength_reduction import limit_load_safety_factor
from fem.settings import BoundsSettings, FemSettings
from meshes.gmsh_model import generate
from meshes.section.section import Section
from meshes.settings import MeshSettings
from tests.support.water import WATER, section, soil

FIXED = FemSettings(sides="fixed", flow="associated")


def above_a_lens(half_width: float, level: float, cohesion: float) -> Section:
    """Level clay, with a lens of sand without cohesion 2 m deep under a level of its own."""
    clay = {"cohesion": f"{cohesion} kPa", "friction_angle": "0 deg", "density": "18 kN/m^3", "density_saturated": None}
    ends: Any = [[-half_width, -2.5], [half_width, -2.5]]
    sand = soil("Sand", cohesion=0.0, friction_angle="33 deg", bottom={"elevation": ends}, piezometric_level=level)
    layers = [soil("Cover", bottom={"depth": 2.0}, **clay), sand, soil("Clay", **clay)]
    return section(*layers, surface=[[-15.0, 0.0], [15.0, 0.0]], base={"elevation": -6.0})


@pytest.mark.slow
def test_no_bound_is_above_the_block_that_is_punched_out() -> None:
    """Cover above the lens moves up as a block: 2 c t on its two sides against (u - γ t) b. What more weight would hold
    down is no share of loads that is borne: a lower bound was 0.624 for a block lifted at 0.614 (and ground that
    fails at 0.45 to 0.47)."""
    ground = above_a_lens(5.0, 3.0, 20.0)
    block = 2.0 * 2.0 * 20e3 / (10.0 * (5.0 * WATER - 2.0 * 18e3))
    bounds = safety_bounds(ground, FIXED, BoundsSettings(gap=0.2, max_cells=1000), smooth_sides=True)
    assert 0.3 * block < bounds.lower <= block
    elements = limit_load_safety_factor(ground, generate(ground, MeshSettings(size=0.8)), FIXED, 0.0, MPI.COMM_SELF)
    assert 0.97 * bounds.lower <= elements.factor <= 1.04 * bounds.upper


def test_ground_that_blows_out_is_told_by_how_much_it_is_lifted() -> None:
    """Not by a Kh of -3.4e4, nor by a factor of safety that its strength has little part in."""
    ground = above_a_lens(5.0, 3.0, 20.0)
    with pytest.raises(UnstableError, match=r"49\.0 kPa under a total vertical stress of 36\.0 kPa .*uplift 0\.73"):
        kh_bounds(ground, FIXED, BoundsSettings(gap=0.2, max_cells=800))
    meshing = MeshSettings(size=0.8)
    with pytest.raises(UnstableError, match=r"in \"Sand\" exceeds the weight above it, .*uplift 0\.73"):
        assess(ground, meshing, generate(ground, meshing), FIXED, MPI.COMM_SELF, lambda *_: None)


def test_ground_that_its_strength_holds_down_has_an_answer_and_a_warning() -> None:
    ground = above_a_lens(1.0, 3.0, 60.0)
    meshing = MeshSettings(size=0.8)
    one_mesh = FIXED.model_copy(update={"accuracy": 0.0})
    assessment = assess(ground, meshing, generate(ground, meshing), one_mesh, MPI.COMM_SELF, lambda *_: None)
    assert assessment.critical.kc > 0.0
    assert any(
        warning.contradiction and "factor against uplift 0.73" in warning.observation for warning in assessment.warnings
    )


def test_ground_that_is_lifted_is_told_so_where_the_iteration_does_not_converge(monkeypatch) -> None:
    """The water that lifts the ground was not named, and another size of the mesh was asked for."""

    def stuck(*_: Any) -> None:
        raise UnstableError("the section fails under its own weight")

    ground, meshing = above_a_lens(1.0, 3.0, 60.0), MeshSettings(size=0.8)
    one_mesh, mesh = FIXED.model_copy(update={"accuracy": 0.0}), generate(ground, meshing)
    monkeypatch.setattr(critical, "bring_to_rest", stuck)
    with pytest.raises(NoEquilibriumError, match=r"up to Kh = .* exceeds the weight above it, .*relieve the pressure"):
        assess(ground, meshing, mesh, one_mesh, MPI.COMM_SELF, lambda *_: None)


def test_bare_sand_whose_water_would_rise_above_it_cannot_stand() -> None:
    sand = soil("Sand", cohesion=0.0, friction_angle="33 deg", piezometric_level=11.0)
    with pytest.raises(UnstableError, match="there is no equilibrium: the pore pressure"):
        soils(section(sand))
