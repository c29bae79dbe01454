"""The critical Kh of one push, against blocks that slide at Kh = mu, and what a push must not depend on."""

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from dem.assembly import DiscMaterials
from dem.errors import NotFiniteError
from dem.ground import Ground
from dem.model import DiscModel
from dem.packing import Packing, lattice_box
from dem.search import pushover
from dem.search.calibration import calibrate, calibrated
from dem.search.calibrator import Calibrator
from dem.search.critical import Search
from dem.search.equilibrium import Trial, settle, step_on, stop
from dem.search.pushover import BAND_DISPLACEMENT, LAST_DISPLACEMENT, LAST_REACH, Continuum, pushover_critical_kh
from dem.settings import DemSettings
from dem.springs import LayerSprings, Strength, soil_discs
from tests.support.dem_cases import FLOOR, GRAVITY, RADIUS, SOIL_SPRINGS

MU = 0.313
SETTINGS = DemSettings()


def block(soil: LayerSprings, tilt: float = 0.0) -> tuple[Ground, DiscModel, Continuum]:
    """Discs that do not turn, apart from each other on a rigid plane, at rest; and where they yield: Kh and way (m)."""
    x = 4.0 * RADIUS * np.arange(4)
    packing = Packing(x, np.full(4, RADIUS), np.full(4, RADIUS), np.zeros(4, np.int32), FLOOR)
    ground = Ground(packing, "box", RADIUS, 1, tilt, (0.0, 0.0), 1)
    model = packing.discs(DiscMaterials([soil], turns=False), gravity=(GRAVITY * np.sin(tilt), -GRAVITY * np.cos(tilt)))
    for _ in range(40):
        step_on(model, 0.05)
        stop(model)
    return ground, model, Continuum(soil.friction, float(model.mass[0] * GRAVITY * soil.friction / soil.ks))


@cache
def sliding_block() -> tuple[Search, DiscModel]:
    """The push of a block of MU on a level plane, and its discs at the end."""
    ground, model, continuum = block(replace(SOIL_SPRINGS, friction=MU, kpn=0.0, kps=0.0))
    return pushover_critical_kh(model, ground, SETTINGS, continuum)


@pytest.mark.parametrize(("mu", "tilt_deg"), [(MU, 5.0), pytest.param(0.07, 0.0, marks=pytest.mark.slow)])
def test_a_block_is_pushed_over_where_friction_says(mu: float, tilt_deg: float) -> None:
    """A block on a plane that dips by beta slides at Kh = tan(phi - beta)."""
    tilt = np.radians(tilt_deg)
    ground, model, continuum = block(replace(SOIL_SPRINGS, friction=mu, kpn=0.0, kps=0.0), tilt)
    result = pushover_critical_kh(model, ground, SETTINGS, continuum, until_failed=False)[0]
    assert result.verdict == "bracketed"
    assert result.kc == pytest.approx(np.tan(np.arctan(mu) - tilt), rel=0.02)
    assert result.kc_lower <= result.kc <= result.kc_upper


def test_an_error_after_the_curve_leaves_the_discs_of_its_end(monkeypatch: pytest.MonkeyPatch) -> None:
    """A disc that is nowhere is no ground that slid: the answer is whole, and the slip surface that of the curve."""
    ground, model, continuum = block(replace(SOIL_SPRINGS, friction=MU, kpn=0.0, kps=0.0))
    points = pushover._points

    def lost(discs: DiscModel, *options: Any) -> Iterator[Trial | str | None]:
        for trial in points(discs, *options):
            yield trial
            if trial is None:
                discs.x[:] = np.nan
                raise NotFiniteError("a disc is nowhere")

    whole = sliding_block()[0]
    monkeypatch.setattr(pushover, "_points", lost)
    result, loaded = pushover_critical_kh(model, ground, SETTINGS, continuum)
    assert (result.verdict, result.kc, result.curve) == (whole.verdict, whole.kc, whole.curve)
    assert result.reason.endswith("the test continued until NotFiniteError: a disc is nowhere")
    assert np.isfinite(loaded.x).all()
    assert (loaded.x - model.x).mean() == pytest.approx(result.trials[-1].displacement_m, rel=0.05)


def test_a_push_tells_where_and_why_it_ends() -> None:
    """A block whose reach is short moves by eight of them, one whose reach is long by eight radii."""
    ground, model, short = block(replace(SOIL_SPRINGS, friction=MU, kpn=0.0, kps=0.0))
    long = short._replace(yielding=2.0 * RADIUS / SETTINGS.ductility)
    for (item, loaded), way, why in (
        (
            sliding_block(),
            LAST_DISPLACEMENT * SETTINGS.ductility * short.yielding,
            "at the largest displacement of the test",
        ),
        (pushover_critical_kh(model, ground, SETTINGS, long), BAND_DISPLACEMENT * RADIUS, "a band of shear has formed"),
    ):
        assert item.reason.endswith(why)
        assert f"the test continued to a displacement of {(loaded.x - model.x).mean():.2g} m" in item.reason
        assert (loaded.x - model.x).mean() == pytest.approx(way, rel=0.05)


def test_the_critical_kh_is_known_before_the_discs_have_failed() -> None:
    """A push that ends with its curve has the same curve to the last bit; its block is a little past the reach."""
    ground, model, continuum = block(replace(SOIL_SPRINGS, friction=MU, kpn=0.0, kps=0.0))
    result, loaded = pushover_critical_kh(model, ground, SETTINGS, continuum, until_failed=False)
    until_failed, furthest = sliding_block()
    assert (result.kc_lower, result.kc_upper, result.curve) == (
        until_failed.kc_lower, until_failed.kc_upper, until_failed.curve
    )  # fmt: skip
    assert result.verdict == "bracketed"
    assert result.reason.endswith("times the yield displacement of the finite elements")
    reach = SETTINGS.ductility * continuum.yielding
    assert reach < (loaded.x - model.x).mean() < 1.3 * reach < (furthest.x - model.x).mean()


def test_ground_of_which_a_part_comes_apart_is_pushed_no_further() -> None:
    """One disc of four is twenty times as far as the others."""
    ground, model, _ = block(replace(SOIL_SPRINGS, friction=MU, kpn=0.0, kps=0.0))
    disc_model = model.copy()
    disc_model.x += 0.1 * RADIUS
    machine = pushover.DisplacementControl(RADIUS, 1.0)
    assert not pushover._end_reason(disc_model, model, ground, machine, 0.1 * RADIUS)
    disc_model.x[-1] += 2.0 * RADIUS
    assert "a part has separated from the rest" in pushover._end_reason(
        disc_model, model, ground, machine, 0.1 * RADIUS
    )


def test_the_curve_is_elastic_and_then_level() -> None:
    """Up to mu a block gives way by Kh m g / ks, beyond it slides at that Kh."""
    continuum = block(replace(SOIL_SPRINGS, friction=MU, kpn=0.0, kps=0.0))[2]
    result = sliding_block()[0]
    assert result.kc == pytest.approx(MU, rel=0.02)
    assert result.kc_lower <= result.kc <= result.kc_upper
    kh, moved = np.array(result.curve).T
    yielding = continuum.yielding
    elastic = moved < 0.8 * yielding
    assert elastic.sum() >= 3
    assert kh[elastic] == pytest.approx(moved[elastic] * MU / yielding, rel=0.05)
    assert kh[moved > 1.3 * yielding] == pytest.approx(MU, rel=0.05)
    assert result.trials[-1].displacement_m <= LAST_REACH * SETTINGS.ductility * yielding


@pytest.mark.slow
def test_the_ground_does_not_swing_on_the_machine() -> None:
    """On a stiff one, which a small reach makes, Kh is as smooth: no point is far from those beside it."""
    ground, model = heap()
    result = pushover_critical_kh(model, ground, SETTINGS, Continuum(0.3, 2e-4))[0]
    kh = np.array([trial.kh for trial in result.trials])
    assert np.abs(np.diff(kh, 2)).max() < 0.1 * kh.max()
    assert max(trial.kinetic_ratio for trial in result.trials) < 1e-3


@cache
def heap() -> tuple[Ground, DiscModel]:
    soil = soil_discs("sand", 4.0e7, Strength(0.3), 2000.0, 2000.0, RADIUS, 0.1)
    ground = Ground(lattice_box(12, 4, RADIUS), "box", RADIUS, 4, 0.0, (0.0, 0.0), 1)
    return ground, settle(ground, [soil], SETTINGS)


@pytest.mark.slow
def test_the_answer_does_not_depend_on_threads_and_the_discs_stay_as_they_were() -> None:
    ground, model = heap()
    before = model.x.copy()
    continuum = Continuum(0.3, 0.01)
    item, two = (
        pushover_critical_kh(model, ground, SETTINGS, continuum, threads=n, until_failed=False)[0] for n in (1, 2)
    )
    assert item == two
    assert np.array_equal(model.x, before)


@pytest.mark.slow
def test_stronger_discs_bear_more() -> None:
    """And the factor that meets a target between two is found."""
    ground, model = heap()
    calibrator = Calibrator(ground, list(model.springs.layers), model, SETTINGS, continuum=Continuum(0.3, 0.01))
    weak, strong = (calibrator.search("strength", factor).kc for factor in (0.8, 1.3))
    assert weak is not None
    assert strong is not None
    assert weak < strong
    calibration = calibrate(calibrator, 0.5 * (weak + strong), "strength", [])
    assert calibration.verdict == "calibrated"
    assert 0.8 < calibration.value < 1.3


def test_a_push_wants_a_displacement() -> None:
    ground, model = heap()
    with pytest.raises(ValueError, match="a displacement above 0"):
        pushover_critical_kh(model, ground, SETTINGS, Continuum(0.3, 0.0))


def test_discs_are_brought_to_the_nearest_kh_at_which_the_continuum_may_fail() -> None:
    softening = Continuum(0.16, 0.1, 0.23)
    assert [softening.nearest(kh) for kh in (0.1, 0.2, 0.3)] == [0.16, 0.2, 0.23]
    assert Continuum(0.16, 0.1).nearest(0.2) == 0.16


class _Proportional(Calibrator):
    """Discs whose critical Kh is 0.38 times the factor on their strength, as that of a packing of S-13 about is."""

    def settled_with(self, parameter: str, factor: float) -> DiscModel:
        return self.settled

    def _searched(self, key: tuple[str, float], settled: DiscModel, fine: bool) -> Search:
        return Search(0.38 * key[1] - 0.001, 0.38 * key[1] + 0.001, "bracketed")


@pytest.mark.parametrize(("first", "factors"), [(0.9, {0.9}), (0.8, {0.8, 0.89474})])
def test_another_packing_begins_with_the_factor_of_the_first(first: float, factors: set[float]) -> None:
    """Random packings of one section differ little: a factor that is close enough needs one search."""
    ground, model, _ = block(replace(SOIL_SPRINGS, friction=MU, kpn=0.0, kps=0.0))
    discs = _Proportional(ground, [SOIL_SPRINGS], model, DemSettings())
    calibration = calibrated(discs, Continuum(0.34, 0.1), one_at_a_time=False, first=first)
    assert calibration.verdict == "calibrated"
    assert {round(factor, 5) for _, factor in discs.searches} == factors
    assert {name for name, _ in discs.searches} == {"strength"}
