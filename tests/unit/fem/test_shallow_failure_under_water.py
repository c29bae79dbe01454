"""Faces without cohesion under any water: none is told to bear more than its own infinite slope."""

import math
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fem.continuum.face_reinforcement import strengthened
from fem.continuum.shallow_failure import (
    ShallowFailure,
    faces_at,
    least_rolling_factor,
    merged_faces,
    shallow_failures,
)
from fem.limit.bounds import KhBounds, kh_bounds
from fem.limit.first_mesh import first_mesh
from fem.limit.safety_bounds import safety_bounds
from fem.settings import BoundsSettings, FemSettings
from meshes.pore_loads import Pressure, at_ends, corner_pressure
from meshes.section.section import Section
from tests.support.water import WATER, soil

FIXED = FemSettings(sides="fixed")
SLOPE = 0.4
FACE = {"surface": [[-30.0, 0.0], [0.0, 0.0], [50.0, 20.0], [90.0, 20.0]], "base": {"elevation": -5.0}}


def face_of_sand(phi: float = 45.0, water: dict[str, Any] | None = None, **changes: Any) -> Section:
    """A face of 2.5:1, 20 m high, of sand, with water as a file has it."""
    sand = soil("Sand", cohesion=0.0, friction_angle=f"{phi} deg", density="19 kN/m^3", **changes)
    table = {} if water is None else {"water": water}
    return Section.parse({"name": "face", **FACE, **table, "strata": [sand]})


def infinite_slope(phi: float, weight: float, pressure: float, driving: float = 1.0) -> float:
    """Kh of an infinite slope of 2.5:1 whose base bears ``weight`` (N/m² per metre of depth), a share ``driving`` of
    which drives it, the rest being borne by still water, and ``pressure`` more of water in the pores.

    (W' cos² β - u) tan φ - W' sin β cos β over γ (cos² β + sin β cos β tan φ), for γ = 20 kN/m³: force balance of a
    slice without forces between slices (Skempton & DeLory 1957) with Kh γ acting horizontally.
    """
    beta, tan = math.atan(SLOPE), math.tan(math.radians(phi))
    sin, cos = math.sin(beta), math.cos(beta)
    up = (weight * cos**2 - pressure) * tan - driving * weight * sin * cos
    return up / (20e3 * (cos**2 + sin * cos * tan))


BUOYANT = 20e3 - WATER
ALONG = [[-30.0, 10.0], [25.0, 10.0], [50.0, 20.0], [90.0, 20.0]]


def test_a_face_with_a_pore_pressure_ratio_above_a_pond_is_told_once() -> None:
    """Water begins below its first metre, which fails at the same Kh: (cos² β - ru) tan φ - sin β cos β over
    cos² β + sin β cos β tan φ, from u = ru γ z in the infinite slope."""
    section = face_of_sand(water={"table": 7.5}, pore_pressure_ratio=0.15)
    pieces = shallow_failures(section, FIXED)
    (above,) = merged_faces(pieces)
    assert len(pieces) == 2
    assert (above.start, above.end) == (18.75, 50.0)
    beta = math.atan(SLOPE)
    cos, both = math.cos(beta) ** 2, math.sin(beta) * math.cos(beta)
    assert above.kh == pytest.approx((cos - 0.15 - both) / (cos + both), rel=1e-9)


def test_pieces_of_a_face_that_are_told_with_the_same_digits_are_told_once() -> None:
    """The upstream face of a dam with seepage had five pieces of Kh = 0.108, between which its water changes."""
    pieces = [
        ShallowFailure("shell", float(x), x + 1.0, 0.46, kh) for x, kh in enumerate((0.1083, 0.1080, 0.1081, 0.112))
    ]
    first, last = merged_faces(pieces)
    assert (first.start, first.end, first.kh) == (0.0, 3.0, 0.1080)
    assert (last.start, last.end, last.kh) == (3.0, 4.0, 0.112)


def test_the_edge_of_a_face_that_fails_at_almost_the_same_kh_is_not_told_beside_it() -> None:
    """A dam with seepage: its face below the pond failed at 0.0886, 0.18 m of wet sand above the pond at 0.0892, and
    the report had a shallow failure at 0.089 and an edge that fails at 0.089."""
    wet = ShallowFailure("shell", 30.0, 64.0, 0.46, 0.0886)
    [face] = merged_faces([wet, ShallowFailure("shell", 64.0, 64.18, 0.46, 0.0892)])
    assert (face.start, face.end, face.kh) == (30.0, 64.18, 0.0886)


def test_a_face_that_meets_the_pond_part_way_has_two_shallow_failures() -> None:
    """Buoyant below the pond, 0.2184; with water seeping out above it, 0.0223 and a factor of safety of 1.078. The
    middle of it all would tell 0.1204."""
    section = face_of_sand(water={"table": ALONG})
    below, above = shallow_failures(section, FIXED)
    assert (below.start, below.end, above.start, above.end) == (0.0, 25.0, 25.0, 50.0)
    assert below.kh == pytest.approx(infinite_slope(45.0, BUOYANT, 0.0), rel=1e-9)
    assert below.kh == pytest.approx(0.2184, abs=5e-5)
    assert above.kh == pytest.approx(infinite_slope(45.0, 20e3, WATER), rel=1e-9)
    assert above.kh == pytest.approx(0.0223, abs=5e-5)
    friction = [stratum.friction_angle for stratum in section.strata]
    factor = least_rolling_factor(section, faces_at(section, FIXED, 0.0), 0.0, friction)
    closed = (1.0 - WATER / (20e3 * math.cos(math.atan(SLOPE)) ** 2)) * math.tan(math.radians(45.0)) / SLOPE
    assert factor == pytest.approx(closed, rel=1e-9)
    assert factor == pytest.approx(1.078, abs=5e-4)


def test_bounds_say_what_they_leave_out_and_are_strict_only_without() -> None:
    """At the factor of the whole, 1.15, the face has failed: the shallow 1.078 stands beside the bounds. Where no face
    rolls before, nothing is strengthened."""
    few = BoundsSettings(gap=0.2, max_cells=800, davis=False)
    section = face_of_sand(water={"table": ALONG})
    bounds = kh_bounds(section, FIXED, few)
    assert min(face.kh for face in bounds.shallow_failures) == pytest.approx(0.0223, abs=5e-5)
    assert bounds.section is not section
    messages = safety_bounds(section, FIXED, few, smooth_sides=True)
    assert messages.shallow_failure == pytest.approx(1.078, abs=5e-4)
    assert messages.shallow_failure < messages.lower


@pytest.mark.parametrize("ratio", [0.2, 0.35])
def test_a_pore_pressure_ratio(ratio: float) -> None:
    section = face_of_sand(pore_pressure_ratio=ratio, density_saturated=None)
    [face] = shallow_failures(section, FIXED)
    whole = infinite_slope(45.0, 19e3, ratio * 19e3) * 20e3 / 19e3
    assert face.kh == pytest.approx(whole, rel=1e-9)


def test_a_drawdown_leaves_the_pressure_that_the_water_took_its_weight_from() -> None:
    """Above the new level the ground that does not drain has the pressure of a table along the face."""
    section = face_of_sand(42.0, water={"table": 18.0, "after_drawdown": 9.0})
    below, drawn, dry = shallow_failures(section, FIXED)
    assert [below.end, drawn.end] == pytest.approx([22.5, 45.0])
    assert below.kh == pytest.approx(infinite_slope(42.0, BUOYANT, 0.0), rel=1e-9)
    assert drawn.kh == pytest.approx(infinite_slope(42.0, 20e3, WATER), rel=1e-9)
    assert dry.kh == pytest.approx(math.tan(math.radians(42.0) - math.atan(SLOPE)), rel=1e-9)


def test_pressure_that_shaking_adds_counts_where_the_ground_is_shaken() -> None:
    section = face_of_sand(40.0, water={"table": 25.0}, excess_pore_pressure_ratio=0.3)
    [seismic] = shallow_failures(section, FIXED)
    [still] = shallow_failures(section, FIXED, excess_pressure=False)
    assert seismic.kh == pytest.approx(infinite_slope(40.0, BUOYANT, 0.3 * BUOYANT), rel=1e-9)
    assert still.kh == pytest.approx(infinite_slope(40.0, BUOYANT, 0.0), rel=1e-9)
    assert faces_at(section, FIXED, 0.0) == [still]


@pytest.mark.parametrize(("below", "weight", "strips"), [(0.1, 20e3, 1), (0.4, 19e3, 2)])
def test_water_just_below_the_face_counts_down_to_the_least_depth(below: float, weight: float, strips: int) -> None:
    """A table 0.1 m below the face: of the 0.5 m that are left out, 0.4 m are as wet as with the table along it. So
    thin a film of moist sand is left with the saturated one, and has its weight; 0.4 m are a stratum of their own."""
    table = [[-30.0, 10.0], [25.0, 10.0 - below], [50.0, 20.0 - below], [90.0, 20.0 - below]]
    section = face_of_sand(water={"table": table})
    worst = min((face for face in shallow_failures(section, FIXED) if face.end > 26.0), key=lambda face: face.kh)
    beta = math.atan(SLOPE)
    wet = infinite_slope(45.0, 20e3, WATER) * 20e3 * (0.5 - below)
    dry = math.tan(math.radians(45.0) - beta) * weight * below
    assert worst.kh == pytest.approx((wet + dry) / (20e3 * (0.5 - below) + weight * below), rel=1e-6)
    strong = strengthened(section, [worst], FIXED)
    assert sum("strengthened face" in s.name for s in strong.strata) == strips
    assert strong.layering.areas().sum() == pytest.approx(section.layering.areas().sum())


@st.composite
def random_face(draw: st.DrawFn) -> Section:
    """A face under a pond, and a table along it, below it, or level; ratios, a drawdown, pressure of shaking."""
    pond = draw(st.floats(-4.0, 22.0))
    below = draw(st.sampled_from([0.0, 0.0, 0.07, 0.3, 2.0]))
    top = draw(st.sampled_from(["level", "along", "rising"]))
    x = min(max(pond / SLOPE, 0.0), 50.0)
    behind = pond if top == "level" else 20.0 - below if top == "along" else draw(st.floats(pond, 30.0))
    table = [[-30.0, pond], *([[x, pond - below]] if 0.0 < x < 50.0 else []), [50.0, behind], [90.0, behind]]
    water: dict[str, Any] = {"table": table, "head": draw(st.sampled_from(["vertical", "normal"]))}
    if draw(st.booleans()):
        water["after_drawdown"] = draw(st.floats(-4.0, pond))
    changes = {
        "drains": draw(st.booleans()),
        "pore_pressure_ratio": draw(st.sampled_from([None, None, 0.0, 0.25])),
        "excess_pore_pressure_ratio": draw(st.sampled_from([0.0, 0.0, 0.4])),
    }
    return face_of_sand(draw(st.floats(28.0, 48.0)), water, **changes)


def by_force(section: Section, x: float, depth: float, shaking: bool) -> tuple[float, float, float]:
    """Weight less uplift, force of seepage to the left, and mass times g (N/m²) of the column of a thin layer below the
    face: sums over 200 points of its own differences of the pore pressure."""
    water = section.water_pressure
    ground = SLOPE * x
    z = ground - depth * (np.arange(200) + 0.5) / 200
    at = np.column_stack([np.full(200, x), z])
    layer = section.stratum_at(*at.T)

    def pressure(points: np.ndarray) -> np.ndarray:
        result = water.at_rest(points, at, layer)
        return result + water.excess(points, at, layer) if shaking else result

    step = 1e-4 * depth
    along, up = step * np.array([1.0, 0.0]), step * np.array([0.0, 1.0])
    rise = [(pressure(at + d) - pressure(at - d)) / (2.0 * step) for d in (along, up)]
    of_face = 9.80665 * np.array([section.strata[k].density_ordinary for k in layer])
    share = depth / 200
    return float(share * (of_face + rise[1]).sum()), float(share * rise[0].sum()), float(share * of_face.sum())


def message(section: Section, outcome: list[ShallowFailure], x: float) -> ShallowFailure | None:
    """The face at x, if it is one."""
    return next((face for face in outcome if face.start < x < face.end), None)


@given(random_face(), st.lists(st.floats(0.05, 49.95), min_size=5, max_size=20))
@settings(deadline=None)
def test_no_face_is_told_to_bear_more_than_its_infinite_slope(section: Section, places: list[float]) -> None:
    """Kh and factor of safety, at any place of the face that no water from outside holds, in a layer of 10 mm."""
    down = FIXED.model_copy(update={"direction": "downhill"})
    result, still = shallow_failures(section, down), faces_at(section, FIXED, 0.0)
    beta, phi = math.atan(SLOPE), section.strata[0].friction_angle
    least = least_rolling_factor(section, still, 0.0, [s.friction_angle for s in section.strata])
    for x in places:
        if min(abs(x - at) for at in (*section.water_pressure.kinks, *section.layering.x)) < 0.03:
            continue
        on = np.array([[x, SLOPE * x]])
        stratum = section.stratum_at(*(on - [[0.0, 1e-3]]).T)
        inside = section.water_pressure.at_rest(on, on, stratum)
        if section.water_pressure.on_ground(on, on)[0] > inside[0] + 1.0:
            assert message(section, result, x) is None
            continue
        vertical, left, mass = by_force(section, x, 0.01, shaking=True)
        kh = (vertical * math.tan(phi - beta) - left) / mass
        face = message(section, result, x)
        assert face is not None
        assert face.kh <= kh + 1e-6
        deeper = on - [[0.0, FIXED.least_depth]]  # water there counts, and the layer of 10 mm does not reach it
        wet_below = inside[0] <= 0.0 < section.water_pressure.at_rest(deeper, deeper, stratum)[0]
        if not (face.into_water or wet_below):
            assert face.kh == pytest.approx(kh, abs=1e-6)
        vertical, left, _ = by_force(section, x, 0.01, shaking=False)
        driven = beta + math.atan2(left, vertical)
        if driven > 0.0:
            assert least is not None
            assert least <= math.tan(phi) / math.tan(min(driven, math.pi / 2)) + 1e-6


@given(random_face())
@settings(max_examples=15, deadline=None)
def test_pore_pressure_is_linear_in_every_triangle(section: Section) -> None:
    """Bounds take it from the corners: where a table bends within a triangle they would be those of other water."""
    ground = section.cut_at_films
    mesh = first_mesh(ground, 2000)
    for pressure in (ground.water_pressure.at_rest, ground.water_pressure.excess):
        assert_linear(mesh, pressure)


def assert_linear(mesh: Any, pressure: Pressure) -> None:
    corner = corner_pressure(mesh, pressure)
    middle = mesh.points[mesh.cells].mean(axis=1)
    for j in range(3):
        ends = mesh.cells[:, [j, (j + 1) % 3]]
        half = pressure(mesh.points[ends].mean(axis=1), middle, mesh.stratum)
        over = at_ends(mesh, corner, np.arange(len(middle)), ends).mean(axis=1) - half
        assert np.abs(over).max() < 250.0


def bank_with_a_short_wet_face() -> Section:
    """A low-water bank of 1:2 whose table leaves the pond on the face and rises inwards, below a crust of clay."""
    crust = soil("Crust", bottom={"elevation": [[26.0, 9.0], [50.0, 9.0]]}, cohesion="25 kPa", friction_angle="0 deg")
    sand = soil("Sand", cohesion=0.0, friction_angle="31 deg", density="18.5 kN/m^3")
    sand["density_saturated"] = sand["density"]
    table = [[0.0, 8.5], [25.0, 8.5], [36.0, 9.8], [50.0, 9.8]]
    ground = {"surface": [[0.0, 6.0], [20.0, 6.0], [28.0, 10.0], [50.0, 10.0]], "base": {"elevation": 2.0}}
    return Section.parse({"name": "bank", **ground, "water": {"table": table}, "strata": [crust, sand]})


@cache
def bounds_of_that_bank() -> KhBounds:
    """With little work allowed."""
    return kh_bounds(bank_with_a_short_wet_face(), FemSettings(), BoundsSettings(seconds=3.0))


@pytest.mark.slow
def test_where_two_faces_meet_the_bounds_are_those_of_the_slope_as_a_whole() -> None:
    """Finer triangles find ever smaller mechanisms where the water meets such a face, 0.03 and less; the slope as a
    whole bears 0.0768 to 0.0784 (30 s of work), elements 0.0768 to 0.0776."""
    result = bounds_of_that_bank()
    assert [round(face.kh, 3) for face in result.shallow_failures if face.start < 25.0] == [0.036]
    assert 0.07 < result.lower < 0.0784
    assert 0.0768 < result.upper < 0.09
    assert result.shallow is None or result.shallow < 0.0364


def test_the_work_allowed_is_a_limit_of_all_bounds_together() -> None:
    """A mesh is begun only where its work is likely to fit, and no attempt may take more than is left, but for the few
    iterations that any program is given."""
    result = bounds_of_that_bank()
    work = sum(mesh.work for direction in result.directions for mesh in direction.meshes)
    assert work < 3.6
    assert result.end_reason == "time"


def test_a_sea_floor_level_to_rounding_has_both_bounds() -> None:
    """Half of it rises by 0.1 µm to 0.1 mm in 30 m: such a face was given a cohesion below the margin that stresses
    keep from the yield surface, and no mesh had a lower bound. Level sand fails at γ'/γ tan φ.
    """
    sand = soil("Sand", cohesion=0.0, friction_angle="32 deg", density="18 kN/m^3", density_saturated="20 kN/m^3")
    level = BUOYANT / 20e3 * math.tan(math.radians(32.0))
    for rise in (1e-7, 1e-4):
        ground = {"surface": [[0.0, 0.0], [30.0, 0.0], [60.0, rise]], "base": {"elevation": -8.0}}
        section = Section.parse({"name": "floor", **ground, "water": {"table": 2.0}, "strata": [sand]})
        assert shallow_failures(section, FIXED) == []
        bounds = kh_bounds(section, FIXED, BoundsSettings(gap=0.05, max_cells=1000))
        assert 0.95 * level < bounds.lower <= bounds.upper < 1.1 * level


@pytest.mark.slow
def test_bare_sand_from_which_water_seeps_is_strengthened_where_it_slips_first() -> None:
    """A dam with a core: its dry downstream face rolls at tan(36° - β) = 0.253, the slope fails upstream at 0.16, but
    water comes out of 0.8 m of the downstream toe, which does not stand. Such a dam was told as strict bounds,
    0.109 <= Kh <= 0.017: no face seemed to need strength, and pore pressures differ between coarse and fine triangles.
    """
    shell = soil("Shell", cohesion=0.0, friction_angle="36 deg", bottom={"elevation": 0.0}, permeability="1e-4 m/s")
    ground = soil("Ground", cohesion="5 kPa", friction_angle="32 deg", permeability="6e-6 m/s")
    core = soil("Core", cohesion="20 kPa", friction_angle="25 deg", permeability="1e-8 m/s")
    dam = {
        "name": "dam",
        "surface": [[-20, 0], [0, 0], [20, 8], [26, 8], [46, 0], [70, 0]],
        "base": {"elevation": -6.0},
        "water": {"flow": True, "table": [[-20, 6], [15, 6], [46, 0], [70, 0]]},
        "strata": [shell, ground],
        "zones": [core | {"points": [[22, 0], [24, 8], [25, 8], [27, 0]]}],
    }
    section, fem = Section.parse(dam), FemSettings(sides="smooth")
    bounds = kh_bounds(section, fem, BoundsSettings(gap=0.06, max_cells=1600))
    assert 0.15 < bounds.lower < 0.16 < bounds.upper < 0.17
    assert any(face.kh < 0.0 and face.end == pytest.approx(46.0) for face in bounds.shallow_failures)
    for direction in bounds.directions:
        assert direction.lower <= direction.upper


@pytest.mark.slow
@pytest.mark.parametrize(("direction", "lowest", "highest"), [("downhill", 0.0745, 0.0763), ("uphill", 0.142, 0.1466)])
def test_a_bank_out_of_which_water_flows_has_both_bounds_either_way(
    direction: str, lowest: float, highest: float
) -> None:
    """Water seeps out of 0.4 m of sand beside the pond, with a skin of it dry, and washes it out at rest.

    Below the skin sand without cohesion met the face, and against the force the face was left as it is: neither way had
    a lower bound. Elements have 0.0756 and 0.1456, bounds of much work 0.0745 to 0.0761 and 0.1437 to 0.1454.
    """
    ground = {"surface": [[0, 8], [20, 8], [36, 0], [60, 0]], "base": {"elevation": -6.0}}
    silt = soil("Silt", cohesion="6 kPa", friction_angle="30 deg", permeability="1e-6 m/s", bottom={"elevation": 3.0})
    sand = soil("Sand", cohesion=0.0, friction_angle="34 deg", permeability="1e-4 m/s", bottom={"elevation": -2.0})
    clay = soil("Clay", cohesion="40 kPa", friction_angle="0 deg", permeability="1e-8 m/s")
    water = {"flow": True, "table": [[0, 6], [20, 5], [32, 2], [60, 2]]}
    for item in (silt, sand, clay):
        item |= {"density": "1.8 t/m^3", "density_saturated": "2.0 t/m^3"}
    section = Section.parse({"name": "bank", **ground, "water": water, "strata": [silt, sand, clay]})
    wish = BoundsSettings(gap=0.1, max_cells=2500, seconds=20.0, davis=False)
    bounds = kh_bounds(section, FemSettings(direction=direction), wish)
    assert 0.9 * lowest < bounds.lower < highest
    assert lowest < bounds.upper < 1.15 * highest
    washed_out = [face for face in bounds.shallow_failures if face.kh < 0.0]
    assert washed_out[0].start > 31.7
    assert washed_out[-1].end < 32.2


@pytest.mark.slow
def test_rough_bounds_of_ground_without_equilibrium_leave_work_for_the_bounds() -> None:
    """Water seeps out of sand at the toe, which has no equilibrium before its face is strengthened: the solver looked
    for one for longer than all bounds were allowed to take, and there was no lower bound."""
    clay = soil("Clay", cohesion=30e3, friction_angle="0 deg", permeability="1e-8 m/s", bottom={"elevation": 6.5})
    sand = soil("Sand", cohesion=0.0, friction_angle="32 deg", permeability="1e-5 m/s")
    fill = soil("Fill", cohesion=3e3, friction_angle="24 deg", permeability="1e-7 m/s")
    fill["bottom"] = {"elevation": [[0.0, 7.87], [168.3, 8.71]]}
    levee = {
        "name": "levee",
        "surface": [[0.0, 0.0], [45.6, 0.0], [98.4, 13.2], [102.9, 13.2], [122.7, 0.5], [168.3, 0.5]],
        "base": {"elevation": -4.1},
        "water": {"table": [[0.0, 8.98], [81.5, 8.98], [102.9, 3.93], [122.7, -0.2], [168.3, -0.2]], "flow": True},
        "strata": [fill, clay, sand],
    }
    allowed = BoundsSettings(seconds=5.0, davis=False)
    bounds = kh_bounds(Section.parse(levee), FemSettings(direction="downhill"), allowed)
    assert bounds.work < 5.0
    assert 0.12 < bounds.lower < bounds.upper < 0.132
