"""Davis's substitute for ψ < φ where its answer follows from that of ψ = φ, and where the path as given went astray.

In ground of one soil with ψ = 0 the three forms divide c and tan φ by λ / cos φ (A) and by √(λ² + tan² φ) (B and C), so
that a slope whose factor of safety is F with ψ = φ has F cos φ and √(F² - tan² φ) on the same mesh.
"""

import functools
import math

import pytest
from mpi4py import MPI

from fem.search.critical import critical_coefficient
from fem.search.strength_reduction import safety_factor
from fem.settings import FemSettings
from meshes.gmsh_model import generate
from meshes.settings import MeshSettings
from tests.support.fem_problems import section, soil

PHI = 45.0
# A slope of 45°, 10 m high, φ = 45°, ψ = 0, 6 kPa, 20 kN/m³, as such studies have them.
SLOPE = section(
    [[0.0, 10.0], [15.0, 10.0], [25.0, 0.0], [40.0, 0.0]],
    15.0,
    soil(E=4e7, nu=0.3, c=6e3, phi=PHI, psi=0.0, ordinary=2039.4, seismic=2039.4),
)


@functools.cache
def mesh():
    return generate(SLOPE, MeshSettings(columns=24, rows=10))


@functools.cache
def factor(flow, form="B"):
    return safety_factor(SLOPE, mesh(), FemSettings(flow=flow, davis=form), 0.0, MPI.COMM_SELF)


@pytest.mark.parametrize("form", ["A", "B", "C"])
def test_factor_of_safety_of_one_soil_without_dilation_follows_from_that_of_full_dilation(form):
    full = factor("associated").factor
    exact = full * math.cos(math.radians(PHI)) if form == "A" else math.sqrt(full**2 - math.tan(math.radians(PHI)) ** 2)
    value = factor("davis", form)
    assert value.verdict == "plateau"
    assert value.factor == pytest.approx(exact, rel=0.004)


def test_slope_of_45_degrees_stands_by_davis_where_the_path_as_given_said_nothing():
    """Strict bounds prove failure at 1.53 with ψ = φ; form A is 1.08 of that at most. Coarse meshes are above."""
    assert 1.0 < factor("davis", "A").factor < factor("davis", "B").factor < factor("associated").factor < 1.62


def test_less_dilation_never_bears_more():
    wish = FemSettings(direction="downhill")
    davis, full = (
        critical_coefficient(SLOPE, mesh(), wish.model_copy(update={"flow": flow}), MPI.COMM_SELF)
        for flow in ("davis", "associated")
    )
    assert 0.0 < davis.kc < full.kc
    assert davis.upper < 1.01 * davis.kc
    assert [state.past_equilibrium for state in davis.states] == [False, False, False]
    assert davis.states[0].kh == pytest.approx(0.5 * davis.kc, rel=0.01)


def test_of_two_faces_the_steeper_one_counts():
    """An embankment of 45° to the left and 18° to the right; its ends are level, so that "downhill" is to the right."""
    faces = section(
        [[0.0, 0.0], [10.0, 0.0], [16.0, 6.0], [24.0, 6.0], [42.0, 0.0], [52.0, 0.0]],
        10.0,
        soil(E=3e7, nu=0.3, c=1e4, phi=30.0, psi=0.0),
    )
    grid = generate(faces, MeshSettings(size=2.0, method="free"))
    result = critical_coefficient(faces, grid, FemSettings(), MPI.COMM_SELF)
    assert (result.direction, result.sign) == ("uphill", -1)
    assert result.opposite.direction == "downhill"
    assert result.kc < 0.7 * result.opposite.kc


def test_grains_roll_down_a_face_of_sand_and_the_search_goes_on_below():
    """tan(φ* - β) with tan φ* = sin 33°, β = 18.4°: 0.169; deeper failures of 1:3 sand need more."""
    sand = section(
        [[0.0, 6.0], [10.0, 6.0], [28.0, 0.0], [38.0, 0.0]], 10.0, soil(E=3e7, nu=0.3, c=0.0, phi=33.0, psi=0.0)
    )
    grid = generate(sand, MeshSettings(size=1.5, method="free"))
    result = critical_coefficient(sand, grid, FemSettings(direction="downhill"), MPI.COMM_SELF)
    exact = math.tan(math.atan(math.sin(math.radians(33.0))) - math.atan(1.0 / 3.0))
    assert [shallow_failure.kh for shallow_failure in result.shallow_failures] == [pytest.approx(exact, rel=1e-6)]
    assert exact < result.kc < 2.0 * exact
