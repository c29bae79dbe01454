"""Triggering by Idriss & Boulanger against liquepy, and against a public run of the monograph's example."""

import pytest

from workflow.earthquake.triggering.blow_count import BlowCount, SurfaceMotion
from workflow.earthquake.triggering.idriss_boulanger import (
    assess,
    fines_correction,
    magnitude_scaling,
    normalised,
    overburden_factor,
    resistance_ratio,
    rod_correction,
    stress_ratio,
    stress_reduction,
)


@pytest.mark.parametrize(
    ("depth", "magnitude", "expected"),
    [(2.0, 6.9, 0.9856520), (5.0, 7.5, 0.9608480), (12.0, 7.5, 0.8671125), (20.0, 6.0, 0.5763679)],
)
def test_stress_reduction_is_liquepys(depth: float, magnitude: float, expected: float) -> None:
    """liquepy 0.6.34, boulanger_and_idriss_2014.calc_rd, which has the same equation."""
    assert stress_reduction(depth, magnitude) == pytest.approx(expected, abs=1e-7)


@pytest.mark.parametrize(
    ("clean", "ratio", "shallow", "deep"),
    [
        (3.0, 0.0751307, 1.0641743, 0.9530504),
        (10.0, 0.1180632, 1.0857731, 0.9372488),
        (20.0, 0.2058527, 1.1, 0.9092877),
        (30.0, 0.4849316, 1.1, 0.8621582),
    ],
)
def test_resistance_and_overburden_factor_are_liquepys(clean: float, ratio: float, shallow: float, deep: float) -> None:
    """liquepy 0.6.34: calc_crr_m7p5_from_n1_60cs, and calc_k_sigma_w_n1_60cs at 40 and 200 kPa (pa 101.325)."""
    assert resistance_ratio(clean) == pytest.approx(ratio, abs=1e-6)
    assert overburden_factor(clean, 40.0) == pytest.approx(shallow, abs=1e-6)
    assert overburden_factor(clean, 200.0) == pytest.approx(deep, abs=1e-6)


# Depth (m), total and effective stress (kPa), CSR, (N1)60cs and CRR at M = 7.5 and one atmosphere.
APPENDIX_A = [
    (2.6, 49.8, 41.952, 0.211320, 6.561643, 0.095468),
    (4.9, 95.8, 65.389, 0.252025, 13.216723, 0.141709),
    (10.2, 201.8, 119.396, 0.262166, 15.489038, 0.160285),
]


@pytest.mark.parametrize(("depth", "total", "effective", "load", "clean", "bears"), APPENDIX_A)
def test_the_example_of_the_monograph(
    depth: float, total: float, effective: float, load: float, clean: float, bears: float
) -> None:
    """The boring of Appendix A of the monograph (a_max 0.280 g, M 6.9, water at 1.8 m, ER 75 %), as the public package
    LiquePy (github LiquePy/LiquePy, Examples) prints it: CSR, MSF = 1.171394 and CRR. Its C_N is another one, so that
    blow counts are compared from (N1)60cs on. The monograph's own table was not at hand."""
    point = BlowCount(depth, 10.0, total, effective, 0.0)
    assert stress_ratio(point, SurfaceMotion(0.280, 6.9)) == pytest.approx(load, abs=1e-6)
    assert resistance_ratio(clean) == pytest.approx(bears, abs=1e-6)
    assert magnitude_scaling(6.9) == pytest.approx(1.171394, abs=1e-6)


def test_corrections_of_the_monographs_figures() -> None:
    """Δ(N1)60 tends to 5.5 for silty soils, is 1.1 at 10 % and nothing for clean sand; C_R by length of rods."""
    assert fines_correction(2.0) < 1e-3
    assert fines_correction(10.0) == pytest.approx(1.149185, abs=1e-6)  # LiquePy's row at 9.4 m
    assert fines_correction(14.0) == pytest.approx(2.905354, abs=1e-6)  # and at 10.2 m
    assert 5.4 < fines_correction(50.0) < 5.7
    assert [rod_correction(length) for length in (2.9, 3.3, 5.6, 8.7, 12.0)] == [0.75, 0.80, 0.85, 0.95, 1.0]


def test_the_blow_count_is_consistent_with_its_own_overburden_correction() -> None:
    """(N1)60cs = C_N(N1)60cs N60 + Δ, whichever way it was found; at one atmosphere C_N = 1."""
    n1, clean = normalised(BlowCount(12.0, 15.0, 220.0, 101.325, 12.0), 60.0, 1.5)
    assert n1 == pytest.approx(15.0, rel=1e-9)
    assert clean == pytest.approx(15.0 + fines_correction(12.0), rel=1e-9)


def test_dense_sand_does_not_liquefy_and_the_factor_ends_at_two() -> None:
    assessment = assess(BlowCount(6.0, 60.0, 110.0, 70.0, 0.0), SurfaceMotion(0.3, 7.5), 60.0, 1.5)
    assert assessment.factor == 2.0


def test_more_shaking_and_fewer_blows_make_it_worse() -> None:
    def factor(blows: float, peak: float, magnitude: float) -> float:
        point = BlowCount(6.0, blows, 110.0, 70.0, 5.0)
        return assess(point, SurfaceMotion(peak, magnitude), 60.0, 1.5).factor

    assert factor(10.0, 0.2, 7.5) > factor(10.0, 0.3, 7.5) > factor(5.0, 0.3, 7.5) > factor(5.0, 0.3, 8.3)
