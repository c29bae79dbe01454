"""Slides of a small box: what liquefaction does, what is recorded; a stopped one goes on with the same bits."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from dem.case import Case
from dem.engine.checks import BALANCE
from dem.engine.engine import Engine
from dem.ground import Ground
from dem.model import DiscModel
from dem.packing import lattice_box
from dem.search.equilibrium import settle
from dem.settings import DemSettings, SlideSettings
from dem.slides.balance import LEAST_STEP, REPORTED_IMBALANCE, energy_tolerance, on_energy
from dem.slides.drive import Shaking
from dem.slides.liquefaction import Slider
from dem.slides.liquefied_strength import liquefied
from dem.slides.slide import Row, Slide
from dem.slides.slip import compare, cracked_shares, slip_surface
from dem.slides.surface import Surface, crack_opening, escaped
from meshes.section.section import Section
from tests.support.dem_cases import RADIUS, SOIL_SPRINGS
from tests.support.sections import slope

# springs as soft, for their weight, as those of Table 2
SAND = replace(
    SOIL_SPRINGS,
    kn=4.0e6,
    ks=1.0e6,
    cn=1.3e5,
    ct=6.5e4,
    kpn=4.0e5,
    kps=1.0e5,
    cohesion=0.0,
    allowed_overlap=1.0,
    name="sand",
)
LAYERS = [SAND, replace(SAND, name="loose")]
SETTINGS = SlideSettings(duration=6.0, frames=3)
BETWEEN = 6e-5  # energy out of balance over the total energy exchanged, between what the step and half of it leave


@pytest.fixture(scope="module")
def ground() -> Ground:
    """16 columns and 6 rows that dip by 5 degrees; rows 2 and 3 from the bottom are the loose layer."""
    packing = lattice_box(16, 6, RADIUS)
    row = np.round(packing.z / (np.sqrt(3.0) * RADIUS)).astype(int)
    packing.layer[packing.free & ((row == 2) | (row == 3))] = 1
    return Ground(packing, "box", RADIUS, 6, float(np.radians(5.0)), (10.0, 20.0), 1)


@pytest.fixture(scope="module")
def start(ground: Ground) -> DiscModel:
    return settle(ground, LAYERS, DemSettings(model="paper"))


def slid(start: DiscModel, ground: Ground, case: Case | None, **changes: object) -> Slide:
    settings = SETTINGS.model_copy(update=changes)
    return Slider(start, ground, [1], case, settings).run()


def test_kh_reverses_in_its_cycles_where_no_record_is_given(start: DiscModel, ground: Ground) -> None:
    """Two cycles of half a second and the halves at the edges, then nothing; it was held for ever before."""
    settings = SETTINGS.changed(kh=0.1, kh_cycles=2.0, kh_period=0.5, onset=1.0)
    drive = Slider(start, ground, [1], Case(residual=0.1), settings).motion
    assert drive.starts == {1: 0.0}  # liquefied in full once the shaking begins
    assert drive.end == pytest.approx(1.0 + 1.5 + settings.duration, abs=1e-5)
    moving = drive.acceleration
    swing = np.interp(start.time + np.linspace(0.0, 4.0, 401), moving.times, moving.x)
    assert np.abs(swing[:100]).max() == 0.0
    assert swing.max() == pytest.approx(-swing.min(), rel=0.02)
    assert swing.max() == pytest.approx(0.1 * 9.81 * np.cos(ground.tilt), rel=0.02)
    assert np.abs(swing[260:]).max() < 1e-9
    assert Slider(start, ground, [1], None, settings.changed(kh=0.0)).motion.end == settings.duration


def test_liquefied_layers_take_the_factors() -> None:
    """Table 2, case 1 of layer 4: springs and dashpots a tenth, no friction, no cohesion, no pore springs."""
    dry, wet = liquefied(LAYERS, [1], Case(stiffness=0.1, damping=0.1))
    assert replace(dry, allowed_overlap=1.0) == SAND
    assert (wet.kn, wet.ks, wet.cn, wet.ct) == pytest.approx((4.0e5, 1.0e5, 1.3e4, 6.5e3))
    assert (wet.friction, wet.pore_friction, wet.cohesion, wet.kpn, wet.kps) == (0.0, 0.0, 0.0, 0.0, 0.0)
    assert (dry.allowed_overlap, wet.allowed_overlap) == (2.0, 2.0)
    on_the_way = liquefied(LAYERS, [1], Case(stiffness=0.01, damping=0.1), 0.5)[1]
    assert on_the_way.kn == pytest.approx(0.1 * SAND.kn)
    assert liquefied(LAYERS, [1], Case(stiffness=0.1, friction=0.5))[1].friction == pytest.approx(0.5 * SAND.friction)


def test_softer_layers_settle_more_and_nothing_escapes(start: DiscModel, ground: Ground) -> None:
    alone = slid(start, ground, None)
    cases = [slid(start, ground, Case(stiffness=s)) for s in (0.3, 0.1, 0.05)]
    drops = [slide.rows[-1].settlement_uphill_m for slide in (alone, *cases)]
    assert drops == sorted(drops)
    assert drops[-1] > 5.0 * max(drops[0], 0.01)
    for slide in cases:
        assert slide.escaped == 0
        work = [row.work_J for row in slide.rows]
        fixed = [row.kinetic_J + row.stored_J + row.dissipated_J for row in slide.rows]
        # energy in the springs that was cut at the onset is no work, and does not change afterwards
        assert np.ptp(np.array(fixed) - work) < 2e-3 * max(abs(w) for w in work)
    data = cases[-1].as_json(alone)
    assert data["slides_over_share_uphill"] >= data["slides_over_share_downhill"]
    assert len(data["surface_before"]) > 10
    assert np.ptp(data["surface_after"], axis=0)[0] == pytest.approx(np.ptp(data["surface_before"], axis=0)[0], abs=4.0)


def test_a_slide_that_a_side_of_the_box_stopped_has_not_come_to_rest(
    start: DiscModel, ground: Ground, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The surface lies still in both; where a side holds it, it would go on in a longer section."""
    monkeypatch.setattr("dem.slides.liquefaction.stopped_by", lambda sides: "right")
    slide = slid(start, ground, Case(stiffness=0.3), kh=0.0, duration=30.0, still=1e-3)
    assert not slide.settled
    assert slide.stopped_by == "right"
    assert slide.reason == "the right side of the box stopped the slide: in a longer section it would continue"


def closing(load: float, k: float) -> float:
    """How far two rows come together under a load (N) per disc: two contacts of stiffness k (N/m), eq. (1), carry it,
    load = 2 k (2r - D) (h - v)/D with D = sqrt(r^2 + (h - v)^2), h = r sqrt(3)."""
    h, v = RADIUS * np.sqrt(3.0), np.linspace(0.0, 0.5, 5001)
    distance = np.hypot(RADIUS, h - v)
    return float(np.interp(load, 2.0 * k * (2.0 * RADIUS - distance) * (h - v) / distance, v))


def test_soft_rows_settle_as_their_springs_say(start: DiscModel, ground: Ground) -> None:
    """Rows 2 and 3 liquefied: the gap between them has the soft springs, those above and below the mean of both."""
    slide = slid(start, ground, Case(stiffness=0.3), kh=0.0, duration=30.0, still=1e-3)
    assert slide.settled
    disc = SAND.effective_density * np.pi * RADIUS**2 * 9.80665 * np.cos(ground.tilt)
    after = closing(4 * disc, 0.65 * SAND.kn) + closing(3 * disc, 0.3 * SAND.kn) + closing(2 * disc, 0.65 * SAND.kn)
    before = sum(closing(rows * disc, SAND.kn) for rows in (2, 3, 4))
    assert slide.rows[-1].settlement_middle_m == pytest.approx(after - before, rel=0.05)


def test_a_stopped_slide_goes_on_with_the_same_bits(start: DiscModel, ground: Ground, tmp_path: Path) -> None:
    case = Case(stiffness=0.05)
    whole = Slider(start, ground, [1], case, SETTINGS, tmp_path / "whole").run()

    class InterruptError(Exception):
        pass

    def after_five(_model: DiscModel, row: Row, _frame: bool) -> None:
        if row.time_s > 2.4:
            raise InterruptError

    with pytest.raises(InterruptError):
        Slider(start, ground, [1], case, SETTINGS, tmp_path / "part").run(after_five)
    resumed = Slider(start, ground, [1], case, SETTINGS, tmp_path / "part")
    assert 0 < len(resumed.slide.rows) < len(whole.rows)
    assert resumed.run() == whole
    assert Slider(start, ground, [1], case, SETTINGS, tmp_path / "part").run() == whole
    (tmp_path / "part" / "rows.json").write_text("{half of a")
    assert Slider(start, ground, [1], case, SETTINGS, tmp_path / "part").slide.rows == []


def test_a_slide_whose_energy_does_not_balance_begins_again_with_half_the_step(
    start: DiscModel, ground: Ground, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = Case(stiffness=0.1, damping=0.1)
    plain = Slider(start, ground, [1], case, SETTINGS).run()
    assert plain.step_share == SETTINGS.step_of("paper")

    def misses(allowed: float) -> Slide:
        monkeypatch.setattr("dem.slides.liquefaction.energy_tolerance", lambda _: allowed)
        return Slider(start, ground, [1], case, SETTINGS, tmp_path / f"{allowed:g}").run()

    half = misses(BETWEEN)
    assert half.step_share == SETTINGS.step_of("paper") / 2
    assert half.reason.split(";")[0] == plain.reason.split(";")[0]
    assert abs(len(half.rows) - len(plain.rows)) <= 1  # when a slide is at rest hangs on a look
    for row, other in zip(half.rows, plain.rows, strict=False):
        assert row.time_s == pytest.approx(other.time_s, abs=0.01)
    assert half.rows[-1].slide_max_m == pytest.approx(plain.rows[-1].slide_max_m, abs=0.1)
    resumed = Slider(start, ground, [1], case, SETTINGS, tmp_path / f"{BETWEEN:g}").run()
    assert resumed == half

    never = misses(1e-12)
    assert never.step_share == LEAST_STEP * SETTINGS.step_of("paper")
    assert "EnergyBalanceError" in never.reason
    assert not never.settled


def test_the_shortest_step_has_a_wider_tolerance_of_the_energy_and_what_it_leaves_is_told(start: DiscModel) -> None:
    assert energy_tolerance(1.0) == energy_tolerance(0.5) == BALANCE
    assert BALANCE < energy_tolerance(LEAST_STEP) < REPORTED_IMBALANCE
    balance = Engine().run(start.copy(), steps=100)
    assert balance is not None
    assert on_energy(balance) == []
    gap = replace(balance, external=balance.external - 0.02 * balance.turnover - balance.gap)
    assert on_energy(gap) == ["2 % of the energy that the discs exchanged is unaccounted for"]


def test_threads_do_not_change_a_slide(start: DiscModel, ground: Ground) -> None:
    case = Case(stiffness=0.05)
    item, two = (Slider(start, ground, [1], case, SETTINGS).run(threads=n) for n in (1, 2))
    assert item == two


def test_an_onset_that_takes_time_ends_at_the_same_springs(start: DiscModel, ground: Ground) -> None:
    case = Case(stiffness=0.1)
    slider = Slider(start, ground, [1], case, SETTINGS.model_copy(update={"onset": 2.0}))
    slider.run()
    assert list(slider.model.springs.layers) == liquefied(LAYERS, [1], case)


def test_surface_and_slip(start: DiscModel, ground: Ground) -> None:
    """The upper three rows are pushed by 0.4 m along the rows: a slide of the surface, a jump below them."""
    surface = Surface.of(start, ground)
    assert len(surface.discs) == pytest.approx(16, abs=1)
    assert list(np.unique(surface.third)) == [0, 1, 2]
    moved = start.copy()
    upper = ~moved.fixed & (moved.z > 2.6 * np.sqrt(3.0) * RADIUS)
    moved.x[upper] += 0.4
    slide, settlement = surface.movement(moved, ground)
    assert slide == pytest.approx(0.4 * np.cos(ground.tilt), abs=1e-9)
    assert settlement == pytest.approx(0.4 * np.sin(ground.tilt), abs=1e-9)
    line = slip_surface(moved, start, ground)
    assert len(line) > 4
    u = (line[:, 0] - 10.0) * np.sin(ground.tilt) + (line[:, 1] - 20.0) * np.cos(ground.tilt)
    assert np.median(u) == pytest.approx(2.5 * np.sqrt(3.0) * RADIUS, abs=0.5 * RADIUS)
    assert len(slip_surface(start, start, ground)) == 0
    section = Section.parse(slope())
    agreement = compare(section, np.array([[20.0, 15.0], [60.0, 9.0]]), np.array([[0.0, 14.0], [100.0, 4.0]]))
    assert agreement is not None
    assert agreement.mean_distance_m == pytest.approx(2.0)
    assert agreement.same_stratum_share == 0.5
    assert compare(section, np.zeros((0, 2)), line) is None


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_largest_slide_is_to_either_side(side: float, start: DiscModel, ground: Ground) -> None:
    """The face of an embankment that fell to the left slid 2.7 m, and the report said 2.0 m, those of the right one."""
    slider = Slider(start, ground, [1], Case(residual=0.1), SETTINGS)
    surface, moved = slider.surface, start.copy()
    moved.x[surface.discs[-5:]] += side * ground.downhill * 0.8
    moved.x[surface.discs[:5]] -= side * ground.downhill * 0.3
    slider.model = moved
    assert slider._look().slide_max_m == pytest.approx(0.8 * np.cos(ground.tilt))
    slide = slider._finished()
    assert slide.slide_max_at_x_m in surface.x[-5:]
    alone = replace(slide, slide=[0.2] * len(slide.slide))
    assert slide.as_json(alone)["slides_over_share"] == pytest.approx(5.0 / len(slide.slide))


def test_cracks_and_escapes_are_counted(start: DiscModel, ground: Ground) -> None:
    assert crack_opening(start, ground, Surface.of(start, ground)) == pytest.approx(0.0, abs=0.02)
    torn = start.copy()
    torn.x[~torn.fixed & (torn.x > 12.0)] += 0.3
    assert crack_opening(torn, ground, Surface.of(start, ground)) == pytest.approx(0.3, abs=0.15)
    assert escaped(torn) == 0
    torn.z[int(np.flatnonzero(~torn.fixed)[0])] -= 4.0 * RADIUS
    assert escaped(torn) == 1
    cracked = start.copy()
    cracked.pore_length[:] = -np.abs(cracked.pore_length)
    assert cracked_shares(cracked) == {"sand": 1.0, "loose": 1.0}
    assert set(cracked_shares(start).values()) == {0.0}


def test_a_record_shakes_and_strata_liquefy_each_at_its_time(ground: Ground, start: DiscModel) -> None:
    """Constant push as a record is Kh that is held; what liquefies later is still whole until then; then calm."""
    time = np.linspace(0.0, 3.0, 61)
    acceleration = np.where(time < 2.0, 0.1 * 9.80665 * np.minimum(1.0, time / 0.5), 0.0)
    heard: dict[float, float] = {}

    def look(model: DiscModel, row: Row, _: bool) -> None:
        heard[round(row.time_s, 2)] = model.springs.layers[1].kn

    shaking = Shaking(time, acceleration, {1: 1.25})
    slide = Slider(start, ground, [1], Case(stiffness=0.1), SETTINGS, shaking=shaking).run(look)
    assert heard[1.0] == LAYERS[1].kn
    assert heard[1.25] == LAYERS[1].kn  # the look comes before the change
    assert heard[1.75] == pytest.approx(0.1 * LAYERS[1].kn)
    assert slide.rows[-1].time_s > 3.0  # rest counts from the end of the record on
    assert slide.rows[-1].slide_max_m > 0.0


def test_no_record_moves_nothing_and_its_sign_is_downhill(ground: Ground, start: DiscModel) -> None:
    time = np.linspace(0.0, 1.0, 41)
    wave = 2.0 * np.sin(np.pi * time)

    def far(loading: np.ndarray) -> float:
        slider = Slider(start, ground, [], None, SETTINGS, shaking=Shaking(time, loading, {}))
        slider.run()
        return float(slider.surface.movement(slider.model, ground)[0].mean())

    count, down, up = far(0.0 * wave), far(wave), far(-wave)
    assert abs(count) < 1e-4
    assert down > 1e-3
    assert abs(up) < 0.1 * down  # ground that spreads to both sides: the weight resists this one
