"""Attenuation against the tables by which the hazard engine OpenQuake tests its own implementations, and pygmm."""

import math

import pytest

from meshes.errors import InputError
from meshes.section.quantity import GRAVITY
from workflow.earthquake.attenuation import GAL, fukushima_tanaka, si_midorikawa
from workflow.earthquake.boore import Slip, boore
from workflow.earthquake.settings import EarthquakeSettings


@pytest.mark.parametrize(
    ("magnitude", "kilometres", "expected"),
    [(5.0, 10.0, 0.15527333), (6.0, 30.0, 0.118229228), (7.0, 60.0, 0.112587914), (8.0, 30.0, 0.336829527),
     (8.0, 200.0, 0.031026481)],
)  # fmt: skip
def test_fukushima_tanaka(magnitude: float, kilometres: float, expected: float) -> None:
    """gem/oq-engine, tests/gsim/data/FT1990/FT1990_MEAN.csv, in g of 9.81 m/s²."""
    motion = fukushima_tanaka(magnitude, 1000.0 * kilometres, "average")
    assert motion.median / 9.81 == pytest.approx(expected, rel=1e-5)
    assert fukushima_tanaka(magnitude, 1000.0 * kilometres, "soft").median == pytest.approx(1.4 * motion.median)


@pytest.mark.parametrize(
    ("magnitude", "depth", "kilometres", "expected"),
    [(6.0, 20.0, 30.9, 0.18649966), (7.0, 50.0, 75.75, 0.22755208), (6.0, 70.0, 300.0, 0.00568157)],
)
def test_si_midorikawa_within_a_plate(magnitude: float, depth: float, kilometres: float, expected: float) -> None:
    """gem/oq-engine, tests/gsim/data/SM99/SM99SSLAB_MEAN_PGA.csv, in g."""
    motion = si_midorikawa(magnitude, 1000.0 * kilometres, 1000.0 * depth, "intraplate")
    assert motion.median / GRAVITY == pytest.approx(expected, rel=1e-5)


def test_si_midorikawa_elsewhere() -> None:
    """SM99SINTER_MEAN_PGA.csv there at M 7, 50 km deep, 300 km away; in the crust it is 10^0.01 less."""
    between, crust = (si_midorikawa(7.0, 300_000.0, 50_000.0, kind).median for kind in ("interplate", "crustal"))
    assert between / GRAVITY == pytest.approx(0.00874747, rel=1e-5)
    assert between / crust == pytest.approx(10.0**0.01)


def test_noshiro_1983() -> None:
    """The paper has 250 gal for M 7.7, by an attenuation analysis of its own, whose distance it does not give. The
    distance of 27 km that Youd, Hansen & Bartlett (2002) use for Noshiro gives 318 gal, and 250 gal is within one
    standard deviation; the median is 250 gal at 39 km."""
    motion = fukushima_tanaka(7.7, 27_000.0, "average")
    assert motion.median / GAL == pytest.approx(318.0, abs=1.0)
    assert motion.low < 250.0 * GAL < motion.high
    assert fukushima_tanaka(7.7, 39_000.0, "average").median / GAL == pytest.approx(250.0, abs=3.0)


def test_outside_its_range_a_relation_says_nothing() -> None:
    with pytest.raises(InputError, match=r"magnitude = 8.5: outside the range of Fukushima & Tanaka \(1990\)"):
        fukushima_tanaka(8.5, 50_000.0, "average")
    with pytest.raises(InputError, match=r"(?s)magnitude = 5.*distance = 400 km") as caught:
        si_midorikawa(5.0, 400_000.0, 10_000.0, "crustal")
    assert len(caught.value.problems) == 2


@pytest.mark.parametrize(
    ("magnitude", "kilometres", "velocity", "slip", "expected", "sigma"),
    [(6.9, 27.2, 270.0, "strike-slip", 0.1686221008532482, 0.5842994536693566),
     (7.7, 39.0, 300.0, "reverse", 0.17454391080088572, 0.6050859443087403),
     (5.0, 80.0, 760.0, "normal", 0.00352532350395825, 0.7022492435026185),
     (6.0, 5.0, 200.0, "unknown", 0.3363362278007354, 0.5492986437267071),
     (8.0, 250.0, 400.0, "reverse", 0.01563630081936677, 0.681911410853325)],
)  # fmt: skip
def test_boore_is_pygmms(
    magnitude: float, kilometres: float, velocity: float, slip: Slip, expected: float, sigma: float
) -> None:
    """pygmm 0.8.0, BooreStewartSeyhanAtkinson2014, region global: median in g, standard deviation of its logarithm."""
    motion = boore(magnitude, 1000.0 * kilometres, velocity, slip)
    assert motion.median / GRAVITY == pytest.approx(expected, rel=1e-9)
    assert motion.sigma * math.log(10.0) == pytest.approx(sigma, rel=1e-9)


def test_boore_has_a_range_and_needs_the_ground() -> None:
    with pytest.raises(InputError, match=r"(?s)magnitude = 7.5.*distance = 500 km.*vs30 = 100 m/s") as caught:
        boore(7.5, 500_000.0, 100.0, "normal")
    assert len(caught.value.problems) == 3
    earthquake_settings = EarthquakeSettings(magnitude=7.0, distance="30 km", relation="boore")
    with pytest.raises(InputError, match='relation = "boore": expected vs30'):
        earthquake_settings.motion()
    motion = earthquake_settings.model_copy(update={"vs30": 270.0, "slip": "strike-slip"}).motion()
    assert motion == boore(7.0, 30_000.0, 270.0, "strike-slip")
