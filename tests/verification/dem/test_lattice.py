"""The triangular lattice, chain and column against their closed forms."""

from dataclasses import replace

import numpy as np
import pytest

from dem.assembly import DiscBoundary, DiscGeometry, DiscMaterials
from dem.engine.engine import Engine
from dem.engine.forces import contact_forces, resultants
from dem.engine.time_step import largest_step, step_finder
from dem.model import DiscModel
from tests.support.dem_cases import BARE_SPRINGS, FLOOR, GRAVITY, KN, MASS, RADIUS, lattice, random_discs, stress, trace

SPACING = 2.0 * RADIUS * (1.0 - 1e-6)  # everything touches


def patch(ks: float, size: int = 11) -> tuple[DiscModel, np.ndarray]:
    """A free patch of lattice that sticks at its contacts, and the mask of the disc in the middle."""
    soil = replace(BARE_SPRINGS, ks=ks, friction=1e12)
    x, z = lattice(size, size, SPACING)
    middle = np.hypot(x - x.mean(), z - z.mean())
    model = DiscModel.create(
        DiscGeometry(x - x[np.argmin(middle)], z - z[np.argmin(middle)], RADIUS), DiscMaterials([soil])
    )
    return model, np.arange(len(x)) == np.argmin(middle)


def displace(model: DiscModel, ux: np.ndarray, uz: np.ndarray, turn: np.ndarray | float) -> None:
    """Moves the discs by (ux, uz) and turns them, as motion: slip comes with it, inertia does not."""
    dt = 1e-7
    model.set_velocity(ux / dt, uz / dt, turn / dt)
    model.fixed[:] = True
    Engine(dt=dt, energies=False).run(model, steps=1)
    model.fixed[:] = False


@pytest.mark.parametrize("ratio", [0.2, 0.5, 1.0])
def test_elastic_constants(ratio: float) -> None:
    kn, ks = KN, ratio * KN
    size = 1e-8
    strains = {"M": (1.0, 0.0, 0.0), "G": (0.0, 0.0, 1.0), "E": (1.0, -(kn - ks) / (3.0 * kn + ks), 0.0)}
    values = {}
    for name, (exx, ezz, gxz) in strains.items():
        model, middle = patch(ks)
        before = stress(model, contact_forces(model), np.sqrt(0.75) * SPACING**2, middle)
        displace(model, size * (exx * model.x + gxz * model.z), size * ezz * model.z, -0.5 * size * gxz)
        after = stress(model, contact_forces(model), np.sqrt(0.75) * SPACING**2, middle)
        values[name] = (after - before) / size
    root = np.sqrt(3.0)
    assert values["M"][0, 0] == pytest.approx(root / 4.0 * (3.0 * kn + ks), rel=1e-5)
    assert values["G"][0, 1] == pytest.approx(root / 4.0 * (kn + ks), rel=1e-5)
    assert values["G"][1, 0] == pytest.approx(values["G"][0, 1], rel=1e-5)
    assert values["E"][0, 0] == pytest.approx(2.0 * root * kn * (kn + ks) / (3.0 * kn + ks), rel=1e-5)
    assert abs(values["E"][1, 1]) < 1e-5 * kn


@pytest.mark.parametrize("direction", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("kind", ["P", "S"])
def test_long_waves(kind: str, direction: float) -> None:
    kn, ks = KN, 0.4 * KN
    model, middle = patch(ks)
    number = 2e-2 / RADIUS  # wave number: long, and yet felt in the forces
    c, s = np.cos(direction), np.sin(direction)
    phase = number * (model.x * c + model.z * s)
    along = (c, s) if kind == "P" else (-s, c)
    size = 1e-8
    turn = 0.0 if kind == "P" else -0.5 * number * size * np.sin(phase)
    wave = size * np.cos(phase)
    displace(model, wave * along[0], wave * along[1], turn)
    fx, fz, _ = resultants(model, contact_forces(model))
    force = fx[middle] * along[0] + fz[middle] * along[1]
    speed = np.sqrt(-force[0] / (MASS * size)) / number
    stiffness = 3.0 * kn + ks if kind == "P" else kn + ks
    assert speed == pytest.approx(RADIUS * np.sqrt(1.5 * stiffness / MASS), rel=3e-4)


def constant(ks: float, cn: float = 0.0) -> DiscModel:
    """A lattice inside a frame of fixed discs, everything touching, with a little random motion."""
    soil = replace(BARE_SPRINGS, ks=ks, friction=1e12, cn=cn, ct=cn)
    x, z = lattice(14, 14, SPACING)
    i, j = np.meshgrid(np.arange(14), np.arange(14))
    frame = ((i == 0) | (i == 13) | (j == 0) | (j == 13)).ravel()
    model = DiscModel.create(DiscGeometry(x, z, RADIUS, fixed=frame), DiscMaterials([soil]))
    rng = np.random.default_rng(1)
    vx, vz, spin = 1e-9 * rng.standard_normal((3, len(x)))
    model.set_velocity(vx[~frame], vz[~frame], spin[~frame] / RADIUS, where=~frame)
    return model


def bustle(model: DiscModel) -> float:
    """Sum of the squares of all speeds."""
    return float(np.sum(model.vx**2 + model.vz**2 + model.vr**2))


@pytest.mark.parametrize(("ks", "damping"), [(0.1, 0.0), (0.5, 0.0), (1.0, 0.0), (0.3, 0.5)])
def test_stable_step(ks: float, damping: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Motion stays small up to the step the engine allows, and grows without end beyond what the closed form allows.

    The frame of fixed discs allows some thousandths more than the closed form of a lattice without end."""
    cn = damping * np.sqrt(MASS * KN)
    model = constant(ks * KN, cn)
    allowed = largest_step(model).seconds
    square = max(6.0 + 2.0 * ks, 24.0 * ks) * KN / MASS
    rate = (max(6.0 + 2.0, 24.0) if ks > 3.0 / 11.0 else 8.0) * cn / MASS
    closed_form = 2.0 / (rate + np.sqrt(rate**2 + square))
    assert allowed <= 1.005 * closed_form
    if ks > 3.0 / 11.0 and damping == 0.0:
        assert allowed == pytest.approx(closed_form, rel=5e-3)  # rotation sets it, and the bound is exact
    before = bustle(model)
    Engine(dt=0.99 * allowed, balance=np.inf).run(model, steps=3000)
    assert bustle(model) < 30.0 * before
    model = constant(ks * KN, cn)
    monkeypatch.setattr(Engine, "_refuse", lambda *_: None)
    Engine(dt=1.03 * closed_form, energies=False).run(model, steps=1500)
    assert not bustle(model) < 1e3 * before


def highest_frequency(model: DiscModel, ks: float) -> float:
    """Highest frequency (rad/s) of discs whose listed pairs all touch, from the whole matrix of their stiffness."""
    matrix = np.zeros((3 * len(model), 3 * len(model)))
    for i, j in zip(model.pair_i, model.pair_j, strict=True):
        dx, dz = model.x[j] - model.x[i], model.z[j] - model.z[i]
        distance, radii = np.hypot(dx, dz), model.radius[i] + model.radius[j]
        nx, nz, lever = dx / distance, dz / distance, max(distance / radii, 1.0)
        places = [3 * i, 3 * i + 1, 3 * i + 2, 3 * j, 3 * j + 1, 3 * j + 2]
        along = np.array([-nx, -nz, 0.0, nx, nz, 0.0])
        across = np.array([nz, -nx, -lever, -nz, nx, -lever])  # turns in radii, as spins are
        matrix[np.ix_(places, places)] += KN * np.outer(along, along) + ks * np.outer(across, across)
    inverse = np.column_stack([1.0 / model.mass, 1.0 / model.mass, model.inertia_ratio / model.mass]).ravel()
    root = np.sqrt(inverse)
    return float(np.sqrt(np.linalg.eigvalsh(root[:, None] * matrix * root).max()))


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("ratio", [0.1, 0.5, 1.0])
def test_bound_of_the_step_is_safe_and_close_for_random_discs(seed: int, ratio: float) -> None:
    """The bound allows 0.94 to 0.96 of the step that the exact highest frequency allows."""
    model = random_discs(seed, 49, replace(BARE_SPRINGS, ks=ratio * KN), 0.0)
    exact = 2.0 / highest_frequency(model, ratio * KN)
    assert 0.9 * exact < largest_step(model).seconds <= exact


@pytest.mark.parametrize("share", [0.2, 0.9, 1.0, 1.1])
def test_bound_that_is_large_enough_is_not_improved(share: float) -> None:
    model = random_discs(1, 49, replace(BARE_SPRINGS, ks=0.5 * KN), 0.0)
    best = largest_step(model).seconds
    early = step_finder(model, enough=share * best)().seconds
    assert min(share, 1.0) * best <= early <= best
    assert share > 0.2 or early < best


def test_column_settles_under_its_weight() -> None:
    count = 12
    soil = replace(BARE_SPRINGS, cn=np.sqrt(MASS * KN))
    z = RADIUS + 2.0 * RADIUS * np.arange(count)
    model = DiscModel.create(
        DiscGeometry(np.zeros(count), z, RADIUS), DiscMaterials([soil]), DiscBoundary(FLOOR), gravity=(0.0, -GRAVITY)
    )
    Engine(dt="auto").run(model, 20.0)
    item = MASS * GRAVITY / KN
    above = np.arange(count, 0, -1)  # discs that each contact carries
    assert z - model.z == pytest.approx(np.cumsum(above) * item, rel=1e-6)
    assert (z - model.z)[-1] == pytest.approx(count * (count + 1) / 2 * item, rel=1e-6)
    assert contact_forces(model).line_fz == pytest.approx([count * MASS * GRAVITY], rel=1e-6)


@pytest.mark.parametrize("mode", [1, 3, 8])
def test_chain_frequencies(mode: int) -> None:
    """The scheme keeps q(n+1) - 2 q(n) + q(n-1) = -(omega dt)^2 q(n) for each mode, whatever the step."""
    count, dt = 8, 5e-4
    x = SPACING * np.arange(count + 2)
    ends = (np.arange(count + 2) == 0) | (np.arange(count + 2) == count + 1)
    model = DiscModel.create(DiscGeometry(x, np.zeros(count + 2), RADIUS, fixed=ends), DiscMaterials([BARE_SPRINGS]))
    shape = np.sin(np.arange(count + 2) * mode * np.pi / (count + 1))
    model.set_velocity(1e-6 * np.where(ends, 0.0, shape), 0.0)
    q = trace(model, dt, 60, lambda m: (m.x - x) @ shape)
    bend = 2.0 * q[1:-1] - q[:-2] - q[2:]
    square = (bend @ q[1:-1]) / (q[1:-1] @ q[1:-1]) / dt**2
    assert np.sqrt(square) == pytest.approx(
        2.0 * np.sqrt(KN / MASS) * np.sin(mode * np.pi / (2.0 * (count + 1))), rel=1e-6
    )
