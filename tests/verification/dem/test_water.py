"""Water and loads of discs: buoyancy, seepage down a slope, what presses on the ground, and what of it shakes."""

from dataclasses import replace

import numpy as np
import pytest

from dem.acceleration import Acceleration, tilted_gravity
from dem.assembly import DiscBoundary, DiscGeometry, DiscMaterials
from dem.case import Case
from dem.engine.engine import Engine
from dem.engine.forces import contact_forces, resultants
from dem.ground import ground_of
from dem.laboratory.element_table import middle_stresses
from dem.laboratory.soil_contacts import soil_layers
from dem.model import DiscModel
from dem.search.deposit import deposit
from dem.search.equilibrium import settle
from dem.settings import DemSettings, SlideSettings
from dem.slides.liquefaction import HISTORY_INTERVAL, Slider
from meshes.section.quantity import GRAVITY
from tests.support.dem_cases import FLOOR, KN, MASS, RADIUS, SOIL_SPRINGS
from tests.support.water import WATER, section, soil

DISCS = DemSettings(elements=500, packing="random")
SMALL = DemSettings(elements=150, packing="random")
FRICTION = 0.8
PAIR = {"density": None, "density_saturated": None}


def discs(inputs):
    """The discs of a section before they settle."""
    layers = [layer.springs(0.5, 0.25) for layer in soil_layers(inputs)]
    return ground_of(inputs, DISCS).model(layers, DISCS)


def test_discs_under_still_water_feel_what_discs_of_buoyant_weight_feel():
    under, buoyant = (
        discs(config)
        for config in (
            section(water={"table": 12.0}),
            section(soil(density_ordinary=20e3 / GRAVITY - 1000.0, density_seismic=20e3 / GRAVITY, **PAIR)),
        )
    )
    free = ~under.fixed
    assert np.array_equal(under.x, buoyant.x)
    np.testing.assert_allclose(under.mass, buoyant.mass, rtol=1e-12)
    for item, other in zip(under.pull, buoyant.pull, strict=True):
        np.testing.assert_allclose(item[free], other[free], atol=1e-6 * GRAVITY)


def test_a_surcharge_and_a_jump_of_pore_pressure_reach_the_discs_whole():
    loaded = section(surcharges=[{"from": 4, "to": 14, "pressure": ["10 kPa", "30 kPa"]}])
    model = discs(loaded)
    np.testing.assert_allclose(np.sum(model.mass * model.pore_acceleration_z), -200e3, rtol=1e-9)
    clay = soil("Clay", bottom={"elevation": 1.0}, pore_pressure_ratio=0.0, density_saturated=None)
    artesian = section(clay, soil("Sand", piezometric_level=8.0))
    model = discs(artesian)
    below = model.layer == 1
    lifted = np.sum((model.mass * model.pore_acceleration_z)[~below & ~model.fixed])
    displaced = np.sum((model.mass * model.pore_acceleration_z)[below])
    # the jump of 7 m of head between clay and sand, and 60 m wide, less what Archimedes gives the sand below
    assert lifted + displaced == pytest.approx(60.0 * (7.0 + 6.0) * WATER, rel=0.05)


def test_discs_that_move_through_the_water_table_are_buoyed_by_their_part_below_it():
    """Archimedes, with the part of a square as high and wide as the disc: nothing above, γw / ρ of the soil below."""
    config = section(surface=[[0.0, 10.0], [60.0, 10.0]], water={"table": 6.0})
    ground = ground_of(config, DISCS)
    model = ground.model([layer.springs(0.5, 0.25) for layer in soil_layers(config)], DISCS)
    free = ~model.fixed
    for rise in (0.0, 1.7, -2.4):
        model.z += rise
        below = np.clip(0.5 - (ground.to_section(model.x, model.z)[1] - 6.0) / (2.0 * model.radius), 0.0, 1.0)
        felt = ground.buoyancy(model)
        density = np.array([s.density_seismic for s in config.strata])[model.layer[free]]
        np.testing.assert_allclose(felt[1][free], below[free] * WATER / density, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(felt[0], 0.0, atol=1e-9)


def test_ground_that_sinks_into_liquefied_ground_is_carried_by_the_water_that_it_displaces():
    """A crust on liquefied ground under Kh: all that moved through the table has the buoyancy of where it is, within
    what it moved since the last look. With buoyancy that stayed as it was a crust sank as a stone in mud: 18 kN/m3
    on 9 of buoyant sand, where in nature it floats, 18 on 19 of sand and water."""
    crust = soil("Crust", bottom={"elevation": -2.5}, cohesion="2 kPa", friction_angle="32 deg", density_saturated=None)
    sand = soil("Sand", cohesion=0.0, friction_angle="33 deg", density="19 kN/m^3", density_saturated=None)
    flat = section(crust, sand, surface=[[0.0, 0.0], [60.0, 0.0]], base={"elevation": -15.0}, water={"table": -2.5})
    lies = deposit(flat, DemSettings(elements=150))
    start, case = lies.settled, Case(residual_strength=5e3, strain_potential=0.3)
    slider = Slider(start, lies.ground, [1], case, SlideSettings(kh=0.2, kh_seconds=0.5, duration=20.0))
    slider.run()
    model, ground = slider.model, lies.ground
    more = model.mass * (model.pore_acceleration_z - start.pore_acceleration_z)
    expected = model.mass * (ground.buoyancy(model) - ground.buoyancy(start))[1]
    moved = np.abs(model.z - start.z) > 0.2
    reaches = expected > 0.02 * GRAVITY * model.mass  # a dry disc may sink and stay above the table
    sank = moved & (model.layer == 0) & (model.z < start.z) & reaches
    assert np.count_nonzero(sank) > 3
    assert (more[sank] > 0.0).all()
    since = (
        2.0 * model.radius * WATER * HISTORY_INTERVAL * np.abs(model.vz).max()
    )  # that of a disc's width over its way since the look, at no more than the speed of the fastest
    assert (np.abs(more - expected) < 1.2 * since + 0.01 * WATER * np.pi * model.radius**2).all()


def smooth_row(tilt, **changes):
    """A row of discs that do not turn on a rough plane, its sides periodic: a uniform slope one disc deep."""
    rough = replace(
        SOIL_SPRINGS, friction=FRICTION, contact_cohesion=0.0, rolling_friction=np.inf, cn=np.sqrt(MASS * KN),
        ct=np.sqrt(MASS * KN),
    )  # fmt: skip
    return DiscModel.create(
        DiscGeometry(2.0 * RADIUS * np.arange(16), np.full(16, RADIUS), RADIUS),
        DiscMaterials([rough], law="soil"),
        DiscBoundary(FLOOR, period=(32.0 * RADIUS, 0.0)),
        gravity=tilted_gravity(tilt, GRAVITY),
        **changes,
    )


@pytest.mark.parametrize(("head", "excess"), [("vertical", 0.0), ("normal", 0.0), ("normal", 0.15)])
def test_a_row_that_repeats_slides_down_with_seepage_at_its_closed_form(head, excess):
    """Kh = (γ cos² - u/h) tan φ - γ sin cos over γ (cos² + sin cos tan φ), of a layer that water flows through along
    the slope, u/h with what shaking adds; 1 % less than that it stays, 1 % more and it goes."""
    slope, density = np.arctan(0.2), 20e3 / GRAVITY
    cosine, sine = np.cos(slope), np.sin(slope)
    strip = section(
        soil(cohesion=0.0, excess_pore_pressure_ratio=excess), surface=[[0.0, 12.0], [60.0, 0.0]], base={"depth": 4.0},
        water={"table": {"depth": 0.0}, "head": head},
    )  # fmt: skip
    water, at = strip.water_pressure, np.array([[30.0, 4.0]])

    def pressure(place):
        return float((water.at_rest(place, at, [0]) + water.excess(place, at, [0]))[0])

    rise = [(pressure(at + d) - pressure(at - d)) / 2e-3 for d in 1e-3 * np.eye(2)]
    pore = WATER * (cosine**2 if head == "normal" else 1.0)
    pore += excess * (20e3 - pore)
    more = (20e3 * cosine**2 - pore) * FRICTION - 20e3 * sine * cosine
    kc = more / (20e3 * (cosine**2 + sine * cosine * FRICTION))
    moved = []
    for share in (0.99, 1.01):
        model = smooth_row(slope, acceleration=Acceleration.seismic(share * kc, tilt=slope, ramp=(0.0, 2.0)))
        ax, az = -np.array(rise) / density
        model.pore_acceleration_x[:], model.pore_acceleration_z[:] = cosine * ax - sine * az, sine * ax + cosine * az
        begin = model.x.copy()
        Engine(dt=1e-4, balance=np.inf).run(model, 6.0)
        moved.append(float(np.mean(model.x - begin)))
    assert abs(moved[0]) < 0.005
    assert moved[1] > 0.02


@pytest.mark.parametrize(("tilt", "share"), [(0.0, 1.0), (0.3, 0.0), (0.3, 0.5)])
def test_a_loaded_row_slides_at_its_closed_form(tilt, share):
    """Kh = tan(φ - β) (W + Q)/(W + s Q) of discs that weigh W and carry Q, of which the share s shakes with them."""
    load = 0.7
    kc = np.tan(np.arctan(FRICTION) - tilt) * (1.0 + load) / (1.0 + share * load)
    moved = []
    for part in (0.99, 1.01):
        model = smooth_row(tilt, acceleration=Acceleration.seismic(part * kc, tilt=tilt, ramp=(0.0, 2.0)))
        model.pore_acceleration_x[:], model.pore_acceleration_z[:] = load * np.array(model.gravity)[:, None]
        model.added_mass_x[:], model.added_mass_z[:] = share * load * np.cos(tilt), share * load * np.sin(tilt)
        begin = model.x.copy()
        Engine(dt=1e-4, balance=np.inf).run(model, 6.0)
        moved.append(float(np.mean(model.x - begin)))
    assert abs(moved[0]) < 0.005
    assert moved[1] > 0.02


def test_what_shakes_does_its_work_and_comes_to_the_same_with_any_number_of_threads():
    ends = []
    for threads in (1, 2):
        model = smooth_row(0.1, acceleration=Acceleration.seismic(1.2, tilt=0.1, ramp=(0.0, 0.2)))
        model.added_mass_x[::2], model.added_mass_z[::2] = 0.5, -0.1
        begin = np.array([model.x, model.z])
        energies = Engine(dt=1e-4, threads=threads).run(model, 0.2)
        ends.append((model.x.copy(), model.z.copy(), energies.external, energies.weight))
    energies = Engine(dt=1e-4).run(model, 0.4)  # its energies balance, or it raises
    by_weight = float(np.sum(model.mass * (np.array(model.gravity) @ (np.array([model.x, model.z]) - begin))))
    assert energies.weight == pytest.approx(by_weight, rel=1e-6)
    assert energies.external > energies.weight
    for item, other in zip(*ends, strict=True):
        assert np.array_equal(item, other)


def test_surcharges_and_free_water_push_with_their_inertia():
    """Westergaard's pressure on a face at an angle b comes to 7/12 γw H² Kh sin b along x, times cos b upwards; H is
    the depth of the water, 5 m here. Of a surcharge of 200 kN/m half shakes."""
    load = {"from": 4, "to": 14, "pressure": ["10 kPa", "30 kPa"], "seismic_share": 0.5}
    model = discs(section(surcharges=[load]))
    np.testing.assert_allclose(GRAVITY * np.sum(model.mass * model.added_mass_x), 100e3, rtol=1e-9)
    assert not model.added_mass_z.any()
    model = discs(section(water={"table": 7.0, "westergaard": True}))
    whole, face = 7.0 / 12.0 * WATER * 5.0**2, np.arctan(0.4)
    along, up = (GRAVITY * np.sum(model.mass * values) for values in (model.added_mass_x, model.added_mass_z))
    np.testing.assert_allclose([along, up], [whole * np.sin(face), whole * np.cos(face)], rtol=0.01)


@pytest.mark.parametrize("ratio", [0.0, 0.4])
def test_what_carries_the_ground_is_what_excess_pore_pressure_leaves(ratio):
    """Discs at rest under still water press on their box with 1 - r of their buoyant weight."""
    ground = section(
        soil(excess_pore_pressure_ratio=ratio), surface=[[0.0, 5.0], [20.0, 5.0]], base={"elevation": 0.0},
        water={"table": 8.0},
    )  # fmt: skip
    layers = [layer.springs(0.5, 0.25) for layer in soil_layers(ground)]
    model = settle(ground_of(ground, SMALL), layers, SMALL)
    forces, free = contact_forces(model), ~model.fixed
    buoyant = np.sum(model.mass[free]) * GRAVITY * (20e3 - WATER) / 20e3
    _, up, _ = resultants(model, forces)
    supported = -np.sum(up[model.fixed]) + np.sum(forces.line_fz)
    np.testing.assert_allclose(supported, (1.0 - ratio) * buoyant, rtol=1e-3)


def test_strength_of_discs_goes_by_effective_stress():
    under = section(water={"table": 12.0})
    np.testing.assert_allclose(middle_stresses(under), 7.5 * (20e3 - WATER), rtol=2e-3)
