"""The engine as a machine: threads, restarts, numbering, neighbour lists, and the JIT."""

import os
import signal
import subprocess
import sys
import threading
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from dem.acceleration import Acceleration, tilted_gravity
from dem.assembly import DiscBoundary, DiscGeometry, DiscMaterials
from dem.engine.engine import Engine
from dem.engine.forces import contact_forces, resultants
from dem.engine.memory import ReusedMemory
from dem.engine.pulses import ShortRuns
from dem.engine.time_step import largest_step
from dem.model import DiscModel
from dem.springs import Law
from tests.support import TOP
from tests.support.dem_cases import (
    BARE_SPRINGS,
    EARTH_SPRINGS,
    FLOOR,
    GRAVITY,
    QUAKE,
    RADIUS,
    SOIL_SPRINGS,
    box,
    same,
    shaking,
    trace,
)


@pytest.fixture(params=["lists by one thread", "lists by all threads"])
def lists(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Few discs are listed, laid out and brought back by one thread, unless they count as many."""
    if request.param == "lists by all threads":
        monkeypatch.setattr("dem.chunked_map.FEW_DISCS", 0)


@pytest.mark.usefixtures("lists")
@pytest.mark.parametrize("law", ["paper", "soil"])
@pytest.mark.parametrize("energies", [True, False])
def test_number_of_threads_changes_no_bit(energies: bool, law: Law) -> None:
    runs = []
    for threads in (1, 3):
        model = shaking(law)
        Engine(threads=threads, energies=energies, balance=1.0).run(model, 0.4)
        runs.append(model)
    assert runs[0].lists_made > 2
    assert np.any(runs[0].pore_length < 0.0)
    assert all(same(runs[0], other) for other in runs[1:])


@pytest.mark.parametrize("law", ["paper", "soil"])
def test_pulses_change_no_bit(law: Law) -> None:
    """Between them places and speeds are those of separate runs, and contacts once they are asked for."""
    runs, pulsed = shaking(law), shaking(law)
    for model in (runs, pulsed):
        model.skin = 0.5  # the list of neighbours lasts, and with it the stable step
        model.make_list()
    dt = 0.3 * largest_step(runs).seconds
    with ShortRuns(pulsed, 0.3) as pulses:
        for turn in range(10):
            Engine(dt=dt, energies=False).run(runs, steps=7)
            pulses.on(7.0 * dt)
            for name in ("x", "z", "vx", "vz", "vr", "roll", "time", "steps"):
                assert np.array_equal(getattr(pulsed, name), getattr(runs, name))
            if turn == 4:
                pulses.whole()
                assert same(pulsed, runs)
                for model in (pulsed, runs):
                    model.set_velocity(0.0, 0.0, where=~model.fixed)
    assert same(pulsed, runs)
    assert np.any(runs.shear != 0.0)


@pytest.mark.parametrize("law", ["paper", "soil"])
def test_restart_changes_no_bit(tmp_path: Path, law: Law) -> None:
    engine = Engine(dt=2e-4, balance=1.0)
    whole = shaking(law)
    engine.run(whole, steps=4001)
    part = shaking(law)
    engine.run(part, steps=1777)
    part.save(tmp_path / "checkpoint.npz")
    part = DiscModel.load(tmp_path / "checkpoint.npz")
    engine.run(part, steps=4001 - 1777)
    assert whole.lists_made > 4
    assert np.any(whole.pore_length < 0.0)
    assert same(whole, part)
    assert part.springs.layers == whole.springs.layers
    assert np.any(whole.rolled != 0.0) == (law == "soil")


def test_room_is_used_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """Zeros each time, in the same place where they fit; in another where they do not, or where many discs count."""
    monkeypatch.setattr("dem.engine.memory.LARGEST_ARRAY", 40)
    room = ReusedMemory(100)
    first = room.zeros("links", 7, 3)
    place = first.ctypes.data
    first[...] = 1.0
    again = room.zeros("links", 5, 4)
    assert (again == np.zeros((5, 4))).all()
    assert again.ctypes.data == place
    assert room.zeros("rolling", 5, 4).ctypes.data != place
    assert room.zeros("links", 50, 4).shape == (50, 4)
    assert (room.zeros("few", 2, 2) == np.zeros((2, 2))).all()
    assert "few" not in room.rooms
    many = ReusedMemory()
    assert (many.zeros("links", 5, 4) == np.zeros((5, 4))).all()
    assert not many.rooms


def test_checkpoint_holds_everything(tmp_path: Path) -> None:
    model = shaking("soil")
    model.lines = FLOOR.copy() - (0, 5, 0, 0, 0, 0)
    Engine(balance=1.0).run(model, 0.2)
    model.save(tmp_path / "checkpoint.npz")
    again = DiscModel.load(tmp_path / "checkpoint.npz")
    assert same(model, again)
    assert vars(again).keys() == vars(model).keys()
    assert np.array_equal(again.acceleration.x, QUAKE.x)
    assert np.array_equal(again.springs.pairs, model.springs.pairs)
    assert not list(tmp_path.glob(".*"))


@pytest.mark.parametrize("law", ["paper", "soil"])
def test_numbering_changes_rounding_only(law: Law) -> None:
    """The same discs numbered in another order move the same way, until chaos has magnified the last bits."""
    first = shaking(law)
    shuffle = np.random.default_rng(0).permutation(len(first))
    second = DiscModel.create(
        DiscGeometry(first.x[shuffle], first.z[shuffle], RADIUS, first.layer[shuffle]),
        DiscMaterials(first.springs.layers, law=law),
        gravity=first.gravity,
        acceleration=first.acceleration,
        skin=first.skin,
    )
    second.set_pore_springs()
    second.set_velocity(first.vx[shuffle], first.vz[shuffle])
    engine = Engine(dt=2e-4, balance=1.0)
    engine.run(first, steps=300)
    engine.run(second, steps=300)
    assert np.abs(first.x[shuffle] - second.x).max() < 1e-9
    assert np.abs(first.vx[shuffle] - second.vx).max() < 1e-7
    assert np.sum(first.pore_length < 0.0) == np.sum(second.pore_length < 0.0)


@pytest.mark.parametrize("law", ["paper", "soil"])
def test_skin_of_the_list_changes_rounding_only(law: Law) -> None:
    ends = []
    for skin in (0.02, 0.3, 0.6):
        model = shaking(law)
        model.skin = skin
        model.make_list()
        Engine(dt=2e-4, balance=1.0).run(model, steps=400)
        ends.append((model.x.copy(), model.lists_made))
    assert ends[0][1] > ends[2][1]
    assert np.abs(ends[0][0] - ends[1][0]).max() < 1e-9
    assert np.abs(ends[0][0] - ends[2][0]).max() < 1e-9


def test_no_jump_of_force_when_a_pair_enters_or_leaves_the_list() -> None:
    """A disc that flies past another and back: its force changes by no more in a step than its path allows."""
    soil = replace(SOIL_SPRINGS, cn=0.0, ct=0.0)
    model = DiscModel.create(DiscGeometry([0.0, 3.0], [0.0, 1.3], RADIUS, fixed=[True, False]), DiscMaterials([soil]))
    model.set_velocity(np.array([0.0, -2.0]), 0.0)
    pairs, force = [], []

    def watch(m: DiscModel) -> float:
        pairs.append(len(m.pair_i))
        force.append(np.hypot(*(f[1] for f in resultants(m, contact_forces(m))[:2])))
        return 0.0

    dt = 2e-3
    trace(model, dt, 1250, watch)
    assert 0 in pairs
    assert 1 in pairs
    jumps = np.abs(np.diff(force))
    assert max(force) > 1e5
    assert jumps.max() <= 1.5 * (soil.kn + soil.ks) * 2.5 * dt


def test_list_is_made_only_when_a_disc_has_moved_half_the_skin() -> None:
    model = DiscModel.create(DiscGeometry([0.0, 10.0], [0.0, 0.0], RADIUS), DiscMaterials([BARE_SPRINGS]), skin=0.2)
    model.set_velocity(np.array([0.0, 1.0]), 0.0)
    begin = model.lists_made
    Engine(dt=1e-3).run(model, steps=99)
    assert model.lists_made == begin
    Engine(dt=1e-3).run(model, steps=3)
    assert model.lists_made == begin + 1


def test_no_steps_leave_the_model_as_it_is() -> None:
    model = shaking()
    Engine(balance=1.0).run(model, steps=5)
    before = model.copy()
    energies = Engine(balance=1.0).run(model, steps=0)
    assert same(before, model)
    assert energies == Engine().measure(model)
    assert Engine(energies=False).run(model, steps=0) is None
    with pytest.raises(ValueError, match="negative"):
        Engine().run(model, steps=-1)


def test_output_comes_at_the_times_asked_for() -> None:
    model = DiscModel.create(
        DiscGeometry([0.0, 10.0], [0.0, 0.0], RADIUS), DiscMaterials([BARE_SPRINGS]), gravity=(0.0, -GRAVITY)
    )
    seen = []
    Engine(dt=1e-3).run(model, 0.1, every=0.03, on_output=lambda m: seen.append((m.time, m.z[0])))
    assert [t for t, _ in seen] == pytest.approx([0.03, 0.06, 0.09, 0.1])
    assert [z for _, z in seen] == pytest.approx([-0.5 * GRAVITY * t**2 for t, _ in seen])


def test_weight_is_effective_and_the_rest_is_full() -> None:
    """Gravity moves a disc with rho_w / rho_d of its value, Kh with all of it."""
    soil = replace(BARE_SPRINGS, density=2220.0, effective_density=1220.0)
    model = DiscModel.create(
        DiscGeometry([0.0, 10.0], [0.0, 0.0], RADIUS), DiscMaterials([soil]), gravity=(0.0, -GRAVITY)
    )
    model.acceleration = Acceleration.seismic(0.1, g=GRAVITY)
    Engine(dt=1e-3).run(model, 1.0)
    assert model.vz == pytest.approx(-GRAVITY * 1220.0 / 2220.0, rel=1e-9)
    assert model.vx == pytest.approx(0.1 * GRAVITY, rel=1e-9)


def test_acceleration_in_time_is_followed() -> None:
    times = np.linspace(0.0, 1.0, 11)
    model = DiscModel.create(DiscGeometry([0.0, 10.0], [0.0, 0.0], RADIUS), DiscMaterials([BARE_SPRINGS]))
    model.acceleration = Acceleration(times, np.sin(5.0 * times), times**2)
    Engine(dt=1e-3).run(model, 1.5)
    for v, a in ((model.vx, np.sin(5.0 * times)), (model.vz, times**2)):
        assert v == pytest.approx(0.1 * (a.sum() - 0.5 * (a[0] + a[-1])) + 0.5 * a[-1], abs=1e-3)


def test_kh_acts_horizontally_in_a_tilted_frame() -> None:
    tilt = 0.2
    down = np.array(tilted_gravity(tilt, 1.0))
    across = Acceleration.seismic(1.0, tilt=tilt, g=1.0)
    side = np.array([across.x[0], across.z[0]])
    assert side @ down == pytest.approx(0.0, abs=1e-15)
    assert side @ side == pytest.approx(1.0)
    assert side[0] > 0.0
    ramp = Acceleration.seismic(0.3, tilt=tilt, ramp=(1.0, 3.0), g=1.0)
    assert np.interp([0.0, 1.0, 2.0, 3.0, 9.0], ramp.times, ramp.x) == pytest.approx(
        0.3 * np.cos(tilt) * np.array([0.0, 0.0, 0.5, 1.0, 1.0]), abs=1e-12
    )


def test_softened_springs_keep_overlap_and_slip() -> None:
    model = box(8, 6, tilt=0.1)
    Engine().run(model, 1.0)
    before = contact_forces(model)
    a, b = model.springs.layers
    model.set_springs([replace(s, kn=0.1 * s.kn, ks=0.1 * s.ks, cn=0.0, ct=0.0) for s in (a, b)])
    after = contact_forces(model)
    model.set_springs([replace(s, cn=0.0, ct=0.0) for s in (a, b)])
    undone = contact_forces(model)
    assert after.normal == pytest.approx(0.1 * undone.normal, abs=1e-6 * np.abs(before.normal).max())
    assert after.tangential == pytest.approx(0.1 * undone.tangential, abs=1e-6 * np.abs(before.normal).max())


def test_shrunk_discs_keep_mass_and_spin_and_their_overlaps_change() -> None:
    model = box(8, 6, EARTH_SPRINGS, tilt=0.1, law="soil")
    engine = Engine()
    engine.run(model, 1.0)
    mass, spin, edits = model.mass.copy(), model.spin.copy(), engine.measure(model).edits
    over = model.radius[model.pair_i] + model.radius[model.pair_j] - model.distance()
    deepest = over.max()
    shrinking = ~model.fixed
    model.set_radius(np.where(shrinking, model.radius - 0.25 * deepest, model.radius))
    assert np.array_equal(model.mass, mass)
    assert model.spin == pytest.approx(spin, rel=1e-12)
    over = model.radius[model.pair_i] + model.radius[model.pair_j] - model.distance()
    assert over.max() < 0.8 * deepest
    energies = engine.run(model, 1.0)
    assert energies is not None
    assert energies.edits < edits
    assert abs(energies.gap) < 1e-3 * energies.turnover
    with pytest.raises(ValueError, match="positive radii"):
        model.set_radius(-model.radius)


def test_cut_pore_springs_by_layer() -> None:
    model = box(8, 6)
    model.set_pore_springs()
    upper = (model.layer[model.pair_i] == 0) | (model.layer[model.pair_j] == 0)
    fixed = model.pore_length > 0.0
    assert model.cut_pore_springs([0]) == np.sum(upper & fixed)
    assert np.all(model.pore_length[upper] == 0.0)
    assert np.all(model.pore_length[fixed & ~upper] > 0.0)


def test_settled_column_of_discs_carries_its_weight_to_the_base() -> None:
    model = DiscModel.create(
        DiscGeometry(np.zeros(9), RADIUS + 2.0 * RADIUS * np.arange(9), RADIUS),
        DiscMaterials([replace(SOIL_SPRINGS, effective_density=1200.0, cn=5.0 * SOIL_SPRINGS.cn)]),
        DiscBoundary(FLOOR),
        gravity=(0.0, -GRAVITY),
    )
    Engine().run(model, 12.0)
    model.set_pore_springs()
    Engine().run(model, 1.0)
    assert contact_forces(model).line_fz == pytest.approx([np.sum(model.mass * model.weight) * GRAVITY], rel=1e-6)


def test_interrupted_run_leaves_a_whole_model() -> None:
    """Ctrl-C while the kernel runs: the model stands where the kernel stopped, and goes on from there."""
    model, whole = shaking(), shaking()
    engine = Engine(dt=2e-4, balance=1.0)

    def press() -> None:
        while not model.steps:
            time.sleep(0.01)
        signal.raise_signal(signal.SIGINT)

    pressing = threading.Thread(target=press, daemon=True)
    pressing.start()
    with pytest.raises(KeyboardInterrupt):
        engine.run(model, steps=10**9)
    pressing.join()
    assert 0 < model.steps < 10**9
    assert model.time == pytest.approx(model.steps * 2e-4)
    engine.run(whole, steps=model.steps)
    for name in ("x", "vz_half", "pore_length", "shear"):
        assert np.array_equal(getattr(model, name), getattr(whole, name))


TINY = """
import numpy as np
import sys
from tests.support.dem_cases import box, EARTH_SPRINGS, SOIL_SPRINGS
from dataclasses import replace
from dem.engine.engine import Engine
law = sys.argv[1]
model = box(5, 4, replace(SOIL_SPRINGS if law == "paper" else EARTH_SPRINGS, cohesion=2e3), tilt=0.1, law=law)
model.lines = np.array([[0.0, -1.5, 0.0, 1.0, -1e3, 1e3], [0.0, 1.0, 1.0, 0.0, -1e3, 1e3]])
model.make_list()
model.set_pore_springs()
model.set_velocity(np.sin(np.arange(len(model))) * ~model.fixed, 0.0)
energies = Engine(dt=3e-4, threads=2, balance=1.0).run(model, steps=60)
booked = [energies.gap, energies.dashpots, energies.cracks]
values = [model.x, model.z, model.vx, model.vr, np.sort(model.pore_length), booked]
print(" ".join(float(v).hex() for v in np.concatenate(values)))
"""


@pytest.mark.slow
def test_processes_that_start_at_once_share_one_cache(tmp_path: Path) -> None:
    command = [sys.executable, "-c", TINY, "paper"]
    where = TOP
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
    for _ in range(2):  # compiling at the same time, then reading
        started = [
            subprocess.Popen(command, cwd=where, env=environment, stdout=subprocess.PIPE, text=True) for _ in range(3)
        ]
        outputs = [process.communicate()[0] for process in started]
        assert all(process.returncode == 0 for process in started)
        assert len(set(outputs)) == 1
        assert outputs[0]


@pytest.mark.parametrize("law", [pytest.param("paper", marks=pytest.mark.slow), "soil"])
def test_same_numbers_with_the_jit_switched_off(law: Law) -> None:
    root = TOP
    outputs = []
    for off in ("0", "1"):
        result = subprocess.run(
            [sys.executable, "-c", TINY, law], cwd=root, env=os.environ | {"NUMBA_DISABLE_JIT": off},
            capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert result.returncode == 0, result.stderr
        outputs.append(np.array([float.fromhex(v) for v in result.stdout.split()]))
    with_jit, without = outputs
    assert np.array_equal(with_jit[:-3], without[:-3])  # the motion, to the last bit
    assert with_jit[-3:] == pytest.approx(without[-3:], rel=1e-9, abs=1e-6)  # sums of the energy balance
