"""Strength of liquefied discs above the lower edge of their layer."""

from dataclasses import replace

import numpy as np
import pytest

from dem import DiscMaterials, DiscModel
from dem.disc_area import area_with_voids
from dem.overburden import effective_overburden
from dem.packing import lattice_box
from dem.slides.edge_strength import BAND, LEAST_SHARE, edge_shares
from tests.unit.dem.test_liquefied_ground import LOOSE

RADIUS, GRAVITY = 0.5, 9.81
ROWS, ROW_HEIGHT = 30, np.sqrt(3.0) * RADIUS
MIDDLE = 12  # first row of the upper layers


def lattice(upper: int = 0) -> DiscModel:
    """Return thirty rows of a lattice: stratum 1 below row 12, stratum ``upper`` from there on."""
    packing = lattice_box(16, ROWS, RADIUS)
    packing.layer[packing.free] = np.where(packing.z[packing.free] < MIDDLE * ROW_HEIGHT, 1, upper)
    layers = [LOOSE, replace(LOOSE, name="low"), replace(LOOSE, name="high")]
    return packing.discs(DiscMaterials(layers, law="soil", turns=False), gravity=(0.0, -GRAVITY))


def shares(model: DiscModel, liquefies: np.ndarray, strength: np.ndarray, increase: float = 0.0) -> np.ndarray:
    pressure, area = effective_overburden(model), area_with_voids(model)
    return edge_shares(model, liquefies, strength, np.full(len(model), increase), pressure, area)


def test_a_constant_strength_falls_with_the_overburden_in_the_band() -> None:
    """Closed form: a band at the height h slips at the Kh of the edge with s p(h) / (p(h) + γ h)."""
    model = lattice()
    low = (model.layer == 1) & ~model.fixed
    share = shares(model, low, np.where(low, 8e3, 0.0))
    height = model.z - (model.z[low].min() - RADIUS)
    band = low & (height < BAND * 2.0 * RADIUS)
    unit_weight = GRAVITY * float((model.mass * model.weight / area_with_voids(model))[band][0])
    above = effective_overburden(model)
    assert share[band] == pytest.approx((above / (above + unit_weight * height))[band])
    assert (share[band] < 0.99).all()
    assert (share[band] > 0.9).all()
    assert (share[~band] == 1.0).all()


def test_a_strength_in_proportion_to_the_overburden_stays() -> None:
    model = lattice()
    low = (model.layer == 1) & ~model.fixed
    assert shares(model, low, np.where(low, 0.1 * effective_overburden(model), 0.0), 0.1) == pytest.approx(1.0)


def test_thin_ground_keeps_four_fifths() -> None:
    """All rows liquefy: at the surface there is next to no overburden, but the edge is far; in two rows it is near."""
    model = lattice(upper=1)
    free = ~model.fixed
    top = free & (model.z > np.sort(np.unique(model.z[free].round(3)))[-3])
    share = shares(model, top, np.where(top, 8e3, 0.0))
    assert share[top].min() == LEAST_SHARE
    assert shares(model, free, np.where(free, 8e3, 0.0))[top] == pytest.approx(1.0)


def test_other_liquefied_ground_below_is_no_edge() -> None:
    model = lattice(upper=2)
    free, high = ~model.fixed, model.layer == 2
    both = shares(model, free, np.where(free, 8e3, 0.0))
    assert (both[high] == 1.0).all()
    alone = shares(model, high & free, np.where(high & free, 8e3, 0.0))
    assert alone[high & free].min() < 0.97
