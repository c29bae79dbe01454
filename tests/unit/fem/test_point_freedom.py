"""Points that the boundary conditions leave no stress, or no strain; and contacts that are all but straight."""

from dataclasses import replace

import numpy as np
import pytest

from fem.continuum.shallow_failure import shallow_failures, strengthened
from fem.limit.adaptive_bounds import proven_lower_bound, proven_upper_bound
from fem.limit.bounds import body_of, first_mesh, kh_bounds
from fem.limit.bracket import Limits
from fem.limit.limit_problem import LimitProblem, Side, limit_problem, units_of
from fem.limit.point_freedom import stress_free_corners, unstrained_points
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
    found = unstrained_points(problem)
    assert np.count_nonzero(found) == corners
    assert set(problem.points[found][:, 1]) <= {0.0}


def test_a_bare_surface_without_cohesion_has_no_stress():
    problem = box(30.0, cohesion=0.0)
    free = stress_free_corners(problem)
    top = problem.points[problem.mesh.cells][..., 1] == 2.0
    assert np.array_equal(free, top)
    assert not stress_free_corners(box(30.0)).any()


def test_sand_that_touches_the_surface_between_two_strips_has_no_stress_there():
    """Both strips have a stress along the face, of the same size: the sand between them would have just that, too."""
    upper = layer("upper", cohesion=0, friction_angle="33 deg", bottom={"elevation": [[0, 8], [12, 6]]})
    lower = layer("lower", cohesion=0, friction_angle="33 deg")
    data = {"name": "touch", "surface": [[0, 10], [24, 2]], "base": {"elevation": 0}, "strata": [upper, lower]}
    section, settings = Section.parse(data), FemSettings(sides="fixed")
    strong = strengthened(section, shallow_failures(section, settings), settings)
    mesh = first_mesh(strong, 3000)
    body = body_of(strong, mesh, settings, davis=False)
    problem = limit_problem(mesh, body, units_of(mesh, body))
    free = stress_free_corners(problem)
    touches = np.isclose(problem.points[problem.mesh.cells], [12.0, 6.0]).all(axis=2) & (problem.cohesion == 0.0)
    assert touches.any()
    assert np.all(free[touches])
    _, notes, stress = proven_lower_bound(problem)
    assert stress is not None
    assert not notes


@pytest.mark.parametrize("noise", [1e-9, 1e-8, 1e-7, 1e-5])
def test_contacts_that_are_all_but_straight_do_not_cost_the_bounds(noise):
    """Edges of bisected triangles go on straight through their middles; here they have a kink of ``noise`` m."""
    section = Section.parse(slope())
    mesh = triangulate(section, 4.0)
    body = body_of(section, mesh, FemSettings(sides="fixed"), davis=False)
    found = bracket(mesh, body, Limits(gap=0.5, max_cells=400))
    inner = np.ones(len(found.mesh.points), dtype=bool)
    inner[found.mesh.edges[found.mesh.edge_cells[:, 1] < 0]] = False
    shift = noise * np.random.default_rng(1).uniform(-1.0, 1.0, found.mesh.points.shape) * inner[:, None]
    shaken = replace(found.mesh, points=found.mesh.points + shift)
    problem = limit_problem(shaken, body, units_of(shaken, body))
    (_, _, stress), (_, _, mechanism) = proven_lower_bound(problem), proven_upper_bound(problem)
    assert stress is not None
    assert mechanism is not None
    assert stress.multiplier == pytest.approx(found.meshes[-1].lower, rel=0.02)
    assert mechanism.multiplier == pytest.approx(found.meshes[-1].upper, rel=1e-3)


@pytest.mark.parametrize("sides", ["fixed", "free-field"])
def test_a_slope_of_46_degrees_of_friction_has_both_bounds(sides):
    data = Section.read(SECTIONS / "slope_2to1.toml").model_dump(exclude_none=True, by_alias=True)
    data["strata"][0]["friction_angle"] = "46 deg"
    found = kh_bounds(Section.parse(data), FemSettings(sides=sides), BoundsSettings(gap=0.1, max_cells=4000))
    assert found.gap <= 0.1
