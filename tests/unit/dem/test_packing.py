"""Packings: counts of the paper, discs inside and apart, layers, boundary without holes, any polygon, any section."""

import numpy as np
import pytest

from dem.assembly import DiscMaterials
from dem.engine.engine import Engine
from dem.kernels.pushing_apart import clearance
from dem.packing import Packing, boundary, lattice_box, periodic_packing, random_packing, triangular_lattice
from dem.springs import from_strata
from meshes.section.section import Section
from tests.support import SECTIONS
from tests.support.dem_cases import BARE_SPRINGS, GRAVITY, SOIL_SPRINGS

RADIUS = 0.5
# a slope with a step: a corner that points inwards, another in the base
STEP = np.array([[0.0, 0.0], [14.0, -1.0], [30.0, 1.0], [30.0, 8.0], [18.0, 8.0], [15.0, 12.0], [0.0, 12.0]])


def two_layers(x: np.ndarray, z: np.ndarray) -> np.ndarray:
    return np.where(z > 5.0, 0, 1)


def gaps(packing: Packing) -> np.ndarray:
    """Distance of the rims of each disc and its nearest neighbour."""
    dx = packing.x[:, None] - packing.x
    dz = packing.z[:, None] - packing.z
    gap = np.hypot(dx, dz) - packing.radius[:, None] - packing.radius
    np.fill_diagonal(gap, np.inf)
    gap[np.ix_(~packing.free, ~packing.free)] = np.inf
    return gap.min(axis=1)


def test_the_papers_counts() -> None:
    packing = lattice_box(133, 24, 0.75)
    assert packing.free.sum() == 3180
    assert (~packing.free).sum() == 189
    assert gaps(packing)[packing.free] == pytest.approx(np.zeros(3180), abs=1e-9)


def test_lattice_fills_a_polygon_with_discs_that_touch() -> None:
    packing = triangular_lattice(STEP, two_layers, RADIUS)
    free = packing.free
    assert np.all(clearance(packing.x[free], packing.z[free], STEP) >= RADIUS * (1.0 - 1e-9))
    # nine tenths of the plane less what the rim costs
    assert np.pi * RADIUS**2 * free.sum() > 0.78 * 300.0
    assert gaps(packing)[free].min() > -0.15 * RADIUS  # boundary discs may be a little nearer than touching
    inner = free & (clearance(packing.x, packing.z, STEP) > 3.0 * RADIUS)
    assert gaps(packing)[inner] == pytest.approx(np.zeros(inner.sum()), abs=1e-9)
    assert np.array_equal(packing.layer[free], two_layers(packing.x[free], packing.z[free]))


def test_lattice_rows_follow_an_angle() -> None:
    packing = triangular_lattice(STEP, two_layers, RADIUS, angle=0.3)
    x, z = packing.x[packing.free], packing.z[packing.free]
    height = (-np.sin(0.3) * x + np.cos(0.3) * z) / (np.sqrt(3.0) * RADIUS)
    rows = height - height[0]
    assert rows == pytest.approx(np.round(rows), abs=1e-9)


@pytest.mark.parametrize(("spread", "porosity"), [(0.0, 0.25), (0.2, 0.2), (0.5, 0.22)])
def test_random_packing_has_the_spread_and_porosity_asked_for(spread: float, porosity: float) -> None:
    packing = random_packing(STEP, two_layers, RADIUS, spread=spread, porosity=porosity, seed=3)
    free = packing.free
    radius = packing.radius[free]
    area = 0.5 * np.sum(STEP[:, 0] * np.roll(STEP[:, 1], -1) - np.roll(STEP[:, 0], -1) * STEP[:, 1])
    assert 1.0 - np.pi * np.sum(radius**2) / area == pytest.approx(porosity, abs=1e-12)
    assert radius.mean() == pytest.approx(RADIUS, rel=0.03)
    assert np.ptp(radius) == pytest.approx(2.0 * spread * RADIUS, rel=0.05, abs=1e-12)
    assert gaps(packing)[free].min() > -0.2 * RADIUS
    among = Packing(packing.x[free], packing.z[free], radius, packing.layer[free], packing.lines)
    assert gaps(among).min() > -0.011 * RADIUS
    assert clearance(packing.x[free], packing.z[free], STEP).min() > RADIUS * (1.0 - spread) - 0.02 * RADIUS


def test_seed_decides_the_random_packing() -> None:
    first, again, other = (random_packing(STEP, two_layers, RADIUS, porosity=0.25, seed=s) for s in (1, 1, 2))
    assert np.array_equal(first.x, again.x)
    assert np.array_equal(first.radius, again.radius)
    assert not np.array_equal(first.x, other.x)


def test_too_dense_a_packing_is_refused_in_words(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("dem.packing.SWEEPS", 200)
    with pytest.raises(ValueError, match="use a larger porosity"):
        random_packing(STEP, two_layers, RADIUS, porosity=0.08)


@pytest.mark.parametrize(
    ("outline", "words"),
    [(STEP[::-1], "counter-clockwise"), (STEP[:2], "at least three"), (STEP * np.nan, "finite")],
)
def test_impossible_outlines_are_refused(outline: np.ndarray, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        triangular_lattice(outline, two_layers, RADIUS)


def test_boundary_has_no_hole_and_holds_what_falls() -> None:
    """Loose discs shaken in every direction for two seconds are still inside, and gaps of the wall are small."""
    packing = random_packing(STEP, two_layers, RADIUS, porosity=0.3, seed=5)
    wall = ~packing.free
    dx = packing.x[wall, None] - packing.x[wall]
    dz = packing.z[wall, None] - packing.z[wall]
    apart = np.sort(np.hypot(dx, dz), axis=1)[:, 1:3]
    ends = 2  # the upper ends of the two side walls
    assert np.sum(apart[:, 1] > 2.3 * RADIUS) <= ends
    model = packing.discs(DiscMaterials([SOIL_SPRINGS, BARE_SPRINGS]), gravity=(0.0, -GRAVITY))
    rng = np.random.default_rng(0)
    model.set_velocity(*(8.0 * rng.standard_normal((2, len(model))) * packing.free), 0.0)
    Engine(balance=1e-2).run(model, 1.5)
    free = packing.free
    assert np.all(model.z[free] > -1.5)
    assert np.all((model.x[free] > -RADIUS) & (model.x[free] < 30.0 + RADIUS))


@pytest.mark.parametrize("name", ["s13", "slope_2to1", "natural_slope"])
def test_both_packings_fit_a_section(name: str) -> None:
    section = Section.read(SECTIONS / f"{name}.toml")
    outline = section.outline()
    x, z = outline.T
    radius = np.sqrt(0.5 * np.sum(x * np.roll(z, -1) - np.roll(x, -1) * z) / 800.0 / np.pi)
    layers = from_strata(section.strata, radius)
    assert [layer.name for layer in layers] == [stratum.name for stratum in section.strata]
    for packing in (
        triangular_lattice(outline, section.stratum_at, radius),
        random_packing(outline, section.stratum_at, radius, porosity=0.26),
    ):
        free = packing.free
        assert 400 < free.sum() < 820
        assert np.array_equal(packing.layer[free], section.stratum_at(packing.x[free], packing.z[free]))
        model = packing.discs(DiscMaterials(layers), gravity=(0.0, -GRAVITY))
        Engine().run(model, steps=200)


def test_a_vertical_step_of_the_surface_is_no_wall() -> None:
    """The face of a quay was a rigid line from top to bottom, which the discs in front of it had "passed"."""
    step = np.array([[0.0, 0.0], [30.0, 0.0], [30.0, 4.0], [15.0, 4.0], [15.0, 12.0], [0.0, 12.0]])
    _, lines = boundary(step, RADIUS)
    assert sorted(lines[:, 2:4].round(6).tolist()) == [[-1.0, 0.0], [0.0, 1.0], [1.0, 0.0]]
    of_base = np.array([[0.0, 0.0], [15.0, 0.0], [15.0, 4.0], [30.0, 4.0], [30.0, 12.0], [0.0, 12.0]])
    assert len(boundary(of_base, RADIUS)[1]) == 5


def test_periodic_packing_fits_to_itself_at_its_sides() -> None:
    lower, upper = np.array([[0.0, 0.0], [20.0, -2.0]]), np.array([[0.0, 10.0], [8.0, 10.5], [20.0, 8.0]])
    packing = periodic_packing(lower, upper, lambda x, _z: np.zeros(len(x), int), RADIUS, porosity=0.22, seed=4)
    assert packing.period == (20.0, -2.0)
    assert ((packing.x >= 0.0) & (packing.x < 20.0)).all()
    shifted = (np.append(packing.x, packing.x + 20.0), np.append(packing.z, packing.z - 2.0))
    both = Packing(*shifted, np.tile(packing.radius, 2), np.tile(packing.layer, 2), packing.lines)
    x, z, radius = both.x, both.z, both.radius
    apart = np.hypot(x[:, None] - x, z[:, None] - z) - radius[:, None] - radius
    np.fill_diagonal(apart, 0.0)
    assert apart.min() >= -0.0101 * RADIUS


def test_periodic_packing_has_one_rise() -> None:
    level, falls = np.array([[0.0, 0.0], [20.0, 0.0]]), np.array([[0.0, 10.0], [20.0, 8.0]])
    with pytest.raises(ValueError, match="at the base and at the surface"):
        periodic_packing(level, falls, lambda x, _z: np.zeros(len(x), int), RADIUS)
