"""Smooth sides: held horizontally and free vertically, without shear stress, against closed forms and strict bounds."""

import math
from typing import Any

import numpy as np
import pytest
from mpi4py import MPI
from scipy.optimize import minimize_scalar

from fem.limit.adaptive_bounds import proven_lower_bound
from fem.limit.bounds import DirectionGround, kh_bounds
from fem.limit.first_mesh import first_mesh
from fem.limit.limit_problem import limit_problem, units_of
from fem.limit.safety_bounds import safety_bounds
from fem.limit.section_body import body_of
from fem.limit_load.limit_load import critical_limit_load
from fem.path.gravity import gravity_equilibrium
from fem.search.critical import critical_coefficient
from fem.search.strength_reduction import limit_load_safety_factor, safety_factor
from fem.settings import BoundsSettings, FemSettings, Sides, usual_sides, usual_sides_of_slides
from meshes.gmsh_model import generate
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section
from meshes.settings import MeshSettings
from tests.support import fem_problems
from tests.support.water import section, soil

SMOOTH = FemSettings(sides="smooth", flow="associated", direction="downhill", kh=())
COARSE = BoundsSettings(gap=0.08, max_cells=1500, davis=False)


def test_a_vertical_acceleration_keeps_ground_between_smooth_sides_oedometric() -> None:
    """σz = (1 - kv) ρ g z, σx = ν/(1 - ν) σz, no shear stress, and the surface rises by kv ρ g H² / (2 M) with
    M = E (1 - ν) / ((1 + ν)(1 - 2ν)). Sides that are held vertically carry a part of it by shear stress."""
    kv, nu, young, density, height = 0.4, 0.3, 1e7, 2000.0, 9.0
    ground = fem_problems.section([[0.0, 0.0], [6.0, 0.0]], height, fem_problems.soil(nu=nu, E=young, c=1e6))
    mesh = generate(ground, MeshSettings(columns=3, rows=9))
    settings = FemSettings(sides="smooth", element="quadratic", vertical=kv)
    problem, _, _ = gravity_equilibrium(ground, mesh, settings, MPI.COMM_SELF)
    depth = -fem_problems.points_of(problem)[..., 1].ravel()
    vertical = -(1.0 - kv) * density * GRAVITY * depth
    exact = np.column_stack([vertical * nu / (1.0 - nu), vertical, vertical * nu / (1.0 - nu), 0.0 * depth])
    np.testing.assert_allclose(problem.stress, exact, atol=1e-5 * density * GRAVITY * height)


def test_a_block_on_a_slippery_seam_is_held_by_its_smooth_sides() -> None:
    """Clay on a weak seam fails by a wedge that rises at one side and another that sinks at the other side.

    Lower bound: σx = γz ± 2c at the sides (Rankine 1857) and linear in between, Kh = 4 c / (γ L); the base shear of the
    seam carries the seam. Upper bound: wedges at θ, whose planes dissipate c H / (sin θ cos θ) each, and a block of
    L H - H² / tan θ that slides on the seam.
    """
    cohesion, seam, unit, length, height, thin = 20e3, 1e3, 20e3, 24.0, 2.0, 0.25
    upper = soil("Clay", cohesion="20 kPa", friction_angle="0 deg", density="20 kN/m^3", bottom={"depth": height})
    lower = soil("Seam", cohesion="1 kPa", friction_angle="0 deg", density="20 kN/m^3")
    ground = section(
        upper, lower, surface=[[0.0, 0.0], [length, 0.0]], base={"depth": height + thin}, water={"table": -50.0}
    )
    fixed = 4.0 * cohesion / (unit * length)

    def wedges(theta: float) -> float:
        dissipated = 2.0 * cohesion * height / (math.sin(theta) * math.cos(theta)) + seam * length
        return dissipated / (unit * (length * height - height**2 / math.tan(theta)))

    fails = float(minimize_scalar(wedges, bounds=(0.7, 1.2), method="bounded").fun)
    mesh = generate(ground, MeshSettings(columns=48, rows=9))
    kc = critical_limit_load(ground, mesh, SMOOTH, MPI.COMM_SELF).kc
    strict = kh_bounds(ground, SMOOTH, COARSE)
    assert fixed < strict.lower < kc < strict.upper < fails


def embankment(**water: Any) -> Section:
    """A bank of 4 m on 1 m of the same soil, with 20 m of level ground on both sides."""
    surface = [[0.0, 0.0], [20.0, 0.0], [28.0, 4.0], [32.0, 4.0], [40.0, 0.0], [60.0, 0.0]]
    clay = soil(cohesion="8 kPa", friction_angle="20 deg", dilation_angle="20 deg")
    return section(clay, surface=surface, base={"elevation": -1.0}, **water)


def test_far_sides_do_not_matter() -> None:
    """Kh and the factor of safety of a bank with wide margins are the same with all kinds of sides."""
    ground = embankment(water={"table": -0.5})
    mesh = generate(ground, MeshSettings(size=1.0))
    kinds: list[Sides] = ["free-field", "smooth", "fixed", "periodic"]
    all_kinds = [SMOOTH.model_copy(update={"sides": sides}) for sides in kinds]
    kc = [critical_limit_load(ground, mesh, settings, MPI.COMM_SELF).kc for settings in all_kinds]
    factor = [limit_load_safety_factor(ground, mesh, settings, 0.1, MPI.COMM_SELF).factor for settings in all_kinds]
    assert max(kc) < 1.01 * min(kc)
    assert max(factor) < 1.01 * min(factor)


CUT_SHORT = [
    section(
        soil("Fill", cohesion="6 kPa", friction_angle="25 deg", dilation_angle="25 deg", bottom={"elevation": 0.0}),
        soil("Clay", cohesion="18 kPa", friction_angle="0 deg"),
        surface=[[0.0, 4.0], [3.0, 4.0], [11.0, 0.0], [14.0, 0.0]], base={"elevation": -3.0}, water=water,
    )
    for water in ({"table": -50.0}, {"table": [[0.0, 2.0], [11.0, 0.0], [14.0, 0.0]]})
]  # fmt: skip


@pytest.mark.parametrize(
    "ground", [pytest.param(CUT_SHORT[0], marks=pytest.mark.slow), CUT_SHORT[1]], ids=["dry", "water"]
)
def test_strict_bounds_bracket_the_elements_of_slopes_cut_short(ground: Section) -> None:
    """The mechanism reaches both sides: what is assumed there decides, and elements and bounds assume the same."""
    mesh = generate(ground, MeshSettings(size=0.75))
    kc = critical_limit_load(ground, mesh, SMOOTH, MPI.COMM_SELF).kc
    strict = kh_bounds(ground, SMOOTH, COARSE)
    assert 0.995 * strict.lower < kc < 1.01 * strict.upper
    fixed = SMOOTH.model_copy(update={"sides": "fixed"})
    assert 1.1 * kc < critical_limit_load(ground, mesh, fixed, MPI.COMM_SELF).kc
    factor = limit_load_safety_factor(ground, mesh, SMOOTH, 0.05, MPI.COMM_SELF).factor
    of_factor = safety_bounds(ground, SMOOTH, COARSE, 0.05, factor)
    assert 0.995 * of_factor.lower < factor < 1.01 * of_factor.upper


@pytest.mark.slow
def test_paths_of_equilibria_come_close_to_the_limit_loads() -> None:
    """Kh and the factor of safety by cones and along a path, with smooth sides that decide. The fill dilates by 20
    instead of 25 degrees on the path, and carries no more than with ψ = φ (Radenkovic 1961)."""
    ground = CUT_SHORT[1]
    mesh, path = generate(ground, MeshSettings(size=1.0)), SMOOTH.model_copy(update={"flow": "non-associated"})
    kc = critical_limit_load(ground, mesh, SMOOTH, MPI.COMM_SELF).kc
    factor = limit_load_safety_factor(ground, mesh, SMOOTH, 0.05, MPI.COMM_SELF).factor
    strata = [
        s.model_copy(update={"dilation_angle": math.radians(20.0 if s.friction_angle else 0.0)}) for s in ground.strata
    ]
    ground = ground.model_copy(update={"strata": tuple(strata)})
    along = (
        critical_coefficient(ground, mesh, path, MPI.COMM_SELF).kc,
        safety_factor(ground, mesh, path, 0.05, MPI.COMM_SELF).factor,
    )
    assert 0.95 * kc < along[0] < 1.02 * kc
    assert 0.9 * factor < along[1] < 1.005 * factor  # it still rises where the path ends


def test_level_sand_beside_a_smooth_side_bears_a_seismic_force_on_the_first_mesh() -> None:
    """Bare sand with water just below its toe: one triangle in the corner of ground and side, without shear stress
    along the side, bears no Kh at all (2e-11 by rounding); several bear 0.06."""
    sand = {"density": "17.5 kN/m^3", "density_saturated": "19.5 kN/m^3", "cohesion": "0 kPa", "poissons_ratio": 0.3,
            "friction_angle": "31 deg", "youngs_modulus": "53 MPa"}  # fmt: skip
    bare = Section.parse(
        {
            "name": "bare",
            "surface": [[0.0, 14.0], [32.9, 14.0], [60.38, 0.0], [87.58, 0.0]],
            "base": {"elevation": -10.0},
            "water": {"table": [[0.0, 6.1], [32.9, 3.05], [60.38, -0.41], [87.58, -0.41]]},
            "strata": [{"name": "sand", **sand}],
        }
    )
    ground = DirectionGround.of(bare, SMOOTH, 2500).section.cut_at_films
    mesh = first_mesh(ground, 2500, "smooth")
    body = body_of(ground, mesh, SMOOTH)
    stress = proven_lower_bound(limit_problem(mesh, body, units_of(mesh, body)))[-1]
    assert stress is not None
    assert stress.multiplier > 0.05


def test_an_embankment_on_level_sand_fails_itself_and_not_the_sand_beside_it() -> None:
    """Where a section does not say, level ends are held horizontally. Slip circles of Bishop and Spencer through the
    embankment: Kh = 0.352. Under the K0 stress alone the sand slides out of a side, 30 m from the embankment."""
    fill = soil("Fill", cohesion="8 kPa", friction_angle="34 deg", density="19 kN/m^3", bottom={"elevation": 0.0})
    sand = soil("Sand", cohesion="0 kPa", friction_angle="31 deg", density="19 kN/m^3", bottom={"elevation": -7.0})
    clay = soil("Clay", cohesion="80 kPa", friction_angle="0 deg", density="18 kN/m^3")
    ground = section(
        fill, sand, clay, base={"elevation": -12.0}, water={"table": -1.0},
        surface=[[-40.0, 0.0], [0.0, 0.0], [10.0, 5.0], [22.0, 5.0], [32.0, 0.0], [72.0, 0.0]],
    )  # fmt: skip
    assert usual_sides(ground) == "smooth"
    mesh = generate(ground, MeshSettings(max_cells=1500))
    level, out = (
        critical_limit_load(ground, mesh, SMOOTH.changed(sides=sides), MPI.COMM_SELF).kc
        for sides in ("smooth", "free-field")
    )
    assert level == pytest.approx(0.352, rel=0.05)
    assert out < 0.2


def test_level_ground_half_as_long_as_the_soft_ground_is_deep_is_held_at_its_ends() -> None:
    """An embankment of 6.6 m on 19 m of soft ground, 18 m of which lie level beside it: 0.009 to 0.015 by bounds
    between free-field sides, 0.069 to 0.074 between smooth ones, 0.074 by circles. Where it falls it is not held."""
    clay = soil("Clay", cohesion="25 kPa", friction_angle="0 deg", density="17 kN/m^3")
    ends = [(0.0, 0.0), (0.0, 1.0)]
    results = []
    for left, right in ends:
        surface = [[0.0, left], [18.3, 0.0], [31.5, 6.6], [44.2, 6.6], [57.4, 0.0], [75.7, -right]]
        results.append(usual_sides(section(clay, base={"elevation": -18.9}, surface=surface)))
    assert results == ["smooth", "free-field"]


def test_a_plateau_behind_a_cut_is_level_and_a_slope_that_continues_is_not() -> None:
    """12 m of sand at 31° below a plateau of 1:40: between free-field sides the level ground before the cut slides out
    at Kh = 0.029, and slip circles fail at 0.080. A slope of 1:40 from side to side is no plateau."""
    sand = soil("Sand", cohesion="0 kPa", friction_angle="36 deg", density="18 kN/m^3")
    cut = [[0.0, 5.0], [30.0, 5.0], [50.0, 17.0], [90.0, 18.0]]
    assert usual_sides(section(sand, base={"elevation": -10.0}, surface=cut)) == "smooth"
    slope = [[0.0, 5.0], [90.0, 7.25]]
    assert usual_sides(section(sand, base={"elevation": -10.0}, surface=slope)) == "free-field"


@pytest.mark.parametrize(
    ("left", "right", "sides"),
    [
        (4.2, -1.5, "smooth"),  # level behind the bank, a bed that falls by 1 in 20
        (4.2, -1.0, None),  # level at both ends, as for the elements
        (7.0, -1.0, None),  # a hillside above the bank moves with it
    ],
)
def test_level_ground_behind_a_bank_is_held_for_material_points(left: float, right: float, sides: Sides | None) -> None:
    sand = soil("Sand", cohesion="0 kPa", friction_angle="31 deg", density="19 kN/m^3")
    surface = [[0.0, left], [40.0, 4.2], [52.0, -1.0], [80.0, -1.0], [90.0, right]]
    for mirrored in (False, True):
        points = [[90.0 - x, z] for x, z in reversed(surface)] if mirrored else surface
        assert usual_sides_of_slides(section(sand, base={"elevation": -8.0}, surface=points)) == sides
        liquefies = section(sand | {"liquefies_in": [1]}, base={"elevation": -8.0}, surface=points)
        assert usual_sides_of_slides(liquefies) == "free-field"
