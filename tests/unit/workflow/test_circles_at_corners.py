"""Slip circles that few slices accept and many slices refuse."""

import pytest

from meshes.section.section import Section
from tests.support.sections import layer
from workflow.estimates.slices import RIGHT
from workflow.estimates.slip_circles import critical_circle


def brook(far_bank: float) -> Section:
    """Return a bank of clay with a crust above a brook, whose far bank has a height ``far_bank`` (m)."""
    surface = [[0, 18], [60, 16], [95, 3], [100, 1], [104, 1], [108, 1 + far_bank], [140, 1 + far_bank]]
    bottom = {"elevation": [[0, 15.5], [60, 13.5], [95, 0.5], [100, 0], [140, 0]]}
    crust = layer("Crust", cohesion="10 kPa", friction_angle="30 deg", bottom=bottom)
    clay = layer("Clay", cohesion="20 kPa", friction_angle="0 deg")
    return Section.parse({"name": "brook", "surface": surface, "base": {"elevation": -15.0}, "strata": [crust, clay]})


@pytest.mark.parametrize("far_bank", [0.0, 2.0])
def test_ground_that_fails_without_shaking_has_a_circle_with_a_factor_below_1(far_bank: float) -> None:
    """The best circles on few slices left the crust too steeply, or lay above the far corner of the bed. On many slices
    none of them was left, so that no factor of safety was reported beside a critical Kh below 0."""
    section = brook(far_bank)
    critical = critical_circle(section, RIGHT, None, 0.5)
    at_rest = critical_circle(section, RIGHT, 0.0, 0.5)
    assert critical is not None
    assert critical.bishop < 0.0
    assert at_rest is not None
    assert 0.4 < at_rest.bishop < 0.647  # 0.647: the circle of the critical Kh
