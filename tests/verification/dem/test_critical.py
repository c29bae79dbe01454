"""Verdicts and critical Kh of discs, against a block that slides at Kh = mu and other known answers."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from dem.assembly import DiscMaterials
from dem.ground import Ground
from dem.model import DiscModel
from dem.packing import Packing, lattice_box
from dem.search.calibration import calibrate, choose, sensitivities
from dem.search.calibrator import Calibrator, changed
from dem.search.critical import critical_kh
from dem.search.equilibrium import KhRise, displacement, period, settle, step_on, stop, try_kh, unbalanced_ratio
from dem.settings import DemSettings
from dem.springs import LayerSprings
from tests.support.dem_cases import FLOOR, RADIUS, SOIL_SPRINGS

MU = 0.313  # no multiple of a step of Kh
SETTINGS = DemSettings(model="paper", resolution=0.005)


def blocks(layers: list[LayerSprings], tilt: float = 0.0, count: int = 4) -> tuple[Ground, DiscModel]:
    """Discs that cannot turn, apart from each other on a rough rigid plane that dips by `tilt`: blocks, at rest."""
    x = 4.0 * RADIUS * np.arange(count)
    layer = np.arange(count) % len(layers)
    packing = Packing(x, np.full(count, RADIUS), np.full(count, RADIUS), layer.astype(np.int32), FLOOR)
    ground = Ground(packing, "box", RADIUS, 1, tilt, (0.0, 0.0), 1)
    gravity = (9.80665 * np.sin(tilt), -9.80665 * np.cos(tilt))
    model = packing.discs(DiscMaterials(layers, turns=False), gravity=gravity)
    for _ in range(40):
        step_on(model, 0.05)
        stop(model)
    assert unbalanced_ratio(model) < 1e-3
    return ground, model


@pytest.mark.parametrize(("mu", "tilt_deg"), [(MU, 0.0), (MU, 5.0), (0.031, 0.0), (0.022, 0.0), (0.087, 0.0)])
def test_a_block_slides_where_friction_says(mu: float, tilt_deg: float) -> None:
    """A block on a plane that dips by beta slides at Kh = tan(phi - beta), from tan(beta + atan Kh) = mu."""
    soil = replace(SOIL_SPRINGS, friction=mu, kpn=0.0, kps=0.0)
    ground, model = blocks([soil], np.radians(tilt_deg))
    search = critical_kh(model, ground, SETTINGS)
    kc = np.tan(np.arctan(mu) - np.radians(tilt_deg))
    assert search.verdict == "bracketed"
    assert search.kc_lower <= kc <= search.kc_upper
    assert search.kc_upper - search.kc_lower <= 0.005 * (1.0 + 1e-9)
    assert {t.verdict for t in search.trials} == {"stands", "fails"}


def test_elastic_displacement_is_that_of_the_spring() -> None:
    """Under Kh a block gives way by Kh m g / ks, the answer that `flexibility` is."""
    soil = replace(SOIL_SPRINGS, friction=MU, kpn=0.0, kps=0.0)
    ground, model = blocks([soil])
    search = critical_kh(model, ground, SETTINGS)
    assert search.flexibility_m == pytest.approx(model.mass[0] * 9.80665 / soil.ks, rel=2e-2)


def test_the_answer_does_not_depend_on_threads_or_on_the_way() -> None:
    soil = replace(SOIL_SPRINGS, friction=MU)
    packing = lattice_box(12, 4, RADIUS)
    ground = Ground(packing, "box", RADIUS, 4, 0.0, (0.0, 0.0), 1)
    model = settle(ground, [soil], SETTINGS)
    before = model.x.copy()
    item, two = (critical_kh(model, ground, DemSettings(model="paper", kh_limit=0.6), threads=n) for n in (1, 2))
    assert item == two
    assert np.array_equal(model.x, before)


def test_what_stands_and_what_fails_says_why() -> None:
    soil = replace(SOIL_SPRINGS, friction=MU, kpn=0.0, kps=0.0)
    ground, model = blocks([soil])
    stands = try_kh(model.copy(), model, ground, SETTINGS, KhRise(0.0, 0.8 * MU, 1e-3))
    assert (stands.verdict, stands.unbalanced_ratio < SETTINGS.unbalanced) == ("stands", True)
    moved = model.copy()
    flexible = model.mass[0] * 9.80665 / soil.ks
    fails = try_kh(moved, model, ground, SETTINGS, KhRise(0.0, 1.2 * MU, flexible))
    assert fails.verdict == "fails"
    assert "times the elastic one and grows" in fails.reason
    assert displacement(moved, model, ground) > 3.0 * 1.2 * MU * flexible
    patient = SETTINGS.model_copy(update={"growth": 1e9, "patience": 2.0})
    assert try_kh(model.copy(), model, ground, patient, KhRise(0.0, 1.2 * MU, flexible)).verdict == "undecided"


def test_ground_that_slides_at_the_first_kh_stood_under_its_own_weight() -> None:
    """Friction of 0.01 holds blocks on a level floor, and gives way at Kh = 0.01, before the first that is tried."""
    ground, model = blocks([replace(SOIL_SPRINGS, friction=0.01, ks=1.0, kpn=0.0, kps=0.0)])
    search = critical_kh(model, ground, SETTINGS)
    assert (search.verdict, search.kc_lower, search.kc_upper, search.kc) == ("undecided", 0.0, 0.02, None)
    assert search.reason.startswith("the discs stand at rest, but not at Kh = 0.02")


def test_ground_that_does_not_fail_stands_to_the_limit() -> None:
    ground, model = blocks([replace(SOIL_SPRINGS, friction=5.0)])
    limited = critical_kh(model, ground, SETTINGS.model_copy(update={"kh_limit": 0.25}))
    assert (limited.verdict, limited.kc) == ("stands everywhere", None)


def test_period_of_a_uniform_ground() -> None:
    """4 H / V_s with V_s = r sqrt(1.5 (kn + ks) / m) (verification: waves in the triangular lattice)."""
    packing = lattice_box(20, 6, RADIUS)
    ground = Ground(packing, "box", RADIUS, 6, 0.0, (0.0, 0.0), 1)
    model = packing.discs(DiscMaterials([SOIL_SPRINGS]))
    mass = np.pi * RADIUS**2 * SOIL_SPRINGS.density
    height = 5 * RADIUS * np.sqrt(3.0) + 2.0 * RADIUS
    speed = RADIUS * np.sqrt(1.5 * (SOIL_SPRINGS.kn + SOIL_SPRINGS.ks) / mass)
    assert period(model, ground) == pytest.approx(4.0 * height / speed, rel=1e-6)


class OnBlocks(Calibrator):
    """Calibrates sliding blocks, which fail at Kh = mu."""

    @classmethod
    def of_friction(cls, **changes: Any) -> "OnBlocks":
        soil = replace(SOIL_SPRINGS, friction=MU, kpn=0.0, kps=0.0)
        ground, model = blocks([soil])
        return cls(ground, [soil], model, SETTINGS.model_copy(update={"parameter": "friction"}), **changes)

    def settled_with(self, parameter: str, factor: float) -> DiscModel:
        return self.settled if factor == 1.0 else blocks(changed(self.layers, parameter, factor))[1]


def test_calibration_finds_the_friction_that_the_block_needs() -> None:
    """A target of 0.4 of the critical Kh wants a factor of 0.4 on friction."""
    heard: list[tuple[str, float]] = []
    calibrator = OnBlocks.of_friction(on_search=lambda p, f, _: heard.append((p, f)))
    ground, soil, model = calibrator.ground, calibrator.layers[0], calibrator.settled
    settings = calibrator.settings = calibrator.settings.changed(tolerance=0.01, resolution=0.01)
    calibration = calibrate(calibrator, 0.4 * MU, "friction", [("", 1.0, calibrator.search("", 1.0))])
    assert calibration.verdict == "calibrated"
    assert calibration.value == pytest.approx(0.4, abs=0.05)
    assert calibration.search.kc == pytest.approx(0.4 * MU, abs=settings.tolerance)
    assert len(heard) == len(set(heard)) <= 8

    again = OnBlocks(ground, [soil], model, settings, known=calibrator.searches)
    assert calibrate(again, 0.4 * MU, "friction", [("", 1.0, again.search("", 1.0))]).value == calibration.value

    far = OnBlocks(ground, [soil], model, settings.model_copy(update={"range": (0.5, 2.0)}), known=calibrator.searches)
    lost = calibrate(far, 0.1 * MU, "friction", [("", 1.0, far.search("", 1.0))])
    assert lost.verdict == "out of reach"
    assert lost.value == 0.5
    assert "the discs fail at Kh = 0.1" in lost.reason


@pytest.mark.slow
def test_the_critical_kh_of_blocks_depends_on_friction_alone() -> None:
    calibrator = OnBlocks.of_friction()
    table = sensitivities(calibrator)
    moved = {p: s.kc for p, f, s in table if f == 2.0}
    assert moved["friction"] == pytest.approx(2.0 * MU, abs=0.005)
    assert moved["stiffness"] == pytest.approx(MU, abs=0.005)
    assert moved["pore_strength"] == pytest.approx(MU, abs=0.005)

    known = len(calibrator.searches)
    assert choose(calibrator, table, 0.8 * MU) == "friction"
    assert len(calibrator.searches) == known  # halved, friction reaches it: no need to try the ends of the range
    assert choose(calibrator, table, 0.3 * MU) == "friction"
    assert {("friction", 0.1), ("stiffness", 0.1)} <= set(calibrator.searches)


def test_springs_that_do_not_carry_the_ground_are_no_fault() -> None:
    """Discs so soft that they are pushed through each other fail under their own weight, and calibration goes on."""
    packing = lattice_box(10, 8, RADIUS)
    ground = Ground(packing, "box", RADIUS, 8, 0.0, (0.0, 0.0), 1)
    soil = replace(SOIL_SPRINGS, kn=2.0e6, ks=5.0e5, cn=8e4, ct=4e4, kpn=0.0, kps=0.0)
    model = settle(ground, [soil], SETTINGS)
    calibrator = Calibrator(ground, [soil], model, SETTINGS)
    assert calibrator.search("stiffness", 0.02).verdict == "fails under its own weight"
