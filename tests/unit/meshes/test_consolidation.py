"""The state to which the ground consolidated: where its lines come from, and what is refused."""

import tomllib
from typing import Any

import numpy as np
import pytest

from meshes.errors import InputError
from meshes.section.polyline import lower_line
from meshes.section.section import Section
from tests.support.water import soil


def ground(**changes: Any) -> Section:
    clay = soil("Clay", cohesion=0, friction_angle=0, strength_ratio=0.25, density="18 kN/m^3", density_saturated=None)
    data = {"name": "polder", "surface": [[0, 0], [20, 0]], "base": {"elevation": -10}, "water": {"table": 2.0}}
    return Section.parse({**data, "strata": [clay], "consolidation": {"table": -1.0}, **changes})


def strength(section: Section, x: float, z: float) -> float:
    at = np.array([[x, z]])
    return float(section.cohesion_field.at(at, at, section.stratum_at(*at.T))[0])


def test_a_flood_does_not_lower_the_preconsolidation() -> None:
    """At 3 m σ'v falls from 3 x 18 - 2 x 9.81 to 3 x (18 - 9.81) kPa: to 71 %, the strength by 0.71^0.2 only."""
    water = 9.80665e3
    before, now = 3.0 * 18e3 - 2.0 * water, 3.0 * (18e3 - water)
    assert strength(ground(), 5.0, -3.0) == pytest.approx(0.25 * now**0.2 * before**0.8, rel=1e-6)
    assert strength(ground(consolidation=None), 5.0, -3.0) == pytest.approx(0.25 * now, rel=1e-6)


@pytest.mark.parametrize("below", [0.0, -1.0])
def test_a_drawdown_does_not_change_the_strength_of_clay_below_a_new_dam(below: float) -> None:
    """Below the crest σ'v was 0, since the water in the dam above the line counted with the lower table alone."""
    dam = [[0, 0], [20, 0], [30, 6], [34, 6], [44, 0], [64, 0]]
    clay = {**soil("Clay", cohesion=0, friction_angle=0, strength_ratio=0.25), "consolidated_below": below}
    fill = {**soil("Fill"), "bottom": {"elevation": 0.0}}
    water = {"table": [[0, 5], [28, 5], [44, 0], [64, 0]]}
    lower = {**water, "after_drawdown": [[0, 1], [22, 1], [44, 0], [64, 0]]}
    full, emptied = (ground(surface=dam, strata=[fill, clay], water=state, consolidation=None)
                     for state in (water, lower))  # fmt: skip
    for x in (5.0, 24.0, 31.0, 50.0):
        assert strength(full, x, -5.0) > 0.0
        assert strength(emptied, x, -5.0) == pytest.approx(strength(full, x, -5.0), rel=1e-9)


def test_seepage_in_a_new_dam_loads_clay_by_its_pore_pressure_not_by_the_table_of_heads() -> None:
    """Behind a wall that closes the dam σ'v is γ' z; the straight table of heads added the weight of 2 m of water."""
    dam = [[0, 0], [20, 0], [30, 6], [34, 6], [44, 0], [64, 0]]
    clay = {**soil("Clay", cohesion=0, friction_angle=0, strength_ratio=0.25, permeability="1e-9 m/s"),
            "consolidated_below": 0.0}  # fmt: skip
    fill = {**soil("Fill", permeability="1e-6 m/s"), "bottom": {"elevation": 0.0}}
    water = {"flow": True, "table": [[0, 5], [28, 5], [44, 0], [64, 0]], "cutoffs": [{"x": 32, "bottom": -10}]}
    closed = ground(surface=dam, strata=[fill, clay], water=water, consolidation=None)
    assert strength(closed, 37.0, -5.0) == pytest.approx(0.25 * 5.0 * (20e3 - 9.80665e3), rel=1e-3)
    open_dam = ground(surface=dam, strata=[fill, clay], water={**water, "cutoffs": []}, consolidation=None)
    corners = np.array([[[x, -4.0], [x + 2.0, -4.0], [x, -4.5]] for x in np.arange(1.0, 62.0, 0.5)])
    field, clays = open_dam.cohesion_field, np.full(len(corners), len(open_dam.strata) - 1)
    at = corners.reshape(-1, 2)
    exact = field.at(at, np.repeat(corners.mean(axis=1), 3, axis=0), np.repeat(clays, 3)).reshape(-1, 3)
    # At the toe, where the load of the water bends upwards, the lower bounds had no strength at all.
    assert (field.corners(corners, clays, above=False) > 0.95 * exact).all()
    assert (field.corners(corners, clays, above=True) < 1.05 * exact).all()


def test_its_depths_are_below_the_ground_without_zones_that_raise_it() -> None:
    berm = {"name": "Berm", "points": [[5, 0], [15, 0], [14, 2], [6, 2]], "material": "Clay"}
    state = {"table": {"depth": 1.0}, "surface": {"depth": 0.0}}
    raised = ground(zones=[berm], consolidation=state)
    assert raised.cohesion_field.state is not None
    for line, z in zip(raised.cohesion_field.state.lines, (-1.0, 0.0), strict=True):
        assert line is not None
        np.testing.assert_allclose(line[:, 1], z)
    again = Section.parse(tomllib.loads(raised.to_toml()))
    assert strength(again, 10.0, -3.0) == pytest.approx(strength(raised, 10.0, -3.0), rel=1e-12)


def test_the_lower_of_two_lines_steps_and_bends_where_they_do() -> None:
    first = np.array([[0.0, 1.0], [5.0, 1.0], [5.0, 3.0], [10.0, 3.0]])
    second = np.array([[0.0, 0.0], [10.0, 4.0]])
    expected = [[0, 0], [2.5, 1], [5, 1], [5, 2], [7.5, 3], [10, 3]]
    np.testing.assert_allclose(lower_line(first, second), expected)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"consolidation": {}}, "table and surface: missing"),
        ({"strata": [soil()]}, "no stratum has a strength_ratio"),
        ({"consolidation": {"tabel": 1.0}}, "tabel"),
    ],
)
def test_a_state_without_effect_is_refused(changes: Any, words: str) -> None:
    with pytest.raises(InputError) as refused:
        ground(**changes)
    assert words in str(refused.value)
