"""Points that the boundary conditions leave no stress, or no strain; and contacts that are all but straight."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from fem.continuum.face_reinforcement import strengthened
from fem.continuum.shallow_failure import shallow_failures
from fem.limit.adaptive_bounds import proven_lower_bound, proven_upper_bound
from fem.limit.bounds import as_analysed, kh_bounds
from fem.limit.bracket import Limits
from fem.limit.factor_search import FactorSearch
from fem.limit.factor_trial import FactorWork, TrialStart
from fem.limit.first_mesh import first_mesh
from fem.limit.limit_problem import LimitProblem, Side, limit_problem, units_of
from fem.limit.point_freedom import pressed_all_round, stress_free_corners, unstrained_points
from fem.limit.safety_bounds import safety_bounds
from fem.limit.section_body import body_of
from fem.settings import BoundsSettings, FemSettings
from meshes.section.section import Section
from meshes.triangles import triangulate
from tests.support import SECTIONS
from tests.support.bound_problems import FIXED, bracket, ground, rectangles
from tests.support.sections import layer, slope

SIDES = {"footing": Side(), "surface": Side(), "left": FIXED, "right": FIXED, "base": FIXED}


def box(phi: float, cohesion: float = 1.0) -> LimitProblem:
    """A square block of 2 by 2 m, held but for its top, in eight triangles before corners are split."""
    body = ground(cohesion, phi, SIDES, weight=1.0)
    mesh = rectangles([0.0, 1.0, 2.0], [0.0, 1.0, 2.0])
    return limit_problem(mesh, body, units_of(mesh, replace(body, dead_force=body.live_force)))


@pytest.mark.parametrize(("phi", "corners"), [(0, 0), (30, 0), (42, 0), (46, 2), (50, 2)])
def test_a_held_right_angle_cannot_strain_from_45_degrees_on(phi, corners):
    """With one cell on either edge, the velocity between them has to lie within 90° - φ of both normals."""
    problem = box(phi)
    values = unstrained_points(problem)
    assert np.count_nonzero(values) == corners
    assert set(problem.points[values][:, 1]) <= {0.0}


def test_a_bare_surface_without_cohesion_has_no_stress():
    problem = box(30.0, cohesion=0.0)
    free = stress_free_corners(problem)
    top = problem.points[problem.mesh.cells][..., 1] == 2.0
    assert np.array_equal(free, top)
    assert not stress_free_corners(box(30.0)).any()


def test_clay_without_strength_at_the_ground_has_no_stress_there_and_an_equal_pressure_below_a_load() -> None:
    """s_u = 0.25 σ'v of bare ground vanishes at its surface: what no traction holds is free of stress, and below a load
    that has not consolidated it the pressure is the same all round."""
    clay = layer("clay", cohesion=0, friction_angle=0, strength_ratio=0.25)
    data = {**slope(), "surcharges": [{"from": 20.0, "to": 60.0, "pressure": "5 kPa"}], "strata": [clay]}
    section, settings = Section.parse(data), FemSettings(sides="smooth")
    mesh = first_mesh(section, 400, "smooth")
    body = body_of(section, mesh, settings)
    problem = limit_problem(mesh, body, units_of(mesh, body))
    there, free = pressed_all_round(problem), stress_free_corners(problem)
    points = problem.points[problem.mesh.cells]
    ground = np.interp(points[..., 0], *section.ground.T)
    assert np.array_equal(there, np.isclose(points[..., 1], ground))
    loaded = there & (points[..., 0] > 20.1) & (points[..., 0] < 59.9)
    assert loaded.any()
    assert not free[loaded].any()
    assert free[there & ((points[..., 0] < 19.9) | (points[..., 0] > 60.1))].all()


def test_normally_consolidated_clay_under_water_is_bracketed() -> None:
    """An endless slope of s_u = S σ'v fails at every depth at once: γ' z S = γ' z sin β cos β + Kh γ z cos² β, and its
    factor of safety is S / (sin β cos β). Its strength vanishes at the ground, where stresses had no room before."""
    soil = {key: value for key, value in layer("clay").items() if not key.startswith("density")}
    clay = {**soil, "density": "15.5 kN/m^3", "cohesion": 0, "friction_angle": 0, "strength_ratio": 0.25}
    data = {
        "name": "delta",
        "surface": [[0.0, -5.0], [40.0, -12.0]],
        "base": {"elevation": [[0.0, -25.0], [40.0, -32.0]]},
        "water": {"table": 0.0, "unit_weight": "9.81 kN/m^3"},
        "strata": [clay],
    }
    section, angle = Section.parse(data), np.arctan(7.0 / 40.0)
    fem, limits = FemSettings(sides="periodic", direction="downhill"), BoundsSettings(max_cells=600, gap=0.005)
    bounds, factor = kh_bounds(section, fem, limits), safety_bounds(section, fem, limits)
    kc = (15.5 - 9.81) / 15.5 * (0.25 - np.sin(angle) * np.cos(angle)) / np.cos(angle) ** 2
    assert bounds.lower <= kc <= bounds.upper <= bounds.lower + 0.005
    assert factor.lower <= 0.25 / (np.sin(angle) * np.cos(angle)) <= factor.upper <= 1.01 * factor.lower


def assert_no_stress_where_the_contact_comes_out(strata: list[dict[str, Any]], cells: int) -> None:
    """On a face of 1:3, whose two strata meet at (12, 6): sand has no stress there, and a lower bound holds."""
    data = {"name": "touch", "surface": [[0, 10], [24, 2]], "base": {"elevation": 0}, "strata": strata}
    section, settings = Section.parse(data), FemSettings(sides="fixed")
    strong = strengthened(section, shallow_failures(section, settings), settings)
    mesh = first_mesh(strong, cells)
    body = body_of(strong, mesh, settings, davis=False)
    problem = limit_problem(mesh, body, units_of(mesh, body))
    touches = np.isclose(problem.points[problem.mesh.cells], [12.0, 6.0]).all(axis=2) & (problem.cohesion == 0.0)
    assert touches.any()
    assert np.all(stress_free_corners(problem)[touches])
    _, notes, stress = proven_lower_bound(problem)
    assert stress is not None
    assert not notes


def test_sand_that_touches_the_surface_between_two_strips_has_no_stress_there():
    """Both strips have a stress along the face, of the same size: the sand between them would have just that, too."""
    upper = layer("upper", cohesion=0, friction_angle="33 deg", bottom={"elevation": [[0, 8], [12, 6]]})
    lower = layer("lower", cohesion=0, friction_angle="33 deg")
    assert_no_stress_where_the_contact_comes_out([upper, lower], 3000)


def test_sand_below_clay_whose_pore_pressure_ends_at_the_ground_has_no_stress_there() -> None:
    """Pore pressure jumps along the contact and is zero, to rounding, where the contact comes out of the face, so
    that tractions are continuous there. Without this condition the stress lay 7e-07 beyond the yield surface.
    """
    contact = {"elevation": [[0, 6], [24, 6]]}
    clay = layer("clay", cohesion="20 kPa", friction_angle=0, pore_pressure_ratio=0.3, bottom=contact)
    sand = layer("sand", cohesion=0, friction_angle="33 deg")
    assert_no_stress_where_the_contact_comes_out([clay, sand], 300)


@pytest.mark.parametrize("noise", [1e-9, 1e-8, 1e-7, 1e-5])
def test_contacts_that_are_all_but_straight_do_not_cost_the_bounds(noise):
    """Edges of bisected triangles go on straight through their middles; here they have a kink of ``noise`` m."""
    section = Section.parse(slope())
    mesh = triangulate(section, 4.0)
    body = body_of(section, mesh, FemSettings(sides="fixed"), davis=False)
    text = bracket(mesh, body, Limits(gap=0.5, max_cells=400))
    inner = np.ones(len(text.mesh.points), dtype=bool)
    inner[text.mesh.edges[text.mesh.edge_cells[:, 1] < 0]] = False
    shift = noise * np.random.default_rng(1).uniform(-1.0, 1.0, text.mesh.points.shape) * inner[:, None]
    seismic = replace(text.mesh, points=text.mesh.points + shift)
    problem = limit_problem(seismic, body, units_of(seismic, body))
    (_, _, stress), (_, _, mechanism) = proven_lower_bound(problem), proven_upper_bound(problem)
    assert stress is not None
    assert mechanism is not None
    assert stress.multiplier == pytest.approx(text.meshes[-1].lower, rel=0.02)
    assert mechanism.multiplier == pytest.approx(text.meshes[-1].upper, rel=1e-3)


@pytest.mark.parametrize("sides", ["fixed", "free-field"])
def test_a_slope_of_46_degrees_of_friction_has_both_bounds(sides):
    data = Section.read(SECTIONS / "slope_2to1.toml").model_dump(exclude_none=True, by_alias=True)
    data["strata"][0]["friction_angle"] = "46 deg"
    bounds = kh_bounds(Section.parse(data), FemSettings(sides=sides), BoundsSettings(gap=0.1, max_cells=4000))
    assert bounds.gap <= 0.1


@pytest.mark.parametrize("factor", [0.845, pytest.param(0.95, marks=pytest.mark.slow)])
def test_ground_whose_side_hardly_strains_at_a_point_has_a_mechanism(factor: float) -> None:
    """On the left side of S-13 a layer of sand meets clay: the slack there is 0.018 and 0.0203 at these factors."""
    fem = FemSettings()
    section = as_analysed(Section.read(SECTIONS / "s13.toml"), fem)
    start = TrialStart(0.3, factor, False)
    mesh = first_mesh(section, 8000, fem.sides)
    search = FactorSearch(section, mesh, fem, BoundsSettings(), 1, start, FactorWork(20.0))
    upper = search.measure(factor, lower=False).upper
    assert upper is not None
    assert upper < 0.4
