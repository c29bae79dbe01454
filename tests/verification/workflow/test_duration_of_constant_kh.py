"""A constant Kh acts for its duration on ground that has liquefied, as on the block that slides are compared with."""

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from dem.ground import Ground
from dem.model import DiscModel
from dem.packing import Packing
from dem.settings import SlideSettings
from dem.slides.drive import LEAD_TIME, constant_kh
from meshes.section.quantity import GRAVITY
from workflow.config import Config
from workflow.estimates.comparison import block_drive
from workflow.stages.mpm import PointRun, at_rest, slide_of_points

KH, SECONDS, STRENGTH, UNIT_WEIGHT, DEPTH = 0.1, 2.0, 3e3, 18e3, 4.0


def _level_ground(onset: float) -> Config:
    """Return level ground that repeats itself: 2 m of crust on 2 m of sand that keeps 3 kPa, on firm ground."""
    soil = {"youngs_modulus": "30 MPa", "poissons_ratio": 0.33, "density": UNIT_WEIGHT / GRAVITY}
    return Config.parse(
        {
            "name": "level",
            "surface": [[0.0, 6.0], [30.0, 6.0]],
            "base": {"elevation": 0.0},
            "strata": [
                soil | {"name": "crust", "cohesion": "50 kPa", "friction_angle": "30 deg", "bottom": {"depth": 2.0}},
                soil
                | {"name": "sand", "cohesion": 0.0, "friction_angle": "33 deg", "bottom": {"depth": DEPTH}}
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


@pytest.mark.parametrize(("onset", "most"), [(0.0, 1.1), (5.0, 1.5)])
def test_liquefied_ground_slides_as_far_as_a_block_under_the_same_kh(onset: float, most: float) -> None:
    """A rectangular pulse moves a block by g t² / 2 (Kh - kc) Kh / kc, here kc = s / (γ h); Kh acts on ground
    that liquefies slowly some tenths of a second before, too."""
    config = _level_ground(onset)
    expected = block_drive(config).slide(STRENGTH / (UNIT_WEIGHT * DEPTH), KH)
    assert expected == pytest.approx(2.745, rel=1e-3)
    slider, _ = at_rest(config)
    slide = slide_of_points(PointRun(config, slider, 1, 10.0), lambda _: None)
    assert slide.settled
    assert 0.95 < float(np.median(slide.slide[-1])) / expected < most


def test_discs_feel_a_constant_kh_for_its_duration_after_liquefaction() -> None:
    start = cast("DiscModel", SimpleNamespace(law="soil", time=10.0))
    ground = Ground(cast("Packing", None), "random", 0.5, 0, tilt=0.0, origin=(0.0, 0.0), downhill=1)
    motion = constant_kh(start, ground, [1], SlideSettings(kh=KH, kh_seconds=SECONDS, onset=3.0))
    liquefied_at = 10.0 + LEAD_TIME["soil"] + 3.0
    times, felt = motion.acceleration.times, motion.acceleration.x
    assert np.interp(liquefied_at + 0.99 * SECONDS, times, felt) == pytest.approx(KH * GRAVITY, rel=1e-3)
    assert np.interp(liquefied_at + SECONDS + 1.1, times, felt) == pytest.approx(0.0, abs=1e-3)
    assert motion.rest_from >= LEAD_TIME["soil"] + 3.0 + SECONDS
