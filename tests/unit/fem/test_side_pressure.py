"""Free-field sides press on material points with the stress at rest, and as a liquid does on liquefied ground."""

import numpy as np
import pytest

from fem.continuum.liquefied_ground import UNDRAINED_POISSON
from fem.kernels import point_stress as law
from fem.mpm import PointSlider, SlideProgramme, ground_of
from fem.mpm.changes import PLANE_STRENGTH, SIDE, changes_of
from meshes.section.liquefies import RemainingStrength
from tests.support.sections import layer
from workflow.config import Config

LIQUEFIES = {1: RemainingStrength(0.0, 0.0, 0.0, 4e3)}


@pytest.fixture(scope="module")
def slider() -> PointSlider:
    """Ground whose second stratum liquefies, at rest between free-field sides."""
    soil = {"youngs_modulus": "30 MPa", "poissons_ratio": 0.25, "density_ordinary": 1.9e3, "density_seismic": 1.9e3}
    firm = soil | {"cohesion": 5e3, "friction_angle": "35 deg"}
    data = {
        "name": "sides",
        "surface": [[0.0, 9.0], [24.0, 8.0]],
        "base": {"elevation": 0.0},
        "strata": [
            layer("crust", **firm, bottom={"elevation": 6.0}),
            layer("loose", **soil, cohesion=0.0, friction_angle="30 deg", bottom={"elevation": 3.0}, liquefies_in=[1]),
            layer("firm", **firm),
        ],
    }
    slider = PointSlider(ground_of(Config.parse(data).section, 150, "free-field"), 1)
    slider.settle()
    return slider


def test_firm_ground_at_the_edge_of_a_liquefied_layer_keeps_its_side_pressure(slider: PointSlider) -> None:
    """Points at the edge change with the layer, since they slip along it, and had the pressure of a liquid."""
    changes = changes_of(slider.ground, slider.engine, LIQUEFIES)
    before, after, liquefies = (changes[name] for name in ("before", "after", "liquefies"))
    stratum = slider.engine.original(slider.ground.points.stratum)
    at_side, at_edge = before[:, SIDE] != 0.0, (liquefies == 1) & (stratum != 1)
    assert (at_side & at_edge).sum() >= 4
    assert (after[at_edge, PLANE_STRENGTH] > 0.0).all()
    assert after[at_side & at_edge, SIDE] == pytest.approx(before[at_side & at_edge, SIDE], rel=1e-12)
    wet = at_side & (stratum == 1)
    height = slider.engine.original(slider.ground.points.state[:, law.VOLUME]) / (0.5 * slider.ground.grid.cell)
    liquid = UNDRAINED_POISSON / (1.0 - UNDRAINED_POISSON) * slider.ground.effective * height
    assert np.abs(after[wet, SIDE]) == pytest.approx(liquid[wet], rel=1e-12)


def test_water_continues_across_periodic_sides() -> None:
    """Seepage along a slope pulls by γ_w times its fall everywhere; nodes at the side had half of it."""
    soil = {"youngs_modulus": "30 MPa", "poissons_ratio": 0.25, "density": 1.9e3, "friction_angle": "35 deg"}
    fall, width = 0.1, 20.0
    data = {
        "name": "slope",
        "surface": [[0.0, fall * width], [width, 0.0]],
        "base": {"depth": 8.0},
        "water": {"table": [[0.0, fall * width - 1.0], [width, -1.0]]},
        "strata": [soil | {"name": "wet", "cohesion": "5 kPa"}],
    }
    config = Config.parse(data)
    uplift = ground_of(config.section, 160, "periodic").grid.uplift
    assert uplift[:, 2, 0] == pytest.approx(fall * config.section.water_pressure.unit_weight, rel=1e-6)


def test_ground_that_has_come_apart_is_not_pressed_again_while_it_liquefies(slider: PointSlider) -> None:
    points = slider.ground.points
    loose = np.flatnonzero((points.side != 0.0) & (points.stratum == 1))[0]
    points.side[loose] = 0.0
    programme = SlideProgramme(np.zeros_like, {1: 0.0}, LIQUEFIES, 1.0, 2.0, 2.0)
    pressure = slider.begin(programme)
    slider.began["before"][slider.engine.order[loose], SIDE] = 1e3  # as it was when it began
    slider._liquefy(programme, {1: 0.0}, pressure)
    assert points.side[loose] == 0.0
    assert (points.side[points.stratum == 1] != 0.0).any()
