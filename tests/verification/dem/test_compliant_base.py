"""A base that gives way, beside an elastic layer on an elastic half-space."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
from scipy.optimize import curve_fit

from dem.acceleration import Acceleration
from dem.engine.compliant_base import UPDATE_INTERVAL
from dem.engine.engine import Engine
from dem.engine.time_step import largest_step
from dem.laboratory.soil_contacts import soil_contacts
from dem.model import DiscModel
from dem.search.equilibrium import damp_to_rest
from docs.verify.slides.uniform_slope import UniformSlope
from meshes.section.quantity import GRAVITY

HEIGHT, RADIUS, DENSITY, LENGTH = 10.0, 0.25, 1900.0, 4.0  # m, m, kg/m3, m
SHAKING, CYCLES, RISES = 0.05, 12, 2  # m/s2; cycles, and those in which they come on
LOOK = 0.005  # s


class Column(NamedTuple):
    """Level ground of strong discs whose sides are periodic, at rest; what swings, with which period (s)."""

    model: DiscModel
    top: np.ndarray
    period: float

    @property
    def impedance(self) -> float:
        """ρ V_s L of the column, whose period is 4 H / V_s (kg/s per metre)."""
        return float(self.model.mass[~self.model.fixed].sum()) * 4.0 / self.period


def watched(model: DiscModel, top: np.ndarray, seconds: float) -> np.ndarray:
    """Time (s), place (m) and speed (m/s) of the top, and acceleration of the base (m/s2), as they go: (n, 4)."""
    rows: list[tuple[float, ...]] = []
    dt = 0.5 * largest_step(model).seconds

    def look(now: DiscModel) -> None:
        rows.append((now.time, now.x[top].mean(), now.vx[top].mean(), now.base_rate))

    Engine(dt=dt, energies=False).run(model, seconds, every=LOOK, on_output=look)
    return np.array(rows)


@pytest.fixture(scope="module")
def column() -> Column:
    sand = soil_contacts(1e5, np.radians(33.0), 0.5 * DENSITY * GRAVITY * HEIGHT, 3e7)

    def layers(voids):
        return [sand.discs("soil", DENSITY, RADIUS, voids)]

    slope = UniformSlope(0.0, (HEIGHT,), RADIUS, layers, length=LENGTH)
    model = slope.model
    damp_to_rest(model, slope.ground, "under its weight")
    top = ~model.fixed & (model.z > model.z.max() - 1.0)
    disc_model, begin = model.copy(), model.time
    disc_model.acceleration = Acceleration(begin + np.array([0.0, 1e-3]), np.array([0.0, SHAKING]), np.zeros(2))
    time, place, _, _ = watched(disc_model, top, 3.0).T

    def swing(t, size, omega, phase, damping, middle):
        return size * np.exp(-damping * omega * t) * np.cos(omega * t + phase) + middle

    start = 1e-3, 10.0, 0.0, 0.02, 0.0
    fitted, _ = curve_fit(swing, time - begin, place - place[0], p0=start)
    return Column(model, top, 2.0 * np.pi / float(fitted[1]))


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [1.0, 0.5])
def test_resonance_is_that_of_a_layer_on_a_half_space(column: Column, ratio: float) -> None:
    """Surface over outcrop at the first period: the impedance below over that of the layer (Kramer 1996, eq. 7.25).

    A tenth less, since the base follows late. On a rigid base it would go on growing.
    """
    model, period = column.model.copy(), column.period
    model.base_impedance = column.impedance / ratio
    begin, omega = model.time, 2.0 * np.pi / period
    time = np.arange(0.0, CYCLES * period, 0.002)
    acceleration = SHAKING * np.sin(omega * time) * np.minimum(1.0, time / (RISES * period))
    model.acceleration = Acceleration(begin + time, acceleration, np.zeros(len(time)))
    t, _, speed, base = watched(model, column.top, float(time[-1])).T
    moved = np.gradient(speed, t) + base - SHAKING * np.sin(omega * (t - begin))  # the outcrop moves against the push
    late = t > begin + time[-1] - 3.0 * period
    phase = omega * (t[late] - begin)
    waves = np.column_stack([np.sin(phase), np.cos(phase), np.ones(late.sum())])
    sine, cosine, _ = np.linalg.lstsq(waves, moved[late], rcond=None)[0]
    assert np.hypot(sine, cosine) / SHAKING == pytest.approx(1.0 / ratio, rel=0.15)


def test_a_checkpoint_keeps_how_the_base_moves(column: Column, tmp_path) -> None:
    model = column.model.copy()
    model.base_impedance = column.impedance
    model.acceleration = Acceleration(model.time + np.array([0.0, 0.3]), np.array([0.0, SHAKING]), np.zeros(2))
    engine = Engine(dt=0.5 * largest_step(model).seconds)
    engine.run(model, 0.3)
    model.save(tmp_path / "base.npz")
    other = DiscModel.load(tmp_path / "base.npz")
    assert model.base_velocity != 0.0
    for each, threads in ((model, 1), (other, 2)):
        Engine(dt=engine.dt, threads=threads).run(each, 0.2)
    assert np.array_equal(model.x, other.x)
    assert model.base_velocity == other.base_velocity


def test_a_constant_push_moves_the_base_at_a_constant_speed(column: Column) -> None:
    """v = F / (ρ V_s L): the discs no longer feel the base."""
    model = column.model.copy()
    model.base_impedance = column.impedance
    model.acceleration = Acceleration(model.time + np.array([0.0, 1.0]), np.array([0.0, SHAKING]), np.zeros(2))
    Engine(dt=0.5 * largest_step(model).seconds).run(model, 6.0)
    force = SHAKING * model.mass[~model.fixed].sum()
    assert model.base_velocity == pytest.approx(force / column.impedance, rel=0.1)


@pytest.mark.parametrize("steps", [1.0, 2.0, 3.5])
def test_discs_in_free_flight_leave_the_base_at_rest(column: Column, steps: float) -> None:
    """What does not touch the base exerts no force on it, however its acceleration changes and in however few steps
    it is measured: with accelerations of the middle of steps such ground rocked the base ever further.
    """
    model = column.model.copy()
    model.z = np.where(model.fixed, model.z - 100.0, model.z)
    model.gravity = (0.0, 0.0)
    model.set_springs([replace(layer, contact_cohesion=0.0, faded=1.0) for layer in model.springs.layers])
    model.base_impedance = column.impedance
    model.set_velocity(0.0, 0.0)
    model.last_dt = UPDATE_INTERVAL / steps
    model.acceleration = Acceleration(model.time + np.array([0.0, 1.0]), np.array([0.0, 1.0]), np.zeros(2))
    Engine(dt=model.last_dt, energies=False).run(model, 0.9)
    assert np.abs(model.vx[~model.fixed]).max() == pytest.approx(0.4, abs=0.01)
    assert abs(model.base_velocity) < 1e-9
