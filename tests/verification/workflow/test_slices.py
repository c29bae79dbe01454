"""Limit equilibrium of slices beside published factors of safety, closed forms and identities."""

import math
import tomllib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from fem.continuum.strength import with_davis_strength
from fem.limit.bounds import kh_bounds
from fem.settings import BoundsSettings, FemSettings
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section
from meshes.section.tension_crack import TensionCrack
from tests.support import TOP
from tests.support.sections import layer
from tests.support.slice_statics import range_of_kh
from workflow.estimates.deeper_circles import ground_of_circles
from workflow.estimates.longer_section import circle_of_longer_section
from workflow.estimates.slice_methods import (
    _moment_balance,
    bishop_critical_kh,
    bishop_factor,
    spencer_critical_kh,
    spencer_factor,
)
from workflow.estimates.slices import LEFT, RIGHT, divide, loaded_by_crack
from workflow.estimates.slip_circles import SlipCircle, _corners, critical_circle, surface_balance
from workflow.estimates.structures import face_circle, structures_of

PUBLISHED = Path(__file__).parents[1] / "published"


def _published(name: str) -> Section:
    data = tomllib.loads((PUBLISHED / f"{name}.toml").read_text())
    return Section.parse({key: value for key, value in data.items() if key != "published"}, name)


def _slope(
    cohesion: str = "10 kPa", friction: str = "25 deg", weight: str = "19 kN/m^3/g_0", **more: object
) -> Section:
    soil = {
        "name": "Soil", "youngs_modulus": "10 MPa", "poissons_ratio": 0.3, "cohesion": cohesion,
        "friction_angle": friction, "density": weight,
    }  # fmt: skip
    surface = [[0.0, 10.0], [20.0, 10.0], [40.0, 20.0], [60.0, 20.0]]
    return Section.parse({"name": "slope", "surface": surface, "base": {"elevation": 0.0}, "strata": [soil], **more})


def _circles(section: Section, kh: float | None = 0.0, crest: tuple[float, float] | None = None) -> list[SlipCircle]:
    """The critical circles towards both sides, the least first."""
    both = [critical_circle(section, towards, kh, crest=crest) for towards in (LEFT, RIGHT)]
    return sorted((circle for circle in both if circle is not None), key=lambda circle: circle.bishop)


def _arc(centre: tuple[float, float], radius: float, ends: tuple[float, float], n: int = 200) -> np.ndarray:
    x = np.linspace(*ends, n + 1)
    return np.column_stack([x, centre[1] - np.sqrt(radius**2 - (x - centre[0]) ** 2)])


@pytest.mark.parametrize(
    ("name", "kh", "bishop", "spencer"),
    [
        ("acads_1a", 0.0, 0.987, 0.986),  # Slide2 manual, verification problem 1
        ("acads_1c", 0.0, 1.405, 1.375),  # Slide2 manual, 3
        ("acads_1d", 0.15, None, 0.991),  # Slide2 manual, 4
        # Slide2 manual, Arai & Tagyo 1985, example 1
        pytest.param("arai_tagyo_1", 0.0, 1.409, 1.406, marks=pytest.mark.slow),
        ("arai_tagyo_3", 0.0, 1.118, 1.118),  # the same, example 3, with water
        # Slide2 manual, Duncan & Wright 2005, and Pruška 2009
        pytest.param("duncan_wright_627", 0.0, None, 1.599, marks=pytest.mark.slow),
        pytest.param("pruska_14_c", 0.0, None, 0.53, marks=pytest.mark.slow),
    ],
)
def test_published_factors_by_slices(name: str, kh: float, bishop: float | None, spencer: float) -> None:
    circle = _circles(_published(name), kh)[0]
    assert circle.spencer == pytest.approx(spencer, rel=0.012)
    if bishop is not None:
        assert circle.bishop == pytest.approx(bishop, rel=0.012)


def test_a_published_slope_with_a_tension_crack_full_of_water() -> None:
    """ACADS 1(b) with a crack of 2 c / (γ √Ka) = 3.81 m: Slide2 manual, verification problem 2."""
    crack = TensionCrack.model_validate({"bottom": {"depth": 3.81}, "water": "full"})
    circle = critical_circle(_published("acads_1b"), LEFT, crack=crack)
    assert circle is not None
    assert circle.bishop == pytest.approx(1.596, rel=0.006)
    assert circle.spencer == pytest.approx(1.592, rel=0.006)
    assert circle.surface[-1].tolist() == [circle.surface[-2, 0], 35.0]  # up the crack to the crest


@pytest.mark.parametrize("water", ["dry", "1 m", "full"])
@pytest.mark.parametrize("mirrored", [False, True])
def test_a_cut_in_cracked_clay_stands_as_high_as_its_wedge(water: str, mirrored: bool) -> None:
    """φ = 0, crack of z = H / 2: F = 2 c (H - z) / (γ (H² - z²) / 2 + P) on a plane of 45°, which dry is Terzaghi's
    H = 2.67 c / γ (Theoretical Soil Mechanics, 1943, p. 154); circles are hardly worse. P = γw h² / 2."""
    c, gamma, height, z = 20e3, 20e3, 3.0, 1.5
    surface = [[0.0, 10.0], [20.0, 10.0], [20.01, 10.0 + height], [40.0, 10.0 + height]]
    if mirrored:
        surface = [[40.0 - x, level] for x, level in reversed(surface)]
    section = _slope("20 kPa", "0 deg", "20 kN/m^3/g_0", surface=surface)
    crack = TensionCrack.model_validate({"bottom": {"depth": z}, "water": water})
    circle = critical_circle(section, RIGHT if mirrored else LEFT, crack=crack)
    thrust = 0.5 * 1000.0 * GRAVITY * {"dry": 0.0, "1 m": 1.0, "full": z}[water] ** 2
    wedge = 2.0 * c * (height - z) / (0.5 * gamma * (height**2 - z**2) + thrust)
    assert circle is not None
    assert 0.985 * wedge < circle.bishop < 1.005 * wedge


def test_the_water_of_a_crack_turns_the_ground_by_its_moment() -> None:
    """φ = 0: F = c L R / (Σ W d + P a), P = γw h² / 2 with the arm a from the centre to h / 3 above the bottom."""
    section, (x0, z0), radius, cohesion = _slope("30 kPa", "0 deg"), (28.0, 28.0), 22.0, 30e3
    line = _arc((x0, z0), radius, (15.351, 46.0), 2000)
    crack = TensionCrack.model_validate({"bottom": {"elevation": float(line[-1, 1])}, "water": "3 m"})
    dry = divide(section, line[None, :, 0], line[None, :, 1])
    wet = loaded_by_crack(dry, section, crack, (line[-1:, 0], line[-1:, 1]), LEFT)
    circle = np.array([x0]), np.array([z0]), np.array([radius])
    length = radius * (math.asin((line[-1, 0] - x0) / radius) - math.asin((line[0, 0] - x0) / radius))
    driving = [cohesion * length * radius / bishop_factor(slices, *circle)[0] for slices in (dry, wet)]
    moment = 0.5 * 1000.0 * GRAVITY * 3.0**2 * (z0 - line[-1, 1] - 1.0)
    assert driving[1] - driving[0] == pytest.approx(moment, rel=2e-3)
    balance, without = spencer_factor(wet), spencer_factor(dry)
    assert balance is not None
    assert without is not None
    assert balance.factor < without.factor


def test_a_weak_seam_needs_the_slip_surface_that_follows_it() -> None:
    """ACADS 3(a): Spencer 1.258 and Morgenstern-Price 1.261 along the seam (manuals of Slide2 and SLOPE/W)."""
    section = _published("acads_3a")
    along = np.array([[40.4, 27.3], [43.5, 26.6], [63.0, 26.6], [67.7, 31.6], [73.4, 39.2]])
    assert surface_balance(section, along, LEFT) == pytest.approx(1.26, rel=0.02)
    assert _circles(section)[0].bishop > 1.4


def test_clay_has_the_factor_of_its_moments() -> None:
    """φ = 0: F = c L R / Σ W d about the centre, and Kh = (c L R - Σ W d) / Σ W h where F = 1, whatever the method."""
    section, (x0, z0), radius, cohesion = _slope("30 kPa", "0 deg"), (28.0, 28.0), 22.0, 30e3
    line = _arc((x0, z0), radius, (15.351, 48.494))
    slices = divide(section, line[None, :, 0], line[None, :, 1])
    circle = np.array([x0]), np.array([z0]), np.array([radius])
    edges = np.linspace(line[0, 0], line[-1, 0], 200_001)
    x = 0.5 * (edges[1:] + edges[:-1])
    ground, base = np.interp(x, [0, 20, 40, 60], [10, 10, 20, 20]), z0 - np.sqrt(radius**2 - (x - x0) ** 2)
    weight = 19e3 * np.maximum(ground - base, 0.0) * np.diff(edges)
    driving, shaking = weight @ (x - x0), weight @ (z0 - 0.5 * (ground + base))
    length = radius * (math.asin((line[-1, 0] - x0) / radius) - math.asin((line[0, 0] - x0) / radius))
    resisting = cohesion * length * radius
    assert bishop_factor(slices, *circle)[0] == pytest.approx(resisting / driving, rel=2e-3)
    assert bishop_critical_kh(slices, *circle)[0] == pytest.approx((resisting - driving) / shaking, rel=5e-3)


def test_a_plane_through_dry_sand_slides_by_its_angle() -> None:
    """A wedge without cohesion on a plane of angle β: F = tan φ / tan β."""
    section, beta = _slope("0.001 Pa", "35 deg", unusual=True), math.radians(20.0)
    x = np.linspace(22.0, 22.0 + 9.0 / math.tan(beta), 101)
    line = np.column_stack([x, 11.0 + (x - 22.0) * math.tan(beta)])
    balance = spencer_factor(divide(section, line[None, :, 0], line[None, :, 1]))
    assert balance is not None
    assert balance.factor == pytest.approx(math.tan(math.radians(35.0)) / math.tan(beta), rel=1e-4)


@settings(max_examples=25)
@example(cohesion=29.5, friction=0.0, x=22.0, rise=1.0)
@given(cohesion=st.floats(1.0, 60.0), friction=st.floats(0.0, 40.0), x=st.floats(22.0, 34.0), rise=st.floats(1.0, 14.0))
def test_the_factor_is_one_at_the_critical_kh(cohesion: float, friction: float, x: float, rise: float) -> None:
    section = _slope(f"{cohesion} kPa", f"{friction} deg")
    centre, radius = (x, 21.0 + rise), 21.0 + rise - 6.0
    ends = x - math.sqrt(radius**2 - (11.0 + rise) ** 2), x + math.sqrt(radius**2 - (1.0 + rise) ** 2)
    ends = max(ends[0], 0.5), min(ends[1], 59.5)
    line = _arc(centre, radius, ends, 60)
    line[:, 1] = np.minimum(line[:, 1], np.interp(line[:, 0], [0, 20, 40, 60], [10, 10, 20, 20]))
    slices = divide(section, line[None, :, 0], line[None, :, 1])
    of_circle = np.array([centre[0]]), np.array([centre[1]]), np.array([radius])
    kh = bishop_critical_kh(slices, *of_circle)[0]
    if np.isfinite(kh):
        assert bishop_factor(slices, *of_circle, kh)[0] == pytest.approx(1.0, abs=1e-5)
    critical = spencer_critical_kh(slices)
    if critical is not None and (balance := spencer_factor(slices, critical.kh)) is not None:
        # Two inclinations may balance, and the flattest of each search is taken: φ = 0, c = 29.5 kPa has 1 at 6.7° and
        # 0.993 at -4.9°.
        same = abs(balance.inclination - critical.inclination) < 1e-3
        assert balance.factor == pytest.approx(1.0, abs=1e-4 if same else 0.02)


def test_still_water_over_the_slope_takes_its_buoyancy_off() -> None:
    """Under still water that covers it a slope has the factor of a dry one with the buoyant unit weight."""
    under = _slope("5 kPa", "25 deg", "20 kN/m^3/g_0", water={"table": {"elevation": 25.0}})
    dry = _slope("5 kPa", "25 deg", f"{20e3 / GRAVITY - 1000.0} kg/m^3", unusual=True)
    wet, buoyant = _circles(under)[0], _circles(dry)[0]
    assert wet.bishop == pytest.approx(buoyant.bishop, rel=1e-3)
    assert wet.spencer == pytest.approx(buoyant.spencer, rel=2e-3)


def test_the_mirrored_slope_fails_alike() -> None:
    data = _slope().model_dump(mode="python", exclude_none=True, by_alias=True)
    mirrored = Section.parse({**data, "surface": [[0, 20], [20, 20], [40, 10], [60, 10]]})
    item, other = _circles(_slope(), 0.1)[0], _circles(mirrored, 0.1)[0]
    assert (item.towards, other.towards) == ("left", "right")
    assert item.bishop == pytest.approx(other.bishop, rel=2e-3)
    assert surface_balance(_slope(), item.surface, LEFT, 0.1) == pytest.approx(item.spencer, rel=1e-3)
    assert surface_balance(_slope(), item.surface, RIGHT, 0.1) is None


def test_circles_of_one_crest_only_are_sought_where_it_is_named() -> None:
    surface = [[0, 10], [10, 10], [22, 18], [32, 18], [44, 10], [50, 10], [54, 14], [60, 14]]
    section = Section.parse(
        {**_slope().model_dump(mode="python", exclude_none=True, by_alias=True), "surface": surface}
    )
    circles = _circles(section, 0.0, crest=(22.0, 32.0))
    assert {circle.towards for circle in circles} == {"left", "right"}
    assert all(22.0 <= _crest(circle) <= 32.0 for circle in circles)


def _crest(circle: SlipCircle) -> float:
    first, last = circle.surface[0], circle.surface[-1]
    return float(first[0] if first[1] > last[1] else last[0])


def test_a_levee_and_its_low_water_bank_are_told_apart() -> None:
    """Bishop's kc of the levee with full strength is 0.146 by hand, that of the bank beside it 0.039."""
    data = tomllib.loads((TOP / "tests/support/levee/levee.toml").read_text(encoding="utf-8"))
    section = Section.parse({key: value for key, value in data.items() if key in Section.model_fields})
    (levee,) = structures_of(section)
    assert (levee.crest.left, levee.crest.right, levee.kind) == (66.0, 72.0, "levee")
    bank = critical_circle(section, LEFT, None)
    assert bank is not None
    assert not levee.slides_with(bank.surface)
    assert bank.bishop == pytest.approx(0.039, abs=0.001)
    circle = face_circle(section, levee, LEFT, bank, None, 0.0, 0.0)
    assert circle is not None
    assert levee.slides_with(circle.surface)
    assert circle.bishop == pytest.approx(0.146, abs=0.003)
    assert face_circle(section, levee, LEFT, circle, None, 0.0, 0.0) is circle


def test_the_levee_with_the_strength_of_davis() -> None:
    """Bishop's factor is 1.43 by hand, and kc 0.098 (0.0961 here): tan φ* = sin φ and c* = c cos φ for ψ = 0."""
    data = tomllib.loads((TOP / "tests/support/levee/levee.toml").read_text(encoding="utf-8"))
    section = Section.parse({key: value for key, value in data.items() if key in Section.model_fields})
    weak, (levee,) = with_davis_strength(section), structures_of(section)
    for kh, by_hand, error in ((0.0, 1.43, 0.005), (None, 0.098, 0.02)):
        circle = face_circle(weak, levee, LEFT, None, kh, 0.0, 0.0)
        assert circle is not None
        assert levee.slides_with(circle.surface)
        assert circle.bishop == pytest.approx(by_hand, rel=error)


def _bank(sand: str) -> Section:
    """A bank of silt on sand, whose lower face is sand under water."""
    soil = {"youngs_modulus": "12 MPa", "poissons_ratio": 0.35}
    silt = {
        "name": "Silt", "density": "1.8 t/m^3", "cohesion": "3 kPa", "friction_angle": "32 deg",
        "bottom": {"elevation": [[0.0, 0.5], [49.0, 0.3]]}, **soil,
    }  # fmt: skip
    below = {"name": "Sand", "density": "1.85 t/m^3", "cohesion": sand, "friction_angle": "30 deg", **soil}
    surface = [[0.0, 4.0], [40.0, 4.2], [52.0, -1.0], [90.0, -2.0]]
    water = {"table": [[0.0, 1.5], [46.0, 1.2], [90.0, 1.2]]}
    data = {"name": "bank", "surface": surface, "base": {"elevation": -6.0}, "strata": [silt, below], "water": water}
    return Section.parse(data)


def test_circles_below_a_face_of_sand_mean_the_slope_as_a_whole() -> None:
    """Strict bounds of the ground below the face are 0.1230 to 0.1251 (gap 2 %); the face fails at 0.053."""
    section = _bank("0 kPa")
    shallow = critical_circle(section, RIGHT, None, 0.5)
    ground, circle = ground_of_circles(section, RIGHT, None, 0.5)
    assert shallow is not None
    assert circle is not None
    assert shallow.bishop < 0.1  # the shallowest circle of those that are sought, within the sand
    assert [stratum.name for stratum in ground.strata] != [stratum.name for stratum in section.strata]
    assert circle.bishop == pytest.approx(0.124, rel=0.02)
    assert circle.surface[0, 0] < 42.0  # it takes the crest along


def test_circles_of_cohesive_ground_are_those_of_the_section() -> None:
    section = _bank("2 kPa")
    ground, circle = ground_of_circles(section, RIGHT, None, 0.5)
    same = critical_circle(section, RIGHT, None, 0.5)
    assert ground is section
    assert circle is not None
    assert same is not None
    assert circle.bishop == same.bishop


def _road() -> Section:
    """An embankment of 6.5 m on soft clay, between level ground on both sides."""
    soft = {"friction_angle": "0 deg", "density_ordinary": "1.65 t/m^3", "density_seismic": "1.65 t/m^3"}
    strata = [
        layer("Fill", cohesion="7 kPa", friction_angle="32 deg", bottom={"elevation": 0.0}),
        layer("Crust", cohesion="30 kPa", bottom={"elevation": -2.4}, **soft),
        layer("Clay", cohesion="23 kPa", **soft),
    ]
    surface = [[0, 0], [32.9, 0], [45.9, 6.5], [56.3, 6.5], [69.3, 0], [102.2, 0]]
    return Section.parse({"name": "road", "surface": surface, "base": {"elevation": -10.3}, "strata": strata})


def test_the_kh_of_a_circle_through_fill_on_clay_is_one_of_many_that_its_statics_allow() -> None:
    """Strict bounds are 0.043 to 0.046, Bishop and Spencer have 0.03: the clay resists with c alone, and the normal
    force on the steep cut through the fill passes the centre of the circle, so that only an assumption gives it."""
    section = _road()
    circle = critical_circle(section, LEFT, None)
    assert circle is not None
    assert circle.bishop == pytest.approx(0.031, abs=0.002)
    x = np.linspace(*circle.surface[[0, -1], 0], 61)
    z = np.interp(x, *circle.surface.T)
    slices = divide(section, x[None], z[None], LEFT)
    levels = section.layering.interfaces(x[1:-1])
    tops, bottoms = (np.maximum(part, z[1:-1, None]) for part in (levels[:, :-1], levels[:, 1:]))
    cohesion = (tops - bottoms) @ np.array([stratum.cohesion for stratum in section.strata])
    tan = np.tan([stratum.friction_angle for stratum in section.strata])
    friction = np.where(tops - bottoms > 1e-6, tan, np.inf).min(axis=1)  # of the weakest soil on the side of a slice
    least, largest = range_of_kh(slices, cohesion, friction, levels[:, 0] - z[1:-1])
    assert least < 0.026 < circle.bishop < 0.041 < largest


@pytest.mark.slow
def test_strict_bounds_lie_where_the_statics_of_a_circle_through_fill_allow() -> None:
    bounds = kh_bounds(_road(), FemSettings(sides="smooth", direction="downhill"), BoundsSettings(seconds=20, gap=0.05))
    assert 0.040 < bounds.lower < bounds.upper < 0.048


def test_a_circle_that_ends_at_a_side_slides_at_less_in_a_longer_section() -> None:
    """Clay of 20 kPa, 15 m deep, with 12 m of it level beside an embankment."""
    fill = layer("Fill", cohesion="5 kPa", friction_angle="30 deg", bottom={"elevation": 0.0})
    clay = layer("Clay", cohesion="25 kPa", friction_angle="0 deg")
    surface = [[0, 0], [12, 0], [20, 4], [28, 4], [36, 0], [48, 0]]
    section = Section.parse({"name": "near", "surface": surface, "base": {"elevation": -15}, "strata": [fill, clay]})
    circle = critical_circle(section, LEFT, None)
    assert circle is not None
    longer = circle_of_longer_section(section, circle.surface[[0, -1], 0].tolist(), circle.bishop, LEFT, 0.5)
    assert longer is not None
    assert longer.side == "left"
    assert longer.past_m > 2.0
    assert longer.bishop < 0.97 * circle.bishop
    assert circle_of_longer_section(section, (5.0, 40.0), circle.bishop, LEFT, 0.5) is None


def test_a_circle_along_a_wet_face_is_the_failure_of_this_face() -> None:
    """A river bank of sand, φ = 31° at 1:2: tan φ / tan β = 1.2017 below water; where the water table rises behind the
    face a circle has 0.4 % less, and was reported as the failure of the whole slope.
    """
    weight = dict.fromkeys(("density_ordinary", "density_seismic", "density_saturated"), "18.5 kN/m^3/g_0")
    sand = layer("Sand", cohesion="0 kPa", friction_angle="31 deg", **weight)
    line = {"elevation": [[46.0, 9.0], [80.0, 9.0]]}
    crust = layer("Crust", cohesion="25 kPa", friction_angle="0 deg", bottom=line, **weight)
    section = Section.parse({
        "name": "bank", "surface": [[0, 6], [40, 6], [48, 10], [80, 10]], "base": {"elevation": 0.0},
        "water": {"table": [[0, 8.5], [45, 8.5], [56, 9.8], [80, 9.8]]}, "strata": [crust, sand],
    })  # fmt: skip
    ground, circle = ground_of_circles(section, LEFT, 0.0, 0.5)
    assert ground is not section
    assert circle is not None
    assert circle.bishop > 1.03 * math.tan(math.radians(31.0)) / 0.5


@pytest.mark.parametrize(("second", "expected"), [(None, None), (0.31, (1.3, 0.31))])
def test_side_forces_between_which_a_slice_has_no_normal_force_are_no_balance(
    second: float | None, expected: tuple[float, float] | None
) -> None:
    """The flattest change of sign is a pole, where no factor has a meaning; a steeper balance counts, if there is one.
    Below a levee whose sand had liquefied a run ended with a traceback at such a pole."""

    def factor(theta: float) -> float:
        return math.nan if 0.01 < theta < 0.02 else 1.3

    def turning(value: float, theta: float) -> float:
        return value * (theta - 0.015) * (1.0 if second is None else theta - second)

    result = _moment_balance(factor, turning)
    assert result == (None if expected is None else pytest.approx(expected, abs=1e-6))


@pytest.mark.slow
def test_a_surveyed_ground_has_the_circles_of_the_drawn_one() -> None:
    """267 points of the ground made 700,000 circles of 47,000, 290 s for a dike of D-Stability and its two Kh."""
    drawn = _slope("5 kPa", "25 deg")
    x = np.linspace(0.0, 60.0, 301)
    z = np.interp(x, *np.array(drawn.surface).T) + 0.02 * np.random.default_rng(5).normal(size=len(x))
    # Not parsed, which would thin so dense a line; a longer section has as many points at larger distances.
    surveyed = Section.model_validate({**tomllib.loads(drawn.to_toml()), "surface": np.column_stack([x, z]).tolist()})
    assert len(surveyed.ground) == 301
    assert len(_corners(surveyed)) <= 80
    for kh in (0.0, None):
        expected, result = (critical_circle(ground, LEFT, kh) for ground in (drawn, surveyed))
        assert expected is not None
        assert result is not None
        assert result.bishop == pytest.approx(expected.bishop, abs=0.01)
    assert len(_corners(drawn)) == len(drawn.ground)
