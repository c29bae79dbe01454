"""The law of soil discs against closed forms: rolling resistance, cohesion, two materials, the stop, its energies."""

from dataclasses import replace

import numpy as np
import pytest

from dem.acceleration import Acceleration, tilted_gravity
from dem.assembly import DiscBoundary, DiscGeometry, DiscMaterials
from dem.engine.engine import Engine
from dem.engine.forces import contact_forces, resultants
from dem.engine.time_step import largest_step
from dem.kernels.contact import ATTRACTION_REACH
from dem.model import DiscModel
from dem.pair_table import pair_table
from dem.springs import STOP_DEPTH, LayerSprings
from tests.support.dem_cases import BARE_SPRINGS, FLOOR, GRAVITY, KN, MASS, RADIUS, lattice, random_discs, trace

WEIGHT = MASS * GRAVITY
ROUGH = replace(BARE_SPRINGS, ks=0.5 * KN, cn=np.sqrt(MASS * KN), ct=0.5 * np.sqrt(MASS * KN), friction=0.6)


def on_incline(tilt: float, soil: LayerSprings, turns: bool = True, kh: float = 0.0) -> DiscModel:
    """A disc at rest on a rigid line that falls to the right by `tilt` (rad), sunk in by what carries its weight."""
    sunk = WEIGHT * (np.cos(tilt) - kh * np.sin(tilt)) / KN
    return DiscModel.create(
        DiscGeometry([0.0], [RADIUS - sunk], RADIUS),
        DiscMaterials([soil], law="soil", turns=turns),
        DiscBoundary(FLOOR),
        gravity=tilted_gravity(tilt, GRAVITY),
        acceleration=Acceleration.seismic(kh, tilt=tilt, g=GRAVITY),
    )


def acceleration(model: DiscModel) -> float:
    """Mean acceleration (m/s2) over half a second, once the first tenth is over."""
    engine = Engine(dt=1e-4)
    engine.run(model, 0.1)
    before, then = model.vx[0], model.time
    engine.run(model, 0.5)
    return float((model.vx[0] - before) / (model.time - then))


@pytest.mark.parametrize(("tilt", "rolling"), [(20.0, 0.1), (20.0, 0.3), (10.0, 0.05)])
def test_disc_that_rolls_down_an_incline(tilt: float, rolling: float) -> None:
    """m a = W sin b - F and m r a/2 = F r - mu_r r N: a = 2/3 g (sin b - mu_r cos b)."""
    beta = np.radians(tilt)
    model = on_incline(beta, replace(ROUGH, rolling_friction=rolling))
    due = 2.0 / 3.0 * GRAVITY * (np.sin(beta) - rolling * np.cos(beta))
    assert acceleration(model) == pytest.approx(due, rel=1e-6)
    assert model.vr[0] == pytest.approx(-model.vx[0], rel=1e-4)


@pytest.mark.parametrize(("rolling", "stands"), [(0.18, True), (0.17, False), (np.inf, True)])
def test_disc_stands_where_rolling_friction_exceeds_the_slope(rolling: float, stands: bool) -> None:
    """tan 10 deg = 0.1763."""
    model = on_incline(np.radians(10.0), replace(ROUGH, rolling_friction=rolling))
    Engine(dt=2e-4).run(model, 4.0)
    assert (abs(model.vx[0]) < 1e-3 * RADIUS) == stands
    if stands and np.isfinite(rolling):
        # the rolling spring, as stiff as the tangential one on the rim, carries W sin b at the lever r
        assert model.line_rolled[0] == pytest.approx(WEIGHT * np.sin(np.radians(10.0)), rel=1e-3)


def test_discs_of_infinite_rolling_friction_do_not_turn() -> None:
    soils = [replace(ROUGH, rolling_friction=np.inf), replace(ROUGH, name="other", rolling_friction=0.1)]
    model = DiscModel.create(DiscGeometry([0.0, 1.4], [0.0, 0.4], RADIUS, [0, 1]), DiscMaterials(soils, law="soil"))
    assert list(model.inertia_ratio) == [0.0, 2.0]
    model.set_velocity(0.0, np.array([0.3, -0.3]))
    Engine(dt=1e-4, balance=np.inf).run(model, 0.05)
    assert model.vr[0] == 0.0
    assert model.vr[1] != 0.0


def test_rolling_moments_of_two_discs_are_opposite() -> None:
    """PFC's rolling resistance: k_s R^2 (w_j - w_i) t, R = r_i r_j/(r_i + r_j), up to mu_r R Fn."""
    radius = np.array([0.5, 1.0])
    heavy = replace(BARE_SPRINGS, ks=0.5 * KN, density=1e12, effective_density=1e12, friction=0.0, rolling_friction=0.2)
    reduced = radius.prod() / radius.sum()
    spin = np.array([0.02, -0.05])
    force = 0.01 * KN
    model = DiscModel.create(DiscGeometry([0.0, 1.49], [0.0, 0.0], radius), DiscMaterials([heavy], law="soil"))
    model.set_velocity(0.0, 0.0, spin)
    seen = []

    def watch(m: DiscModel) -> None:
        f = contact_forces(m)
        seen.append(
            (m.time, *(radius * [f.rim_i[0], f.rim[0]] if m.pair_i[0] == 0 else radius * [f.rim[0], f.rim_i[0]]))
        )

    trace(model, 1e-3, 400, watch)
    time, on_first, on_second = np.array(seen).T
    moment = heavy.ks * reduced**2 * (spin[1] - spin[0]) * time
    limit = 0.2 * reduced * force
    assert np.abs(moment[-1]) > 2.0 * limit
    assert on_first == pytest.approx(np.clip(moment, -limit, limit), rel=1e-4)
    assert on_second == pytest.approx(-on_first, rel=1e-12)


@pytest.mark.parametrize(("share", "stands"), [(1.01, True), (0.99, False)])
def test_block_held_by_cohesion(share: float, stands: bool) -> None:
    """A disc that does not turn stands on an incline as long as W sin b <= mu W cos b + C."""
    beta = np.radians(35.0)
    need = WEIGHT * (np.sin(beta) - 0.3 * np.cos(beta))
    soil = replace(ROUGH, friction=0.3, contact_cohesion=share * need, rolling_friction=np.inf)
    model = on_incline(beta, soil)
    # as it hangs there, without the jerk of a weight that comes on at once
    model.line_shear[:] = -min(WEIGHT * np.sin(beta), 0.3 * WEIGHT * np.cos(beta) + soil.contact_cohesion)
    if stands:
        acceleration(model)
        assert model.vx[0] == pytest.approx(0.0, abs=1e-6)
    else:
        # and slides by what is left once it does: cohesion is not lost
        assert acceleration(model) == pytest.approx((need - soil.contact_cohesion) / MASS, rel=1e-5)


def test_cohesion_is_there_again_when_discs_touch_again_and_pulls_nowhere() -> None:
    soil = replace(ROUGH, density=1e9, effective_density=1e9, friction=0.0, contact_cohesion=5e4)
    model = DiscModel.create(
        DiscGeometry([0.0, 1.49], [0.0, 0.0], RADIUS), DiscMaterials([soil], law="soil", turns=False)
    )

    def sheared() -> float:
        model.set_velocity(0.0, np.array([0.0, 0.1]))
        Engine(dt=1e-4, balance=np.inf).run(model, 0.1)
        return abs(contact_forces(model).tangential[0])

    assert sheared() == pytest.approx(5e4)
    model.x[1] += 0.02
    assert np.all(np.hypot(contact_forces(model).fx, contact_forces(model).fz) == 0.0)
    model.x[1] -= 0.02
    assert sheared() == pytest.approx(5e4)


def test_cohesive_discs_bear_a_pull_and_attract_again() -> None:
    """F = kn (overlap) down to -a C, where the spring lets go: that costs (a C)^2 / (2 kn), which comes back."""
    heavy = replace(BARE_SPRINGS, density=1e12, effective_density=1e12, contact_cohesion=5e4, attraction=2.0)
    gap = 2.0 * 5e4 / KN
    model = DiscModel.create(
        DiscGeometry([0.0, 2.0 * RADIUS], [0.0, 0.0], RADIUS), DiscMaterials([heavy], law="soil", turns=False)
    )
    due = [(0.5 * gap, -5e4), (0.99 * gap, -0.99e5), (1.01 * gap, 0.0), (0.99 * gap, -0.99e5), (-gap, 1e5)]
    for apart, force in due:
        step = apart - (float(model.distance()[0]) - 2.0 * RADIUS)
        model.set_velocity(np.array([0.0, step / 0.1]), 0.0)
        energies = Engine(dt=1e-4, balance=np.inf).run(model, 0.1)
        assert contact_forces(model).normal[0] == pytest.approx(force, rel=1e-3)
        assert energies is not None
        stored = 0.5 * KN * (apart**2 - gap**2) if apart < gap else 0.0
        assert energies.elements + energies.bonds == pytest.approx(stored, rel=1e-3, abs=1e-4)


def test_of_two_materials_the_one_that_attracts_less_counts() -> None:
    clay = replace(BARE_SPRINGS, contact_cohesion=5e4, attraction=2.0)
    sand = replace(BARE_SPRINGS, name="sand", friction=0.5)
    loam = replace(clay, name="loam", kn=3.0 * KN, contact_cohesion=2e4)
    gap = pair_table([clay, sand, loam], law="soil").pairs[ATTRACTION_REACH, :16].reshape(4, 4)
    stored = np.array([1e5, 0.0, 4e4])
    assert np.diag(gap)[:3] == pytest.approx(stored / [KN, KN, 3.0 * KN])
    assert gap[0, 1] == gap[1, 2] == 0.0
    assert gap[0, 2] == gap[2, 0] == pytest.approx(4e4 / (2.0 * KN))
    assert gap[:3, 3] == pytest.approx(np.diag(gap)[:3])  # the boundary attracts as what touches it does
    assert np.all(pair_table([replace(clay, contact_cohesion=0.0)], law="soil").pairs[ATTRACTION_REACH] == 0.0)


@pytest.mark.parametrize(("loading", "due"), [(5e4, 0.7 * 5e4), (2e5, 6e4 + 0.1 * 2e5)])
def test_two_materials_are_as_strong_as_the_weaker(loading: float, due: float) -> None:
    """Sand (mu 0.7) governs at little normal force, clay (C = 60 kN, mu 0.1) at much."""
    sand = replace(BARE_SPRINGS, ks=0.5 * KN, density=1e9, effective_density=1e9, friction=0.7)
    clay = replace(sand, name="clay", friction=0.1, contact_cohesion=6e4)
    for layers in ([0, 1], [1, 0]):
        model = DiscModel.create(
            DiscGeometry([0.0, 2.0 * RADIUS - loading / KN], [0.0, 0.0], RADIUS, layers),
            DiscMaterials([sand, clay], law="soil", turns=False),
        )
        model.set_velocity(0.0, np.array([0.0, 0.02]))
        Engine(dt=1e-4, balance=np.inf).run(model, 0.1)
        assert abs(contact_forces(model).tangential[0]) == pytest.approx(due, rel=5e-3)


def test_softened_discs_do_not_fall_through_each_other() -> None:
    """Two springs side by side beyond a quarter of the radius: W = k d + (K - k)(d - d0)."""
    soft = replace(ROUGH, kn=1e-4 * KN, ks=1e-4 * KN, cn=0.05 * np.sqrt(MASS * KN), stop=KN, rolling_friction=np.inf)
    z = np.array([0.0, 1.95 * RADIUS])
    model = DiscModel.create(
        DiscGeometry([0.0, 0.0], z, RADIUS, fixed=[True, False]),
        DiscMaterials([soft], law="soil"),
        gravity=(0.0, -GRAVITY),
    )
    energies = Engine().run(model, 3.0)
    depth = STOP_DEPTH * RADIUS
    over = 2.0 * RADIUS - (model.z[1] - model.z[0])
    assert over == pytest.approx((WEIGHT + (KN - soft.kn) * depth) / KN, rel=2e-6)
    assert over < 0.5 * RADIUS
    assert energies is not None
    stored = 0.5 * soft.kn * over**2 + 0.5 * (KN - soft.kn) * (over - depth) ** 2
    assert energies.elements == pytest.approx(stored, rel=1e-6)
    assert abs(energies.gap) < 1e-3 * energies.turnover


SOIL_DISCS = replace(
    BARE_SPRINGS, ks=0.5 * KN, cn=0.1 * np.sqrt(MASS * KN), ct=0.1 * np.sqrt(MASS * KN), friction=0.4,
    contact_cohesion=5e3, rolling_friction=0.1, stop=2.0 * KN,
)  # fmt: skip


def heap(seed: int, attraction: float = 0.0) -> DiscModel:
    """Discs of two materials that fall into a box, with velocities and spins of their own."""
    rng = np.random.default_rng(seed)
    x, z = lattice(12, 10, 2.5 * RADIUS)
    second = replace(
        SOIL_DISCS,
        name="second",
        kn=2.0 * KN,
        friction=0.1,
        contact_cohesion=4e4,
        attraction=attraction,
        rolling_friction=0.3,
    )
    box = [[0.0, -RADIUS, 0.0, 1.0], [-RADIUS, 0.0, 1.0, 0.0], [x.max() + RADIUS, 0.0, -1.0, 0.0]]
    discs = DiscModel.create(
        DiscGeometry(x, z, RADIUS * rng.uniform(0.8, 1.2, 120), np.arange(120) % 2),
        DiscMaterials([SOIL_DISCS, second], law="soil"),
        DiscBoundary(np.hstack([box, np.full((3, 1), -1e3), np.full((3, 1), 1e3)])),
        gravity=(0.0, -GRAVITY),
        skin=0.05,
    )
    discs.set_velocity(*rng.standard_normal((3, 120)))
    return discs


@pytest.mark.parametrize(
    ("seed", "attraction"),
    [(1, 0.0), (2, 2.0), *(pytest.param(*each, marks=pytest.mark.slow) for each in ((2, 0.0), (1, 1.0)))],
)
def test_ledger_closes_with_every_part_of_the_law(seed: int, attraction: float) -> None:
    model = heap(seed, attraction)
    energies = Engine(dt=0.03 * largest_step(model).seconds, balance=np.inf).run(model, 1.5)
    assert energies is not None
    for part in (energies.dashpots, energies.sliding, energies.rolling):
        assert part > 1e-3 * energies.turnover
    assert abs(energies.gap) < 5e-4 * energies.turnover
    # where nothing rolls over its limit, what rolling stores comes back
    assert energies.rolling_springs > 0.0
    assert energies.rolling_springs == pytest.approx(_rolling_energy(model), rel=2e-2)


def _rolling_energy(model: DiscModel) -> float:
    i, j = model.layer[model.pair_i], model.layer[model.pair_j]
    ks = np.array([s.ks for s in model.springs.layers])
    pairs = np.sum(model.rolled**2 / (ks[i] + ks[j]))
    return float(pairs + np.sum(0.5 * model.line_rolled**2 / ks[model.layer[model.line_disc]]))


def test_rolling_resistance_keeps_momentum() -> None:
    model = random_discs(5, 60, BARE_SPRINGS, 0.3)
    closed = DiscModel.create(
        DiscGeometry(model.x, model.z, model.radius),
        DiscMaterials([replace(SOIL_DISCS, allowed_overlap=2.0)], law="soil"),
    )
    closed.set_velocity(model.vx, model.vz, model.spin)

    def momenta() -> np.ndarray:
        m = closed
        spin = np.sum(m.mass * (m.x * m.vz_half - m.z * m.vx_half + 0.5 * m.radius * m.vr_half))
        return np.array([m.mass @ m.vx_half, m.mass @ m.vz_half, spin])

    before = momenta()
    Engine(dt=0.1 * largest_step(closed).seconds, balance=np.inf).run(closed, steps=400)
    size = closed.mass @ np.hypot(closed.vx, closed.vz)
    assert momenta() - before == pytest.approx([0.0, 0.0, 0.0], abs=1e-11 * size * (np.ptp(closed.x) + 1.0))


def test_step_of_rolling_discs_is_bounded() -> None:
    """Rolling makes the bound of the step smaller, and just below it a heap stays at rest."""
    model = heap(4)
    without = heap(4)
    without.set_springs([replace(s, rolling_friction=0.0) for s in without.springs.layers])
    assert largest_step(model).seconds < largest_step(without).seconds
    Engine(balance=np.inf).run(model, 3.0)
    rest = model.copy()
    Engine(dt=0.95 * largest_step(rest).seconds, balance=np.inf).run(model, 1.0)
    assert np.hypot(model.x - rest.x, model.z - rest.z).max() < 1e-2 * RADIUS


def test_settled_heap_is_in_equilibrium_moments_included() -> None:
    model = heap(4)
    model.set_springs([replace(s, cn=5.0 * s.cn, ct=5.0 * s.ct) for s in model.springs.layers])
    Engine(balance=np.inf).run(model, 12.0)
    forces = contact_forces(model)
    fx, fz, moment = resultants(model, forces)
    supported = np.hypot(forces.fx, forces.fz).max()
    assert np.hypot(fx, fz).max() < 1e-3 * supported
    assert np.abs(moment).max() < 1e-3 * supported * RADIUS
    assert np.abs(forces.rim_i - forces.rim).max() > 1e-2 * supported
