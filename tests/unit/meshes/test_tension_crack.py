"""What is said of tension cracks of a section."""

from typing import Any

import numpy as np
import pytest

from tests.support.sections import analysed, layer

SLOPE: dict[str, Any] = {
    "name": "cracked",
    "surface": [[0.0, 10.0], [30.0, 10.0], [50.0, 4.0], [80.0, 4.0]],
    "base": {"elevation": -6.0},
    "strata": [layer("clay")],
}


@pytest.mark.parametrize(
    ("bottom", "message"),
    [
        ({"depth": 6.5}, "cracks are 6.5 m deep, and the ground rises by 6 m"),
        ({"elevation": [[0.0, 2.0], [30.0, 2.0], [40.0, 7.0]]}, "cracks are 8 m deep"),
        ({"depth": 6.0}, ""),
        ({"elevation": 8.0}, ""),
    ],
)
def test_cracks_deeper_than_the_slope_is_high_are_told(bottom: dict[str, Any], message: str) -> None:
    notices = [t for t in analysed({**SLOPE, "tension_crack": {"bottom": bottom}}).notices if "below the toe" in t]
    assert len(notices) == bool(message)
    assert not message or message in notices[0]


def test_level_ground_has_no_slope_that_a_crack_could_be_deeper_than() -> None:
    level = {**SLOPE, "surface": [[0.0, 4.0], [80.0, 4.0]], "tension_crack": {"bottom": {"depth": 2.0}}}
    assert not [text for text in analysed(level).notices if "below the toe" in text]


@pytest.mark.parametrize("drains", [False, True])
def test_cracked_ground_has_the_pore_pressure_that_a_drawdown_leaves(drains: bool) -> None:
    """The cracks are dry but where the river stands, and add nothing: clay below the river kept all of its pressure
    before the drawdown, 36 kPa under 20 kPa of weight, and was said to blow out."""
    data = {
        **SLOPE,
        "water": {"table": 9.0, "after_drawdown": 6.0},
        "strata": [layer("clay", cohesion="30 kPa", friction_angle="0 deg", drains=drains)],
    }
    plain = analysed(data).section
    cracked = analysed({**data, "tension_crack": {"bottom": {"depth": 1.0}, "water": "0.1 m"}}).section
    assert cracked.uplift is None
    for x, depth in ((60.0, 0.5), (48.0, 0.7), (40.0, 0.6), (36.0, 0.9)):
        pressures = []
        for section in (plain, cracked):
            z = float(section.layering.interfaces(np.array([x]))[0, 0]) - depth
            k = int(np.searchsorted(-section.layering.interfaces(np.array([x]))[0], -z)) - 1
            at = np.array([[x, z]])
            pressures.append(float(section.water_pressure.at_rest(at, at, np.array([k]))[0]))
        least = 9806.65 * (0.1 - 1.0 + depth)  # of the water in the crack
        assert pressures[1] == pytest.approx(max(pressures[0], least), abs=1.0)


def test_full_cracks_of_a_crest_with_a_crossfall_are_full() -> None:
    """Water ran out of them to the ground a crack's depth away, 7 mm lower: bounds had a film of dry ground, some
    hundred times as long as thick, all along the crest, and no lower bound where it met the slope."""
    surface = [[0.0, 10.3], [30.0, 10.0], [50.0, 4.0], [80.0, 4.0]]
    clay = layer("clay", cohesion="30 kPa", friction_angle="0 deg")
    crack = {"bottom": {"depth": 0.7}, "water": "full"}
    section = analysed({**SLOPE, "surface": surface, "strata": [clay], "tension_crack": crack}).section.cut_at_films
    at = section.layering.interfaces(np.array([10.0, 20.0, 28.0, 40.0, 60.0, 70.0]))
    thickness = -np.diff(at, axis=1)
    assert thickness[thickness > 0.0].min() > 0.1
    ground = at[:3, :1] * [0.0, 1.0] + [[10.0, 0.0], [20.0, 0.0], [28.0, 0.0]]
    pressure = section.water_pressure.at_rest(ground - [0.0, 0.7], ground - [0.0, 0.5], np.zeros(3, dtype=int))
    assert pressure == pytest.approx(0.7 * 9806.65, rel=1e-6)


@pytest.mark.parametrize(("run", "cracked_to"), [(0.0, 29.52), (0.2, 29.52), (3.0, 30.0)])
@pytest.mark.parametrize("mirrored", [False, True])
def test_ground_beside_an_upright_face_has_no_cracks(run: float, cracked_to: float, mirrored: bool) -> None:
    """Slices of a cliff 30 m high toppled at any Kh: the critical Kh was 0.048, with bounds of 0.000 to 0.076, and is
    0.240 with intact ground beside the face."""
    surface = [[0.0, 10.0], [30.0, 10.0], [30.0 + run, 2.0], [80.0, 2.0]]
    if mirrored:
        surface = [[80.0 - x, z] for x, z in surface[::-1]]
    clay = layer("clay", cohesion="30 kPa", friction_angle="0 deg")
    section = analysed({**SLOPE, "surface": surface, "strata": [clay], "tension_crack": {"bottom": {"depth": 4.8}}})
    at = np.array([20.0, cracked_to - 0.05, min(cracked_to + 0.05, 29.98)])
    cracked = section.section.stratum_at(80.0 - at if mirrored else at, np.full(3, 9.5))
    names = [section.section.strata[k].name for k in cracked]
    assert [name.endswith("cracked") for name in names] == [True, True, cracked_to == 30.0]
