"""Pore pressure above the weight of all that lies above it: where, and by how much."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshes.section.section import Section
from tests.support.water import WATER, random_water, section, soil

FLAT = {"surface": [[0.0, 0.0], [40.0, 0.0]], "base": {"elevation": -12.0}}


def above_an_aquifer(level: float, thickness: float = 4.0, **changes: Any) -> Section:
    """Level clay of 18 kN/m³ on sand whose water would rise to a level."""
    clay = soil("Clay", bottom={"depth": thickness}, density="18 kN/m^3", density_saturated=None)
    sand = soil("Sand", piezometric_level=level, density="20 kN/m^3", density_saturated=None)
    return section(clay, sand, **FLAT, **changes)


def test_clay_above_an_aquifer_lifts_off_where_its_water_would_rise_too_far() -> None:
    """4 m of clay weigh 72 kPa, as much as 7.34 m of water: with a level 4.5 m above ground the factor is 0.864."""
    assert above_an_aquifer(18.0 * 4.0e3 / WATER - 4.0).uplift is None
    uplift = above_an_aquifer(4.5).uplift
    assert uplift is not None
    assert (uplift.stratum, uplift.elevation, uplift.weight) == ("Sand", -4.0, pytest.approx(72e3, rel=1e-9))
    assert uplift.pressure == pytest.approx(8.5 * WATER, rel=1e-9)
    assert uplift.factor == pytest.approx(72e3 / (8.5 * WATER), rel=1e-9)
    assert (uplift.start, uplift.end) == (0.0, 40.0)
    assert not uplift.bare
    assert "83.4 kPa under a total vertical stress of 72.0 kPa (factor against uplift 0.86)" in uplift.description
    assert any("factor against uplift 0.86" in notice for notice in above_an_aquifer(4.5).notices)


def test_water_and_loads_on_the_ground_hold_it_down() -> None:
    pond = above_an_aquifer(4.5, water={"table": 1.2})
    assert pond.uplift is None
    pond = above_an_aquifer(4.5, water={"table": 1.1})
    assert pond.uplift is not None
    assert pond.uplift.weight == pytest.approx(72e3 + 1.1 * WATER, rel=1e-9)
    load = above_an_aquifer(4.5, surcharges=[{"from": 10.0, "to": 30.0, "pressure": "12 kPa"}]).uplift
    assert load is not None
    assert load.x <= 10.0 or load.x >= 30.0


def test_an_excavation_above_a_lens_blows_out_where_its_floor_is_too_thin() -> None:
    """Its slope rises at 1:2 from x = 10 m: weight and pressure are equal where 18 (2 + 0.5 (x - 10)) = 9.81 x 6."""
    clay = soil("Clay", bottom={"elevation": -6.0}, density="18 kN/m^3", density_saturated=None)
    sand = soil("Sand", piezometric_level=0.0, density_saturated=None)
    pit = {"surface": [[-20.0, -4.0], [10.0, -4.0], [22.0, 2.0], [40.0, 2.0]], "base": {"elevation": -12.0}}
    uplift = section(clay, sand, **pit).uplift
    assert uplift is not None
    assert uplift.weight == pytest.approx(36e3, rel=1e-9)
    assert (uplift.start, uplift.end) == (-20.0, pytest.approx(10.0 + 2.0 * (6.0 * WATER / 18e3 - 2.0), rel=1e-6))


def test_ground_above_the_tip_of_a_stratum_lifts_off_on_both_sides_of_it() -> None:
    """The sand has no thickness 4 m below the ground at x = 20 m, and dips from there to both sides by 1:5: clay of
    18 d (kN/m²) weighs less than its pressure, 9.81 (d + 4), down to d = 4.79 m."""
    top = [[0.0, -8.0], [20.0, -4.0], [40.0, -8.0]]
    bottom = [[0.0, -9.0], [20.0, -4.0], [40.0, -9.0]]
    clay = soil("Clay", bottom={"elevation": top}, density="18 kN/m^3", density_saturated=None)
    sand = soil(
        "Sand", bottom={"elevation": bottom}, piezometric_level=4.0, density="18 kN/m^3", density_saturated=None
    )
    rock = soil("Rock", density="18 kN/m^3", density_saturated=None)
    uplift = section(clay, sand, rock, **FLAT).uplift
    assert uplift is not None
    assert (uplift.x, uplift.elevation) == (20.0, -4.0)
    deepest = 4.0 * WATER / (18e3 - WATER)
    assert (uplift.start, uplift.end) == pytest.approx((20.0 - 5.0 * (deepest - 4.0), 20.0 + 5.0 * (deepest - 4.0)))


@pytest.mark.parametrize(("ratio", "lifts"), [(0.9, False), (1.0, False), (1.1, True)])
def test_a_pore_pressure_ratio_above_one_lifts_all_of_it(ratio: float, lifts: bool) -> None:
    uplift = section(soil(pore_pressure_ratio=ratio, density_saturated=None), unusual=True).uplift
    assert (uplift is not None) == lifts
    if uplift is not None:
        assert uplift.factor == pytest.approx(1.0 / 1.1, rel=1e-9)
        assert uplift.elevation == -5.0


def test_a_drawdown_takes_the_water_off_that_held_the_ground_down() -> None:
    """A piezometric level of its own does not follow it."""
    assert above_an_aquifer(4.5, water={"table": 3.0}).uplift is None
    assert above_an_aquifer(4.5, water={"table": 3.0, "after_drawdown": 0.0}).uplift is not None


def test_sand_whose_water_would_rise_above_the_ground_is_bare() -> None:
    sand = soil("Sand", cohesion=0.0, piezometric_level=[[0.0, 10.0], [20.0, 10.0], [40.0, 3.0], [60.0, 3.0]])
    uplift = section(sand).uplift
    assert uplift is not None
    assert uplift.bare
    cohesive = section({**sand, "cohesion": "5 kPa"}).uplift
    assert cohesive is not None
    assert not cohesive.bare


@given(random_water(), st.floats(-6.0, 20.0))
@settings(max_examples=40, deadline=None)
def test_no_place_is_worse_than_the_one_that_is_told(bank: Section, level: float) -> None:
    """Looked for at random, with a level of its own in the lower soil."""
    strata = [*bank.strata[:-1], bank.strata[-1].model_copy(update={"pore_pressure_ratio": None})]
    data = bank.model_dump(mode="python", exclude_none=True, by_alias=True)
    data["strata"] = [s.model_dump(mode="python", exclude_none=True, by_alias=True) for s in strata]
    data["strata"][-1]["piezometric_level"] = level
    ground = Section.parse(data)
    random = np.random.default_rng(1)
    x = random.uniform(0.01, 59.99, 400)
    edges = ground.layering.interfaces(x)
    z = edges[:, -1] + random.uniform(0.0, 1.0, 400) * (edges[:, 0] - edges[:, -1])
    at, water = np.column_stack([x, z]), ground.water_pressure
    weight = water.overburden(at, at) + water.ponded(water.table_after, at, at)
    weight -= ground.surface_loads.dead(at, at, np.tile([0.0, 1.0], (400, 1)))[:, 1]
    excess = water.at_rest(at, at, ground.stratum_at(x, z)) - weight
    most = 100.0 if ground.uplift is None else ground.uplift.pressure - ground.uplift.weight
    assert excess.max() <= most * (1.0 + 1e-9) + 1e-6
    if ground.uplift is not None:
        wrong = x[excess > 100.0]
        assert np.all((wrong >= ground.uplift.start - 1e-6) & (wrong <= ground.uplift.end + 1e-6))


@pytest.mark.parametrize(("head", "lifts"), [(4.0, False), (9.0, True)])
def test_water_that_rises_behind_a_wall_lifts_sand_above_the_critical_gradient(head: float, lifts: bool) -> None:
    """It rises beside a wall of depth d at a gradient of h / (π d) in deep ground (Harr 1962, section 5-6), and
    lifts sand above γ'/γw, 1.04 at 20 kN/m³ (Terzaghi 1943, article 94): inside, as no pressure is on the ground."""
    sand = soil("Sand", density="20 kN/m^3", density_saturated=None, permeability="1e-4 m/s")
    table = [[-20.0, head], [0.0, head], [0.0, 0.0], [20.0, 0.0]]
    water = {"flow": True, "table": table, "cutoffs": [{"x": 0.0, "bottom": -2.0}]}
    ground = {"surface": [[-20.0, 0.0], [20.0, 0.0]], "base": {"elevation": -15.0}}
    uplift = section(sand, water=water, **ground).uplift
    assert (uplift is not None) == lifts
    if uplift is not None:
        assert 0.0 <= uplift.start <= uplift.x < uplift.end < 2.0
        assert -4.0 < uplift.elevation < 0.0
