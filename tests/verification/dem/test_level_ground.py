"""Level ground that liquefies sinks by the water that drains, and not otherwise."""

import numpy as np
import pytest

from dem.search.deposit import deposit
from dem.slides.liquefaction import Slider
from workflow.config import Config

WIDTH, LOOSE = 50.0, 10.0  # m


@pytest.mark.parametrize("strain", [pytest.param(0.0, marks=pytest.mark.slow), 0.035])
def test_level_ground_sinks_by_the_volume_that_drains(strain: float) -> None:
    """The crust settles by the volumetric strain times the thickness of the layer, to 1 % of that thickness, and drifts
    by less than a twentieth of the diameter of a disc."""
    soil = {"density": "19 kN/m^3", "youngs_modulus": "17 MPa", "poissons_ratio": 0.33, "friction_angle": "33 deg"}
    case = {"residual_strength": {"loose": "10 kPa"}, "volumetric_strain": strain}
    config = Config.parse({
        "name": "level",
        "surface": [[0.0, 0.0], [WIDTH, 0.0]],
        "base": {"elevation": -17.5},
        "water": {"table": -2.5},
        "strata": [
            soil | {"name": "crust", "bottom": {"elevation": -2.5}, "cohesion": "2 kPa"},
            soil | {"name": "loose", "bottom": {"elevation": -2.5 - LOOSE}, "cohesion": 0, "liquefies_in": [1]},
            soil | {"name": "dense", "cohesion": 0, "friction_angle": "40 deg"},
        ],
        "slide": {"kh": 0.0, "cases": [case]},
        "dem": {"elements": 440},
    })  # fmt: skip
    ground = deposit(config.section, config.dem)
    start = ground.settled
    slider = Slider(start, ground.ground, [1], config.cases[0], config.slide)
    slider.run()
    crust = ~start.fixed & (start.layer == 0) & (np.abs(start.x - 0.5 * WIDTH) < WIDTH / 3.0)
    settlement = (start.z - slider.model.z)[crust].mean()
    assert settlement == pytest.approx(strain * LOOSE, abs=0.012 * LOOSE)
    assert abs((slider.model.x - start.x)[crust].mean()) < 0.06
