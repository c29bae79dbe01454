"""Columns and uniform slopes of soil discs, against what is known of them."""

from itertools import product

import numpy as np
import pytest

import dem
from docs.verify.slides.uniform_slope import UniformSlope

RADIUS, DENSITY, G = 0.5, 1800.0, 9.81


def sand(height: float) -> dem.SoilContacts:
    return dem.soil_contacts(0.0, np.radians(33.0), DENSITY * G * 0.5 * height)


def clay_column(height: float, width: float, radius: float, ratio: float, seed: int = 0) -> dem.SoilColumn:
    """A column of clay at rest behind its gate; ratio: gamma H / su."""
    su = DENSITY * G * height / ratio
    clay = dem.soil_contacts(su, 0.0, 0.5 * DENSITY * G * height, 300.0 * su)
    column = dem.SoilColumn(
        width, height, radius, lambda e: [clay.discs("clay", DENSITY, radius, e)], seed=seed, reach=4.0
    )
    column.settle()
    return column


def test_a_uniform_slope_carries_its_weight() -> None:
    """Normal stress at the base of each layer is rho g h cos b; Kh below the yield coefficient moves nothing far."""
    contacts = sand(10.0)
    slope = UniformSlope(
        np.radians(4.0), [4.0, 6.0], RADIUS,
        lambda e: [contacts.discs(name, DENSITY, RADIUS, e) for name in ("low", "crust")], length=16.0,
    )  # fmt: skip
    for layer, depth in ((0, 10.0), (1, 6.0)):
        expected = DENSITY * G * depth * np.cos(np.radians(4.0))
        model = slope.model
        on_it = ~model.fixed & (model.layer >= layer)
        weight = float((model.mass * model.weight)[on_it].sum()) * G * np.cos(np.radians(4.0))
        assert weight / model.period[0] == pytest.approx(expected, rel=0.05)
    slope_response = slope.shake_constant(0.2, 2.0, later=10.0)
    assert slope_response.rest.rested
    assert abs(slope_response.slide[-1]) < 0.05


@pytest.mark.parametrize("ratio", [3.0, 3.5])
def test_a_column_of_clay_that_stands(ratio: float) -> None:
    """A vertical cut stands below gamma H / su = 3.83 (limit analysis): 98 % of its mass stays within H/50 of it, and
    its face bulges by less than H/12 before the strength of clay is reached."""
    column = clay_column(10.0, 10.0, RADIUS, ratio)
    assert column.porosity == pytest.approx(0.22, abs=0.03)
    rest = column.release()
    out = dem.run_out(column.model)
    assert rest.rested
    assert out.loose == 0.0
    assert (out.x98 - 10.0) / 10.0 < 0.02
    assert (out.front - 10.0) / 10.0 < 0.08


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1])
def test_a_slump_of_clay_let_go_at_once(seed: int) -> None:
    """gamma H / su = 10, half width 2 H: continua in large displacement (MPM) run 1.6 to 2.1 H by their transfer
    scheme; 0 to 1 % of the discs leave the ground."""
    column = clay_column(30.0, 60.0, 0.9, 10.0, seed)
    column.release()
    out = dem.run_out(column.model)
    assert out.loose < 0.02
    assert 1.6 <= (out.front - 60.0) / 30.0 <= 2.1


@pytest.mark.slow  # a layer on firm ground is fast, in test_periodic_section.py
@pytest.mark.parametrize(("base", "rows", "seed"), product((2.0, 0.0), (2, 4, 8), (0, 1)))
def test_a_liquefied_layer_of_constant_strength_holds_it_at_its_edge(base: float, rows: int, seed: int) -> None:
    """Statics of an endless slope as below: 0.95 to 1.07 of the strength over the weight above the lower edge, between
    rough ground or on the base; up to 1.13 if the strength were the same throughout the layer, whose discs shear in a
    band above its edge."""
    angle, ratio, radius, crust = np.radians(2.6), 0.2, 0.25, 5.0
    thickness = rows * np.sqrt(3.0) * radius
    contacts = sand(base + thickness + crust)
    layers = [base, thickness, crust] if base else [thickness, crust]
    names = ("base", "loose", "crust")[-len(layers) :]
    slope = UniformSlope(
        angle, layers, radius, lambda e: [contacts.discs(name, DENSITY, radius, e) for name in names], length=12.0,
        seed=seed,
    )  # fmt: skip
    weak, model = len(layers) - 2, slope.model
    on_edge = ~model.fixed & (model.layer >= weak)
    pressure = G * np.cos(angle) * float((model.mass * model.weight)[on_edge].sum()) / model.period[0]
    slope.liquefy([weak], dem.Case(residual_strength=ratio * pressure))
    critical = (ratio - np.tan(angle)) / (1.0 + ratio * np.tan(angle))
    slope_response = slope.shake_constant(2.0 * critical, 6.0, layer=weak, later=1.0)
    assert slope_response.strength()[0] == pytest.approx(ratio, rel=0.08)


@pytest.mark.slow
def test_a_liquefied_layer_between_dry_ones_holds_what_was_asked() -> None:
    """Statics of an endless slope (Newmark 1965): accelerations at twice the yield coefficient show the strength.

    Layers of 2 to 8 rows hold 1.07 to 1.13 of what is asked; about 0.05 of it is that their uppermost discs lie lower
    than the plane between layer and crust."""
    angle, ratio, radius = np.radians(2.6), 0.2, 0.25
    contacts = sand(12.0)
    slope = UniformSlope(
        angle, [2.0, 2.0, 5.0], radius,
        lambda e: [contacts.discs(name, DENSITY, radius, e) for name in ("base", "loose", "crust")], length=12.0,
    )  # fmt: skip
    slope.liquefy([1], dem.Case(residual=ratio))
    critical = (ratio - np.tan(angle)) / (1.0 + ratio * np.tan(angle))
    slope_response = slope.shake_constant(2.0 * critical, 6.0, layer=1, later=1.0)
    assert slope_response.strength()[0] == pytest.approx(ratio, rel=0.15)
