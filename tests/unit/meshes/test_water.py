"""Water of a section: what is read, where it cuts strata, and its pressure by hand."""

import tomllib
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings

from meshes.section.cutting import BELOW_WATER, THICKEST_POCKET
from meshes.section.dense_lines import CELL
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section
from meshes.triangles import triangulate
from tests.support.sections import problems
from tests.support.water import BANK, WATER, at_rest, random_water, section, soil

TABLE = [[0.0, 7.0], [20.0, 6.0], [36.0, 3.6], [60.0, 3.6]]
PAIR = {"density": None, "density_saturated": None}


def test_a_stratum_that_the_table_crosses_is_moist_above_and_saturated_below() -> None:
    cut = section(soil("Sand", liquefies_in=[1]), water={"table": TABLE})
    above, below = cut.strata
    assert (above.name, below.name) == ("Sand", "Sand" + BELOW_WATER)
    assert above.density_ordinary == above.density_seismic == pytest.approx(18e3 / GRAVITY)
    assert below.density_ordinary == below.density_seismic == pytest.approx(20e3 / GRAVITY)
    assert not above.liquefiable
    assert below.liquefiable
    # by hand: between the ground and the table, which comes out of the ground at x = 36 m
    assert cut.layering.areas()[0] == pytest.approx(20.0 * 3.5 + 16.0 * 2.0, rel=1e-9)
    assert cut.layering.areas().sum() == pytest.approx(section().layering.areas().sum(), rel=1e-12)


def test_soil_above_the_water_that_a_zone_parts_does_not_liquefy_either() -> None:
    """Sand above an anchor block liquefied, and the sand beside the block above the same water did not."""
    block = {**soil("Block", cohesion="3 MPa"), "points": [[8.0, 6.0], [12.0, 6.0], [12.0, 9.0], [8.0, 9.0]]}
    cut = section(soil("Sand", liquefies_in=[1]), water={"table": 7.0}, zones=[block])
    sand = [stratum for stratum in cut.strata if stratum.name.startswith("Sand")]
    assert [(s.name, s.liquefiable) for s in sand] == [
        ("Sand", False), ("Sand, part 2", False), ("Sand, part 2" + BELOW_WATER, True)
    ]  # fmt: skip
    assert not any("lies above the water table" in text for text in cut.notices)


def test_what_is_below_water_altogether_is_saturated_and_keeps_its_name() -> None:
    [below] = section(water={"table": 12}).strata
    assert (below.name, below.density_ordinary) == ("Soil", pytest.approx(20e3 / GRAVITY))


def test_water_that_passes_through_a_face_beside_a_point_of_its_table_meets_it_there() -> None:
    """The table's point is 5 mm before the face: a sliver of ground above it, 8 mm by 2.5 m, had no mesh."""
    ground = {"surface": [[0.0, 8.8], [19.1, 8.8], [24.6, 0.0], [43.1, 0.0]], "base": {"elevation": -4.7}}
    table = [[0.0, 6.0], [21.5, 4.06], [23.27, 2.12], [43.1, 2.12]]
    bank = Section.parse({"name": "bank", **ground, "strata": [soil()], "water": {"table": table}})
    moist = bank.layering.polygons(0)[0]
    assert moist[:, 0].max() == pytest.approx(23.27)
    assert len(triangulate(bank, 2.0).cells) > 100


def test_a_section_that_was_cut_is_read_back_as_it_is() -> None:
    cut = section(soil("Sand", bottom={"depth": 6}), soil("Clay"), water={"table": TABLE})
    again = Section.parse(tomllib.loads(cut.to_toml()))
    assert again.to_toml() == cut.to_toml()


def test_without_water_nothing_is_cut_and_one_density_is_both() -> None:
    [only] = section(soil(density_saturated=None)).strata
    assert only.density_ordinary == only.density_seismic == pytest.approx(18e3 / GRAVITY)
    assert not section().water_pressure.present


@settings(max_examples=40, deadline=None)
@given(random_water())
def test_cut_strata_fill_the_section_and_lie_on_their_side_of_the_water(cut: Section) -> None:
    assert cut.layering.areas().sum() == pytest.approx(section().layering.areas().sum(), rel=1e-9)
    table = cut.water_points()
    # a pocket smaller than cells stays with the other half
    pocket = THICKEST_POCKET * CELL * float(cut.layering.areas().sum() / np.ptp(cut.extent))
    for k, stratum in enumerate(cut.strata):
        whole = any(other.name == stratum.name + BELOW_WATER for other in cut.strata)
        for polygon in cut.layering.polygons(k):
            over = polygon[:, 1] - np.interp(polygon[:, 0], *table.T)
            if stratum.name.endswith(BELOW_WATER):
                assert over.max() <= 0.02 + pocket
            elif whole:
                assert over.min() >= -0.02 - pocket


def test_pressure_is_hydrostatic_below_the_table_and_water_stands_on_the_ground() -> None:
    bank = section(water={"table": TABLE})
    np.testing.assert_allclose(
        at_rest(bank, (10.0, 9.0), (10.0, 0.0), (50.0, 2.0), (50.0, -5.0)), WATER * np.array([0.0, 6.5, 1.6, 8.6])
    )
    ground = np.array([[10.0, 10.0], [50.0, 2.0]])
    np.testing.assert_allclose(bank.water_pressure.on_ground(ground, ground), [0.0, 1.6 * WATER])


def test_head_across_the_flow_is_less_by_the_cosine_of_the_slope_squared() -> None:
    slope = [[0.0, 9.0], [60.0, 3.0]]
    vertical, normal = (section(water={"table": slope, "head": head}) for head in ("vertical", "normal"))
    cosine = np.cos(np.arctan(0.1))
    np.testing.assert_allclose(at_rest(normal, (30.0, 0.0)), cosine**2 * at_rest(vertical, (30.0, 0.0)), rtol=1e-12)


def test_a_stratum_may_have_a_level_or_a_ratio_of_its_own() -> None:
    perched = soil("Fill", bottom={"elevation": 6.0}, piezometric_level=8.0)
    clay = soil("Clay", bottom={"elevation": 0.0}, pore_pressure_ratio=0.5, density_saturated=None)
    three = section(perched, clay, soil("Rock", piezometric_level=12.0), water={"table": 1.0})
    weight = 2.0 * 18e3 + 2.0 * 20e3 + 3.0 * 18e3  # 2 m moist, 2 m saturated, 3 m of clay
    wanted = [0.0, 1.0 * WATER, 0.5 * weight, 14.0 * WATER]
    np.testing.assert_allclose(at_rest(three, (5.0, 9.0), (5.0, 7.0), (5.0, 3.0), (5.0, -2.0)), wanted)


def test_shaking_adds_its_share_of_the_vertical_effective_stress() -> None:
    bank = section(soil(excess_pore_pressure_ratio=0.4), water={"table": 12.0})
    at = np.array([[50.0, -3.0]])
    effective = 5.0 * (20e3 - WATER)
    added = bank.water_pressure.excess(at, at, bank.stratum_at(*at.T))
    np.testing.assert_allclose(added, 0.4 * effective)
    # of the paper's densities the ordinary one is effective already
    pair = section(soil(density_ordinary=1000.0, density_seismic=2000.0, excess_pore_pressure_ratio=0.4, **PAIR))
    np.testing.assert_allclose(pair.water_pressure.excess(at, at, np.zeros(1, int)), 0.4 * 5.0 * 1000.0 * GRAVITY)


def test_shaking_adds_no_pore_pressure_above_the_water() -> None:
    """Moist sand above the table had 0.4 of its weight as pore pressure after shaking."""
    bank = section(soil(excess_pore_pressure_ratio=0.4), water={"table": 7.0})
    assert [stratum.excess_pore_pressure_ratio for stratum in bank.strata] == [0.0, 0.4]
    at = np.array([[10.0, 8.0], [10.0, 5.0]])
    added = bank.water_pressure.excess(at, at, bank.stratum_at(*at.T))
    top = float(np.interp(10.0, *bank.ground.T))
    np.testing.assert_allclose(added, [0.0, 0.4 * ((top - 7.0) * 18e3 + 2.0 * (20e3 - WATER))])
    assert section(soil(excess_pore_pressure_ratio=0.4)).strata[0].excess_pore_pressure_ratio == 0.4  # without a table


def test_after_a_drawdown_ground_that_does_not_drain_keeps_its_pressure_less_the_water_taken_off() -> None:
    falls = {"table": 9.0, "after_drawdown": 3.0}
    bank = section(water=falls)
    # inland there was no water on the ground; over the foot of the slope there were 7 m and there is 1 m
    np.testing.assert_allclose(at_rest(bank, (10.0, 0.0), (50.0, 0.0)), [9.0 * WATER, 3.0 * WATER])
    # complete: what is left is hydrostatic from the face (Morgenstern 1963)
    complete = section(water={"table": 9.0, "after_drawdown": 2.0})
    np.testing.assert_allclose(at_rest(complete, (30.0, 1.0)), 5.0 * WATER)
    drained = section(soil(drains=True), water=falls)
    np.testing.assert_allclose(at_rest(drained, (10.0, 0.0), (50.0, 0.0)), 3.0 * WATER)


def test_a_surcharge_is_linear_between_its_ends_and_nothing_beside_them() -> None:
    [load] = section(surcharges=[{"from": 2, "to": 6.0, "pressure": ["10 kPa", "30 kPa"]}]).surcharges
    x = np.array([1.0, 2.0, 5.0, 6.0])
    np.testing.assert_allclose(load.at(x, x + np.array([0.0, 0.1, 0.0, 0.1])), [0.0, 1e4, 2.5e4, 0.0])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"water": {"table": [[0, 5], [30, 5], [30, 3], [60, 3]]}}, "water, table: a step at x = 30 m"),
        ({"water": {"table": [[0, 5], [50, 3]]}}, "water, table: expected a line across the whole section"),
        ({"water": {"after_drawdown": 3}}, "after_drawdown without table"),
        ({"water": {"table": 3}, "water_table": {"elevation": 1}}, "water_table together with [water]"),
        ({"water": {"tabel": 3}}, 'did you mean "table"?'),
        ({"surcharges": [{"from": 5, "to": 3, "pressure": 1e4}]}, "expected the left end, then the right end"),
        ({"surcharges": [{"from": 5, "to": 70, "pressure": 1e4}]}, "lies outside the section"),
        ({"surcharges": [{"from": 5, "to": 7, "pressure": "2 m"}]}, "wrong dimension"),
        ({"strata": [soil(**PAIR)]}, "density: missing"),
        ({"strata": [soil(density_ordinary=1000.0)]}, "expected density, or the other two"),
        ({"strata": [soil(density_saturated=1700.0)]}, "density_saturated below density"),
        ({"strata": [soil(piezometric_level=3.0, pore_pressure_ratio=0.1)]}, "expected one of them"),
        ({"strata": [soil(excess_pore_pressure_ratio=1.2)]}, "expected at most 1"),
        (
            {"strata": [soil(density_ordinary=1000.0, density_seismic=2000.0, **PAIR)], "water": {"table": 5}},
            "is already reduced by uplift",
        ),
    ],
)
def test_what_is_wrong_is_told(changes: dict[str, Any], message: str) -> None:
    said = problems({"name": "bank", **BANK, "strata": [soil()], **changes})
    assert any(message in text for text in said), said


def test_soil_that_lies_below_water_as_a_whole_needs_its_saturated_density_alone() -> None:
    item, both = (section(soil(density=density), water={"table": 12.0}) for density in (None, "20 kN/m^3"))
    for weighed in (item.strata[0], both.strata[0]):
        assert weighed.density_ordinary == weighed.density_seismic == pytest.approx(20e3 / GRAVITY)


def test_films_of_moist_ground_weigh_as_much_when_a_section_is_written_and_read() -> None:
    """Found on 12 of 300 random tables: what is left to the saturated part, as too thin for cells, was weighed as
    saturated by bounds after a round trip."""
    soil = {"youngs_modulus": "20 MPa", "poissons_ratio": 0.3, "cohesion": "5 kPa", "friction_angle": "32 deg"}
    silt = {"name": "Silt", "density": "15 kN/m^3", "density_saturated": "19 kN/m^3", **soil}
    sand = {"name": "Sand", "bottom": {"elevation": -1}, "density": "16 kN/m^3", "density_saturated": "20 kN/m^3"}
    table = [[0.0, 8.9], [40.9, 6.9], [58.7, 2.08], [80.0, -1.08]]
    before = Section.parse({
        "name": "films", "surface": [[0, 10], [30, 10], [50, 2], [80, 2]], "base": {"elevation": -6},
        "water": {"table": table}, "strata": [{**sand, **soil}, silt],
    })  # fmt: skip
    again = Section.parse(tomllib.loads(before.to_toml()))
    first, then = (
        [(stratum.name, stratum.density_ordinary) for stratum in section.cut_at_films.strata]
        for section in (before, again)
    )
    assert "Silt, film" in dict(first)
    assert dict(first)["Silt, film"] == pytest.approx(15e3 / 9.80665)
    assert first == then
