"""Dense sand of discs fails at the strength that it keeps: in compression, in shear, and as a bare slope.

A dry bare slope at the angle b fails at Kh = tan(phi - b), in planes parallel to its surface.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from dem.laboratory import patch
from dem.laboratory.compression import INERTIAL_NUMBER, STRAIN_RATE
from dem.laboratory.contact_numbers import PRESSURE, ContactNumbers
from dem.laboratory.loading import LoadingKind, confine, load, probe
from dem.laboratory.soil_contacts import DILATION_SHARE, soil_layers
from dem.search.deposit import deposit
from dem.slides.drive import Shaking
from dem.slides.liquefaction import Slider
from dem.undisturbed_contacts import mark_undisturbed
from workflow.config import Config

POROSITY = 0.22  # of a patch before it is confined: then as of ground that has settled
KAPPA = 800.0  # kn over the pressure, as in the middle of a layer
G = 9.81


@pytest.fixture(autouse=True)
def packings_of_this_porosity() -> Iterator[None]:
    """Packings of patches are kept in memory, by their seed alone."""
    patch._heap.cache_clear()
    yield
    patch._heap.cache_clear()


def mean_curve(friction: float, kind: LoadingKind, marked: bool, monkeypatch: pytest.MonkeyPatch) -> np.ndarray:
    """Resistance of six patches over the pressure, at 59 strains up to 0.145 in compression and 0.29 in shear."""
    monkeypatch.setattr(patch, "POROSITIES", {"soil": (POROSITY, POROSITY + 0.005)})
    last = 0.145 if kind == "biaxial" else 0.29
    courses = []
    for seed in range(6):
        sample = ContactNumbers(True, friction, 0.0, KAPPA).sample(seed).patch()
        confine(sample, PRESSURE)
        stiffness, _ = probe(sample, PRESSURE)
        if marked:
            (layer,) = sample.model.springs.layers
            smaller = layer.friction * (1.0 - DILATION_SHARE * layer.friction)
            sample.model.set_springs([replace(layer, undisturbed_friction=smaller)])
            mark_undisturbed(sample.model)
        rate = min(STRAIN_RATE, INERTIAL_NUMBER / sample.inertia(PRESSURE))
        curve = load(sample, kind, PRESSURE, 1.04 * last, rate, stiffness, to_the_end=True)
        resistance = 0.5 * curve.deviator if kind == "biaxial" else curve.shear
        courses.append(np.interp(np.linspace(0.0, last, 59), curve.strain, resistance) / PRESSURE)
    return np.mean(courses, axis=0)


@pytest.mark.slow
@pytest.mark.parametrize(("friction", "before", "now"), [(0.25, 1.12, 1.11), (0.378, 1.27, 1.10), (0.5, 1.40, 1.07)])
def test_patches_have_hardly_a_peak_in_compression(
    friction: float, before: float, now: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With mu = 0.677 of the strongest sand: 1.9 and 1.1. With mu = 0.5 two processors, whose roundings differ, gave
    1.04 and 1.10 for the same six patches."""
    for marked, ratio in ((False, before), (True, now)):
        curve = mean_curve(friction, "biaxial", marked, monkeypatch)
        assert curve.max() / curve[33:].mean() == pytest.approx(ratio, rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.378, 0.5])
def test_patches_shear_at_nearly_the_same_strength_from_the_beginning(
    friction: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In simple shear the strength from 2 to 5 % of strain is 0.9 of that from 10 to 29 %."""
    curve = mean_curve(friction, "simple shear", True, monkeypatch)
    assert curve[5:11].mean() == pytest.approx(0.92 * curve[21:].mean(), rel=0.05)


def slope(angle: float, friction_angle: float) -> Config:
    """A bare slope of sand, 10 m high (degrees)."""
    run = 10.0 / np.tan(np.radians(angle))
    sand = {"name": "Sand", "density": "19 kN/m^3", "youngs_modulus": "30 MPa", "poissons_ratio": 0.3, "cohesion": 0}
    return Config.parse({
        "name": "bare",
        "surface": [[0.0, 10.0], [25.0, 10.0], [25.0 + run, 0.0], [55.0 + run, 0.0]],
        "base": {"elevation": -5.0},
        "strata": [sand | {"friction_angle": f"{friction_angle} deg"}],
    })  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(("angle", "friction_angle"), [(25.0, 30.0), (30.0, 33.0)])
def test_a_bare_slope_fails_at_its_friction_angle(angle: float, friction_angle: float) -> None:
    """It stands at an angle 3 degrees below its strength and fails 3 degrees above, in two of three packings at least
    (25 degrees: 0.27, 0.02 and 0.00 m below).

    Its 9,000 discs have a radius of 0.15 m. With 2,500 discs a slide is 1.2 m deep or more, and is held by the ground
    at its toe: by finite elements, slides of 33 degrees that are deeper fail at Kh = 0.154, as one of 38.8 degrees
    would without toe (0.098 from 0.6 m depth on, 35.6 degrees). A slope of 36 degrees at 33 degrees moves by 0.15 m
    only at 39 degrees.
    """
    run = slope(angle, friction_angle)
    moved = np.zeros((3, 2))
    for seed in range(3):
        lies = deposit(run.section, run.dem.changed(elements=9000, seed=seed), soil_layers(run.section))
        for number, excess in enumerate((-3.0, 3.0)):
            kh = np.tan(np.radians(friction_angle + excess - angle)) * G
            seismic = Shaking(np.array([0.0, 2.0, 12.0]), np.array([0.0, kh, kh]), {})
            slider = Slider(lies.settled, lies.ground, [], None, run.slide, shaking=seismic)
            moved[seed, number] = slider.run().rows[-1].slide_max_m
    stands, fails = np.median(moved, axis=0)
    assert stands < 0.2, moved
    assert fails > 0.5, moved
