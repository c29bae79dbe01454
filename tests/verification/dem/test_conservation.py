"""Momentum, angular momentum and energy: what closed systems keep, and what the energy balance says of open ones."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dem.acceleration import Acceleration
from dem.engine.engine import Engine
from dem.engine.time_step import largest_step
from dem.model import DiscModel
from tests.support.dem_cases import BARE_SPRINGS, KN, SOIL_SPRINGS, box, order, random_discs

ELASTIC = replace(BARE_SPRINGS, ks=0.4 * KN, kpn=0.1 * KN, kps=0.04 * KN, friction=1e12, cohesion=1e12, beta=5.0)


def momenta(model: DiscModel) -> np.ndarray:
    """Momentum and angular momentum half a step ago, as the scheme keeps them exactly."""
    inertia = 0.5 * model.mass * model.radius
    spin = np.sum(model.mass * (model.x * model.vz_half - model.z * model.vx_half) + inertia * model.vr_half)
    return np.array([model.mass @ model.vx_half, model.mass @ model.vz_half, spin])


@settings(max_examples=8, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(2, 150), pores=st.booleans(), sliding=st.booleans())
def test_momentum_is_kept_to_rounding(seed: int, count: int, pores: bool, sliding: bool) -> None:
    model = random_discs(seed, count, SOIL_SPRINGS if sliding else ELASTIC, speed=0.5)
    if pores:
        model.set_pore_springs()
    before = momenta(model)
    Engine(dt=0.1 * largest_step(model).seconds if count > 20 else 1e-4, balance=np.inf).run(model, steps=400)
    size = model.mass @ np.hypot(model.vx, model.vz)
    reach = np.ptp(model.x) + np.ptp(model.z) + 1.0
    assert np.abs(momenta(model) - before) == pytest.approx([0.0, 0.0, 0.0], abs=1e-11 * size * reach)


@settings(max_examples=5, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(20, 120))
def test_energy_of_a_closed_undamped_system_does_not_drift(seed: int, count: int) -> None:
    """Bonded discs that always touch: a smooth system, whose energy error is of second order and does not grow."""
    model = random_discs(seed, count, ELASTIC, speed=0.01)
    model.set_pore_springs()
    engine = Engine(dt=0.05 * largest_step(model).seconds, balance=np.inf)
    gaps = []
    for _ in range(10):
        energies = engine.run(model, steps=500)
        assert energies is not None
        gaps.append(energies.gap / energies.turnover)
    # contacts that open and close within a step leave the first of it
    assert np.max(np.abs(gaps)) < 5e-3
    assert abs(np.mean(gaps[5:]) - np.mean(gaps[:5])) < 2e-4


def test_energy_error_is_of_second_order() -> None:
    errors = []
    for share in (0.2, 0.1, 0.05, 0.025):
        model = box(8, 6, replace(ELASTIC, name="elastic"))
        model.set_pore_springs()
        model.set_velocity(1e-3 * np.sin(model.x) * ~model.fixed, 0.0)
        dt = share * largest_step(model).seconds
        energies = Engine(dt=dt, balance=np.inf).run(model, steps=round(40.0 / share))
        assert energies is not None
        errors.append(energies.gap / energies.turnover)
    assert abs(errors[-1]) < 1e-5
    assert order(np.array(errors)) > 1.7


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_ledger_balances_with_every_part_of_the_law(seed: int) -> None:
    """Weight, Kh in time, dashpots, sliding, cracks of both kinds: to 0.1 % of what is turned over, and better."""
    model = box(16, 10, replace(SOIL_SPRINGS, cohesion=3e3), tilt=0.05)
    model.set_pore_springs()
    rng = np.random.default_rng(seed)
    free = ~model.fixed
    model.set_velocity(*(0.3 * rng.standard_normal((2, len(model))) * free), 0.0)
    times = np.linspace(0.0, 1.0, 21)
    model.acceleration = Acceleration(times, 4.0 * np.sin(9.0 * times), 2.0 * np.cos(7.0 * times))
    energies = Engine(dt="auto", balance=np.inf).run(model, 1.2)
    assert energies is not None
    for part in (energies.dashpots, energies.sliding, energies.cracks, abs(energies.weight), abs(energies.external)):
        assert part > 1e-4 * energies.turnover
    assert abs(energies.gap) < 5e-4 * energies.turnover
    assert np.any(model.pore_length < 0.0)
    assert np.any(model.pore_length > 0.0)


def test_work_of_weight_is_force_times_way() -> None:
    model = box(10, 6, tilt=0.1)
    x, z = model.x.copy(), model.z.copy()
    energies = Engine().run(model, 0.5)
    assert energies is not None
    free = ~model.fixed
    way = model.gravity[0] * (model.x - x) + model.gravity[1] * (model.z - z)
    assert energies.weight == pytest.approx(np.sum((model.mass * model.weight * way)[free]), rel=1e-9)


def test_work_of_a_moving_boundary_is_booked() -> None:
    model = box(8, 5)
    left = model.fixed & (model.x < 0.1)
    model.set_velocity(0.05, 0.0, where=left)
    energies = Engine(balance=np.inf).run(model, 0.4)
    assert energies is not None
    assert energies.boundary > 1e-3 * energies.turnover
    assert abs(energies.gap) < 1e-3 * energies.turnover


def test_edits_between_runs_are_booked_as_such() -> None:
    model = box(8, 5, tilt=0.1)
    model.set_pore_springs()
    engine = Engine()
    engine.run(model, 0.3)
    stored = engine.measure(model).pores
    assert stored > 0.0
    before = engine.measure(model).edits
    model.cut_pore_springs()
    energies = engine.run(model, 0.3)
    assert energies is not None
    # the forces of the instant change too, and the kinetic energy of the scheme with them
    assert energies.edits - before == pytest.approx(-stored, rel=2e-2)
    assert energies.pores == 0.0
