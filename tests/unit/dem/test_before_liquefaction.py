"""Sand that will liquefy has the laws of liquefied ground before the shaking, and nothing disturbs it."""

import numpy as np
import pytest

from dem.case import Case
from dem.kernels import liquefied_pairs as bond
from dem.kernels.liquefied_bonds import limiting_strains
from dem.laboratory.soil_contacts import soil_layers
from dem.liquefied_ground import is_liquefying, set_bonds
from dem.neighbourhood import Neighbourhood
from dem.pressure_balance import balance_pressures
from dem.search.deposit import Deposit, deposit
from dem.settings import DemSettings, SlideSettings
from dem.slides.before_liquefaction import replace_contacts_of_sand
from dem.slides.liquefaction import Slider
from dem.slides.liquefied_strength import Weakening, before_liquefaction, residual
from dem.slides.surface import Surface
from dem.slides.until_rest import come_to_rest
from tests.support.liquefied import ShearedBox
from tests.support.water import section, soil

CASE = Case(residual=0.1)


@pytest.fixture(scope="module")
def level() -> Deposit:
    """Three metres of crust on five of sand that liquefies, on firm ground; 36 m long."""
    ground = section(
        soil("Crust", bottom={"elevation": -3.0}, cohesion="5 kPa", friction_angle="30 deg"),
        soil("Sand", bottom={"elevation": -8.0}, cohesion=0.0, friction_angle="33 deg"),
        soil("Firm", cohesion="50 kPa", friction_angle="35 deg"),
        surface=[[0.0, 0.0], [36.0, 0.0]], base={"elevation": -10.0},
    )  # fmt: skip
    return deposit(ground, DemSettings(elements=350), soil_layers(ground))


def imbalance(box: ShearedBox) -> float:
    """The mean force by the pressures of neighbours, less its mean over neighbours, over pressure times diameter."""
    model = box.model
    wet, near, free = model.liquefied, Neighbourhood.of(model, model.x, model.z), ~model.fixed
    area = wet[:, bond.AREA]
    term = np.where(free, wet[:, bond.PRESSURE] / near.density(area) ** 2, 0.0)
    both = np.where(free[near.i] & free[near.j], 1.0, 2.0)
    force = -both * (term[near.i] + term[near.j]) * area[near.i] * area[near.j] * near.slope
    net = [near.sums(-force * n, force * n) for n in (near.nx, near.nz)]
    net = [f - near.mean(f, np.where(free, area, 0.0)) for f in net]
    return float(np.hypot(*net)[free].mean() / (wet[free, bond.PRESSURE] * 2.0 * model.radius[free]).mean())


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_pressures_balance_after_small_moves(seed: int) -> None:
    """The imbalance falls to a tenth at the most; discs move by less than a tenth of a diameter on average, and the
    ground as a whole by less than a hundredth."""
    box = ShearedBox.of(seed, 6e4)
    model = box.model
    rng = np.random.default_rng(seed)  # as irregular as discs that have settled by their contacts
    free = ~model.fixed
    model.x[free] += 0.04 * rng.normal(size=int(free.sum()))
    model.z[free] += 0.04 * rng.normal(size=int(free.sum()))
    before, x, z = imbalance(box), model.x.copy(), model.z.copy()
    balance_pressures(model, free)
    assert imbalance(box) < 0.1 * before
    way = np.array([model.x - x, model.z - z])
    assert (way[:, ~free] == 0.0).all()
    assert np.hypot(*way)[free].mean() < 0.1
    assert np.abs(way[:, free].mean(axis=1)).max() < 0.01


def test_sand_before_liquefaction_has_its_strength_and_rests(level: Deposit) -> None:
    """p tan phi with the overburden p; replaced contacts are gone, and the surface does not move by a tenth of a
    diameter."""
    start, ground = level.settled, level.ground
    sand = (start.layer == 1) & ~start.fixed
    model = replace_contacts_of_sand(start, ground, [1], CASE)
    assert (is_liquefying(model) == sand).all()
    state = before_liquefaction(start, ground, [1], CASE)
    expected = np.tan(np.radians(33.0)) * state.pressure[sand]
    assert model.liquefied[sand, bond.STRENGTH] == pytest.approx(expected, rel=0.01)
    assert model.springs.layers[1].faded == 1.0
    crust = (start.layer == 0) & ~start.fixed
    come_to_rest(model)
    assert np.abs(model.z - start.z)[crust].mean() < 0.1 * 2.0 * ground.radius
    assert replace_contacts_of_sand(model, ground, [1], CASE) is model


@pytest.mark.parametrize("seed", [0, 1])
def test_a_surface_of_sand_stays_where_it_is(seed: int) -> None:
    """Level sand that liquefies up to its surface: the neighbours of discs there are below them, and lifted the surface
    by a third of a diameter on average, and single discs by a whole one."""
    ground = section(
        soil("Sand", bottom={"elevation": -5.0}, cohesion=0.0, friction_angle="33 deg"),
        soil("Firm", cohesion="50 kPa", friction_angle="35 deg"),
        surface=[[0.0, 0.0], [36.0, 0.0]], base={"elevation": -7.0},
    )  # fmt: skip
    bare = deposit(ground, DemSettings(elements=350, seed=seed), soil_layers(ground))
    start, diameter = bare.settled, 2.0 * bare.ground.radius
    model = replace_contacts_of_sand(start, bare.ground, [0], CASE)
    come_to_rest(model)
    rise = (model.z - start.z)[Surface.of(start, bare.ground).discs]
    assert abs(rise.mean()) < 0.05 * diameter
    assert rise.max() < 0.8 * diameter


def test_strength_falls_from_before_to_after_liquefaction(level: Deposit) -> None:
    """In proportion to the degree of liquefaction, at every disc; other ground keeps its contacts."""
    start, ground = replace_contacts_of_sand(level.settled, level.ground, [1], CASE), level.ground
    sand, after = is_liquefying(start), residual(start, ground, [1], CASE)
    first = start.liquefied[sand, bond.STRENGTH] / start.strength_factor[sand]
    weakening = Weakening(start, ground, [1], CASE)
    for degree in (0.0, 0.3, 1.0):
        model = start.copy()
        weakening.apply(model, {1: degree})
        now = model.liquefied[sand, bond.STRENGTH] / model.strength_factor[sand]
        assert now == pytest.approx(first + degree * (after.strength[sand] - first))
        again = model.copy()
        weakening.apply(again, {1: degree})
        assert np.array_equal(again.liquefied, model.liquefied)
        assert np.array_equal(again.bonds, model.bonds)
    assert model.liquefied[sand, bond.STRAIN] / model.strength_factor[sand] == pytest.approx(after.strain[sand])


def test_strata_without_discs_do_not_liquefy(level: Deposit) -> None:
    """A stratum thinner than a disc may have none."""
    slider = Slider(level.settled, level.ground, [], CASE, SlideSettings(kh=0.0, duration=0.5, onset=0.5))
    assert slider.weakening is None
    assert slider.start is level.settled
    assert abs(slider.run().rows[-1].slide_max_m) < 0.01


def test_a_strain_potential_appears_as_ground_liquefies(level: Deposit) -> None:
    """None before liquefaction, all of it afterwards, and never a law without a steep part."""
    case = Case(residual=0.1, strain_potential=0.3)
    start, ground = replace_contacts_of_sand(level.settled, level.ground, [1], case), level.ground
    sand, after = is_liquefying(start), residual(start, ground, [1], case)
    assert (start.liquefied[sand, bond.KNEE_STRAIN] == 0.0).all()
    weakening, ends = Weakening(start, ground, [1], case), []
    for degree in (0.25, 0.5, 1.0):
        model = start.copy()
        weakening.apply(model, {1: degree})
        wet = model.liquefied[sand]
        ends.append(float((wet[:, bond.KNEE_STRAIN] * wet[:, bond.STRAIN] / start.strength_factor[sand]).mean()))
        assert (wet[:, bond.KNEE_STRAIN] < 1.0).all()
        assert (wet[:, bond.KNEE_STRENGTH] < 1.0).all()
    assert ends == pytest.approx([0.25 * ends[2], 0.5 * ends[2], ends[2]])
    assert wet[:, bond.KNEE_STRAIN] == pytest.approx(np.broadcast_to(after.soft_to, len(start))[sand])
    assert wet[:, bond.KNEE_STRENGTH] == pytest.approx(np.broadcast_to(after.knee, len(start))[sand])


def test_bonds_keep_their_displacement_as_their_law_changes() -> None:
    """Half of the strength at the same stiffness: the mobilised share doubles, the stored energy stays."""
    model = ShearedBox.of(0, 6e4).model
    free, pairs = ~model.fixed, np.array([model.liquefied_i, model.liquefied_j])
    wet, factor = model.liquefied, model.strength_factor
    model.bonds[:, bond.ALONG_AT], model.bonds[:, bond.ACROSS_AT] = 0.3, -0.2
    model.bonds[:, bond.LIMIT_ENERGY_AT] = 50.0
    way = model.bonds[:, bond.ALONG_AT] * limiting_strains(wet, pairs)
    half = [0.5 * wet[:, field] / factor for field in (bond.STRENGTH, bond.STRAIN)]
    set_bonds(model, free, *half, np.zeros(len(model)), np.zeros(len(model)))
    assert model.bonds[:, bond.ALONG_AT] == pytest.approx(0.6)
    assert model.bonds[:, bond.ACROSS_AT] == pytest.approx(-0.4)
    assert model.bonds[:, bond.ALONG_AT] * limiting_strains(wet, pairs) == pytest.approx(way)
    stored = model.bonds[:, bond.LIMIT_ENERGY_AT] * (model.bonds[:, [bond.ALONG_AT, bond.ACROSS_AT]] ** 2).sum(axis=1)
    assert stored == pytest.approx(50.0 * (0.3**2 + 0.2**2))
