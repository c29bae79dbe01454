"""What a slide may not do unnoticed: pass through the box, come near its sides, lose ground."""

from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from dem.case import Case
from dem.ground import Ground
from dem.model import DiscModel
from dem.packing import lattice_box
from dem.settings import DemSettings, SlideSettings
from dem.slides.balance import (
    at_the_sides,
    both_sides,
    deepest_overlap,
    disc_area,
    expected_loss,
    ground_area,
    pressed_through,
    stopped_by,
    thin_crust,
    thin_layers,
    within_scatter,
)
from dem.slides.drive import constant_kh
from dem.slides.liquefaction import Slider
from dem.slides.surface import Surface
from dem.slides.volume import volume_change
from dem.springs import Strength, soil_discs
from tests.support.dem_cases import RADIUS

SAND = soil_discs("sand", 3e7, Strength(0.35), 2000.0, 1000.0, RADIUS, 0.27)
SETTINGS = DemSettings()


@pytest.fixture(scope="module")
def ground() -> Ground:
    """20 columns and 8 rows, level; rows 3 and 4 from the bottom are a layer of their own."""
    packing = lattice_box(20, 8, RADIUS)
    row = np.round(packing.z / (np.sqrt(3.0) * RADIUS)).astype(int)
    packing.layer[packing.free & ((row == 2) | (row == 3))] = 1
    return Ground(packing, "lattice", RADIUS, 0, 0.0, (0.0, 0.0), 1)


@pytest.fixture(scope="module")
def start(ground: Ground) -> DiscModel:
    return ground.model([SAND, replace(SAND, name="loose")], SETTINGS)


def test_discs_that_lie_on_fixed_ones_are_told(start: DiscModel, ground: Ground) -> None:
    """S-13, case 3, with Table 2: free centres came to lie on those of wall discs, and nobody heard of it."""
    assert pressed_through(start) == 0
    pressed = start.copy()
    disc = int(np.flatnonzero(~pressed.fixed)[0])
    walls = np.flatnonzero(pressed.fixed)
    away = np.hypot(pressed.x[walls] - pressed.x[disc], pressed.z[walls] - pressed.z[disc])
    wall = int(walls[np.argmin(away)])
    pressed.x[disc], pressed.z[disc] = pressed.x[wall], pressed.z[wall] + 1e-3
    pressed.make_list()
    assert pressed_through(pressed) == 1
    slider = Slider(start, ground, [1], Case(stiffness=0.1), SlideSettings())
    slider.model = pressed
    assert any(note.startswith("1 disc overlaps the fixed ones") for note in slider._notes())


def test_areas(start: DiscModel, ground: Ground) -> None:
    discs = int((~start.fixed).sum())
    assert disc_area(start) == pytest.approx(discs * np.pi * RADIUS**2)
    assert disc_area(start, [1]) == pytest.approx((start.layer == 1).sum() * np.pi * RADIUS**2)
    lowered = start.copy()
    top = np.flatnonzero(~start.fixed & (start.z > start.z[~start.fixed].max() - 0.1))
    lowered.z[top] -= 0.3
    width = np.ptp(start.x[top])
    assert ground_area(start, ground) - ground_area(lowered, ground) == pytest.approx(0.3 * width, rel=0.1)


def test_the_area_does_not_hang_on_where_in_its_column_the_first_disc_lies(start: DiscModel, ground: Ground) -> None:
    """A disc that rolled by a radius along the left side took half a per cent of a river bank with it."""
    surface = Surface.of(start, ground)
    first = surface.discs[np.argmin(surface.x)]
    rolled = start.copy()
    rolled.x[first] += 0.9 * RADIUS
    slip = 0.9 * RADIUS * np.ptp(start.z[~start.fixed])
    assert ground_area(rolled, ground) == pytest.approx(ground_area(start, ground), abs=0.05 * slip)


def test_volume_change_is_told_by_stratum(start: DiscModel, ground: Ground) -> None:
    """Ground that is 2 % lower has lost 2 % of its area, in every stratum; ground that is carried away and turned over
    on its side, none."""
    lower, disc_model = start.copy(), start.copy()
    lower.z *= 0.98
    assert volume_change(start, lower) == pytest.approx(-0.02, rel=1e-9)
    disc_model.x, disc_model.z = 7.0 - start.z, start.x.copy()
    assert volume_change(start, disc_model) == pytest.approx(0.0, abs=1e-12)
    slider = Slider(start, ground, [1], Case(stiffness=0.1), SlideSettings())
    slider.model = slider.start.copy()
    slider.model.z *= 0.98
    assert any("get denser as they shear" in note and "-2.0 %" in note for note in slider._notes())


def test_ground_that_piles_up_at_a_side_is_told(start: DiscModel, ground: Ground) -> None:
    before = both_sides(start, start, ground)
    assert at_the_sides(before) == []
    piled = start.copy()
    right = ~piled.fixed & (piled.x > piled.x[~piled.fixed].max() - 4.0)
    piled.z[right] += 2.5 * RADIUS
    after = both_sides(piled, start, ground)
    assert (stopped_by(before), stopped_by(after)) == (None, "right")
    assert at_the_sides(after) == [], "the side that stopped the slide is the reason of its end, and no note besides"
    left, right = after
    both = [left._replace(piled=True, rise=0.5 * right.rise), right]
    assert ["piled up" in note and "left" in note for note in at_the_sides(both)] == [True]


def test_a_narrow_column_at_the_right_side_is_no_hollow(start: DiscModel, ground: Ground) -> None:
    """A column narrower than a disc had its highest disc 5 m below the ground: ground that rose by 0.4 m "piled up by
    2.1 m at the right side", which then had stopped a slide that was at rest."""
    free = np.flatnonzero(~start.fixed)
    deepest = free[np.argmin(start.z[free])]
    narrow = start.copy()
    narrow.x[deepest] = start.x[free].min() + 2.0 * ground.radius * (
        int(np.ptp(start.x[free]) / (2.0 * ground.radius)) + 1.2
    )
    assert deepest not in Surface.of(narrow, ground).discs
    assert stopped_by(both_sides(start, narrow, ground)) is None


@pytest.mark.parametrize(("columns", "side"), [(13, None), (8, "right")])
def test_what_slid_far_and_ends_at_a_side_was_stopped_by_it(
    columns: int, side: str | None, start: DiscModel, ground: Ground
) -> None:
    """A disc of the surface slid five columns to the right side; another one slid further, and ended before it."""
    slid = start.copy()
    discs = Surface.of(start, ground).discs
    slid.x[discs[-6]] += 10.0 * RADIUS
    slid.x[discs[2]] += 2.0 * columns * RADIUS
    assert stopped_by(both_sides(slid, start, ground)) == side


@pytest.mark.parametrize(("by_weight", "message"), [(9.9, True), (1.5, False)])
def test_a_flow_failure_is_judged_by_what_weight_alone_does(
    by_weight: float, message: bool, start: DiscModel, ground: Ground, monkeypatch: pytest.MonkeyPatch
) -> None:
    """9.9 m without shaking is one for a bank 8 m high, though it slid 47 m, five times as far, with Kh.

    The slide without shaking counts where it ends, as with shaking: a side pushed the river bank back by 4 m.
    """
    slider = Slider(start, ground, [1], Case(stiffness=0.1), SlideSettings())
    height = np.linspace(8.0, 0.0, len(slider.surface.z))
    slider.surface = replace(slider.surface, z=height)
    slider.slide.rows = [SimpleNamespace(slide_max_m=47.0, time_s=60.0)]
    largest = SimpleNamespace(slide_max_m=by_weight + 4.0, time_s=15.0)
    alone = SimpleNamespace(rows=[largest, SimpleNamespace(slide_max_m=by_weight, time_s=20.0)])
    monkeypatch.setattr(Slider, "run", lambda _: alone)
    assert [("flow failure" in note) for note in slider._flow()] == [True] * message
    assert (slider.slide.flows, slider.slide.slide_by_weight_m) == (message, by_weight)


@pytest.mark.parametrize("by_weight", [True, False])
def test_a_slide_of_a_random_packing_is_not_repeated_without_shaking(
    by_weight: bool, start: DiscModel, ground: Ground, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Only the packing of the run says whether a case is a flow failure: the scatter of packings is that of slides."""
    slider = Slider(start, ground, [1], Case(stiffness=0.1), SlideSettings(), by_weight=by_weight)
    slider.slide.rows = [SimpleNamespace(slide_max_m=47.0, time_s=60.0)]
    requested: list[bool] = []
    monkeypatch.setattr(Slider, "_flow", lambda _: requested.append(True) or [])
    slider._notes()
    assert requested == [True] * by_weight


def test_a_thin_layer_is_told_with_the_radius_that_it_wants(start: DiscModel, ground: Ground) -> None:
    assert thin_layers(start, ground, [0]) == []
    thin = start.copy()
    row = np.round(thin.z / (np.sqrt(3.0) * RADIUS)).astype(int)
    thin.layer[~thin.fixed & (row == 3)] = 0
    messages = thin_layers(thin, ground, [1])
    assert len(messages) == 1
    assert "less than two disc diameters" in messages[0]
    assert "0.38 m" in messages[0]  # a row of 1.5 m: two discs of a quarter of that
    both = thin.copy()
    both.layer[~thin.fixed & (row != 3)] = 1
    both.layer[~thin.fixed & (row == 3)] = 0
    assert len(thin_layers(both, ground, [0, 1])) <= 1, "layers are told in one note"


def test_a_crust_thinner_than_two_discs_is_told(start: DiscModel, ground: Ground) -> None:
    """Rows are 1.3 m apart: one row on a liquefied one is told with a quarter of that as radius, three are not."""
    crusted = start.copy()
    row = np.round(crusted.z / (np.sqrt(3.0) * RADIUS)).astype(int)
    for rows, count in ((1, 1), (3, 0)):
        crusted.layer[~crusted.fixed] = 0
        crusted.layer[~crusted.fixed & (row == row[~crusted.fixed].max() - rows)] = 1
        messages = thin_crust(crusted, ground, [1])
        assert len(messages) == count
        assert ["check with discs of 0.32 m radius" in note for note in messages] == [True] * count
    assert thin_crust(start, ground, []) == []


def test_a_slide_within_the_scatter_of_packings_is_told() -> None:
    """A quarter of a diameter, downhill or uphill; a longer slide is one."""
    for far in (0.2, -0.2):
        assert "less than 0.25 m" in within_scatter(far, 0.5)[0]
    assert within_scatter(0.3, 0.5) == []


def test_liquefied_discs_do_not_pass_through_each_other(start: DiscModel, ground: Ground) -> None:
    """Contacts are gone, but pore water keeps their volume: no two centres come nearer than half a diameter."""
    slider = Slider(start, ground, [1], Case(), SlideSettings(duration=3.0, onset=0.0))
    slide = slider.run()
    model = slider.model
    i, j = model.liquefied_i, model.liquefied_j
    assert np.hypot(model.x[j] - model.x[i], model.z[j] - model.z[i]).min() > RADIUS
    assert not (model.layer[model.pair_i] == 1).any()
    assert slide.overlap < 0.2  # of the discs above and below, whose contacts are there


def test_a_layer_that_drains_loses_what_was_asked(start: DiscModel, ground: Ground) -> None:
    case = Case(residual=0.5, volumetric_strain=0.05)
    slider = Slider(start, ground, [1], case, SlideSettings(kh=0.0, onset=1.0, duration=4.0))
    before = disc_area(start, [1])
    slide = slider.run()
    assert disc_area(slider.model, [1]) == pytest.approx(0.95 * before, rel=1e-9)
    assert (slider.model.mass == start.mass).all()
    assert slide.rows[-1].settlement_middle_m == pytest.approx(0.05 * 2 * np.sqrt(3.0) * RADIUS, rel=0.5)
    assert abs(slide.area_lost_share) < 0.02


def test_softer_springs_give_way_as_was_asked(start: DiscModel, ground: Ground) -> None:
    """Discs of two rows too large by 5 %: their four contacts of a column are shorter by 1 - 1/1.05, the four with the
    rows above and below by 1 - 1/1.025, and twice the mean is the share of their area that is to go."""
    area = ground_area(start, ground)
    pressed = start.copy()
    pressed.radius[pressed.layer == 1] *= 1.05
    share = disc_area(start, [1]) / disc_area(start)
    assert expected_loss(start, start, [1], area, {}) == pytest.approx(0.0, abs=1e-6 * area)
    assert expected_loss(start, start, [1], area, {1: 0.03}) == pytest.approx(0.03 * share * area)
    gave_way = expected_loss(start, pressed, [1], area, {})
    assert gave_way == pytest.approx((2.0 - 1.0 / 1.05 - 1.0 / 1.025) * share * area, rel=0.05)


def test_kh_is_taken_away_again(ground: Ground) -> None:
    settings = SlideSettings(kh=0.2, kh_seconds=2.0, onset=1.0)
    start = SimpleNamespace(law="soil", time=10.0)
    shaking = constant_kh(cast("DiscModel", start), ground, [1], settings).acceleration
    at = np.interp([9.9, 12.0, 14.4, 15.6, 30.0], shaking.times, shaking.x)
    assert at == pytest.approx([0.0, 0.2 * 9.80665, 0.2 * 9.80665, 0.0, 0.0], abs=1e-9)
    paper = SimpleNamespace(law="paper", time=0.0)
    short = constant_kh(cast("DiscModel", paper), ground, [1], settings.changed(kh_seconds=1e-5, onset=0.0))
    assert short.acceleration.x[-1] == pytest.approx(0.0, abs=1e-9)
    endless = constant_kh(cast("DiscModel", start), ground, [1], settings.changed(kh_seconds=None)).acceleration
    assert endless.x[-1] == pytest.approx(0.2 * 9.80665)


def test_a_case_has_one_residual() -> None:
    with pytest.raises(ValueError, match="residual and residual_strength: expected only one of them"):
        Case(residual=0.1, residual_strength="4 kPa")


def test_overlap(start: DiscModel) -> None:
    assert deepest_overlap(start) == pytest.approx(0.0, abs=1e-9)
