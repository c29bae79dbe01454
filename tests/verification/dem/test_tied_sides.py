"""A box whose sides are tied to each other: neighbours, forces and motion across the side are those of the inside."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dem.acceleration import tilted_gravity
from dem.assembly import DiscBoundary, DiscGeometry, DiscMaterials
from dem.engine.engine import Engine
from dem.engine.forces import contact_forces, resultants
from dem.engine.time_step import largest_step
from dem.kernels.contact import COHESION, MU, MU_ROLLING
from dem.kernels.neighbours import pairs_within
from dem.kernels.period import Period
from dem.model import DiscModel
from tests.support.dem_cases import EARTH_SPRINGS, GRAVITY, KN, MASS, RADIUS, lattice

SOIL = replace(EARTH_SPRINGS, kpn=0.0, kps=0.0, cohesion=0.0)
FLOOR = np.array([[0.0, -RADIUS, 0.0, 1.0, -1e9, 1e9]])
COLUMNS = 12
LENGTH = 2.0 * RADIUS * COLUMNS


def heap(rows: int = 8, shift: float = 0.0, periods: int = 0, tilt: float = 0.0, seed: int = 0) -> DiscModel:
    """Discs of two sizes on a floor that goes on for ever; all moved by `shift` (m), some by whole periods."""
    rng = np.random.default_rng(seed)
    x, z = lattice(COLUMNS, rows)
    radius = RADIUS * rng.uniform(0.85, 1.0, len(x))
    far = periods * rng.integers(-1, 2, len(x)) * LENGTH
    return DiscModel.create(
        DiscGeometry(x + shift + far, z, radius),
        DiscMaterials([SOIL], law="soil"),
        DiscBoundary(FLOOR, period=(LENGTH, 0.0)),
        gravity=tilted_gravity(tilt, GRAVITY),
    )


@settings(max_examples=30, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1), count=st.integers(2, 120), length=st.floats(14.0, 60.0), rise=st.floats(-8.0, 8.0)
)
def test_neighbours_are_those_of_all_images(seed: int, count: int, length: float, rise: float) -> None:
    rng = np.random.default_rng(seed)
    x, z = rng.uniform(-50.0, 50.0, count), rng.uniform(0.0, 12.0, count)
    radius = rng.uniform(0.5, 1.2, count)
    i, j = pairs_within(x, z, radius, np.zeros(count, bool), 0.5, Period(length, rise))
    near = np.zeros((count, count), bool)
    for n in range(-10, 11):
        dx, dz = x[None, :] - x[:, None] - n * length, z[None, :] - z[:, None] - n * rise
        near |= (dx**2 + dz**2 < (radius[None, :] + radius[:, None] + 0.5) ** 2) & (np.abs(dx) <= 0.5 * length)
    assert set(zip(i, j, strict=True)) == set(zip(*np.nonzero(np.triu(near, 1)), strict=True))


@pytest.mark.parametrize("rise", [0.0, -3.0])
def test_pair_across_the_side_is_a_pair(rise: float) -> None:
    """The second disc stands a period further on: same contact, same motion, but for rounding."""
    runs = []
    for period in (None, (LENGTH, rise)):
        away = np.array([0.0, 1.0]) if period else np.zeros(2)
        x, z = np.array([0.0, 1.4]) + away * LENGTH, np.array([0.0, 0.4]) + away * rise
        model = DiscModel.create(
            DiscGeometry(x, z, RADIUS), DiscMaterials([SOIL], law="soil"), DiscBoundary(period=period)
        )
        model.set_velocity(np.array([0.2, -0.2]), np.array([0.0, 0.3]), np.array([1.0, 0.5]))
        dt = 0.1 * largest_step(model).seconds
        Engine(dt=dt, balance=np.inf).run(model, steps=15)
        runs.append([model.x - away * LENGTH, model.z - away * rise, model.vr, model.shear, model.rolled])
    assert np.abs(runs[0][4]).max() > 0.0
    for inside, across in zip(*runs, strict=True):
        assert across == pytest.approx(inside, rel=1e-9, abs=1e-9)


def test_where_the_side_lies_changes_rounding_only() -> None:
    ends = []
    for shift, periods in ((0.0, 0), (0.37 * LENGTH, 0), (5.0 * LENGTH, 3)):
        model = heap(shift=shift, periods=periods, tilt=0.1)
        begin = model.x.copy()
        Engine(dt=2e-4, balance=np.inf).run(model, steps=600)
        ends.append((model.x - begin, model.z.copy()))
    assert np.abs(ends[0][0]).max() > 1e-3
    for x, z in ends[1:]:
        assert np.abs(x - ends[0][0]).max() < 1e-9
        assert np.abs(z - ends[0][1]).max() < 1e-9


def test_row_slides_on_for_ever() -> None:
    """Discs that do not turn, side by side on a plane: g (sin b - mu cos b), over many periods."""
    beta = np.radians(40.0)
    smooth = replace(SOIL, friction=0.3, contact_cohesion=0.0, rolling_friction=np.inf, cn=np.sqrt(MASS * KN))
    sunk = MASS * GRAVITY * np.cos(beta) / KN
    model = DiscModel.create(
        DiscGeometry(2.0 * RADIUS * np.arange(COLUMNS), np.full(COLUMNS, -sunk), RADIUS),
        DiscMaterials([smooth], law="soil"),
        DiscBoundary(FLOOR, period=(LENGTH, 0.0)),
        gravity=tilted_gravity(beta, GRAVITY),
    )
    model.set_velocity(10.0, 0.0)
    Engine(dt=1e-4).run(model, 4.0)
    due = GRAVITY * (np.sin(beta) - 0.3 * np.cos(beta))
    assert model.vx == pytest.approx(10.0 + due * 4.0, rel=1e-4)
    assert np.ptp(model.x - 2.0 * RADIUS * np.arange(COLUMNS)) < 1e-6


@pytest.mark.slow
def test_horizontal_force_is_the_same_through_every_upright_cut() -> None:
    """Ground at rest without horizontal load: what goes through the tied side goes through the middle, too."""
    model = heap(rows=6, seed=3)
    model.set_springs([replace(SOIL, cn=np.sqrt(MASS * KN), ct=np.sqrt(MASS * KN))])
    lines = model.springs.lines.copy()
    lines[[MU, COHESION, MU_ROLLING]] = 0.0
    model.springs = replace(model.springs, lines=lines)
    Engine(balance=np.inf).run(model, 12.0)
    forces = contact_forces(model)
    weight = np.sum(model.mass * model.weight) * GRAVITY
    assert np.abs(resultants(model, forces)).max() < 1e-5 * weight
    assert forces.line_fz.sum() == pytest.approx(weight, rel=1e-5)
    dx, _ = model.branch()
    cuts = np.linspace(0.0, LENGTH, 9)
    # how often the way from i to j passes an image of the cut, to the right; its force pushes j
    start = (model.x[model.pair_i] - cuts[:, None]) / LENGTH
    thrust = np.sum(forces.fx * (np.floor(start + dx / LENGTH) - np.floor(start)), axis=1)
    assert thrust[0] > 0.02 * weight
    assert thrust == pytest.approx(thrust[0], rel=1e-3)


def test_period_wants_soil_discs_and_some_length() -> None:
    for law, length in (("paper", LENGTH), ("soil", 3.0 * RADIUS)):
        discs, materials = DiscGeometry([0.0], [0.0], RADIUS), DiscMaterials([SOIL], law=law)
        with pytest.raises(ValueError, match="need law='soil' and a period"):
            DiscModel.create(discs, materials, DiscBoundary(period=(length, 0.0)))
