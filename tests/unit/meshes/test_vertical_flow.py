"""Vertical flow through a clay between a water table and a confined aquifer: its pore pressure by hand, and where it
reaches."""

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dem.ground import ground_of
from dem.laboratory.soil_contacts import soil_layers
from dem.settings import DemSettings
from fem.mpm.pore_water import _pressure as pressure_of_points
from meshes.errors import InputError
from meshes.section.overburden import overburden
from meshes.section.section import Section
from tests.support.water import WATER, at_rest, soil
from workflow.estimates.slices import divide
from workflow.report.tables import line_rows
from workflow.section_import.section_from_files import to_be_given

FEW = DemSettings(elements=300, packing="random")


def ground(flow: Any = None, **changes: Any) -> Section:
    """6 m of clay, in two strata, under water 1 m deep, on sand whose water rises to 4 m."""
    flows = ({"lower_level": 4.0}, None) if flow is None else flow
    strata = [
        soil("Clay", bottom={"elevation": -6.0 if flow is None else -2.0}, vertical_flow=flows[0]),
        *([] if flow is None else [soil("Peat", bottom={"elevation": -6.0}, vertical_flow=flows[1])]),
        soil("Sand", piezometric_level=4.0),
    ]
    data = {"name": "polder", "surface": [[0, 0], [20, 0]], "base": {"elevation": -10}, "water": {"table": 1.0}}
    return Section.parse({**data, "strata": strata, **changes})


def test_the_level_is_linear_between_the_table_and_the_aquifer() -> None:
    """At the ground 1 m, at the bottom of the clay 4 + 6 m, half-way 2.5 + 3 m of water; in the sand hydrostatic."""
    polder = ground()
    np.testing.assert_allclose(
        at_rest(polder, (5, 0), (5, -3), (5, -5.999999), (5, -8)), WATER * np.array([1, 5.5, 10, 12]), rtol=1e-5
    )
    point = overburden(polder, 5.0, 3.0)
    assert point.below_water
    assert point.effective == pytest.approx(3.0 * 20e3 + WATER - 5.5 * WATER)


def test_one_flow_passes_through_two_strata_and_past_its_ends() -> None:
    """From -1 to -6 m, over both; above it the water is hydrostatic."""
    flow = {"upper_level": 1.0, "lower_level": [[0.0, 4.0], [20.0, 6.0]], "top": -1.0, "bottom": -6.0}
    polder = ground((flow, flow))
    assert [len(polder.strata), polder.water_pressure.present] == [3, True]
    np.testing.assert_allclose(
        at_rest(polder, (0.1, -0.5), (10, -1.5), (10, -3.5), (10, -5.5)),
        WATER * np.array([1.5, 1.0 + 0.4 + 1.5, 1.0 + 2.0 + 3.5, 1.0 + 3.6 + 5.5]),
        rtol=1e-12,
    )


def test_water_that_is_drained_below_leaves_the_clay_without_pressure_from_where_it_would_be_negative() -> None:
    """A table at the ground over an aquifer with water at -8 m: h = -4/3 d and d >= 0, so that u = -γ_w d / 3 is 0."""
    clay = soil("Clay", bottom={"elevation": -6.0}, vertical_flow={"lower_level": -8.0})
    drained = ground(water={"table": 0.0}, strata=[clay, soil("Sand", piezometric_level=-8)])
    assert not at_rest(drained, (5, -1), (5, -5), (5, -7.9)).any()
    artesian = ground(water={"table": -2.0})  # h = -2 + d, u = 2 γ_w (d - 1) from 1 m down, where the clay is cut
    np.testing.assert_allclose(at_rest(artesian, (5, -0.5), (5, -2), (5, -4)), WATER * np.array([0, 2, 6]), atol=1e-6)
    assert [stratum.name for stratum in artesian.strata] == ["Clay", "Clay, below water", "Sand"]
    np.testing.assert_allclose(artesian.layering.areas()[:2], [20.0, 100.0])


def test_a_file_with_it_is_read_again_and_zones_and_steps_keep_it() -> None:
    bank = {"surface": [[0, 4], [5, 4], [5, 0], [20, 0]]}
    zone = {
        "name": "Key",
        "points": [[2, 3], [4, 3], [4, -1], [2, -1]],
        **{k: soil()[k] for k in soil() if k != "name"},
    }
    polder = ground(**bank, zones=[zone])
    again = Section.parse(tomllib.loads(polder.to_toml()))
    points = (1.0, 0.5), (1.0, -3.0), (10.0, -3.0), (3.0, -2.0)
    np.testing.assert_allclose(at_rest(again, *points), at_rest(polder, *points))
    # Beside the step the flow begins at 4 m, so that h is 1 + 3 (4 - z) / 10 m; the zone has the table.
    np.testing.assert_allclose(at_rest(polder, *points)[:3], WATER * np.array([1.55, 6.1, 5.5]))
    assert at_rest(polder, (3.0, -0.5))[0] == pytest.approx(1.5 * WATER)


def test_the_ground_blows_out_above_the_critical_gradient() -> None:
    """u = γ_w (1 + 6 + 1.5 + 6.19...) lifts 6 m of 20 kN/m³ under 1 m of water: (4 - 1) / 6 is half the gradient."""
    assert ground().uplift is None
    critical = 1.0 + 6.0 * (20e3 / WATER - 1.0)
    for level, lifted in ((critical - 0.05, False), (critical + 0.05, True)):
        clay = soil("Clay", bottom={"elevation": -6.0}, vertical_flow={"lower_level": level})
        assert (ground(strata=[clay, soil("Sand", pore_pressure_ratio=0.0)]).uplift is not None) == lifted


@pytest.mark.parametrize("drains", [False, True])
@pytest.mark.parametrize("upper", [None, 2.0])
def test_a_drawdown_takes_the_load_off_clay_and_lowers_the_level_of_ground_that_drains(
    drains: bool, upper: float | None
) -> None:
    """From 1 m above the ground to 2 m below it: clay loses the γ_w of 1 m everywhere; a steady flow begins at -2 m, so
    that h is 6 m higher over 6 m of depth. The pressure stayed as it was."""
    flow = {"lower_level": 4.0} if upper is None else {"lower_level": 4.0, "upper_level": upper}
    clay = soil("Clay", bottom={"elevation": -6.0}, vertical_flow=flow, drains=drains)
    lowered = ground(strata=[clay, soil("Sand", piezometric_level=4.0)], water={"table": 1.0, "after_drawdown": -2.0})
    points, depth = [(5, -0.5), (5, -3), (5, -5.5)], np.array([0.5, 3, 5.5])
    start = 1.0 if upper is None else upper
    head = start + (4.0 - start) / 6.0 * depth + depth - 1.0
    if drains and upper is None:
        head = -2.0 + depth + depth
    elif drains:
        head = head + 1.0
    np.testing.assert_allclose(at_rest(lowered, *points), WATER * np.maximum(head, 0.0), rtol=1e-9)
    assert not lowered.water_pressure.on_ground(np.array([[5.0, 0.0]]), np.array([[5.0, 0.0]])).any()


def test_discs_points_and_slices_take_its_pressure() -> None:
    """-du/dz is γ_w (1 + 3 / 6) upwards."""
    polder = ground()
    layers = [layer.springs(0.5, 0.25) for layer in soil_layers(polder)]
    discs = ground_of(polder, FEW).model(layers, FEW)
    inside = ~discs.fixed & (discs.z > -4.5) & (discs.z < -1.5)
    assert inside.sum() > 20
    density = polder.strata[0].density_seismic
    np.testing.assert_allclose(discs.pore_acceleration_z[inside], 1.5 * WATER / density, rtol=1e-9)
    np.testing.assert_allclose(pressure_of_points(polder, np.array([[5.0, -3.0]])), 5.5 * WATER)
    x, z = np.linspace(4.0, 8.0, 3)[None], np.array([[0.0, -3.0, 0.0]])
    np.testing.assert_allclose(divide(polder, x, z).pressure, WATER * 3.25, rtol=1e-12)


def test_the_report_lists_its_lines() -> None:
    names = {name: points for name, _, points in line_rows(ground())}
    assert names["vertical flow through Clay: lower level"] == "4"
    assert names["vertical flow through Clay: bottom"].startswith("(0, -6)")


def test_a_section_that_water_lifts_is_not_called_sound(tmp_path: Path) -> None:
    lifted = tmp_path / "polder.toml"
    for level, words in ((13.0, "lifts the ground"), (4.0, "It is sound.")):
        clay = soil("Clay", bottom={"elevation": -6.0}, vertical_flow={"lower_level": level})
        lifted.write_text(ground(strata=[clay, soil("Sand", piezometric_level=level)]).to_toml())
        assert words in to_be_given(lifted, "It is sound.")[-1]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"water": None}, 'strata 1 "Clay", vertical_flow, upper_level: missing'),
        ({"water": {"table": 1.0, "flow": True}}, "vertical_flow: expected none with flow = true"),
        ({"strata": [soil(vertical_flow={"lower_level": 4.0}, pore_pressure_ratio=0.1)]}, "expected one of them"),
        ({"strata": [soil(vertical_flow={"upper_level": 4.0})]}, "lower_level"),
        ({"strata": [soil(vertical_flow={"lower_level": [[0, 1], [9, 1], [9, 2], [20, 2]]})]}, "a step at x = 9 m"),
    ],
)
def test_bad_flow_is_refused(changes: Any, words: str) -> None:
    with pytest.raises(InputError) as refused:
        ground(**changes)
    assert words in str(refused.value)
