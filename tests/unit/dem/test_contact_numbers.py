"""Element tests by the dimensionless numbers of their contacts: scaled, shared, carried over, and kept."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from dem.errors import ConfinementError
from dem.laboratory import stored_strengths
from dem.laboratory.compression import BINS, PatchStrength, compress
from dem.laboratory.contact_numbers import PRESSURE, RADIUS, ContactNumbers
from dem.laboratory.element_test_programme import SEEDS, ElementTestProgramme, Task, TestOutcome
from dem.laboratory.patch import PatchSample
from dem.laboratory.soil_contacts import SoilLayer, soil_layers
from dem.laboratory.stored_strengths import strength_of_patch
from meshes.section.section import Section
from tests.support.sections import layer

SAND = ContactNumbers(True, 0.4, 0.0, 256.0)
SMALL = (10, 11)


@pytest.fixture(scope="module")
def layers() -> list[SoilLayer]:
    data = {
        "name": "two",
        "surface": [[0.0, 0.0], [40.0, 0.0]],
        "base": {"elevation": -12.0},
        "strata": [
            layer(
                "sand", bottom={"elevation": -4.0}, cohesion="0 kPa", friction_angle="33 deg", youngs_modulus="8 MPa"
            ),
            layer("clay", cohesion="30 kPa", friction_angle="0 deg"),
        ],
    }
    return soil_layers(Section.parse(data))


def strength(after: float, modulus: float = 1e7) -> PatchStrength:
    return PatchStrength(PRESSURE, modulus, 1.2 * after, after, 0.1, np.full(BINS, after))


@pytest.mark.parametrize("numbers", [SAND, ContactNumbers(False, -0.2, 2.0, 128.0)])
def test_patches_of_equal_numbers_are_scaled_copies(numbers: ContactNumbers) -> None:
    """Twice the radius, four times the pressure and the stiffness: the same motion, to the last bit."""
    item = replace(numbers.sample(1), size=SMALL)
    springs = item.layer
    other = PatchSample(
        replace(springs, kn=4.0 * springs.kn, ks=4.0 * springs.ks, stop=4.0 * springs.stop,
                contact_cohesion=8.0 * springs.contact_cohesion),
        "random", 2.0 * RADIUS, seed=1, size=SMALL, law="soil",
    )  # fmt: skip
    small, large = compress(item, PRESSURE), compress(other, 4.0 * PRESSURE)
    assert (large.post_peak, large.E) == pytest.approx((4.0 * small.post_peak, 4.0 * small.E), rel=1e-12)
    assert small.post_peak > 0.0


def test_the_nearest_numbers_are_their_own_nearest(layers: list[SoilLayer]) -> None:
    every = [ContactNumbers.of(soil, float(p)) for soil in layers for p in soil.pressures]
    for numbers in every:
        near = numbers.nearest
        assert near.nearest == near
        assert near.turns == numbers.turns
        assert abs(near.friction - numbers.friction) <= 0.025 + 1e-9
        assert abs(np.log2(near.kappa / numbers.kappa)) <= (1.0 if numbers.turns else 0.25) + 1e-9
        assert (near.cohesion == 0.0) == (numbers.cohesion == 0.0)
    assert len({numbers.nearest for numbers in every[:3]}) < 3, "a sand at two pressures is one"


def test_patches_that_are_as_strong_as_the_map_make_layers_that_are(layers: list[SoilLayer]) -> None:
    """What is carried over from the nearest numbers is the difference of the map, and nothing else."""
    programme = ElementTestProgramme(layers, 0.5)

    def by_the_map(task: Task) -> TestOutcome:
        numbers, _ = task
        return strength(numbers.strength * PRESSURE, numbers.modulus * numbers.stiffness * PRESSURE)

    checks = programme.checks([by_the_map(task) for task in programme.tasks])
    for check, soil in zip(checks, layers, strict=True):
        np.testing.assert_allclose(check.strength_discs_Pa, soil.expected_strength, rtol=1e-9)
    sand = checks[0]
    assert sand.phi_discs_deg == pytest.approx(33.0, abs=1.0)
    assert sand.E_discs_Pa == pytest.approx(sand.E_soil_Pa, rel=0.1)
    assert {seed for _, seed in programme.tasks} == set(SEEDS)


def test_a_test_without_result_says_at_which_pressure_of_the_layer(layers: list[SoilLayer]) -> None:
    programme = ElementTestProgramme(layers[:1], 0.5)
    check = programme.checks(["it does not come to rest" for _ in programme.tasks])[0]
    assert check.strength_discs_Pa == (None, None, None)
    least = layers[0].pressures[0] / 1e3
    assert f"{least:.3g} kPa, seed 101, scaled to 100 kPa: it does not come to rest" in check.notes


def test_a_patch_is_tested_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Kept to the last bit; a file that was damaged is made again, and a test without result is not repeated."""
    requested: list[float] = []

    def counted(sample: PatchSample, pressure: float) -> PatchStrength:
        requested.append(sample.layer.friction)
        if sample.seed == 2:
            raise ConfinementError("it does not come to rest")
        return strength(1e5 / 3.0)

    monkeypatch.setattr(stored_strengths, "_folder", lambda: tmp_path / "kept")
    monkeypatch.setattr(stored_strengths, "compress", counted)
    first, again = strength_of_patch(SAND, 1), strength_of_patch(SAND, 1)
    assert isinstance(first, PatchStrength)
    assert isinstance(again, PatchStrength)
    assert again.post_peak == first.post_peak
    assert again.course.tolist() == first.course.tolist()
    assert strength_of_patch(SAND, 2) == strength_of_patch(SAND, 2) == "it does not come to rest"
    assert len(requested) == 2
    strength_of_patch(SAND._replace(friction=np.nextafter(0.4, 1.0)), 1)
    assert len(requested) == 3
    for file in (tmp_path / "kept").iterdir():
        file.write_text('{"post_peak": 1.0}')
    assert strength_of_patch(SAND, 1).post_peak == first.post_peak  # type: ignore[union-attr]
    assert len(requested) == 4
