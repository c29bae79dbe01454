"""Water and loads of discs: buoyancy, seepage down a slope, and what presses on the ground."""

from dataclasses import replace

import numpy as np
import pytest

from dem.acceleration import Acceleration, tilted_gravity
from dem.engine.engine import Engine
from dem.ground import ground_of
from dem.laboratory.element_table import middle_stresses
from dem.laboratory.soil_layers import soil_layers
from dem.model import DiscModel
from dem.settings import DemSettings
from meshes.section.quantity import GRAVITY
from tests.support.dem_cases import FLOOR, KN, MASS, RADIUS, SOIL
from tests.support.water import WATER, section, soil

DISCS = DemSettings(elements=500, packing="random")
PAIR = {"density": None, "density_saturated": None}


def discs(given):
    """The discs of a section before they settle."""
    layers = [layer.springs(0.5, 0.25) for layer in soil_layers(given)]
    return ground_of(given, DISCS).model(layers, DISCS)


def test_discs_under_still_water_feel_what_discs_of_buoyant_weight_feel():
    under, buoyant = (
        discs(given)
        for given in (
            section(water={"table": 12.0}),
            section(soil(density_ordinary=20e3 / GRAVITY - 1000.0, density_seismic=20e3 / GRAVITY, **PAIR)),
        )
    )
    free = ~under.fixed
    assert np.array_equal(under.x, buoyant.x)
    np.testing.assert_allclose(under.mass, buoyant.mass, rtol=1e-12)
    for one, other in zip(under.pull, buoyant.pull, strict=True):
        np.testing.assert_allclose(one[free], other[free], atol=1e-6 * GRAVITY)


def test_a_surcharge_and_a_jump_of_pore_pressure_reach_the_discs_whole():
    loaded = section(surcharges=[{"from": 4, "to": 14, "pressure": ["10 kPa", "30 kPa"]}])
    model = discs(loaded)
    np.testing.assert_allclose(np.sum(model.mass * model.drift_z), -200e3, rtol=1e-9)
    clay = soil("Clay", bottom={"elevation": 1.0}, pore_pressure_ratio=0.0, density_saturated=None)
    artesian = section(clay, soil("Sand", piezometric_level=8.0))
    model = discs(artesian)
    below = model.layer == 1
    lifted = np.sum((model.mass * model.drift_z)[~below & ~model.fixed])
    pushed = np.sum((model.mass * model.drift_z)[below])
    # the jump of 7 m of head between clay and sand, and 60 m wide, less what Archimedes gives the sand below
    assert lifted + pushed == pytest.approx(60.0 * (7.0 + 6.0) * WATER, rel=0.05)


@pytest.mark.parametrize("head", ["vertical", "normal"])
def test_a_row_that_repeats_slides_down_with_seepage_at_its_closed_form(head):
    """Kh = (γ cos² - u/h) tan φ - γ sin cos over γ (cos² + sin cos tan φ), of a layer that water flows through along
    the slope; 1 % less than that it stays, 1 % more and it goes."""
    slope, friction, density = np.arctan(1.0 / 3.0), 0.8, 20e3 / GRAVITY
    cosine, sine = np.cos(slope), np.sin(slope)
    strip = section(
        soil(cohesion=0.0), surface=[[0.0, 20.0], [60.0, 0.0]], base={"depth": 4.0},
        water={"table": {"depth": 0.0}, "head": head},
    )  # fmt: skip
    at, up = np.array([[30.0, 8.0]]), np.array([0.0, 1e-3])
    along = np.array([1e-3, 0.0])
    rise = [
        float((strip.water_pressure.at_rest(at + d, at, [0]) - strip.water_pressure.at_rest(at - d, at, [0]))[0] / 2e-3)
        for d in (along, up)
    ]
    pore = WATER * (cosine**2 if head == "normal" else 1.0)
    more = (20e3 * cosine**2 - pore) * friction - 20e3 * sine * cosine
    kc = more / (20e3 * (cosine**2 + sine * cosine * friction))
    row = replace(
        SOIL,
        friction=friction,
        contact_cohesion=0.0,
        rolling_friction=np.inf,
        cn=np.sqrt(MASS * KN),
        ct=np.sqrt(MASS * KN),
    )
    moved = []
    for share in (0.99, 1.01):
        x = 2.0 * RADIUS * np.arange(16)
        model = DiscModel.create(
            x, np.full(16, RADIUS), RADIUS, [row], lines=FLOOR, law="soil",
            gravity=tilted_gravity(slope, GRAVITY), period=(32.0 * RADIUS, 0.0),
            acceleration=Acceleration.seismic(share * kc, tilt=slope, ramp=(0.0, 2.0)),
        )  # fmt: skip
        ax, az = -np.array(rise) / density
        model.drift_x[:], model.drift_z[:] = cosine * ax - sine * az, sine * ax + cosine * az
        Engine(dt=1e-4, balance=np.inf).run(model, 6.0)
        moved.append(float(np.mean(model.x - x)))
    assert abs(moved[0]) < 0.005
    assert moved[1] > 0.02


def test_strength_of_discs_goes_by_effective_stress():
    under = section(water={"table": 12.0})
    np.testing.assert_allclose(middle_stresses(under), 7.5 * (20e3 - WATER), rtol=2e-3)
