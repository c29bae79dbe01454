"""Triggering by the Japanese highway code: continuity at every limit of its pieces, and values worked by hand."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from workflow.earthquake.triggering.blow_count import BlowCount, SurfaceMotion
from workflow.earthquake.triggering.highway_code import (
    assess_1990,
    assess_later,
    corrected_2012,
    corrected_2017,
    grain_size_term,
    motion_factor,
    resistance_1990,
    resistance_2012,
    resistance_2017,
    why_not,
)

# At 5 m, N = 8, 95 and 60 kPa; fine sand without fines.
POINT = BlowCount(5.0, 8.0, 95.0, 60.0, 5.0, 0.25)


def test_the_form_of_1990_by_hand() -> None:
    """R1 = 0.0882 √(8/(0.61183 + 0.7)) = 0.21781, R2 = 0.225 log(0.35/0.25) = 0.03288, R3 = 0;
    L = 0.925 · 0.25 · 95/60 = 0.36615; F_L = 0.25069/0.36615 = 0.6847."""
    assert resistance_1990(POINT) == pytest.approx(0.25069, abs=1e-5)
    assert assess_1990(POINT, SurfaceMotion(0.25, math.nan)).factor == pytest.approx(0.6847, abs=1e-4)


def test_the_form_of_2017_by_hand() -> None:
    """N1 = 170 · 8/130 = 10.4615 = Na; R_L = 0.0882 √((0.85 · 10.4615 + 2.1)/1.7) = 0.22427; L as above: 0.6125.
    As the public program masamasace/liquefaction-assessment has the equations."""
    resistance = assess_later(POINT, SurfaceMotion(0.25, math.nan), "2017", "I")
    assert resistance.corrected == pytest.approx(10.4615, abs=1e-4)
    assert resistance.resistance == pytest.approx(0.22427, abs=1e-5)
    assert resistance.factor == pytest.approx(0.6125, abs=1e-4)


def test_the_form_of_2012_by_hand() -> None:
    """0.0882 √(10.4615/1.7) = 0.21880; a motion of type II bears 3.3 · 0.21880 + 0.67 = 1.3920 times that."""
    resistance = assess_later(POINT, SurfaceMotion(0.25, math.nan), "2012", "I")
    two = assess_later(POINT, SurfaceMotion(0.25, math.nan), "2012", "II")
    assert resistance.resistance == pytest.approx(0.21880, abs=1e-5)
    assert two.resistance / resistance.resistance == pytest.approx(1.3920, abs=1e-4)


@given(st.floats(0.0, 60.0))
def test_pieces_of_the_fines_corrections_meet(n1: float) -> None:
    for limit in (10.0, 60.0):
        assert corrected_2012(n1, limit - 1e-9) == pytest.approx(corrected_2012(n1, limit), abs=1e-6)
    for limit in (10.0, 40.0):
        assert corrected_2017(n1, limit - 1e-9) == pytest.approx(corrected_2017(n1, limit), abs=1e-6)


def test_pieces_of_the_resistance_meet() -> None:
    """That of R2 at 0.05 mm within 0.0002 (0.225 log 7 = 0.1901), at 0.6 mm within 0.003 (-0.0527): as printed."""
    assert grain_size_term(0.05) == pytest.approx(grain_size_term(0.05 + 1e-12), abs=2e-4)
    assert grain_size_term(0.6) == pytest.approx(grain_size_term(0.6 + 1e-12), abs=3e-3)
    assert resistance_2012(14.0) == pytest.approx(resistance_2012(14.0 - 1e-9), abs=1e-9)
    assert resistance_2017(14.0) == pytest.approx(resistance_2017(14.0 - 1e-9), abs=1e-4)
    assert motion_factor(0.1, "II") == pytest.approx(motion_factor(0.1 + 1e-9, "II"), abs=1e-6)
    assert motion_factor(0.4, "II") == pytest.approx(motion_factor(0.4 + 1e-9, "II"), abs=0.011)


def test_what_the_code_does_not_ask_about() -> None:
    assert "deeper" in why_not(BlowCount(20.5, 5.0, 400.0, 200.0, 5.0))
    assert "plasticity" in why_not(BlowCount(5.0, 2.0, 90.0, 50.0, 80.0, plasticity=30.0))
    assert "D50" in why_not(BlowCount(5.0, 30.0, 90.0, 50.0, 0.0, d50=15.0))
    assert why_not(BlowCount(5.0, 2.0, 90.0, 50.0, 80.0, plasticity=10.0)) == ""


def test_1990_without_a_grain_size() -> None:
    with pytest.raises(ValueError, match="d50: missing"):
        assess_1990(BlowCount(5.0, 8.0, 95.0, 60.0, 5.0), SurfaceMotion(0.25, math.nan))
