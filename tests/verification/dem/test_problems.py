"""Columns and uniform slopes of soil discs, against what is known of them."""

import numpy as np
import pytest

import dem
from docs.verify.slides.uniform_slope import UniformSlope

RADIUS, DENSITY, G = 0.5, 1800.0, 9.81


def sand(height: float) -> dem.SoilContacts:
    return dem.soil_contacts(0.0, np.radians(33.0), DENSITY * G * 0.5 * height)


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
    push = slope.push(0.2, 2.0, later=10.0)
    assert push.rest.rested
    assert abs(push.slide[-1]) < 0.05


def test_a_column_of_clay_that_stands() -> None:
    """A vertical cut with gamma H / su = 3 stands (known: below 3.83); its front moves by less than H/20."""
    height, width = 10.0, 10.0
    su = DENSITY * G * height / 3.0
    clay = dem.soil_contacts(su, 0.0, 0.5 * DENSITY * G * height, 300.0 * su)
    column = dem.SoilColumn(width, height, RADIUS, lambda e: [clay.discs("clay", DENSITY, RADIUS, e)], reach=3.0)
    column.settle()
    assert column.porosity == pytest.approx(0.22, abs=0.03)
    rest = column.release()
    out = dem.run_out(column.model)
    assert rest.rested
    assert out.loose < 0.03  # some discs of the face have too few neighbours to hold on to
    assert (out.front - width) / height < 0.05


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
    push = slope.push(2.0 * critical, 6.0, layer=1, later=1.0)
    assert push.strength()[0] == pytest.approx(ratio, rel=0.15)
