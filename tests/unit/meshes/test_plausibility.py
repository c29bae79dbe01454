"""What no soil has is refused with what was meant; densities that contradict the water are told."""

from typing import Any

import pytest

from meshes.section.section import Section
from tests.support import SECTIONS
from tests.support.sections import problems
from tests.support.water import BANK, section, soil

BULK = {"density_saturated": None}
PAIR = {"density": None, "density_saturated": None}


def data(**changes: Any) -> dict[str, Any]:
    return {"name": "bank", **BANK, "strata": [soil(**changes)]}


@pytest.mark.parametrize(
    ("changes", "meant"),
    [
        ({"density": 1.8, **BULK}, "1.8 t/m^3"),
        ({"density": 18, **BULK}, "18 kN/m^3"),
        ({"density": "18 t/m^3", **BULK}, "18 kN/m^3"),
        ({"density_saturated": "20 t/m^3"}, "20 kN/m^3"),
        ({"youngs_modulus": "15 kPa"}, "15 MPa"),
        ({"youngs_modulus": 30}, ""),
        ({"cohesion": "60 MPa"}, "60 kPa"),
        ({"cohesion": 5}, "5 kPa"),
        ({"cohesion": 0.01}, ""),
        ({"friction_angle": "70 deg"}, ""),
        ({"cohesion_increase": 2, "cohesion_from": 10}, "2 kPa/m"),
        ({"tension": 5}, "5 kPa"),
        ({"strength_ratio": 22}, "22 %"),
        ({"strength_ratio": 0.22, "ocr": 250}, ""),
        ({"strength_ratio": 0.22, "pre_overburden_pressure": 20}, "20 kPa"),
        ({"strength_table": [[0, "20 kPa"], ["40 kPa", "180 MPa"]]}, "180 kPa"),
        ({"strength_table": [[0, 20], ["40 kPa", "25 kPa"]]}, "20 kPa"),
        ({"pore_pressure_ratio": 30}, "30 %"),
        ({"permeability": 5}, "5 cm/s"),
    ],
)
def test_a_slip_of_the_unit_is_told_with_what_was_meant_and_may_be_meant(changes: dict[str, Any], meant: str) -> None:
    [messages] = problems(data(**changes))
    assert "is implausible" in messages
    assert f'did you mean "{meant}"?' in messages if meant else "did you mean" not in messages
    taken = Section.parse({**data(**changes), "unusual": True})
    assert any("is implausible" in notice for notice in taken.notices)


def test_what_no_soil_has_is_told_beside_what_cannot_be_read() -> None:
    messages = problems(data(poissons_ratio=0.7, youngs_modulus="15 kPa", density="70 kN/m^3", **BULK))
    assert [next(part for part in text.split(": ")[0].split(", ") if "=" in part) for text in messages] == [
        "poissons_ratio = 0.7",
        'density = "70 kN/m^3"',
        'youngs_modulus = "15 kPa"',
    ]
    assert ["did you mean" in text for text in messages] == [False, False, True]
    nothing = data(density=None, density_saturated=None)
    unread = {
        **nothing,
        "strata": [{k: v for k, v in nothing["strata"][0].items() if v is not None} | {"cohesion": "a"}],
    }
    assert ["cohesion" in problems(unread)[0], "density: missing" in problems(unread)[1]] == [True, True]


def test_water_and_loads_have_their_bounds_too() -> None:
    messages = problems(
        {**data(), "water": {"unit_weight": 9.81}, "surcharges": [{"from": 1, "to": 5, "pressure": "20 MPa"}]}
    )
    assert ["water, unit_weight" in messages[0], "surcharges 1, pressure" in messages[1]] == [True, True]


def test_a_unit_weight_is_taken_for_a_density_and_a_density_for_the_weight_of_water() -> None:
    item, other = (section(soil(density=density, **BULK)).strata[0] for density in ("18 kN/m^3", "1.8354891833 t/m^3"))
    assert item.density_seismic == pytest.approx(other.density_seismic)
    assert section(water={"table": 3, "unit_weight": "1.03 t/m^3"}).water.unit_weight == pytest.approx(1030 * 9.80665)


def test_densities_that_contradict_a_drawn_water_table_are_told() -> None:
    drawn = {"water_table": {"elevation": 2.0}}
    buoyant = soil(density_ordinary="1 t/m^3", density_seismic="2 t/m^3", **PAIR)
    assert any("is buoyant, and" in text for text in section(buoyant, **drawn).notices)
    bulk = soil(density_ordinary="1.8 t/m^3", density_seismic="1.8 t/m^3", **PAIR)
    assert any("is not buoyant, and" in text for text in section(bulk, **drawn).notices)
    assert Section.read(SECTIONS / "s13.toml").notices == []


def test_what_is_doubtful_about_the_water_is_told() -> None:
    dry = section(soil("Crust", bottom={"elevation": 5.0}, liquefies_in=[1]), soil(), water={"table": 1.0})
    assert any("lies above the water table" in text for text in dry.notices)
    assert any("not level" in text for text in section(water={"table": [[0, 12], [60, 7]]}).notices)
    assert any("no density_saturated" in text for text in section(soil(**BULK), water={"table": 3.0}).notices)


@pytest.mark.parametrize(
    ("key", "expected"),
    [
        ("unit_weight", 'expected density, which may be a unit weight such as "18 kN/m^3"'),
        ("su", 'expected cohesion, with friction_angle = "0 deg"'),
        ("phi", "expected friction_angle"),
        ("ru", "expected pore_pressure_ratio"),
    ],
)
def test_a_word_of_practice_is_told_with_the_key_that_has_its_meaning(key: str, expected: str) -> None:
    assert any(text.endswith(f"{key}: unknown key; {expected}") for text in problems(data(**{key: 1})))


def test_a_drawdown_that_raises_the_water_is_told() -> None:
    lowered, raised = (
        Section.parse({**data(), "water": {"table": [[0, 6], [60, 6]], "after_drawdown": [[0, 6], [60, level]]}})
        for level in (3.0, 8.0)
    )
    assert not any("water rises" in text for text in lowered.notices)
    assert any("after_drawdown lies above table, by up to 2 m" in text for text in raised.notices)


def test_steady_seepage_is_no_drawdown() -> None:
    water = {"flow": True, "table": [[0, 8], [20, 8], [40, 2], [60, 2]]}
    seeping = Section.parse({**data(permeability="1e-6 m/s"), "water": water})
    assert not any("after_drawdown" in text for text in seeping.notices)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        (60.0, "all of the ground lies below water, at most "),
        (-90.0, "the water table lies below the base of the section"),
    ],
)
def test_water_beside_all_of_the_ground_is_told(table: float, message: str) -> None:
    made = Section.parse({**data(), "water": {"table": table}})
    assert sum(notice.startswith(f"water: {message}") for notice in made.notices) == 1


@pytest.mark.parametrize("mirrored", [False, True])
def test_ground_water_that_falls_to_a_quay_wall_is_no_water_on_the_ground(mirrored: bool) -> None:
    """At the wall the ground steps by 8 m, and only its foot was compared with the level behind it: with the sea on the
    right, every quay was warned of water that is not level; its mirror image was not."""

    def line(*points: tuple[float, float]) -> list[list[float]]:
        return [[70.0 - x, z] for x, z in reversed(points)] if mirrored else [list(point) for point in points]

    quay = {
        "name": "quay", "surface": line((0.0, 4.0), (40.0, 4.0), (40.0, -4.0), (70.0, -4.0)),
        "base": {"elevation": -14.0}, "strata": [soil()],
    }  # fmt: skip
    still = Section.parse({**quay, "water": {"table": line((0.0, 1.5), (40.0, 1.0), (70.0, 1.0))}})
    assert not any("not level" in notice for notice in still.notices)
    flowing = Section.parse({**quay, "water": {"table": line((0.0, 1.5), (40.0, 1.0), (70.0, 0.0))}})
    assert sum("is not level there" in notice for notice in flowing.notices) == 1
