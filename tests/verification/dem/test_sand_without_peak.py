"""Dense sand of discs fails at the strength that it keeps: in compression, and as a bare slope.

A dry bare slope at the angle b fails at Kh = tan(phi - b), in planes parallel to its surface.
"""

from dataclasses import replace

import numpy as np
import pytest

from dem.laboratory import compression, patch
from dem.laboratory.compression import compress
from dem.laboratory.contact_numbers import PRESSURE, ContactNumbers
from dem.laboratory.loading import confine
from dem.laboratory.patch import Patch
from dem.laboratory.soil_contacts import DILATION_SHARE, soil_layers
from dem.search.deposit import deposit
from dem.slides.drive import Shaking
from dem.slides.liquefaction import Slider
from dem.undisturbed_contacts import mark_undisturbed
from workflow.config import Config

POROSITY = 0.20  # of ground that has settled
KAPPA = 1600.0  # kn over the pressure, as in the middle of a layer
G = 9.81


def peak_over_post_peak(friction: float, marked: bool, monkeypatch: pytest.MonkeyPatch) -> float:
    """Peak of the mean curve of six patches, over their strength from 8 to 15 % of strain."""

    def confined(sample: Patch, pressure: float) -> None:
        confine(sample, pressure)
        if marked:
            (layer,) = sample.model.springs.layers
            smaller = layer.friction * (1.0 - DILATION_SHARE * layer.friction)
            sample.model.set_springs([replace(layer, undisturbed_friction=smaller)])
            mark_undisturbed(sample.model)

    monkeypatch.setattr(patch, "POROSITIES", {"soil": (POROSITY, POROSITY + 0.005)})
    monkeypatch.setattr(compression, "confine", confined)
    tests = [compress(ContactNumbers(True, friction, 0.0, KAPPA).sample(seed), PRESSURE) for seed in range(6)]
    course = np.mean([test.course for test in tests], axis=0)
    return float(course.max() / np.mean([test.post_peak for test in tests]))


@pytest.mark.slow
@pytest.mark.parametrize(("friction", "before", "now"), [(0.25, 1.33, 1.20), (0.378, 1.60, 1.20), (0.5, 1.80, 1.26)])
def test_patches_have_hardly_a_peak(
    friction: float, before: float, now: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With mu = 0.677 of the strongest sand: 2.5 and 1.3."""
    assert peak_over_post_peak(friction, False, monkeypatch) == pytest.approx(before, rel=0.05)
    assert peak_over_post_peak(friction, True, monkeypatch) == pytest.approx(now, rel=0.05)


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
@pytest.mark.parametrize(("angle", "friction_angle"), [(25.0, 30.0), (30.0, 33.0), (33.0, 36.0)])
def test_a_bare_slope_fails_at_its_friction_angle(angle: float, friction_angle: float) -> None:
    """It stands at an angle 4 degrees below its strength and fails 4 degrees above: discs of 33 degrees stood at 39."""
    run = slope(angle, friction_angle)
    lies = deposit(run.section, run.dem.changed(elements=2500, seed=0), soil_layers(run.section))
    moved = []
    for excess in (-4.0, 4.0):
        kh = np.tan(np.radians(friction_angle + excess - angle)) * G
        seismic = Shaking(np.array([0.0, 2.0, 12.0]), np.array([0.0, kh, kh]), {})
        slider = Slider(lies.settled, lies.ground, [], None, run.slide, shaking=seismic)
        moved.append(slider.run().rows[-1].slide_max_m)
    assert moved[0] < 0.1, moved
    assert moved[1] > 0.5, moved
