"""One period of an endless slope, its sides periodic, in water: against closed forms."""

import math
from typing import Any

import numpy as np
import pytest
from mpi4py import MPI

from fem.continuum.fields import touched_sides
from fem.continuum.repetition import refuse_other_water
from fem.limit.bounds import kh_bounds
from fem.limit.safety_bounds import safety_bounds
from fem.limit_load.limit_load import critical_limit_load
from fem.search.checks import warnings_of
from fem.search.critical import critical_coefficient
from fem.search.strength_reduction import limit_load_safety_factor, safety_factor
from fem.settings import LEAST_KH, BoundsSettings, FemSettings
from meshes.errors import InputError
from meshes.gmsh_model import generate
from meshes.section.section import Section
from meshes.settings import MeshSettings
from tests.support.water import WATER, section, soil

PERIODIC = FemSettings(sides="periodic", flow="associated", direction="downhill", kh=())
MESH = MeshSettings(columns=4, rows=48)
FALL = 0.25
DEPTH = 6.0


def endless(level: Any, **changes: Any) -> Section:
    """Soil of 6 m on a base parallel to ground that falls 5 m in 20 m."""
    ground = {"surface": [[0.0, 5.0], [20.0, 0.0]], "base": {"depth": DEPTH}}
    return section(soil(**changes), **ground, water={"table": level})


def closed_form(cohesion: float, phi: float, water: float = WATER) -> tuple[float, float]:
    """Critical Kh and factor of safety of an endless slope under still water that slides on its base: the weight of its
    soil, 20 kN/m³, is buoyant, its mass that of all of it."""
    beta, tan = math.atan(FALL), math.tan(math.radians(phi))
    sin, cos = math.sin(beta), math.cos(beta)
    buoyant = (20e3 - water) * DEPTH
    factor = (cohesion + buoyant * cos**2 * tan) / (buoyant * sin * cos)
    return (cohesion + buoyant * (cos**2 * tan - sin * cos)) / (20e3 * DEPTH * (cos**2 + sin * cos * tan)), factor


@pytest.mark.parametrize("level", [9.0, 40.0])
@pytest.mark.parametrize(("cohesion", "phi"), [(20.0, 0.0), (5.0, 20.0)])
def test_an_endless_slope_under_still_water_is_one_of_buoyant_soil(level: float, cohesion: float, phi: float) -> None:
    """However deep the water, though its pressure is 49 kPa larger at the lower end. The stress of the lowest elements
    is that of a place above the base."""
    ground = endless(level, cohesion=f"{cohesion} kPa", friction_angle=f"{phi} deg")
    mesh = generate(ground, MESH)
    kc, factor = closed_form(1e3 * cohesion, phi)
    limit_load_result = critical_limit_load(ground, mesh, PERIODIC, MPI.COMM_SELF)
    assert limit_load_result.kc == pytest.approx(kc, rel=0.02)
    assert limit_load_result.mechanism is not None
    assert touched_sides(mesh, limit_load_result.mechanism) == ()  # it goes on past both sides
    assert limit_load_safety_factor(ground, mesh, PERIODIC, 0.0, MPI.COMM_SELF).factor == pytest.approx(
        factor, rel=0.01
    )


def test_the_path_of_equilibria_comes_there_too() -> None:
    ground = endless(12.0, cohesion="5 kPa", friction_angle="20 deg", dilation_angle="20 deg")
    mesh, path = generate(ground, MESH), PERIODIC.model_copy(update={"element": "quadratic", "flow": "non-associated"})
    kc, factor = closed_form(5e3, 20.0)
    critical_result = critical_coefficient(ground, mesh, path, MPI.COMM_SELF)
    assert critical_result.kc == pytest.approx(kc, rel=0.03)
    assert not any("side" in warning.observation for warning in warnings_of(critical_result, mesh))
    assert safety_factor(ground, mesh, path, 0.0, MPI.COMM_SELF).factor == pytest.approx(factor, rel=0.03)


@pytest.mark.slow
def test_fifteen_layers_of_soft_clay_under_a_deep_sea() -> None:
    """su = 2 + 1.5 z, in the middle of each metre: the last one slides on the base, at Kh = 0.0724 and a factor of
    safety of 3.684, 23.75 kPa over γ' z sin β cos β. Elements of half a metre see the stress of their middle."""
    height = 60.0 * math.tan(math.radians(4.0))
    clay: dict[str, Any] = {"friction_angle": "0 deg", "density": "16 kN/m^3", "density_saturated": "16 kN/m^3"}
    layers = [
        soil(f"Clay {k + 1}", cohesion=f"{2.75 + 1.5 * k} kPa", bottom={"depth": k + 1.0} if k < 14 else None, **clay)
        for k in range(15)
    ]
    ground = section(*layers, surface=[[0.0, height], [60.0, 0.0]], base={"depth": 15.0}, water={"table": 24.0})
    mesh = generate(ground, MeshSettings(size=0.5))
    assert critical_limit_load(ground, mesh, PERIODIC, MPI.COMM_SELF).kc == pytest.approx(0.0724, rel=0.012)
    assert limit_load_safety_factor(ground, mesh, PERIODIC, 0.0, MPI.COMM_SELF).factor == pytest.approx(
        3.684, rel=0.006
    )


@pytest.mark.parametrize(
    ("cohesion", "phi", "level"),
    [pytest.param(20.0, 0.0, 9.0, marks=pytest.mark.slow), (5.0, 20.0, 40.0), (5.0, 20.0, None)],
)
def test_bounds_of_one_period_bracket_the_endless_slope(cohesion: float, phi: float, level: float | None) -> None:
    """Its lower bound is the closed form to 0.1 %: a stress that is linear with depth is one of its own."""
    ground = endless(level or -20.0, cohesion=f"{cohesion} kPa", friction_angle=f"{phi} deg", density="20 kN/m^3")
    kc, factor = closed_form(1e3 * cohesion, phi, WATER if level else 0.0)
    wish = BoundsSettings(gap=0.06, max_cells=2500, davis=False)
    of_kh = wish.model_copy(
        update={"gap": min(0.06, 0.06 * kc / LEAST_KH)}
    )  # a share of a Kh of 0.2 where it is smaller
    bounds = kh_bounds(ground, PERIODIC, of_kh)
    assert 0.999 * kc < bounds.lower <= kc * (1.0 + 1e-9)
    assert kc <= bounds.upper < 1.08 * kc
    safety = safety_bounds(ground, PERIODIC, wish, guess=factor)
    assert 0.99 * factor < safety.lower <= factor * (1.0 + 1e-9)
    assert factor <= safety.upper < 1.08 * factor


def test_bounds_of_one_period_bracket_elements_where_layers_and_ground_are_not_straight() -> None:
    """A bench half-way, another soil in a lens below it, and the same edges on both sides after every refinement."""
    lens: Any = [[4.0, -1.0], [7.0, -3.2], [14.0, -3.2], [17.0, -2.5]]
    soft = soil("Soft", cohesion="8 kPa", friction_angle="18 deg", bottom={"elevation": lens})
    ground = section(
        soil("Crust", bottom={"depth": 1.5}), soft, soil("Rest"), water={"table": 8.0}, base={"depth": DEPTH},
        surface=[[0.0, 5.0], [8.0, 2.0], [12.0, 2.0], [20.0, 0.0]],
    )  # fmt: skip
    bounds = kh_bounds(ground, PERIODIC, BoundsSettings(gap=0.1, max_cells=4000, davis=False))
    left, right = bounds.mesh.matched
    shift = bounds.mesh.points[right] - bounds.mesh.points[left]
    assert len(left) > 3
    np.testing.assert_allclose(shift, np.broadcast_to([20.0, -5.0], shift.shape), atol=1e-9)
    elements = critical_limit_load(ground, generate(ground, MeshSettings(size=0.5)), PERIODIC, MPI.COMM_SELF).kc
    assert 0.98 * bounds.lower < elements < 1.03 * bounds.upper
    assert bounds.upper < 1.15 * bounds.lower


def test_a_lens_within_one_soil_of_an_endless_slope_is_taken() -> None:
    """The soil is a first part at the left of the lens and a second part at its right, which was refused as other
    layers. A lens with the strength of its surroundings has the closed form of an endless dry slope."""
    alike = {"cohesion": "5 kPa", "friction_angle": "20 deg", "density": "20 kN/m^3", "density_saturated": None}
    lens = soil("Lens", **alike, points=[[6.0, 1.5], [12.0, 0.2], [12.0, -1.0], [6.0, -0.5]])
    ground = section(soil(**alike), surface=[[0.0, 5.0], [20.0, 0.0]], base={"depth": DEPTH}, water=None, zones=[lens])
    assert len(ground.strata) == 3
    kc, _ = closed_form(5e3, 20.0, 0.0)
    bounds = kh_bounds(ground, PERIODIC, BoundsSettings(gap=0.06, max_cells=2500, davis=False))
    assert 0.97 * kc < bounds.lower <= kc * (1.0 + 1e-9)
    assert kc <= bounds.upper < 1.08 * kc
    elements = critical_limit_load(ground, generate(ground, MeshSettings(size=0.5)), PERIODIC, MPI.COMM_SELF).kc
    assert elements == pytest.approx(kc, rel=0.02)
    other = soil("Lens", **{**alike, "points": [[14.0, 0.5], [30.0, -2.0], [30.0, -3.0], [14.0, -1.0]]})
    cut = section(soil(**alike), surface=[[0.0, 5.0], [20.0, 0.0]], base={"depth": DEPTH}, water=None, zones=[other])
    with pytest.raises(InputError, match="the left and right sides differ"):
        kh_bounds(cut, PERIODIC, BoundsSettings(gap=0.5, max_cells=400, davis=False))


@pytest.mark.parametrize("changes", [{}, {"excess_pore_pressure_ratio": 0.3}, {"pore_pressure_ratio": 0.3}])
def test_water_that_repeats_with_the_ground_is_taken(changes: dict[str, Any]) -> None:
    for level in ({"depth": 2.0}, [[0.0, 8.0], [20.0, 3.0]]):
        refuse_other_water(endless(level, **changes))


def test_a_shore_in_the_middle_of_what_repeats_is_refused() -> None:
    """After a drawdown to mid-height the pore pressures at the sides differ by one constant, those of 1 m of water on
    the lower side: the next slope below would begin under as much, and its shore would not be where this one's is."""
    ground = section(
        surface=[[0.0, 5.0], [20.0, 0.0]], base={"depth": DEPTH}, water={"table": 8.0, "after_drawdown": 1.0}
    )
    with pytest.raises(InputError, match="the water is 0 m deep at the left side and 1 m at the right one"):
        refuse_other_water(ground)


@pytest.mark.parametrize("level", [2.0, [[0.0, 4.0], [20.0, 0.0]], [[0.0, 8.0], [20.0, -2.0]]])
def test_water_that_does_not_repeat_is_refused(level: Any) -> None:
    ground = endless(level)
    with pytest.raises(
        InputError, match=r'sides = "periodic": the pore pressure changes from the left to the right side by'
    ):
        critical_limit_load(ground, generate(ground, MeshSettings(size=1.0)), PERIODIC, MPI.COMM_SELF)


def test_an_embankment_under_a_lake_may_stand_between_ends_of_one_height() -> None:
    bank = [[0.0, 0.0], [10.0, 0.0], [20.0, 5.0], [30.0, 0.0], [40.0, 0.0]]
    ground = section(soil(), surface=bank, base={"elevation": -3.0}, water={"table": 7.0})
    limit_load_result = critical_limit_load(ground, generate(ground, MeshSettings(size=1.0)), PERIODIC, MPI.COMM_SELF)
    assert np.isfinite(limit_load_result.kc)
