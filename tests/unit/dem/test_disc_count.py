"""The default number of discs follows from the thinnest layer that slides."""

import copy

import numpy as np
import pytest

from dem.disc_count import DISCS_ACROSS_LAYER, FEWEST_DISCS, MOST_DISCS, usual_disc_count
from dem.settings import DemSettings
from workflow.config import Config

SAND = {"density": "18 kN/m^3", "youngs_modulus": "20 MPa", "poissons_ratio": 0.3, "friction_angle": "33 deg"}


def bank(crust: float, loose: float, liquefies: object = (1,), **dem: object) -> Config:
    """Return level ground of 60 m by 12 m: a crust on loose sand on dense sand."""
    strata = [
        {**SAND, "name": "Crust", "cohesion": "5 kPa", "bottom": {"depth": crust}},
        {**SAND, "name": "Loose", "cohesion": 0, "bottom": {"depth": crust + loose}, "liquefies_in": liquefies},
        {**SAND, "name": "Dense", "cohesion": 0},
    ]
    ground = {"name": "bank", "surface": [[0, 0], [60, 0]], "base": {"depth": 12.0}, "strata": strata}
    return Config.parse(copy.deepcopy({**ground, "dem": dem} if dem else ground))


def test_the_thinnest_layer_that_slides_is_four_discs_thick():
    config = bank(1.9, 4.0)
    assert FEWEST_DISCS < config.dem.elements < MOST_DISCS
    assert 2.0 * config.dem.mean_radius(config.section) == pytest.approx(1.9 / DISCS_ACROSS_LAYER, rel=1e-3)


def test_the_number_has_limits():
    assert bank(3.0, 4.0).dem.elements == FEWEST_DISCS
    assert bank(3.0, 0.2).dem.elements == MOST_DISCS
    assert bank(0.2, 4.0, liquefies=()).dem.elements == FEWEST_DISCS


def test_layers_below_what_liquefies_do_not_count():
    assert bank(4.0, 7.8).dem.elements == FEWEST_DISCS  # 0.2 m of dense sand are left


def test_a_number_or_a_radius_in_the_file_counts():
    assert bank(0.5, 4.0, elements=700).dem.elements == 700
    assert bank(0.5, 4.0, radius="0.4 m").dem.mean_radius(bank(0.5, 4.0).section) == 0.4
    assert bank(0.5, 4.0, model="paper").dem.elements == DemSettings().elements == FEWEST_DISCS


def test_the_thin_end_of_a_wedge_counts_little():
    wedge = {
        "name": "wedge", "surface": [[0, 3], [60, 0.001]], "base": {"elevation": -12.0},
        "strata": [
            {**SAND, "name": "Wedge", "cohesion": 0, "bottom": {"elevation": 0.0}, "liquefies_in": [1]},
            {**SAND, "name": "Dense", "cohesion": 0},
        ],
    }  # fmt: skip
    section = Config.parse(wedge).section
    assert section.layering.typical_thickness()[0] == pytest.approx(2.0, rel=1e-3)  # two thirds of the largest
    radius = np.sqrt(section.layering.areas().sum() / usual_disc_count(section) / np.sqrt(12.0))
    assert 2.0 * radius <= 2.0 / DISCS_ACROSS_LAYER * 1.001
