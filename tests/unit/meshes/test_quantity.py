import math
import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st

from meshes.section.quantity import (
    ANGLE,
    COMMON_UNITS,
    COORDINATE,
    DENSITY,
    GRAVITY,
    LENGTH,
    POISSON,
    STIFFNESS,
    STRENGTH,
    Kind,
    Quantity,
    unit_registry,
)


@pytest.mark.parametrize(
    ("kind", "written", "expected"),
    [
        (STIFFNESS, "1560 tf/m^2", 1560 * 9806.65),
        (STIFFNESS, "15.3 MPa", 15.3e6),
        (STIFFNESS, "15.3MPa", 15.3e6),
        (STIFFNESS, "1.5e+7 Pa", 1.5e7),
        (STIFFNESS, "150 kgf/cm^2", 150 * 98066.5),
        (STIFFNESS, "1 kN/m²", 1e3),
        (STIFFNESS, 15300000, 1.53e7),
        (STRENGTH, "10 tf/m**2", 98066.5),
        (STRENGTH, 0, 0.0),
        (DENSITY, "1.8 t/m^3", 1800.0),
        (DENSITY, "1.8 g/cm^3", 1800.0),
        (DENSITY, "1800 kg/m3", 1800.0),
        (DENSITY, "18 kN/m3", 18e3 / 9.80665),
        (STIFFNESS, "15 kgf/cm2", 15 * 98066.5),
        (STRENGTH, "2 mH2O", 2 * 9806.65),
        (ANGLE, "35 deg", math.radians(35)),
        (ANGLE, "35°", math.radians(35)),
        (ANGLE, "0.5 rad", 0.5),
        (ANGLE, 0.5, 0.5),
        (POISSON, 0.33, 0.33),
        (POISSON, "0.33", 0.33),
        (POISSON, 0, 0.0),
        (COORDINATE, "41 ft", 41 * 0.3048),
        (COORDINATE, -12.5, -12.5),
        (LENGTH, "150 cm", 1.5),
    ],
)
def test_converts_to_si(kind: Kind, written: str | float, expected: float) -> None:
    number = kind.read(written)
    assert number == pytest.approx(expected, rel=1e-14)
    assert number.written == written


@pytest.mark.parametrize(
    ("kind", "written", "expected"),
    [
        (STRENGTH, "100 psf", 4788.0258980),
        (STRENGTH, "1 ksf", 47880.258980),
        (STRENGTH, "1 tsf", 95760.517961),
        (STRENGTH, "1 tonf/ft^2", 95760.517961),
        (DENSITY, "110 pcf", 110 * 16.018463374),
        (DENSITY, "0.11 KCF", 110 * 16.018463374),
        (STRENGTH, "50 KPa", 50e3),
        (STIFFNESS, "20 Mpa", 20e6),
        (DENSITY, "18 KN/m3", 18e3 / 9.80665),
        (DENSITY, "18 kN/m³", 18e3 / 9.80665),
        (STRENGTH, "5 tonf/m^2", 5 * 9806.65),
        (DENSITY, "1.8 tonf/m3", 1800.0),
        (DENSITY, "1.8 ton/m3", 1800.0),
        (COORDINATE, "41 FT", 41 * 0.3048),
        (DENSITY, "1.8 gr/cm3", 1800.0),
        (STRENGTH, "0.2 ksc", 2e3 * 9.80665),
    ],
)
def test_units_as_reports_spell_them(kind: Kind, written: str, expected: float) -> None:
    """1 lbf/ft² is 47.88025898 Pa, 1 lbf/ft³ is 16.018463374 kg/m³ (NIST SP 811); tons are metric but beside feet."""
    assert kind.read(written) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(
    ("kind", "written", "reason"),
    [
        (STRENGTH, "2 kg/cm2", "has the wrong dimension (kilogram / centimeter ** 2), a mass per area: write tf, kgf"),
        (STIFFNESS, "1560 t/m^2", "has the wrong dimension (metric_ton / meter ** 2)"),
        (STIFFNESS, "30 kg", "has the wrong dimension (kilogram)"),
        (DENSITY, "1.8 tf/m^2", "has the wrong dimension"),
        (ANGLE, "25 degC", "has the wrong dimension"),
        (POISSON, "0.3 deg", "has the wrong dimension (degree)"),
        (LENGTH, "1 deg", "has the wrong dimension (degree)"),
        (STIFFNESS, "30", "has no unit"),
        (ANGLE, "35", "has no unit"),
        (STIFFNESS, "MPa", "not understood"),
        (STIFFNESS, "", "not understood"),
        (STIFFNESS, "much", "not understood"),
        (STIFFNESS, "30 Mpsk", "not understood"),
        (STIFFNESS, "1,560 tf/m^2", "not understood"),  # 1560 to some and 1.56 to others
        (STIFFNESS, "1,5 MPa", 'has a decimal comma; write "1.5 MPa"; expected'),
        (ANGLE, ",25 deg", 'has a decimal comma; write "0.25 deg"; expected'),
        (STIFFNESS, "1,5,2 MPa", "not understood"),
        (STIFFNESS, "15 + 2 MPa", "not understood"),
        (STIFFNESS, "9**9**9 Pa", "not understood"),  # would not end
        (STIFFNESS, "9 Pa**9**9**9", "not understood"),
        (STIFFNESS, "9 m^99999", "not understood"),
        (STIFFNESS, math.nan, "not a finite number"),
        (STIFFNESS, math.inf, "not a finite number"),
        (STIFFNESS, "nan MPa", "not a finite number"),
        (STIFFNESS, "-inf MPa", "not a finite number"),
        (STIFFNESS, "1e400 Pa", "not a finite number"),
        (STIFFNESS, 10**400, "not a finite number"),
        (STIFFNESS, 0, "out of range"),
        (STIFFNESS, "-30 MPa", "out of range"),
        (STRENGTH, -1e-9, "out of range"),
        (DENSITY, "-1 t/m^3", "out of range"),
        (POISSON, 0.5, "out of range"),
        (POISSON, 0.7, "out of range"),
        (POISSON, -0.1, "out of range"),
        (ANGLE, "90 deg", "out of range"),
        (ANGLE, "-1 deg", "out of range"),
        (ANGLE, 35, 'out of range (a plain number is in radians; did you mean "35 deg"?)'),
        (LENGTH, 0.0, "out of range"),
        (COORDINATE, 1e8, "out of range"),
    ],
)
def test_refuses_with_the_reason_and_what_was_expected(kind: Kind, written: str | float, reason: str) -> None:
    with pytest.raises(ValueError, match="expected") as caught:
        kind.read(written)
    assert str(caught.value).startswith(reason)
    assert kind.expected in str(caught.value)


@pytest.mark.parametrize("written", [True, False, None, [30.0], {"value": 30.0}])
@pytest.mark.parametrize("kind", [STIFFNESS, POISSON, ANGLE, COORDINATE])
def test_refuses_what_is_no_number(kind: Kind, written: object) -> None:
    with pytest.raises(ValueError, match=r"^expected") as caught:
        kind.read(written)
    assert str(caught.value) == kind.expected


def test_limits_are_said_in_words() -> None:
    assert STIFFNESS.expected == 'expected a stiffness above 0, such as "15.3 MPa"'
    assert POISSON.expected == "expected a Poisson's ratio from 0 to below 0.5, such as 0.33"


def test_reading_again_keeps_how_it_was_written() -> None:
    number = STIFFNESS.read("1560 tf/m^2")
    again = STIFFNESS.read(number)
    assert (float(again), again.written) == (float(number), "1560 tf/m^2")
    copy = pickle.loads(pickle.dumps(number))
    assert isinstance(copy, Quantity)
    assert (float(copy), copy.written) == (float(number), "1560 tf/m^2")


@pytest.mark.parametrize("unit", COMMON_UNITS)
@given(number=st.floats(min_value=-1e9, max_value=1e9))
def test_common_units_are_those_of_pint_to_the_last_bit(unit: str, number: float) -> None:
    si, factor = COMMON_UNITS[unit]
    registry = unit_registry()
    by_pint: float = registry.Quantity(number, registry.parse_units(unit)).to(si).magnitude
    assert number * factor == by_pint


@given(number=st.floats(min_value=0.0, max_value=1e9))
def test_a_unit_weight_is_the_density_of_pint_to_the_last_bit(number: float) -> None:
    registry = unit_registry()
    weight = registry.Quantity(number, registry.parse_units("kN/m^3"))
    assert DENSITY.read(f"{number!r} kN/m^3") == weight.to("kg/m^3 * m/s^2").magnitude * (1.0 / GRAVITY)
