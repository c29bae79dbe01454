"""Collisions of discs against their closed forms : restitution, duration, overlap, impact at an angle."""

from dataclasses import replace

import numpy as np
import pytest

from dem.assembly import DiscBoundary, DiscGeometry, DiscMaterials
from dem.engine.engine import Engine
from dem.model import DiscModel
from tests.support.dem_cases import BARE_SPRINGS, FLOOR, KN, MASS, RADIUS, order, trace

OMEGA = np.sqrt(KN / (0.5 * MASS))
SPEED = 1e-4  # so small that the direction of the contact and its lever stay what they are
LEVELS = [100, 200, 400, 800]  # steps in half a period


def collide(zeta: float, steps: int) -> tuple[float, float, float]:
    """Restitution, duration times OMEGA, largest overlap times OMEGA / speed of approach, of a head-on collision."""
    soil = replace(BARE_SPRINGS, cn=2.0 * zeta * np.sqrt(KN * 0.5 * MASS))
    # the first step begins with the discs just in touch, so the jump of the dashpot's force falls on a step
    model = DiscModel.create(
        DiscGeometry([0.0, 2.0 * RADIUS * (1.0 - 1e-14)], [0.0, 0.0], RADIUS), DiscMaterials([soil])
    )
    model.set_velocity(np.array([0.5, -0.5]) * SPEED, 0.0)
    dt = np.pi / OMEGA / steps
    seen = trace(model, dt, int(1.4 * steps), lambda m: (m.x[1] - m.x[0], m.vx_half[1] - m.vx_half[0]))
    overlap = 2.0 * RADIUS - seen[:, 0]
    # the push falls to nothing between two steps: where its last two values point to
    acceleration = np.diff(seen[:, 1])
    last = np.flatnonzero(acceleration > 1e-9 * acceleration.max())[-2]
    end = last + 1.0 + acceleration[last] / (acceleration[last - 1] - acceleration[last])
    k = np.argmax(overlap)
    rise, fall = overlap[k] - overlap[k - 1], overlap[k] - overlap[k + 1]
    peak = overlap[k] + (rise - fall) ** 2 / (8.0 * (rise + fall))
    return seen[-1, 1] / SPEED, end * dt * OMEGA, peak * OMEGA / SPEED


def expected(zeta: float) -> tuple[float, float, float]:
    s = np.sqrt(1.0 - zeta**2)
    angle = np.pi - np.arctan2(2.0 * zeta * s, 1.0 - 2.0 * zeta**2)
    return np.exp(-zeta * angle / s), angle / s, np.exp(-zeta / s * np.arctan2(s, zeta))


@pytest.mark.parametrize(("zeta", "printed"), [pytest.param(0.1, 0.74408, marks=pytest.mark.slow), (0.3, 0.45098)])
def test_head_on(zeta: float, printed: float) -> None:
    restitution, duration, peak = expected(zeta)
    assert restitution == pytest.approx(printed, abs=5e-6)
    errors = np.array([collide(zeta, steps) for steps in LEVELS]) - (restitution, duration, peak)
    assert np.all(np.abs(errors[-1, 1:]) < 5e-5)
    assert order(errors[:, 2]) > 1.8
    assert abs(errors[-1, 0]) < 2e-5
    assert order(errors[:, 0]) > 1.8
    assert order(errors[:, 1]) > 1.5


def test_undamped_head_on_returns_all_energy() -> None:
    errors = np.array([collide(0.0, steps)[0] for steps in LEVELS]) - 1.0
    # the last step in touch is cut somewhere: of second order, with a factor that depends on where
    assert np.all(np.abs(errors) < (np.pi / np.array(LEVELS)) ** 2)


def impact(friction: float, vt: float, steps: int) -> tuple[float, float]:
    """Tangential velocity and spin times radius after an impact on a rigid line at speed (vt, -1) * SPEED."""
    soil = replace(BARE_SPRINGS, ks=0.5 * KN, friction=friction)
    model = DiscModel.create(
        DiscGeometry([0.0], [RADIUS * (1.0 - 1e-14)], RADIUS), DiscMaterials([soil]), DiscBoundary(FLOOR)
    )
    model.set_velocity(vt * SPEED, -SPEED)
    dt = np.pi * np.sqrt(MASS / KN) / steps
    Engine(dt=dt, balance=np.inf).run(model, steps=int(1.2 * steps))
    return model.vx[0] / SPEED, model.vr[0] / SPEED


def test_oblique_impact_sliding_throughout() -> None:
    friction = 0.3
    seen = np.array([impact(friction, 5.0, steps) for steps in LEVELS])
    # counter-clockwise spin is positive: the floor drags the lower rim back
    errors = np.abs(seen - (5.0 - 2.0 * friction, -4.0 * friction))
    assert np.all(errors < 4.0 * friction * (np.pi / np.array(LEVELS)[:, None]) ** 2)
    assert np.all(errors[-1] < 2e-5)


def test_oblique_impact_that_never_slips() -> None:
    # contact point: v_c' = v_c cos(pi sqrt(3 ks/kn)), centre: v_t (2 + that ratio)/3
    ratio = np.cos(np.pi * np.sqrt(1.5))
    errors = np.array([impact(1e9, 1.0, steps) for steps in LEVELS]) - ((2.0 + ratio) / 3.0, (ratio - 1.0) * 2.0 / 3.0)
    assert np.all(np.abs(errors) < 6.0 * (np.pi / np.array(LEVELS)[:, None]))
    assert np.all(np.abs(errors[-1]) < 5e-3)
