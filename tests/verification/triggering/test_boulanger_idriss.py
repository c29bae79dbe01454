"""Triggering by Boulanger & Idriss (2014) from cone penetration tests, against liquepy."""

import math

import pytest

from workflow.earthquake.triggering import idriss_boulanger
from workflow.earthquake.triggering.blow_count import SurfaceMotion
from workflow.earthquake.triggering.boulanger_idriss import (
    ConeTest,
    assess,
    equivalent_count,
    fines_of,
    magnitude_scaling,
    normalised,
    overburden_correction,
    overburden_factor,
    resistance_ratio,
    why_not,
)
from workflow.earthquake.triggering.consequences import limiting_shear_strain

# liquepy 0.6.34, boulanger_and_idriss_2014.run_bi2014 with u2 = 0, pga 0.25 g, M 7, water at 1.5 m and p_a 101.325 kPa
# (K_σ by its calc_k_sigma with that p_a): depth (m), qc and fs, σv and σ'v (kPa), Ic, qc1N, qc1Ncs, CSR, CRR.
LIQUEPY = [
    (1.6, 6000.0, 40.0, 34.36, 33.38, 1.795405, 100.6662, 101.8074, 0.1657772, 0.1610109),
    (3.0, 3000.0, 20.0, 58.16363, 43.46363, 2.105232, 45.84893, 91.90075, 0.2118793, 0.1438525),
    (4.0, 8000.0, 50.0, 76.43026, 51.93026, 1.757872, 108.7702, 108.7776, 0.2298226, 0.1702609),
    (6.0, 12000.0, 60.0, 113.6932, 69.59318, 1.61001, 138.7885, 138.7885, 0.2471675, 0.2649895),
    (12.0, 20000.0, 100.0, 222.5849, 119.6849, 1.526895, 186.2622, 186.2622, 0.2496593, 1.103202),
    (15.0, 8000.0, 70.0, 278.5447, 146.2447, 2.041443, 66.28662, 110.0906, 0.2387574, 0.1539177),
]


@pytest.mark.parametrize(
    ("depth", "q", "sleeve", "total", "effective", "index", "plain", "clean", "load", "bears"), LIQUEPY
)
def test_every_step_is_liquepys(
    depth: float, q: float, sleeve: float, total: float, effective: float, index: float, plain: float, clean: float,
    load: float, bears: float,
) -> None:  # fmt: skip
    point = ConeTest(depth, q, sleeve, total, effective)
    assert point.index == pytest.approx(index, abs=2e-6)
    assert normalised(point) == pytest.approx((plain, clean), rel=2e-6)
    assessment = assess(point, SurfaceMotion(0.25, 7.0))
    assert (assessment.load, assessment.resistance) == pytest.approx((load, bears), rel=5e-6)
    assert assessment.factor == pytest.approx(min(2.0, bears / load), rel=1e-5)
    assert why_not(point) == ""


def test_normalisation_goes_on_until_it_agrees_with_itself() -> None:
    """At 2 m liquepy stops at C_N = 1.7, qc1Ncs = 103.80, since its first two rounds agree, both at that limit; with
    that qc1Ncs eq. 2.15b has C_N = 1.65. The equations agree with themselves at C_N = 1.6577."""
    plain, clean = normalised(ConeTest(2.0, 4000.0, 30.0, 41.32565, 36.42565))
    assert plain * 101.325 / 4000.0 == pytest.approx(1.6577, abs=1e-4)
    assert overburden_correction(clean, 36.42565) == pytest.approx(plain * 101.325 / 4000.0, rel=1e-9)


def test_clay_is_not_judged_and_measured_fines_count() -> None:
    """liquepy's Ic of 1 MPa and 30 kPa 9 m deep is 3.071204, where it does not judge."""
    clay = ConeTest(9.0, 1000.0, 30.0, 164.3425, 90.84246)
    assert clay.index == pytest.approx(3.071204, abs=2e-6)
    assert "behaves as clay" in why_not(clay)
    assert "below the weight" in why_not(ConeTest(9.0, 100.0, 3.0, 164.3, 90.8))
    silty, clean = (normalised(ConeTest(3.0, 3000.0, 20.0, 58.2, 43.5, fines))[1] for fines in (35.0, 0.0))
    assert clean < silty
    assert (fines_of(1.5), fines_of(2.0), fines_of(3.2)) == (0.0, 23.0, 100.0)


def test_published_points() -> None:
    """CRR at qc1Ncs = 100 is 0.137 by hand; at M = 7.5 MSF is 1; MSFmax of dense sand is 2.2; K_σ is 1 at 1 atm."""
    assert resistance_ratio(100.0) == pytest.approx(math.exp(0.884956 + 0.01 - 0.364431 + 0.283871 - 2.8), rel=1e-5)
    assert magnitude_scaling(7.5, 150.0) == pytest.approx(1.0, abs=1e-4)
    assert magnitude_scaling(5.0, 300.0) == pytest.approx(1.0 + 1.2 * (8.64 * math.exp(-1.25) - 1.325))
    assert overburden_factor(120.0, 101.325) == 1.0


def test_a_cone_is_worth_the_blow_count_of_its_relative_density() -> None:
    """Both procedures bear the same there but for a tenth, and the limiting strain is that of Yoshimine et al. (2006)
    for cones: 1.859 (2.163 - 0.478 qc1Ncs^0.264)³, as Idriss & Boulanger (2008) have it."""
    for clean in (60.0, 100.0, 140.0):
        count = equivalent_count(clean)
        assert idriss_boulanger.resistance_ratio(count) == pytest.approx(resistance_ratio(clean), rel=0.12)
        by_cone = 1.859 * (2.163 - 0.478 * clean**0.264) ** 3
        assert limiting_shear_strain(count) == pytest.approx(min(0.5, by_cone), rel=1e-9)
