"""Pore springs: set, pulled, pushed, sheared, cracked both ways at the right step, and what a cracked one does.

Discs so heavy that they keep their velocity are moved past each other, so that distance and slip are known.
"""

from dataclasses import replace

import numpy as np
import pytest

from dem.assembly import DiscGeometry, DiscMaterials
from dem.engine.engine import Engine
from dem.engine.forces import contact_forces
from dem.model import DiscModel
from dem.springs import LayerSprings
from tests.support.dem_cases import MASS, RADIUS, SOIL_SPRINGS, trace

HEAVY = replace(SOIL_SPRINGS, density=1e16, effective_density=0.0, cn=0.0, ct=0.0, allowed_overlap=2.0)
LENGTH = 2.1 * RADIUS  # set with a gap: the contact springs do not touch
DT = 2e-3


def pair(soil: LayerSprings, vx: float, vz: float, length: float = LENGTH, swapped: bool = False) -> DiscModel:
    """Two heavy discs at rest and at (vx, vz), with a pore spring set at `length`."""
    x = np.array([0.0, length])
    model = DiscModel.create(DiscGeometry(x[::-1] if swapped else x, np.zeros(2), RADIUS), DiscMaterials([soil]))
    assert model.set_pore_springs() == 1
    moving = np.array([swapped, not swapped])
    model.set_velocity(vx * moving, vz * moving)
    return model


def watch(model: DiscModel) -> tuple[float, float, float, float]:
    forces = contact_forces(model)
    return model.distance()[0], model.pore_length[0], model.pore_shear[0], forces.normal[0]


def test_reach_of_new_springs() -> None:
    x = np.array([0.0, 1.2 * 2.0 * RADIUS, 2.4 * 2.0 * RADIUS + 1e-9])
    model = DiscModel.create(DiscGeometry(x, np.zeros(3), RADIUS), DiscMaterials([SOIL_SPRINGS]))
    assert model.set_pore_springs() == 1
    linked = model.pore_length != 0.0
    assert set(model.pair_i[linked]) | set(model.pair_j[linked]) == {0, 1}
    assert model.pore_length[linked] == pytest.approx([x[1]], rel=1e-15)
    assert model.set_pore_springs() == 0


def test_pulls_back_to_its_length_and_snaps_at_beta() -> None:
    speed = 0.037
    model = pair(HEAVY, speed, 0.0)
    seen = trace(model, DT, 500, watch)
    distance = np.concatenate([[LENGTH], seen[:-1, 0]])  # where each step found the discs
    due = int(np.argmax(distance >= HEAVY.beta * LENGTH))
    assert due > 100
    assert np.all(seen[:due, 1] == LENGTH)
    assert np.all(seen[due:, 1] == -LENGTH)
    whole = seen[: due - 1]
    assert whole[:, 3] == pytest.approx(HEAVY.kpn * (LENGTH - whole[:, 0]), rel=1e-9)
    assert np.all(whole[:, 3] < 0.0)
    assert np.all(seen[due:, 3] == 0.0)


@pytest.mark.parametrize("squeeze", [pytest.param(0.0, marks=pytest.mark.slow), 0.04])
def test_snaps_in_shear_at_mohr_coulombs_limit(squeeze: float) -> None:
    """|Ft| first exceeds Fn tan(theta) + b C, with Fn of contact and pore spring together."""
    soil = replace(HEAVY, cohesion=3.21e4, friction=0.3)
    model = pair(soil, 0.0, 0.05)
    # moved together first: a push on pore and contact spring
    model.x[1] -= squeeze * 2.0 * RADIUS
    seen = trace(model, DT, 750, watch)
    distance = np.concatenate([[LENGTH - squeeze * 2.0 * RADIUS], seen[:-1, 0]])
    # slip of the rims: the path across the line of centres
    rotated = np.arctan2(0.05 * DT * np.arange(751), LENGTH - squeeze * 2.0 * RADIUS)
    middle = 0.05 * DT * np.cos(rotated[1:])
    shear = soil.kps * np.concatenate([[0.0], np.cumsum(middle)])[:-1]
    normal = soil.kpn * (LENGTH - distance) + soil.kn * np.maximum(2.0 * RADIUS - distance, 0.0)
    over = np.abs(shear) > normal * 0.3 + soil.cohesion
    due = int(np.argmax(over))
    assert due > 50
    assert np.all(seen[:due, 1] == LENGTH)
    assert np.all(seen[due:, 1] == -LENGTH)
    assert seen[:due, 2] == pytest.approx(shear[:due], rel=1e-6)


def test_never_snaps_in_compression() -> None:
    model = pair(replace(HEAVY, cohesion=0.0), -0.3, 0.0)
    seen = trace(model, DT, 1000, watch)
    assert np.all(seen[:, 1] == LENGTH)
    pore = HEAVY.kpn * (LENGTH - seen[:, 0])
    assert seen[:, 3] == pytest.approx(pore + HEAVY.kn * np.maximum(2.0 * RADIUS - seen[:, 0], 0.0), rel=1e-9)


def test_cohesionless_spring_still_pulls_while_there_is_no_shear() -> None:
    model = pair(replace(HEAVY, cohesion=0.0, friction=0.0), 0.037, 0.0)
    seen = trace(model, DT, 150, watch)
    assert np.all(seen[:, 1] == LENGTH)


def cracked(vx: float, vz: float, **changes: float) -> DiscModel:
    model = pair(replace(HEAVY, **changes), vx, vz)
    model.pore_length *= -1.0
    return model


def test_cracked_spring_does_not_pull() -> None:
    seen = trace(cracked(0.05, 0.0), DT, 200, watch)
    assert np.all(seen[:, 3] == 0.0)


def test_cracked_spring_pushes_again_after_the_discs_were_far_apart() -> None:
    """Out of the reach of the neighbour list and back: the crack and its length are not forgotten."""
    model = cracked(5.0, 0.0)
    engine = Engine(dt=DT, balance=np.inf)
    engine.run(model, steps=2000)
    assert model.distance()[0] > LENGTH + 10.0 * model.skin
    assert contact_forces(model).normal[0] == 0.0
    model.set_velocity(-model.vx, 0.0)
    engine.run(model, steps=2000)
    model.set_velocity(np.array([0.0, -0.3]), 0.0)
    seen = trace(model, DT, 200, watch)
    assert seen[-1, 0] < LENGTH - 0.1
    acceleration = (
        np.maximum(LENGTH - seen[:, 0], 0.0) * HEAVY.kpn + np.maximum(2.0 * RADIUS - seen[:, 0], 0.0) * HEAVY.kn
    )
    assert seen[:, 3] == pytest.approx(acceleration, rel=1e-6, abs=1.0)


def test_cracked_spring_shears_only_while_compressed_and_up_to_friction() -> None:
    model = cracked(0.0, 0.1, friction=0.2, cohesion=1e9)
    model.x[1] -= 0.05
    seen = trace(model, DT, 200, lambda m: (m.distance()[0], m.pore_shear[0]))
    distance = np.concatenate([[LENGTH - 0.05], seen[:-1, 0]])
    limit = 0.2 * HEAVY.kpn * np.maximum(LENGTH - distance, 0.0)
    assert np.all(np.abs(seen[:, 1]) <= limit * (1.0 + 1e-12))
    sliding = np.flatnonzero(np.abs(seen[:, 1]) > limit * (1.0 - 1e-12))
    assert 0 < sliding[0] < 150  # holds first, slides then
    # apart and together again: shear starts anew from nothing
    model.set_velocity(np.array([0.0, 1.0]), 0.0)
    Engine(dt=DT, balance=np.inf).run(model, steps=300)
    assert model.pore_shear[0] == 0.0


def test_order_of_the_two_discs_does_not_matter() -> None:
    """Same forces, same crack at the same step, to the last bit, whichever disc was named first."""
    soil = replace(SOIL_SPRINGS, cohesion=2e4)
    runs = []
    for swapped in (False, True):
        model = pair(soil, 0.4, 0.9, swapped=swapped)
        seen = trace(model, 1e-4, 800, lambda m: (m.distance()[0], m.pore_length[0], m.pore_shear[0]))
        runs.append((seen, model.x.copy(), model.vr.copy()))
    assert np.any(runs[0][0][:, 1] < 0.0)
    assert np.array_equal(runs[0][0], runs[1][0])
    assert np.array_equal(runs[0][1], runs[1][1][::-1])
    assert np.array_equal(runs[0][2], runs[1][2][::-1])


def test_bonded_pair_turns_as_one_body_without_slip() -> None:
    """A rigid rotation strains neither spring: levers add up to the distance."""
    model = DiscModel.create(
        DiscGeometry([-0.5 * LENGTH, 0.5 * LENGTH], [0.0, 0.0], RADIUS), DiscMaterials([SOIL_SPRINGS])
    )
    model.set_pore_springs()
    spin = 0.2
    model.set_velocity(0.0, spin * model.x, spin)
    Engine(dt=1e-4, balance=np.inf).run(model, steps=20000)
    assert model.angle == pytest.approx(0.4, rel=1e-4)
    assert np.abs(model.pore_shear) < 1e-6 * SOIL_SPRINGS.kps * LENGTH
    assert model.distance() == pytest.approx([LENGTH * (1.0 + MASS * spin**2 / (2.0 * SOIL_SPRINGS.kpn))], rel=1e-4)
