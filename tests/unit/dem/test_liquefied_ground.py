"""Liquefied soil discs: what they carry, same bits, energy, and what does not go."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import trapezoid

from dem.assembly import DiscBoundary, DiscGeometry, DiscMaterials
from dem.case import Case
from dem.engine.engine import Engine
from dem.engine.time_step import largest_step
from dem.ground import Ground
from dem.kernels.contact import ALLOWED, CN, CT, KN, KS, MU
from dem.kernels.liquefied_bonds import FITTED_STRENGTH
from dem.kernels.liquefied_laws import bond_kernel, density_kernel, stand_in_shares
from dem.kernels.liquefied_pairs import (
    AREA,
    BOND,
    COUNTER_ACROSS_AT,
    COUNTER_ALONG_AT,
    DENSITY,
    PRESENT_DENSITY,
    PRESSURE_TERM,
    STRAIN,
    STRENGTH,
)
from dem.kernels.liquefied_stress import measured_shear
from dem.liquefied_ground import (
    ADJUSTMENT_RATE,
    BOND_STRAIN_RATIO,
    LARGEST_STRAIN,
    SHEAR_MODULUS,
    SMALLEST_STRAIN,
    Onset,
    is_liquefying,
    liquefy,
    match_strength,
    set_share,
)
from dem.model import DiscModel
from dem.overburden import effective_overburden
from dem.packing import lattice_box
from dem.pair_table import pair_table
from dem.pressure_shear import take_back_shear
from dem.slides.edge_strength import BAND
from dem.slides.liquefied_strength import residual
from tests.support.dem_cases import BARE_SPRINGS, RADIUS
from tests.support.liquefied import GRAVITY, ShearedBox, sand, with_voids

LOOSE = sand(3e7, 0.5)


def heap(gravity: float = GRAVITY, base: bool = True, seed: int = 3, soft: bool = False) -> DiscModel:
    """Ten rows of discs of many sizes on fixed ones, all but the upper two liquefied, and moving; open sides.

    soft: whether they have a strain potential, of a third.
    """
    rng = np.random.default_rng(seed)
    i, j = np.meshgrid(np.arange(20), np.arange(12))
    x, z = (i + 0.5 * (j % 2)).ravel().astype(float), (j * 0.9).ravel()
    fixed = (z < 1.0) & base
    layer = np.where(fixed, -1, np.where(z > 9.0, 1, 0))
    radius = rng.uniform(0.4, 0.6, len(x))
    layers = [replace(LOOSE, faded=1.0), LOOSE]
    model = DiscModel.create(
        DiscGeometry(x, z, radius, layer), DiscMaterials(layers, law="soil", turns=False), gravity=(0.0, -gravity)
    )
    n = len(model)
    strain, knee, soft_to = (0.4, 0.1, 0.8) if soft else (SMALLEST_STRAIN, 0.0, 0.0)
    strains = np.full(n, strain)
    liquefy(model, Onset(layer == 0, with_voids(model), np.full(n, 5e4), np.full(n, 1e4), strains, knee, soft_to))
    set_share(model, np.ones(n))
    model.set_velocity(*rng.normal(0.0, 0.5, (2, n)) * ~fixed)
    return model


def same(single: DiscModel, other: DiscModel) -> None:
    for name in ("x", "z", "vx", "vz", "liquefied", "liquefied_i", "bonds", "strength_factor", "energy_sums"):
        assert np.array_equal(getattr(single, name), getattr(other, name)), name


def test_kernels_are_one_over_the_plane() -> None:
    """Integral of W over the plane, closed form of Wendland's C2; its slope is its derivative; w falls from 1 to 0."""
    r = np.linspace(0.0, 1.999, 4001)
    width = np.array([density_kernel.py_func(item, 2.0) for item in r])
    assert trapezoid(2.0 * np.pi * r * width[:, 0], r) == pytest.approx(1.0, rel=1e-4)
    assert np.gradient(width[:, 0], r)[1:-1] == pytest.approx(width[1:-1, 1], abs=1e-3)
    assert [bond_kernel.py_func(entry, 2.0) for entry in (0.0, 2.0)] == [1.0, 0.0]


@pytest.mark.parametrize("soft", [False, True])
def test_threads_do_not_change_a_bit(soft: bool) -> None:
    disc_model, three = heap(soft=soft), heap(soft=soft)
    for model, threads in ((disc_model, 1), (three, 3)):
        Engine(dt=4e-4, threads=threads, balance=5e-3).run(model, steps=400)
    assert disc_model.lists_made > 3
    same(disc_model, three)


@pytest.mark.parametrize("soft", [False, True])
def test_stops_and_checkpoints_do_not_change_a_bit(tmp_path: Path, soft: bool) -> None:
    """Nor in the middle of steps over which forces are held, nor just before a list is made."""
    whole, part = heap(soft=soft), heap(soft=soft)
    engine = Engine(dt=4e-4, balance=5e-3)
    engine.run(whole, steps=301)
    for steps in (3, 97, 1, 100):
        engine.run(part, steps=steps)
        part.save(tmp_path / "half.npz")
        part = DiscModel.load(tmp_path / "half.npz")
    engine.run(part, steps=100)
    assert whole.steps_between_looks > 1
    same(whole, part)


@pytest.mark.parametrize("soft", [False, True])
def test_free_ground_keeps_its_momentum(soft: bool) -> None:
    """Forces come in pairs: without weight and base the momentum of a cloud stays what it was."""
    model = heap(gravity=0.0, base=False, soft=soft)
    before = model.mass @ model.vx, model.mass @ model.vz
    Engine(dt=4e-4, balance=5e-3).run(model, steps=300)
    scale = float(model.mass @ np.hypot(model.vx, model.vz))
    assert abs(model.mass @ model.vx - before[0]) < 1e-9 * scale
    assert abs(model.mass @ model.vz - before[1]) < 1e-9 * scale


@pytest.mark.parametrize("soft", [False, True])
def test_energy_balances_better_with_smaller_steps(soft: bool) -> None:
    gaps = []
    for dt in (8e-4, 2e-4):
        model = heap(soft=soft)
        energies = Engine(dt=dt, balance=1e-2).run(model, 0.4)
        assert energies is not None
        gaps.append(abs(energies.gap) / energies.turnover)
        assert energies.liquefied_slip > 0.0
        assert energies.viscosity > 0.0
    assert gaps[0] < 0.01
    assert gaps[1] < 0.5 * gaps[0]


def test_the_pressure_beside_ground_that_begins_to_liquefy_changes_gradually() -> None:
    """Between clay, which has liquefied to 1, and sand under one overburden it is the same at every degree of sand."""
    assert stand_in_shares.py_func(1.0, 0.0) == (1.0, 0.0)
    assert stand_in_shares.py_func(0.3, 0.3) == (0.0, 0.0)
    for degree in (0.0, 0.05, 0.5, 1.0):
        of_clay, of_sand = stand_in_shares.py_func(1.0, degree)
        assert (1.0 + of_clay) * 1.0 + (1.0 + of_sand) * degree == pytest.approx(2.0)


def test_soft_sand_that_begins_to_liquefy_on_strong_clay_loses_no_energy_to_the_steps() -> None:
    """The dashpot of sand with the strength and the strain of clay was unstable: its losses were below zero, and slides
    were repeated with a quarter of the step."""
    n, clay, sand_above = 240, np.repeat([False, True, False], [20, 100, 120]), np.repeat([False, True], [120, 120])
    x, z = np.meshgrid(np.arange(20.0), 0.9 * np.arange(12))
    layers = [replace(LOOSE, faded=1.0), replace(LOOSE, name="sand", faded=0.05)]
    layer = np.where(clay, 0, np.where(sand_above, 1, -1))
    discs = DiscGeometry((x + 0.5 * (np.arange(12) % 2)[:, None]).ravel(), z.ravel(), np.full(n, 0.5), layer)
    model = DiscModel.create(discs, DiscMaterials(layers, law="soil", turns=False), gravity=(0.0, -GRAVITY))
    area, pressure = with_voids(model), effective_overburden(model)
    liquefy(model, Onset(clay, area, pressure, np.full(n, 3e5), np.full(n, 0.005)))
    liquefy(model, Onset(sand_above, area, pressure, np.full(n, 2e4), np.full(n, 0.25), 0.07, 0.65))
    set_share(model, np.where(clay, 1.0, np.where(sand_above, 0.05, 0.0)))
    model.set_velocity(*np.random.default_rng(3).normal(0.0, 0.1, (2, n)) * ~model.fixed)
    energies = Engine(dt=0.6 * largest_step(model).seconds, balance=1.0).run(model, 0.1)
    assert energies is not None
    assert energies.viscosity > 0.0
    assert abs(energies.gap) < 5e-3 * energies.turnover


@pytest.mark.parametrize("seed", [3, 4])
@pytest.mark.parametrize("axes", [0, 1])
def test_pairs_take_back_the_shear_that_pressure_bears(axes: int, seed: int) -> None:
    """Virials of both on discs within a cloud, means over their neighbours: (xx - zz) / 2, then xz. What single discs
    bear beyond the mean stays; that nothing is left on the average shows the endless slope of `test_strain_potential`.
    """
    model = heap(gravity=0.0, base=False, seed=seed, soft=True)
    wet, i, j, started = model.liquefied, model.liquefied_i, model.liquefied_j, is_liquefying(model)
    wet[:, PRESSURE_TERM] = np.where(started, 5e4, 0.0)
    take_back_shear(model)
    way = np.array([model.x[j] - model.x[i], model.z[j] - model.z[i]])
    apart = np.hypot(*way)
    nx, nz = way / apart
    width, slope = np.array([density_kernel.py_func(min(r, model.reach), model.reach) for r in apart]).T
    twice = np.where(started[i] & started[j], 1.0, 2.0)
    loaded = twice * (wet[i, PRESSURE_TERM] + wet[j, PRESSURE_TERM]) * wet[i, AREA] * wet[j, AREA] * slope * apart
    along, across = model.bonds[:, [COUNTER_ALONG_AT, COUNTER_ACROSS_AT]].T * apart
    fx, fz = along * nx - across * nz, along * nz + across * nx
    borne = loaded * (0.5 * (nx * nx - nz * nz) if axes == 0 else nx * nz)
    taken = 0.5 * (fx * nx - fz * nz) if axes == 0 else 0.5 * (fx * nz + fz * nx)

    def of_discs(values: np.ndarray) -> np.ndarray:
        """The mean over neighbours of what pairs (pairs,) add to each disc, but for a factor."""
        each = np.bincount(i, values, len(model)) + np.bincount(j, values, len(model))
        weight = np.where(started[i] & started[j], width, 0.0)
        near = np.bincount(i, weight * each[j], len(model)) + np.bincount(j, weight * each[i], len(model))
        return np.asarray(density_kernel.py_func(0.0, model.reach)[0] * each + near)

    within = started & (model.x > 3.0) & (model.x < 17.0) & (model.z > 2.0) & (model.z < 8.0)
    first, second = of_discs(borne)[within], of_discs(taken)[within]
    assert within.sum() > 60
    assert np.corrcoef(first, second)[0, 1] < -0.7


def test_work_of_the_plates_goes_into_bonds() -> None:
    """Sheared slowly from 10 % on: what plates do is what bonds take, within a per cent, and nothing is left over."""
    box = ShearedBox.of(0, 6e4, rows=8)
    box.shear(0.1, 0.05)
    before = Engine().measure(box.model)
    box.shear(0.1, 0.05)
    after = Engine().measure(box.model)
    work = after.boundary - before.boundary
    assert after.liquefied_slip - before.liquefied_slip == pytest.approx(work, rel=0.03)
    assert abs(after.gap - before.gap) < 0.01 * work


def affine(strain: np.ndarray) -> tuple[DiscModel, np.ndarray]:
    """Liquefied discs that lie at random, moved by a gradient of displacement (2, 2), with all bonds at their limit in
    the direction in which their discs moved apart but for the rotation; and the displacement (2, n)."""
    rng = np.random.default_rng(4)
    at = 0.9 * np.stack(np.meshgrid(np.arange(30.0), np.arange(30.0))).reshape(2, -1)
    at += rng.uniform(-0.25, 0.25, (2, 900))
    model = DiscModel.create(
        DiscGeometry(*at, 0.5, np.zeros(900, int)), DiscMaterials([replace(LOOSE, faded=1.0)], law="soil", turns=False)
    )
    liquefy(model, Onset(np.ones(900, bool), with_voids(model), *np.full((3, 900), [[5e4], [1e4], [SMALLEST_STRAIN]])))
    set_share(model, np.ones(900))
    i, j = model.liquefied_i, model.liquefied_j
    apart = at[:, j] - at[:, i]
    distance = np.hypot(*apart)
    lever = np.where(distance < model.reach, bond_kernel.py_func(distance, model.reach) * distance, 0.0)
    levers = np.bincount(i, lever, 900) + np.bincount(j, lever, 900)
    model.liquefied[:, BOND] = model.liquefied[:, STRENGTH] * model.liquefied[:, AREA] / levers
    following = apart / distance
    strained = 0.5 * (strain + strain.T) @ apart
    towards = strained / np.maximum(np.hypot(*strained), 1e-12)
    model.bonds[:, :] = 0.0
    model.bonds[:, 0] = np.sum(following * towards, axis=0)
    model.bonds[:, 1] = following[0] * towards[1] - following[1] * towards[0]
    return model, strain @ at


@pytest.mark.parametrize("strain", [[[0.0, 0.01], [0.0, 0.0]], [[0.0, 0.0], [-0.02, 0.0]], [[0.01, 0.0], [0.0, -0.01]]])
def test_the_shear_stress_that_bonds_hold_is_measured(strain: list[list[float]]) -> None:
    """By integration over directions: FITTED_STRENGTH times the strength, in simple and in pure shear."""
    model, way = affine(np.array(strain))
    stress, shear, used = measured_shear(
        model.liquefied, way, np.array([model.liquefied_i, model.liquefied_j]), model.bonds, model.reach, model.repeats
    )
    inside = (np.abs(model.x - 13.0) < 9.0) & (np.abs(model.z - 13.0) < 9.0)
    assert stress[inside].mean() == pytest.approx(FITTED_STRENGTH * 1e4, rel=0.03)
    gamma = np.hypot(strain[0][0] - strain[1][1], strain[0][1] + strain[1][0])
    assert shear[inside] == pytest.approx(gamma)
    assert used[inside] == pytest.approx(1.0)


def test_bonds_hold_less_where_the_ground_holds_more_than_was_asked() -> None:
    """Of ground whose bonds all slip; where it does not strain, as it turns, nothing is changed."""
    model, way = affine(np.array([[0.0, 0.02], [0.0, 0.0]]))
    inside = (np.abs(model.x - 13.0) < 9.0) & (np.abs(model.z - 13.0) < 9.0)
    model.x, model.z = model.x_list + way[0], model.z_list + way[1]
    match_strength(model)
    expected = np.exp(ADJUSTMENT_RATE * 0.02 * (1.0 - FITTED_STRENGTH))
    assert model.strength_factor[inside].mean() == pytest.approx(expected, rel=0.02)
    assert model.liquefied[:, STRENGTH] == pytest.approx(1e4 * model.strength_factor)
    model, way = affine(np.array([[0.0, 0.02], [-0.02, 0.0]]))
    model.x, model.z = model.x_list + way[0], model.z_list + way[1]
    match_strength(model)
    assert model.strength_factor == pytest.approx(1.0)


def test_contacts_of_liquefied_layers_are_gone() -> None:
    """Half on the way; with dry neighbours, the base and each other; overlaps of such discs stop nobody."""
    whole, half, gone = (pair_table([LOOSE, replace(LOOSE, faded=share)], law="soil") for share in (0.0, 0.5, 1.0))
    fading = np.array([1, 3, 4, 5, 7])  # all columns with layer 1: (0, 1), (1, 0), (1, 1), (1, base), (base, 1)
    for row in (KN, KS, CN, CT):
        assert half.pairs[row, fading] == pytest.approx(0.5 * whole.pairs[row, fading])
        assert (gone.pairs[row, fading] == 0.0).all()
        assert gone.pairs[row, 0] == whole.pairs[row, 0] > 0.0
    assert (gone.pairs[ALLOWED, fading] == 2.0).all()
    assert gone.lines[MU, 1] == 0.0 < gone.lines[MU, 0]
    assert gone.lines[KN, 1] == whole.lines[KN, 1]
    with pytest.raises(ValueError, match="faded must lie between 0 and 1"):
        replace(LOOSE, faded=1.1)


def test_what_drains_takes_its_area_along() -> None:
    model = heap()
    area, density = model.liquefied[:, AREA].copy(), model.liquefied[:, PRESENT_DENSITY].copy()
    wet = is_liquefying(model)
    model.set_radius(np.where(wet, 0.95, 1.0) * model.radius)
    assert model.liquefied[wet, AREA] == pytest.approx(0.95**2 * area[wet])
    assert (model.liquefied[~wet, AREA] == area[~wet]).all()
    deep = wet & (model.z > 4.0) & (model.z < 6.0)
    assert model.liquefied[deep, PRESENT_DENSITY] == pytest.approx(0.95**2 * density[deep])


def test_a_free_surface_counts_as_ground_that_is_as_dense_as_below() -> None:
    """Discs with half of their neighbours would press without end once they are buried."""
    box = ShearedBox.of(0, 6e4).model
    at_rest = box.liquefied[is_liquefying(box), DENSITY]
    assert at_rest.min() > 0.85 * np.median(at_rest)


def test_what_cannot_liquefy() -> None:
    n = 40
    x, z, nothing = np.arange(n) * 2.0 * RADIUS, np.zeros(n), np.zeros(n)
    config = Onset(np.ones(n, bool), np.ones(n), nothing, nothing, nothing)
    with pytest.raises(ValueError, match="the laws of liquefied ground need law='soil'"):
        liquefy(DiscModel.create(DiscGeometry(x, z, RADIUS), DiscMaterials([BARE_SPRINGS])), config)
    short = DiscModel.create(
        DiscGeometry(x[:6], z[:6], RADIUS),
        DiscMaterials([LOOSE], law="soil"),
        DiscBoundary(period=(12.5 * RADIUS, 0.0)),
    )
    with pytest.raises(ValueError, match="three times the range of its pore pressure kernel"):
        liquefy(short, config)


@pytest.fixture(scope="module")
def level() -> tuple[DiscModel, Ground]:
    """Twenty columns and eight rows of a lattice; the lower three rows are a layer of their own."""
    packing = lattice_box(20, 8, RADIUS)
    packing.layer[packing.free & (packing.z < 3.0 * RADIUS * np.sqrt(3.0) + RADIUS)] = 1
    ground = Ground(packing, "lattice", RADIUS, 0, 0.0, (0.0, 0.0), 1)
    layers = [LOOSE, replace(LOOSE, name="loose", effective_density=0.5 * LOOSE.effective_density)]
    return packing.discs(DiscMaterials(layers, law="soil", turns=False), gravity=(0.0, -GRAVITY)), ground


def test_overburden_is_the_weight_above(level: tuple[DiscModel, Ground]) -> None:
    """Of level ground with a buoyant layer below: within 3 % in the middle, 15 % beside the walls."""
    model = level[0]
    values = effective_overburden(model)
    row = np.round(model.z / (np.sqrt(3.0) * RADIUS)).astype(int)
    free = ~model.fixed
    lowest, top = int(row[free].min()), int(row[free].max())
    down = np.array([(-model.mass * model.pull[1])[free & (row == k)].mean() for k in range(lowest, top + 1)])
    expected = (np.cumsum(down[::-1])[::-1] - 0.5 * down) / (2.0 * RADIUS)
    middle = free & (np.abs(model.x - model.x.mean()) < 6.0 * RADIUS)
    for k in range(lowest, top + 1):
        assert values[middle & (row == k)] == pytest.approx(expected[k - lowest], rel=0.03)
    assert values[free] == pytest.approx(expected[row[free] - lowest], rel=0.15)


def test_residual_strength_of_a_case(level: tuple[DiscModel, Ground]) -> None:
    """A ratio of the overburden, or so many kPa, less at the lower edge; reached at s/G and 2 % of bonds in series, at
    0.4 % of bonds at least."""
    model, ground = level
    loose = model.layer == 1
    away = loose & (model.z > model.z[loose].min() + (2.0 * BAND - 1.0) * RADIUS)
    ratio = residual(model, ground, [1], Case(residual=0.1))
    assert (ratio.discs == loose).all()
    assert ratio.strength[loose] == pytest.approx(0.1 * effective_overburden(model)[loose])
    assert (ratio.strength[~loose] == 0.0).all()
    assert (ratio.strain[loose] == SMALLEST_STRAIN).all()
    firm = residual(model, ground, [1], Case(residual_strength="8 kPa", stiffness=0.05))
    assert firm.strength[away] == pytest.approx(8e3)
    modulus = 0.05 * SHEAR_MODULUS * LOOSE.kn
    by_modulus = BOND_STRAIN_RATIO * firm.strength[loose] / modulus
    assert firm.strain[loose] == pytest.approx(1.0 / (1.0 / by_modulus + 1.0 / LARGEST_STRAIN))
    assert ratio.area[~model.fixed] == pytest.approx(2.0 * np.sqrt(3.0) * RADIUS**2, rel=0.01)
    liquefy(model, ratio)
    assert model.liquefied[loose, STRENGTH] == pytest.approx(ratio.strength[loose])
    assert model.liquefied[loose, STRAIN] == pytest.approx(SMALLEST_STRAIN)
