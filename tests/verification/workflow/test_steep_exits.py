"""Slip circles that leave the ground steeply through a thin layer of gravel."""

import pytest

from meshes.section.section import Section
from tests.support.sections import layer
from workflow.estimates.slices import LEFT, RIGHT
from workflow.estimates.slip_circles import critical_circle


def embankment(drain_friction: float) -> Section:
    """Return an embankment of 7 m on a blanket of 0.5 m and soft clay."""
    soil = {"density_ordinary": "2 t/m^3", "density_seismic": "2 t/m^3"}
    fill = layer("Fill", bottom={"elevation": 0.0}, **soil, cohesion="2 kPa", friction_angle="35 deg")
    drain = layer("Drain", bottom={"elevation": -0.5}, **soil, cohesion="0 kPa", friction_angle=f"{drain_friction} deg")
    clay = layer("Clay", cohesion="22 kPa", friction_angle="0 deg", density_ordinary="1.6 t/m^3")
    surface = [[0, 0], [30, 0], [36, 2], [46, 2], [56, 7], [70, 7], [84, 0], [120, 0]]
    return Section.parse(
        {"name": "berm", "surface": surface, "base": {"elevation": -9.0}, "strata": [fill, drain, clay]}
    )


@pytest.mark.parametrize("side", [LEFT, RIGHT])
def test_a_thin_drain_at_the_toe_does_not_exclude_all_circles(side: int) -> None:
    """There was "no circle: the ground is level" on a side that strict bounds prove to fail: the few slices in the
    drain, of φ = 38°, have no normal force by Bishop's method. A drain of φ = 20° is at most 5 % weaker."""
    gravel, sand = (critical_circle(embankment(friction), side, 0.0, 0.5) for friction in (38.0, 20.0))
    assert gravel is not None
    assert sand is not None
    assert sand.bishop < gravel.bishop < 1.05 * sand.bishop
    assert gravel.spencer is not None
    assert gravel.spencer == pytest.approx(gravel.bishop, rel=0.03)
    critical = critical_circle(embankment(38.0), side, None, 0.5)
    assert critical is not None
    assert (critical.bishop > 0.0) == (gravel.bishop > 1.0)
