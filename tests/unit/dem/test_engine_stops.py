"""Every way in which the engine stops, in words: what is lost, impossible, too deep, or out of nowhere."""

from dataclasses import replace

import numpy as np
import pytest

from dem.assembly import DiscBoundary, DiscGeometry, DiscMaterials
from dem.engine.engine import Engine
from dem.engine.time_step import largest_step
from dem.errors import EnergyBalanceError, EscapeError, NotFiniteError, OverlapError, SpeedError, StepTooLargeError
from dem.kernels.contact import KN
from dem.model import DiscModel
from tests.support.dem_cases import BARE_SPRINGS, FLOOR, RADIUS, SOIL_SPRINGS, box


def test_fast_disc_stays_inside_or_the_run_stops_in_words() -> None:
    stopped = 0
    for speed in (10.0, 100.0, 1000.0, 10000.0):
        model = box(6, 5, replace(SOIL_SPRINGS, allowed_overlap=2.0))
        model.lines = np.array([
            [0.0, -2.0 * RADIUS, 0.0, 1.0, -1e3, 1e3], [-2.0 * RADIUS, 0.0, 1.0, 0.0, -1e3, 1e3],
            [17.0 * RADIUS, 0.0, -1.0, 0.0, -1e3, 1e3],
        ])  # fmt: skip
        model.make_list()
        model.set_velocity(0.0, -speed, where=model.z == model.z.max())
        try:
            Engine(balance=np.inf).run(model, 0.3)
        except (SpeedError, EscapeError, OverlapError) as error:
            stopped += f"t = {model.time:.6g} s" in str(error)
        else:
            assert np.all(model.z[~model.fixed] > -2.0 * RADIUS)
            assert np.all(np.abs(model.x[~model.fixed] - 7.5 * RADIUS) < 10.0 * RADIUS)
    assert 0 < stopped < 4


def test_too_large_a_step_is_refused_with_the_number() -> None:
    model = box(6, 5)
    stable = largest_step(model)
    with pytest.raises(StepTooLargeError, match=f"stable step of {stable.seconds:.4g} s that disc {stable.disc}"):
        Engine(dt=1.01 * stable.seconds).run(model, 0.1)
    assert Engine(dt="auto").step_of(model) <= 0.2 * stable.seconds
    Engine(dt=0.99 * stable.seconds, balance=1.0).run(model, steps=10)


def test_fast_discs_take_shorter_steps() -> None:
    """The step in which the fastest disc moves by a quarter of the smallest radius, where that is the smallest step."""
    model = box(6, 5)
    at_rest = largest_step(model).seconds
    for speed in (0.1, 10.0) * np.array(0.25 * RADIUS / at_rest):
        model.set_velocity(speed, 0.0, where=model.z == model.z.max())
        assert largest_step(model).seconds == pytest.approx(min(at_rest, 0.25 * RADIUS / speed))


def test_pairs_that_parted_for_good_do_not_shrink_the_step() -> None:
    """A cracked pair stays listed for its memory, however far its discs are; it must not count as a lever so long."""
    model = box(6, 5)
    model.set_pore_springs()
    model.pore_length[model.pore_length != 0.0] *= -1.0
    before = largest_step(model).seconds
    top = int(np.argmax(np.where(model.fixed, -np.inf, model.z)))
    model.z[top] += 100.0 * RADIUS
    model.make_list()
    assert len(model.pair_i[(model.pair_i == top) | (model.pair_j == top)]) > 0
    assert largest_step(model).seconds >= 0.99 * before


def test_smallest_of_all_limits_sets_the_step() -> None:
    """One light disc among heavy ones: its limit counts, that of a disc between two that hardly move, where each of
    equal discs moves its neighbours, too (a factor of 2 at most in the square of the frequency)."""
    light = replace(BARE_SPRINGS, name="light", density=20.0, effective_density=20.0)
    x = np.array([0.0, 1.5, 3.0, 4.5])
    heavy = DiscModel.create(DiscGeometry(x, np.zeros(4), RADIUS, 0), DiscMaterials([BARE_SPRINGS, light]))
    mixed = DiscModel.create(DiscGeometry(x, np.zeros(4), RADIUS, [0, 0, 1, 0]), DiscMaterials([BARE_SPRINGS, light]))
    assert 0.1 * np.sqrt(1.6) < largest_step(mixed).seconds / largest_step(heavy).seconds < 0.1 * np.sqrt(2.0)
    assert largest_step(mixed).disc == 2


def test_nan_stops_the_run() -> None:
    model = box(6, 5)
    Engine().run(model, 0.1)
    model.vx_half[17] = model.vx[17] = np.nan
    with pytest.raises(NotFiniteError, match=r"disc \d+ at x = .* t = 0\.1"):
        Engine().run(model, 0.1)


def test_too_deep_an_overlap_stops_the_run() -> None:
    model = box(6, 5, replace(SOIL_SPRINGS, kn=1e4, ks=1e4))
    with pytest.raises(
        OverlapError, match=r"disc \d+ at x = .* overlap by 0\.5\d* of their mean radius, allowed is 0\.5"
    ):
        Engine(balance=1.0).run(model, 5.0)
    model = box(6, 5, replace(SOIL_SPRINGS, kn=3e5, ks=1e4, allowed_overlap=1.5))
    Engine(balance=1.0).run(model, 1.0)


def test_energy_from_nowhere_stops_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    model = box(6, 5)
    engine = Engine()
    engine.run(model, 0.1)
    sums = model.energy_sums
    sums[0, 3] += 0.01 * model.turnover  # a dashpot that took what nobody gave
    model.energy_known += 0.01 * model.turnover
    with pytest.raises(EnergyBalanceError, match=r"balance has a gap .* disc \d+ at x = "):
        engine.run(model, 0.1)


def test_undamped_heap_that_gains_energy_is_caught() -> None:
    """A spring whose stiffness is changed under the engine's feet: the energy balance sees it."""
    model = box(8, 6, replace(SOIL_SPRINGS, cn=0.0, ct=0.0, friction=0.0, kpn=0.0, kps=0.0))
    engine = Engine(dt=2e-5)
    engine.run(model, 0.05)

    def pump(m: DiscModel) -> None:
        m.springs.pairs[KN] *= 1.2

    with pytest.raises(EnergyBalanceError):
        engine.run(model, 0.2, every=0.01, on_output=pump)


def test_disc_behind_a_line_is_found() -> None:
    model = DiscModel.create(DiscGeometry([0.0], [RADIUS], RADIUS), DiscMaterials([BARE_SPRINGS]), DiscBoundary(FLOOR))
    model.z[:] = -1.5 * RADIUS
    with pytest.raises(EscapeError, match="has passed rigid line 0"):
        Engine(dt=1e-4, balance=1.0).run(model, steps=1)


@pytest.mark.parametrize(
    ("settings", "words"),
    [({"dt": -1.0}, "dt must be positive"), ({"threads": 0}, "threads")],
)
def test_impossible_settings_are_refused(settings: dict, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        Engine(**settings)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"radius": 0.0}, "radius"),
        ({"layer": 3}, "layers 3 to 3"),
        ({"skin": 0.0}, "skin"),
        ({"x": [np.nan]}, "finite"),
    ],
)
def test_impossible_discs_are_refused(change: dict, words: str) -> None:
    config = {"x": [0.0], "z": [0.0], "radius": RADIUS, "layer": 0, "skin": None} | change
    skin = config.pop("skin")
    with pytest.raises(ValueError, match=words):
        DiscModel.create(DiscGeometry(**config), DiscMaterials([BARE_SPRINGS]), skin=skin)
