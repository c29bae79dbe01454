"""Residual strength and strains of liquefied ground.

The publications' own worked numbers of residual strength were not at hand; what stands here are the equations worked by
hand, and that the relation from blow counts meets its sibling from cone resistances where the two tests are equivalent.
The equations of Olson & Stark, and of Idriss & Boulanger with Seed's table, are those of a public program for borings
as well; for Kramer & Wang nothing public was found to hold theirs against.
"""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from workflow.earthquake.triggering.consequences import (
    limiting_factor,
    pore_pressure_ratio,
    shear_strain,
    volumetric_strain,
)
from workflow.earthquake.triggering.residual import (
    IDRISS_BOULANGER,
    KRAMER_WANG,
    OLSON_STARK,
    RELATIONS,
    Penetration,
    fines_addition,
)


def test_olson_stark() -> None:
    """0.03 + 0.0075 · 8 = 0.09; at 12 it is 0.12, the end of their data."""
    assert OLSON_STARK.ratio(Penetration(8.0, 0.0, 50.0)) == pytest.approx(0.09)
    assert OLSON_STARK.ratio(Penetration(12.0, 0.0, 50.0)) == pytest.approx(0.12)
    assert OLSON_STARK.ratio(Penetration(12.1, 0.0, 50.0)) is None
    assert OLSON_STARK.least_ratio(Penetration(14.0, 0.0, 50.0)) == pytest.approx(0.12)


def test_idriss_boulanger_meets_its_sibling_of_the_cone() -> None:
    """Their relation for cones, exp(q/24.5 - (q/61.7)² + (q/106)³ - 4.42), at q = 100, which their CRR curves set equal
    to (N1)60cs = 14: 0.119 from both."""
    of_the_cone = math.exp(100.0 / 24.5 - (100.0 / 61.7) ** 2 + (100.0 / 106.0) ** 3 - 4.42)
    assert IDRISS_BOULANGER.ratio(Penetration(14.0, 0.0, 80.0)) == pytest.approx(of_the_cone, abs=0.001)


def test_without_a_tighter_layer_above_it_idriss_boulanger_leave_more() -> None:
    """N = 16: exp(1 - 3) = 0.1353, times 1 + exp(16/2.4 - 6.6) = 2.069 where water flows off."""
    gathers, flows = (IDRISS_BOULANGER.ratio(Penetration(16.0, 0.0, 80.0, w)) or 0.0 for w in (True, False))
    assert (gathers, flows / gathers) == pytest.approx((0.1353, 2.0689), abs=1e-4)
    loose = [IDRISS_BOULANGER.ratio(Penetration(6.0, 0.0, 80.0, w)) or 0.0 for w in (True, False)]
    assert loose[1] == pytest.approx(loose[0], rel=0.02)


def test_kramer_wang_by_hand() -> None:
    """(N1)60 = 8 at one atmosphere: exp(-8.444 + 0.872 + 5.379) = 0.1116; the ratio falls with the stress."""
    assert KRAMER_WANG.ratio(Penetration(8.0, 0.0, 101.325)) == pytest.approx(0.1116, abs=1e-4)
    ratios = [KRAMER_WANG.ratio(Penetration(8.0, 0.0, stress)) or 0.0 for stress in (50.0, 100.0, 200.0)]
    assert ratios == sorted(ratios, reverse=True)


def test_fines() -> None:
    """Seed's table: 1, 2, 4 and 5 blows at 10, 25, 50 and 75 %."""
    assert [fines_addition(f) for f in (0.0, 10.0, 25.0, 50.0, 75.0, 90.0)] == [0.0, 1.0, 2.0, 4.0, 5.0, 5.0]


@given(st.floats(0.0, 12.0), st.floats(20.0, 300.0))
def test_more_blows_leave_more_strength(n1: float, effective: float) -> None:
    for relation in RELATIONS:
        below, above = (relation.ratio(Penetration(n, 0.0, effective)) for n in (0.9 * n1, n1))
        assert below is not None
        assert above is not None
        assert 0.0 < below <= above < 0.5


# (N1)60cs, F_L, F_α, and the volumetric strain: rows at 4.9, 10.2, 11.0 and 6.4 m of the monograph's Appendix A as
# LiquePy prints them (github LiquePy/LiquePy, Examples/zhang2004_lateral_spread_analysis.xls).
ROWS = [
    (13.216723, 0.687712, 0.822308, 0.031375),
    (15.489038, 0.701854, 0.733997, 0.028085),
    (13.487844, 0.631058, 0.812661, 0.030948),
    (23.797938, 1.223354, 0.304304, 0.005101),
]


@pytest.mark.parametrize(("clean", "factor", "alpha", "volume"), ROWS)
def test_strains_of_the_monographs_boring(clean: float, factor: float, alpha: float, volume: float) -> None:
    assert limiting_factor(clean) == pytest.approx(alpha, abs=1e-5)
    assert volumetric_strain(factor, clean) == pytest.approx(volume, abs=2e-6)


def test_shear_strain_between_one_and_two() -> None:
    """LiquePy's row at 6.4 m: 0.020577. (Its limiting strains have 1.8 where the monograph has 1.859.)"""
    assert shear_strain(1.223354, 23.797938) == pytest.approx(0.020577, abs=1e-5)
    assert shear_strain(2.0, 10.0) == 0.0


@given(st.floats(0.3, 2.0), st.floats(1.0, 35.0))
def test_strains_fall_with_the_factor_and_with_blows(factor: float, clean: float) -> None:
    """With blows where the soil liquefies; beyond F_L = 1 the published equations rise by a trifle below N = 8."""
    assert shear_strain(factor, clean) >= shear_strain(min(2.0, factor + 0.1), clean) - 1e-12
    assert factor > 1.0 or shear_strain(factor, clean) >= shear_strain(factor, clean + 1.0) - 1e-12
    assert 0.0 <= volumetric_strain(factor, clean) <= 0.12


def test_pore_pressure() -> None:
    """1 at F_L = 1; 1/3 where F_L^(-1/0.476) = 1/2, so at 2^0.476 = 1.391; Seed's own form 0.5 + arcsin(2y - 1)/π."""
    assert pore_pressure_ratio(1.0) == pore_pressure_ratio(0.5) == 1.0
    assert pore_pressure_ratio(2.0**0.476) == pytest.approx(1.0 / 3.0)
    y = 1.2 ** (-1.0 / (0.7 * 0.34))
    assert pore_pressure_ratio(1.2) == pytest.approx(0.5 + math.asin(2.0 * y - 1.0) / math.pi)
