"""Liquefied ground that rotates as a block is not resisted by its strength, which is the same in any direction."""

from dataclasses import replace

import numpy as np
import pytest

from dem.assembly import DiscGeometry, DiscMaterials
from dem.engine.engine import Engine
from dem.engine.time_step import largest_step
from dem.kernels import liquefied_pairs as bond
from dem.liquefied_ground import SMALLEST_STRAIN, Onset, liquefy, set_share
from dem.model import DiscModel
from tests.support.liquefied import sand, with_voids

SIDE, STRENGTH = 12.0, 2e4  # m, Pa
TURN, SPIN = 0.3, 0.15  # rad, 1/s


def block(seed: int = 3) -> DiscModel:
    """Return a free round block of liquefied discs without weight or pore pressure, which lie at random."""
    rng = np.random.default_rng(seed)
    at = 0.9 * np.stack(np.meshgrid(np.arange(15.0), np.arange(15.0))).reshape(2, -1)
    at += rng.uniform(-0.2, 0.2, at.shape)
    at = at[:, np.hypot(*(at - 6.3)[:]) < 0.5 * SIDE] - 6.3
    return free_discs(at, 0.45)


def free_discs(at: np.ndarray, radius: float) -> DiscModel:
    """Return liquefied discs at places (2, n) in m, without weight or pore pressure."""
    n = at.shape[1]
    model = DiscModel.create(
        DiscGeometry(*at, radius, np.zeros(n, int)),
        DiscMaterials([replace(sand(1e8, radius), faded=1.0)], law="soil", turns=False),
        gravity=(0.0, 0.0),
    )
    liquefy(model, Onset(np.ones(n, bool), with_voids(model), *np.full((3, n), [[1.0], [STRENGTH], [SMALLEST_STRAIN]])))
    set_share(model, np.ones(n))
    return model


def about_the_middle(model: DiscModel, ux: np.ndarray, uz: np.ndarray) -> float:
    """Return the moment of mass times (ux, uz) about the origin."""
    return float(np.sum(model.mass * (model.x * uz - model.z * ux)))


def test_a_block_that_rotates_keeps_its_spin_and_dissipates_nothing() -> None:
    """A rotation of 17 degrees. Bonds that resist rotation at the rate ω take the power π/2 s ω per area, with the
    strength s, and would stop this block within a twentieth of it."""
    model = block()
    model.set_velocity(-SPIN * model.z, SPIN * model.x)
    spin, energy = about_the_middle(model, model.vx, model.vz), Engine().measure(model).kinetic
    dt = 0.5 * largest_step(model).seconds
    Engine(dt=dt, balance=1e-2).run(model, TURN / SPIN)
    measured = Engine().measure(model)
    assert about_the_middle(model, model.vx, model.vz) == pytest.approx(spin, rel=2e-3)
    assert measured.kinetic == pytest.approx(energy, rel=0.03)
    assert measured.liquefied_slip + measured.viscosity < 0.03 * energy
    area = float(model.liquefied[:, bond.AREA].sum())
    assert energy < 0.05 * 0.5 * np.pi * STRENGTH * TURN * area


def test_moments_of_a_block_that_is_sheared_are_in_balance() -> None:
    """The shear of a free block takes up no angular momentum: forces across the lines of centres alone would."""
    model = block()
    rate = 0.3
    model.set_velocity(rate * model.z, np.zeros(len(model)))
    start = about_the_middle(model, model.vx, model.vz)
    dt = 0.5 * largest_step(model).seconds
    Engine(dt=dt, balance=5e-2).run(model, 0.05)
    inertia = float(np.sum(model.mass * (model.x**2 + model.z**2)))
    assert start == pytest.approx(-0.5 * rate * inertia, rel=0.02)
    assert about_the_middle(model, model.vx, model.vz) == pytest.approx(start, rel=0.01)
    assert Engine().measure(model).liquefied_slip > 0.0


def test_a_disc_that_comes_within_reach_gains_no_energy() -> None:
    """A disc passes a square block of 16 discs almost along the edge of the reach. The moments of its few bonds grow
    from nothing: if they act by the weights w of the evaluation before, which are many times smaller, the disc gets a
    quarter of its kinetic energy from nowhere."""
    block_at = np.stack(np.meshgrid(np.arange(4.0), np.arange(4.0))).reshape(2, -1)
    model = free_discs(np.column_stack([block_at, (5.0, 1.5)]), 0.5)
    nearest = np.sqrt((model.reach * (1.0 + 4e-4)) ** 2 - 0.25)  # beyond the reach of the discs at (3, 1) and (3, 2)
    model.x[-1] = model.liquefied[-1, bond.AT_X] = 3.0 + nearest
    speed = np.zeros((2, 17))
    speed[:, -1] = -0.02, 1.0
    model.set_velocity(*speed)
    start, spin = Engine().measure(model).kinetic, about_the_middle(model, model.vx, model.vz)
    dt = 0.5 * largest_step(model).seconds
    for _ in range(60):
        Engine(dt=dt, balance=0.05).run(model, 1e-3)
        assert Engine().measure(model).kinetic < 1.001 * start
    lever = 3.0  # m, at which the disc passes the corner of the block
    gain = about_the_middle(model, model.vx, model.vz) - spin
    assert abs(gain) < 0.05 * float(model.mass[-1]) * lever
