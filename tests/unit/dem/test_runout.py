"""Measures of a run-out on discs laid by hand, and rest."""

import numpy as np
import pytest

import dem
from dem.assembly import DiscBoundary, DiscGeometry, DiscMaterials
from dem.model import DiscModel
from tests.support.newmark import newmark_slide, newmark_slide_speed

RADIUS = 0.5
SAND = dem.soil_discs("sand", 1e7, dem.Strength(0.3), 2000.0, 2000.0, RADIUS, 0.25)
FLOOR = np.array([0.0, 0.0, 0.0, 1.0, -1e4, 1e4])


def row_and_stray(gap: float = 3.0) -> DiscModel:
    """Ten discs beside each other, one on top of the first, and one that lies apart."""
    x = np.append(np.arange(10) + 0.5, [0.5, 10.5 + gap])
    z = np.append(np.full(10, 0.5), [1.5, 0.5])
    return DiscModel.create(
        DiscGeometry(x, z, RADIUS), DiscMaterials([SAND], law="soil"), DiscBoundary(FLOOR), gravity=(0.0, -9.81)
    )


def test_what_has_left_the_connected_ground() -> None:
    model = row_and_stray()
    assert dem.connected_ground(model).tolist() == [True] * 11 + [False]
    assert dem.loose_share(model) == pytest.approx(1.0 / 12.0)
    assert dem.loose_share(row_and_stray(gap=0.01)) == 0.0


def test_run_out_and_quantiles() -> None:
    model = row_and_stray()
    out = dem.run_out(model)
    assert (out.front, out.x98, out.height) == pytest.approx((10.0, 13.5, 2.0))
    assert dem.mass_quantile(model, 0.5) == pytest.approx(4.5)  # two of the twelve discs lie at 0.5
    with pytest.raises(ValueError, match="between 0 and 1"):
        dem.mass_quantile(model, 1.5)


def test_profile_of_the_deposit() -> None:
    assert dem.deposit_profile(row_and_stray(), 2.0) == pytest.approx(
        np.array([[1.5, 2.0], [3.5, 1.0], [5.5, 1.0], [7.5, 1.0], [9.5, 1.0]])
    )


def test_run_until_rest() -> None:
    """A disc thrown along a floor with a friction of 0.3 stops after v / (mu g) = 1.7 s and v^2 / (2 mu g) = 4.25 m."""
    model = DiscModel.create(
        DiscGeometry([0.0], [0.5], RADIUS), DiscMaterials([SAND], law="soil"), DiscBoundary(FLOOR), gravity=(0.0, -9.81)
    )
    model.set_velocity(5.0, 0.0)
    rest = dem.run_until_rest(model, still=1e-3, longest=10.0, every=0.2, step_share=0.02)
    assert rest.rested
    assert 1.7 < rest.seconds < 2.7
    assert model.x[0] == pytest.approx(5.0**2 / (2.0 * 0.3 * 9.81), rel=0.02)
    again = dem.run_until_rest(model, still=1e-3, longest=10.0, every=0.2, at_least=3.0)
    assert again.seconds >= 3.0
    with pytest.raises(ValueError, match="positive"):
        dem.run_until_rest(model, still=0.0, longest=1.0)


def test_contacts_without_a_section() -> None:
    sand = dem.soil_contacts(0.0, np.radians(35.0), 1e5)
    sine = np.sin(np.radians(35.0))
    assert sand.required_strength == pytest.approx(np.array([0.25, 0.5, 1.0]) * 1e5 * sine / (1.0 - sine))
    assert sand.expected_strength == pytest.approx(sand.required_strength, rel=0.08)
    assert sand.cohesion == 0.0
    clay = dem.soil_contacts(5e4, 0.0, 1e5, 15e6)
    assert clay.expected_strength == pytest.approx(np.full(3, 5e4), rel=0.07)
    assert not clay.notes
    springs = clay.discs("clay", 1800.0, 0.5, 0.25, buoyant_density=800.0)
    assert springs.density == pytest.approx(1.25 * 1800.0)
    assert springs.effective_density == pytest.approx(1.25 * 800.0)
    with pytest.raises(ValueError, match="expected a strength"):
        dem.soil_contacts(0.0, 0.0, 1e5)
    with pytest.raises(ValueError, match="positive stress"):
        dem.soil_contacts(0.0, 0.5, 0.0)


def test_newmark_by_hand() -> None:
    """A block on the level: a = g (k - mu) for T seconds, then mu g (Newmark 1965): d = g (k - mu) T^2 k / (2 mu)."""
    assert newmark_slide(0.0, 0.1, 0.3, 2.0) == pytest.approx(9.81 * 0.2 * 4.0 * 0.3 / 0.2)
    assert newmark_slide(0.0, 0.3, 0.2, 2.0) == 0.0
    assert newmark_slide(0.2, 0.1, 0.3, 2.0) == np.inf


def test_a_block_that_slides_both_ways_drifts_downhill() -> None:
    """Driven far above its yield it drifts at V sin(π ε / 2), V the largest velocity of the base, ε = tan b / ratio.

    Friction balances the weight in the mean of a cycle: sgn(v0 + V sin ωt) has the mean (2/π) asin(v0 / V) = ε.
    """
    angle, ratio, period = np.arctan(0.01), 0.02, 0.5
    time = np.linspace(0.0, 200.0 * period, 20_001)
    acceleration = 5.0 * np.cos(2.0 * np.pi * time / period)
    largest = 5.0 * period / (2.0 * np.pi)
    drift = largest * np.sin(0.5 * np.pi * 0.5)
    assert newmark_slide_speed(angle, ratio, time, acceleration) == pytest.approx(drift * time[-1], rel=0.05)
    assert newmark_slide_speed(angle, 0.009, time, acceleration) == np.inf
    fixed = np.array([0.0, 1e-6, 2.0, 2.0 + 1e-6])
    one_way = newmark_slide_speed(0.0, 0.1, fixed, 9.81 * np.array([0.0, 0.3, 0.3, 0.0]))
    assert one_way == pytest.approx(newmark_slide(0.0, 0.1, 0.3, 2.0), rel=2e-3)
