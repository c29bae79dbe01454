"""Element tests against closed forms of the triangular lattice, and against what is known of random discs."""

from dataclasses import replace

import numpy as np
import pytest

from dem.laboratory.compression import compress
from dem.laboratory.element_test import element_test
from dem.laboratory.loading import Curve, LoadingKind, confine, load, probe
from dem.laboratory.patch import Patch, PatchSample, lattice_patch
from dem.laboratory.plane_elastic import lattice_elastic
from dem.laboratory.strength import dilation
from dem.laboratory.strength_map import strength_map
from dem.springs import ROLLING, Strength, soil_discs
from tests.support.dem_cases import KN, RADIUS, SOIL_SPRINGS

SMALL = (16, 18)  # discs of a random patch: stronger than a large one by a few degrees, but quick
STIFF = 3e-4 * KN  # pressure (Pa) at which discs are nearly rigid


def confined(friction: float, turns: bool = True, pressure: float = STIFF, **changes: float) -> Patch:
    """A lattice without pore springs under a pressure."""
    patch = lattice_patch(replace(SOIL_SPRINGS, friction=friction, **changes), RADIUS)
    if not turns:
        patch.model.inertia_ratio[:] = 0.0
    confine(patch, pressure)
    return patch


def run(patch: Patch, kind: LoadingKind) -> Curve:
    """A test slow enough for strains of a few thousandths."""
    stiffness, _ = probe(patch, STIFF)
    return load(patch, kind, STIFF, 0.018, 2e-4, stiffness)


@pytest.mark.parametrize("ratio", [0.2, 0.5, 1.0])
@pytest.mark.parametrize("pores", [False, True])
def test_stiffness_of_the_lattice(ratio: float, pores: bool) -> None:
    """verification.md: M = sqrt(3)/4 (3 kn + ks), G = sqrt(3)/4 (kn + ks), E = 2 sqrt(3) kn (kn + ks)/(3 kn + ks).

    nu = (kn - ks)/(3 kn + ks), 2-D constants; pore springs add to kn and ks.
    """
    patch = confined(0.7, pressure=1e-4 * KN, ks=ratio * KN, kpn=0.3 * KN, kps=0.1 * KN)
    kn, ks = KN, ratio * KN
    if pores:
        patch.model.set_pore_springs()
        kn, ks = 1.3 * KN, ks + 0.1 * KN
    result, skewness = probe(patch, 1e-4 * KN)
    root = np.sqrt(3.0)
    assert pytest.approx(root / 4.0 * (3.0 * kn + ks), rel=1e-3) == result.M
    assert pytest.approx(root / 4.0 * (kn + ks), rel=1e-3) == result.G
    assert result.E_2d == pytest.approx(2.0 * root * kn * (kn + ks) / (3.0 * kn + ks), rel=1e-3)
    assert result.nu_2d == pytest.approx((kn - ks) / (3.0 * kn + ks), abs=1e-3)
    # the same in all directions, as the lattice is
    assert abs(skewness) < 1e-5
    assert abs(2.0 * result.G / (result.M - result.lame) - 1.0) < 1e-3
    reference = lattice_elastic(patch.model.springs.layers[0], pores)
    assert (result.E, result.nu) == pytest.approx((reference.E, reference.nu), rel=2e-3, abs=1e-3)


@pytest.mark.parametrize("friction", [0.0, 0.2, 0.4, 0.7])
def test_row_climbs_over_the_next_one(friction: float) -> None:
    """Rigid discs that do not turn: a row rests on its leading contacts, which rise by 30 deg: tau/sigma is
    tan(30 deg + phi_mu), and the patch grows at 30 deg. 0.5774, 0.8788, 1.2708, 2.1437."""
    curve = run(confined(friction, turns=False), "simple shear")
    ratio = curve.shear / -curve.stress[:, 1, 1]
    at = int(np.argmax(ratio))
    assert 0 < at < len(ratio) - 5
    assert ratio[at] == pytest.approx(np.tan(np.pi / 6.0 + np.arctan(friction)), rel=0.01)
    if friction > 0.0:
        assert np.degrees(dilation(curve, at + 4)) == pytest.approx(30.0, abs=3.0)


@pytest.mark.parametrize("friction", [0.2, 0.4, 0.7])
def test_row_that_rolls_over_the_next_one(friction: float) -> None:
    """Discs that turn do so all in one sense, held only by friction mu N in their row: 2 F r = 2 mu N r.

    With N = sigma_x h - T/2 (h: height of a row, T: shear force per disc) and the climbing contact at 60 deg this is a
    closed form in sigma_x, which the frame takes: 0.71, 0.84, 1.04 here. Discs spin to and fro as they begin to roll,
    so the mean of the last half counts.
    """
    curve = run(confined(friction), "simple shear")
    d, h = 2.0 * RADIUS, np.sqrt(3.0) * RADIUS
    late = slice(len(curve.strain) // 2, None)
    side, weight = -curve.stress[late, 0, 0].mean() * h, -curve.stress[late, 1, 1].mean() * d
    # T = P/2 + F h/d, W = P h/d - F/2 with the contact's forces P and F, and F = mu (side - T/2)
    equations = np.array([
        [1.0, -0.5, -h / d],
        [0.0, h / d, -0.5],
        [0.5 * friction, 0.0, 1.0],
    ])  # fmt: skip
    expected = np.linalg.solve(equations, [0.0, weight, friction * side])[0]
    force = curve.shear[late].mean() * d
    assert force == pytest.approx(expected, rel=0.01)
    # between a roll that costs nothing and discs that do not turn
    assert np.tan(np.pi / 6.0) < force / weight < 0.9 * np.tan(np.pi / 6.0 + np.arctan(friction))


@pytest.mark.parametrize(("friction", "within"), [(0.0, 0.01), (0.2, 0.01), (0.4, 0.02)])
def test_discs_wedge_those_below_apart(friction: float, within: float) -> None:
    """Rows across the compression, side contacts open: sigma_1/sigma_3 = sqrt(3) cot(30 deg - phi_mu): 3, 5.12, 12.02.

    Rowe (1962), Proc. R. Soc. A 269, 500: sigma_1/sigma_3 = tan(alpha) tan(phi_mu + beta) for regular packings.
    """
    major, minor = run(confined(friction), "biaxial").principal
    expected = np.sqrt(3.0) / np.tan(np.pi / 6.0 - np.arctan(friction))
    assert (major / minor).max() == pytest.approx(expected, rel=within)


def test_lattice_locks_where_friction_exceeds_the_wedge() -> None:
    """For mu > tan 30 deg Rowe's ratio has no positive value: discs cannot be wedged apart however hard one presses."""
    curve = run(confined(0.7), "biaxial")
    major, minor = curve.principal
    assert major[-1] / minor[-1] > 30.0
    assert np.all(np.diff(major) > 0.0)


def test_random_discs_without_pore_springs() -> None:
    """Discs roll, so an assembly is weaker than its contacts (atan 0.7 = 35 deg), but not below 20 deg; no cohesion."""
    soil = replace(SOIL_SPRINGS, cohesion=0.0, kpn=0.0, kps=0.0)
    pressures = [1e-3 * KN, 4e-3 * KN]
    samples = [PatchSample(soil, "random", RADIUS, seed, SMALL) for seed in (0, 1)]
    tests = [element_test(sample, pressures, strain=0.1) for sample in samples]
    for test in tests:
        assert 20.0 < np.degrees(test.phi) < 35.0
        assert abs(test.c) < 0.1 * pressures[-1]
        assert 20.0 < np.degrees(test.phi_shear) < 35.0
    assert all(result.biaxial_strength.verdict == "peak" for test in tests for result in test.tests)
    assert tests[0].phi != tests[1].phi  # of two seeds


@pytest.mark.slow
def test_cohesion_of_pore_springs_is_cohesion_of_the_patch() -> None:
    """... as long as they fail in shear: once they snap at 1.02 of their length first, more of it adds nothing."""
    soil = replace(SOIL_SPRINGS, friction=0.2)
    values = [
        element_test(PatchSample(replace(soil, cohesion=c), "random", RADIUS, size=SMALL), [1e5, 2e5], strain=0.04)
        for c in (0.0, 1e5, 1e8, 1e9)
    ]
    biaxial, shear = [t.c for t in values], [t.c_shear for t in values]
    assert biaxial[0] < 0.5 * biaxial[1] < 0.45 * biaxial[2]
    assert shear[0] < 0.5 * shear[1] < 0.45 * shear[2]
    assert (biaxial[2], shear[2]) == (biaxial[3], shear[3])


@pytest.mark.slow
def test_half_the_rate_gives_the_same_strength() -> None:
    """A single peak hangs on which contact goes first (2 % either way); two pressures and two tests agree to 2 %."""
    soil = replace(SOIL_SPRINGS, cohesion=0.0)
    sample = PatchSample(soil, "random", RADIUS, size=SMALL)
    fast, slow = (element_test(sample, [1e6, 2e6], strain=0.15, rate=rate) for rate in (2e-4, 1e-4))
    assert fast.E == slow.E
    pairs = [(test.biaxial_strength.major, other.biaxial_strength.major)
             for test, other in zip(fast.tests, slow.tests, strict=True)]  # fmt: skip
    pairs += [(item.shear_strength.shear, other.shear_strength.shear)
              for item, other in zip(fast.tests, slow.tests, strict=True)]  # fmt: skip
    ratios = np.array([pair / other for pair, other in pairs])
    assert ratios == pytest.approx(1.0, abs=0.05)
    assert ratios.mean() == pytest.approx(1.0, abs=0.02)
    assert fast.quality["inertial_number_largest"] == pytest.approx(2.0 * slow.quality["inertial_number_largest"])


@pytest.mark.slow
def test_stiff_sand_is_stronger_than_soft() -> None:
    """By as much as the map expects of softness (`strength_map.DILATES`): 1.19 times from kappa = 200 to 6000."""
    pressure, seeds = 1e5, range(16)

    def strength(kappa: float) -> float:
        layer = soil_discs(
            "sand", kappa * pressure, Strength(0.35, 0.0, ROLLING), 2000.0, 2000.0, RADIUS, 0.0, allowed_overlap=1.0
        )
        values = [
            compress(PatchSample(layer, "random", RADIUS, seed, law="soil"), pressure).post_peak for seed in seeds
        ]
        return float(np.mean(values)) / pressure

    soft, stiff = strength(200.0), strength(6000.0)
    assert soft == pytest.approx(0.986, rel=0.03)
    expected = [
        float(strength_map().gained_by_softness(kappa * pressure, np.array([pressure]), 0.0)[0])
        for kappa in (200.0, 6000.0)
    ]
    assert stiff / soft == pytest.approx(expected[1] / expected[0], abs=0.1)
