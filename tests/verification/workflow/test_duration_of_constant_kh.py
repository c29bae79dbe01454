"""A constant Kh acts for its duration on ground that has liquefied, and as it liquefies, alike on discs and points."""

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from dem.ground import Ground
from dem.liquefied_ground import FADING_STEPS
from dem.model import DiscModel
from dem.packing import Packing
from dem.slides.drive import LEAD_TIME, constant_kh, constant_kh_in_time
from meshes.section.quantity import GRAVITY
from workflow.config import Config
from workflow.estimates.comparison import block_drive
from workflow.estimates.sliding_block import newmark
from workflow.stages.mpm import PointRun, at_rest, programme_of, slide_of_points

KH, SECONDS, STRENGTH, UNIT_WEIGHT, DEPTH = 0.1, 2.0, 3e3, 18e3, 4.0
BEFORE = 40e3  # Pa: undrained strength before liquefaction


def _level_ground(onset: float) -> Config:
    """Return level ground that repeats itself: 2 m of crust on 2 m of ground that keeps 3 of 40 kPa, on firm ground."""
    soil = {"youngs_modulus": "30 MPa", "poissons_ratio": 0.33, "density": UNIT_WEIGHT / GRAVITY}
    return Config.parse(
        {
            "name": "level",
            "surface": [[0.0, 6.0], [30.0, 6.0]],
            "base": {"elevation": 0.0},
            "strata": [
                soil | {"name": "crust", "cohesion": "50 kPa", "friction_angle": "30 deg", "bottom": {"depth": 2.0}},
                soil
                | {"name": "weak", "cohesion": BEFORE, "friction_angle": "0 deg", "bottom": {"depth": DEPTH}}
                | {"liquefies_in": [1]},
                soil | {"name": "firm", "cohesion": "200 kPa", "friction_angle": "35 deg"},
            ],
            "fem": {"sides": "periodic"},
            "slide": {
                "kh": KH, "kh_seconds": SECONDS, "onset": onset, "mpm_cells": 150, "duration": 25.0,
                "cases": [{"name": "3 kPa", "residual_strength": STRENGTH}],
            },
        }
    )  # fmt: skip


def _block(config: Config, onset: float) -> float:
    """Return the slide (m) of a rigid block whose strength is lost linearly over the onset, under the same Kh."""
    lead = LEAD_TIME["soil"]
    times, kh = constant_kh_in_time(config.slide, 1, "soil")
    instants = np.union1d(np.linspace(0.0, lead + onset + SECONDS + 5.0, 3001), times)
    share = np.clip((instants - lead) / onset, 0.0, 1.0) if onset > 0.0 else 1.0 * (instants >= lead)
    yields = (BEFORE + share * (STRENGTH - BEFORE)) / (UNIT_WEIGHT * DEPTH)
    return newmark(instants, GRAVITY * np.interp(instants, times, kh), yields).permanent


@pytest.mark.parametrize("onset", [0.0, 5.0])
def test_liquefied_ground_slides_as_far_as_a_block_under_the_same_kh(onset: float) -> None:
    """A rectangular pulse moves a block by g t² / 2 (Kh - kc) Kh / kc, here kc = s / (γ h). Ground that liquefies
    slowly slides farther, as a block does whose strength falls under Kh: it has a velocity once it has liquefied.
    Points slid 1.4 times as far as the first block, since they had liquefied half a step of the onset too early, too.
    """
    config, kc = _level_ground(onset), STRENGTH / (UNIT_WEIGHT * DEPTH)
    at_once, expected = block_drive(config).slide(kc, KH), _block(config, onset)
    assert at_once == pytest.approx(2.745, rel=1e-3)
    assert expected / at_once == pytest.approx(1.31 if onset else 1.0, abs=0.03)
    slider, _ = at_rest(config)
    slide = slide_of_points(PointRun(config, slider, 1, 10.0), lambda _: None)
    assert slide.settled
    assert 0.95 < float(np.median(slide.slide[-1])) / expected < 1.05


def test_sand_of_a_wet_slope_slides_as_far_as_a_block_as_it_liquefies() -> None:
    """Water lies in the crust of a slope of 7.6°, Kh is 1.6 times the yield coefficient. The friction before and the
    ratio after liquefaction belong to the same σ'v; with the mean stress on the plane at the edge of the layer, the
    slope slid three times as far as the block."""
    fall, depth, water, crust = 0.133, 14.0, 5.5, 6.5
    width, density, friction, ratio, onset = 16.0, 1.8e3, np.radians(35.0), 0.35, 5.0
    soil = {"youngs_modulus": "60 MPa", "poissons_ratio": 0.33, "density": density, "friction_angle": "35 deg"}
    config = Config.parse(
        {
            "name": "wet",
            "surface": [[0.0, fall * width], [width, 0.0]],
            "base": {"depth": depth + 2.0},
            "water": {"table": [[0.0, fall * width - water], [width, -water]]},
            "strata": [
                soil | {"name": "crust", "cohesion": "10 kPa", "bottom": {"depth": crust}},
                soil | {"name": "sand", "cohesion": "0 kPa", "bottom": {"depth": depth}, "liquefies_in": [1]},
                soil | {"name": "firm", "cohesion": "200 kPa"},
            ],
            "fem": {"sides": "periodic"},
            "slide": {
                "kh": 0.16, "kh_seconds": SECONDS, "onset": onset, "mpm_cells": 250, "duration": 50.0,
                "cases": [{"name": "ratio", "residual": ratio}],
            },
        }
    )  # fmt: skip
    angle, mass = np.arctan(fall), density * depth * np.cos(np.arctan(fall))
    effective = density * GRAVITY * depth - 9.81e3 * (depth - water)
    times, kh = constant_kh_in_time(config.slide, 1, "soil")
    instants = np.union1d(np.linspace(0.0, 15.0, 3001), times)
    share = np.clip((instants - LEAD_TIME["soil"]) / onset, 0.0, 1.0)
    before = effective * np.cos(angle) ** 2 * np.sin(friction)
    strength = before + share * (ratio * effective - before)
    drive = GRAVITY * (np.sin(angle) + np.interp(instants, times, kh) * np.cos(angle)) - strength / mass
    speed = slid = 0.0
    for step, force in zip(np.diff(instants), drive, strict=False):
        after = max(speed + step * force, 0.0)
        slid, speed = slid + 0.5 * step * (speed + after), after
    slider, _ = at_rest(config)
    slide = slide_of_points(PointRun(config, slider, 1, 10.0), lambda _: None)
    assert slide.settled
    assert 0.95 < float(np.median(slide.slide[-1])) / (slid * np.cos(angle)) < 1.15


@pytest.mark.parametrize("seconds", [0.3, 2.0, None])
def test_discs_and_points_feel_the_same_constant_kh(seconds: float | None) -> None:
    """It gives a block the velocity of a Kh that ends at once; that of the discs lasted half a second longer."""
    config = _level_ground(3.0).with_settings("slide", kh_seconds=seconds)
    start = cast("DiscModel", SimpleNamespace(law="soil", time=10.0))
    ground = Ground(cast("Packing", None), "random", 0.5, 0, tilt=0.0, origin=(0.0, 0.0), downhill=1)
    motion = constant_kh(start, ground, [1], config.slide)
    times = np.linspace(0.0, 12.0, 12001)
    discs = np.interp(10.0 + times, motion.acceleration.times, motion.acceleration.x)
    points = programme_of(config, 1).shaking(times)
    assert discs == pytest.approx(points, abs=1e-9)
    liquefied_at = LEAD_TIME["soil"] + 3.0
    after = times >= liquefied_at
    if seconds is None:
        assert points[after] == pytest.approx(KH * GRAVITY)
        return
    impulse = float(np.sum(points[after]) * (times[1] - times[0]))
    assert impulse == pytest.approx(KH * GRAVITY * seconds, rel=2e-3)
    assert motion.rest_from == pytest.approx(liquefied_at + seconds + 1.0)
    assert points[times > liquefied_at + seconds + 0.501] == pytest.approx(0.0, abs=1e-9)


def test_discs_liquefy_neither_early_nor_late() -> None:
    """The mean degree of liquefaction over an onset is a half, also if the engine stops just before a step of the onset
    ends; then discs had the degree of the step before, and otherwise that of the next one."""
    config, onset = _level_ground(5.0), 5.0
    start = cast("DiscModel", SimpleNamespace(law="soil", time=0.0))
    motion = constant_kh(start, Ground(cast("Packing", None), "random", 0.5, 0, 0.0, (0.0, 0.0), 1), [1], config.slide)
    ends = LEAD_TIME["soil"] + onset * np.arange(FADING_STEPS + 1) / FADING_STEPS
    for late in (0.0, -1e-4, 1e-4):
        shares = [motion.share(1, max(end + late, LEAD_TIME["soil"])) for end in ends]
        assert np.mean(shares[:-1]) == pytest.approx(0.5)
        assert shares[-1] == 1.0
    assert motion.share(1, LEAD_TIME["soil"] - 0.1) == 0.0
