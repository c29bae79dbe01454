"""Sliding, rolling and standing discs against their closed forms."""

from dataclasses import replace

import numpy as np
import pytest

from dem.acceleration import Acceleration, tilted_gravity
from dem.assembly import DiscBoundary, DiscGeometry, DiscMaterials
from dem.engine.engine import Engine
from dem.kernels.contact import CN, MU
from dem.model import DiscModel
from tests.support.dem_cases import BARE_SPRINGS, FLOOR, GRAVITY, KN, MASS, RADIUS, order

SUNK = MASS * GRAVITY / KN  # overlap that carries the weight on a level floor
ROUGH = replace(BARE_SPRINGS, ks=0.5 * KN, cn=np.sqrt(MASS * KN), ct=0.5 * np.sqrt(MASS * KN))


def on_floor(friction: float, tilt: float = 0.0, turns: bool = True, kh: float = 0.0) -> DiscModel:
    """A disc at rest on a rigid line that falls to the right by `tilt`, sunk in by what carries its weight."""
    normal = np.cos(tilt) - kh * np.sin(tilt)
    return DiscModel.create(
        DiscGeometry([0.0], [RADIUS - SUNK * normal], RADIUS),
        DiscMaterials([replace(ROUGH, friction=friction)], turns=turns),
        DiscBoundary(FLOOR),
        gravity=tilted_gravity(tilt, GRAVITY),
        acceleration=Acceleration.seismic(kh, tilt=tilt, g=GRAVITY),
    )


def acceleration(model: DiscModel, dt: float) -> float:
    """Mean acceleration over half a second, once the first tenth is over."""
    engine = Engine(dt=dt)
    engine.run(model, 0.1)
    before, then = model.vx[0], model.time
    engine.run(model, 0.5)
    return float((model.vx[0] - before) / (model.time - then))


def test_sliding_disc_comes_to_roll() -> None:
    friction, speed = 0.3, 1.0
    model = on_floor(friction)
    model.set_velocity(speed, 0.0)
    due = speed / (3.0 * friction * GRAVITY)
    engine = Engine(dt=1e-4)
    engine.run(model, 0.5 * due)
    assert model.vx[0] == pytest.approx(speed - friction * GRAVITY * model.time, rel=1e-6)
    assert model.vr[0] == pytest.approx(-2.0 * friction * GRAVITY * model.time, rel=1e-6)
    engine.run(model, 0.45 * due)
    assert model.vx[0] + model.vr[0] > 1e-2 * speed  # still slips
    engine.run(model, due)
    assert model.vx[0] == pytest.approx(2.0 / 3.0 * speed, rel=1e-3)
    assert model.vr[0] == pytest.approx(-model.vx[0], rel=1e-3)


@pytest.mark.parametrize(("tilt", "friction"), [(20.0, 0.3), (20.0, 0.1), (35.0, 0.2)])
def test_disc_on_incline(tilt: float, friction: float) -> None:
    beta = np.radians(tilt)
    if np.tan(beta) <= 3.0 * friction:
        closed_form = 2.0 / 3.0 * GRAVITY * np.sin(beta)
    else:
        closed_form = GRAVITY * (np.sin(beta) - friction * np.cos(beta))
    assert acceleration(on_floor(friction, beta), 1e-4) == pytest.approx(closed_form, rel=1e-6)


@pytest.mark.parametrize(("tilt", "friction", "kh"), [(20.0, 0.2, 0.0), (5.0, 0.3, 0.3), (5.0, 0.3, 0.1)])
def test_block_on_incline_under_kh(tilt: float, friction: float, kh: float) -> None:
    beta = np.radians(tilt)
    model = on_floor(friction, beta, turns=False, kh=kh)
    if np.tan(beta + np.arctan(kh)) > friction:
        drive = np.sin(beta) + kh * np.cos(beta)
        hold = friction * (np.cos(beta) - kh * np.sin(beta))
        assert acceleration(model, 1e-4) == pytest.approx(GRAVITY * (drive - hold), rel=1e-6)
    else:
        acceleration(model, 1e-4)
        assert model.vx[0] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    ("at_disc", "at_floor", "stands"), [(0.28, 0.1, True), (0.26, 0.1, False), (0.28, 0.085, False)]
)
def test_one_disc_on_two(at_disc: float, at_floor: float, stands: bool) -> None:
    """N = W/2; stands for mu >= tan 15 deg at the disc contacts and a third of that at the floor."""
    # top disc rests in the mouth of two that touch: contact normals 60 deg up, weight W each
    discs = replace(ROUGH, friction=at_disc, name="discs")
    x = np.array([-RADIUS, RADIUS, 0.0])
    z = np.array([RADIUS, RADIUS, RADIUS * (1.0 + np.sqrt(3.0))])
    model = DiscModel.create(
        DiscGeometry(x, z, RADIUS), DiscMaterials([discs]), DiscBoundary(FLOOR), gravity=(0.0, -GRAVITY)
    )
    lines = model.springs.lines.copy()
    lines[MU] = at_floor
    model.springs = replace(model.springs, lines=lines)
    Engine(dt=1e-4).run(model, 3.0)
    apart = model.x[1] - model.x[0] - 2.0 * RADIUS
    assert (apart < 0.01 * RADIUS) == stands
    if stands:
        normal = KN * (2.0 * RADIUS - np.hypot(model.x[2] - model.x[0], model.z[2] - model.z[0]))
        # vertical balance of the upper disc: 2 N (cos 30 + tan 15 sin 30) = W gives N = W/2
        assert normal == pytest.approx(0.5 * MASS * GRAVITY, rel=5e-3)


def test_rolling_converges_with_the_step() -> None:
    """Where friction holds, what is left is the scheme: position after a second on an incline, second order."""
    beta = np.radians(20.0)
    ends = []
    for dt in (8e-4, 4e-4, 2e-4, 1e-4):
        model = on_floor(0.3, beta)
        model.springs.lines[CN] = 0.0
        Engine(dt=dt, balance=1e-2).run(model, 0.08)
        ends.append(model.x[0])
    assert order(np.diff(ends)) > 1.7
