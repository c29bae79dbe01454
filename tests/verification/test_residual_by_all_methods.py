"""Residual strength of one case by elements, both bounds, material points and discs, below a surcharge.

Level ground 30 m wide: 4 m of crust of 18 kN/m³ over sand of 18 kN/m³ with φ = 30° and c = 4 kPa, dry, with 40 kPa from
x = 10 to 20 m. The σ'v that a ratio multiplies has the share of the load under which the ground has consolidated: in
the middle below the load, at a depth d, 18 d + 40 times that share.
"""

import numpy as np
import pytest

from dem.case import Case
from dem.ground import Ground
from dem.model import DiscModel
from dem.packing import lattice_box
from dem.settings import DemSettings
from dem.slides.edge_strength import BAND
from dem.slides.liquefied_strength import residual
from fem.continuum.liquefied_ground import liquefied_section
from fem.mpm.changes import changes_of
from fem.mpm.ground import ground_of
from fem.mpm.slide import PointSlider
from meshes.section.liquefies import RemainingStrength
from meshes.section.section import Section
from meshes.triangles import triangulate
from tests.support.dem_cases import RADIUS
from tests.support.liquefied import sand
from tests.support.water import soil

LOAD, TAN = 40.0, np.tan(np.pi / 6.0)


def section(consolidated: float) -> Section:
    load = {"from": 10.0, "to": 20.0, "pressure": "40 kPa", "consolidated": consolidated}
    dry = {"density": "18 kN/m^3", "density_saturated": "18 kN/m^3", "cohesion": "4 kPa", "friction_angle": "30 deg"}
    return Section.parse({
        "name": "level", "surface": [[0.0, 10.0], [30.0, 10.0]], "base": {"elevation": 0.0}, "surcharges": [load],
        "strata": [soil("Crust", bottom={"elevation": 6.0}, **dry), soil("Sand", **dry)],
    })  # fmt: skip


def of_elements(ground: Section, remaining: RemainingStrength, place: tuple[float, float]) -> float:
    """Cohesion (kPa) by the field of elements and slices."""
    at = np.array([place])
    return float(liquefied_section(ground, {1: remaining}).cohesion_field.at(at, at, np.array([1]))[0]) / 1e3


def of_bounds(ground: Section, remaining: RemainingStrength, place: tuple[float, float], above: bool) -> float:
    """Cohesion (kPa) in the middle of the triangle around a place."""
    section = liquefied_section(ground, {1: remaining})
    mesh = triangulate(section, 1.0)
    corners = mesh.points[mesh.cells]
    near = np.hypot(*(corners.mean(axis=1) - np.array(place)).T).argmin()
    result = section.cohesion_field.corners(corners[[near]], mesh.stratum[[near]], above)[0]
    height = float(corners[near, :, 1].mean()) - place[1]
    return float(result.mean()) / 1e3 + height * 18.0 * remaining.residual


def of_points(ground: Section, remaining: RemainingStrength, x: float) -> np.ndarray:
    """Cohesion times cos φ (kPa), less what 18 kN/m³ above makes of the ratio, of the material points of the sand."""
    points = ground_of(ground, 600)
    slider = PointSlider(points, 1)
    after = changes_of(points, slider.engine, {1: remaining})["after"]
    places, stratum = (slider.engine.original(of) for of in (points.points.x, points.points.stratum))
    below = (stratum == 1) & (abs(places[:, 0] + points.offset[0] - x) < 2.0)
    depth = 10.0 - (places + points.offset)[below, 1]
    return after[below, 0] / 1e3 - remaining.residual * 18.0 * depth


def of_discs(ground: Section, case: Case) -> tuple[DiscModel, np.ndarray]:
    """A lattice of discs in the place of the ground, and their strength (kPa)."""
    packing = lattice_box(20, 8, RADIUS)
    packing.layer[packing.free & (packing.z < 6.0)] = 1
    laid = Ground(packing, "lattice", RADIUS, 0, 0.0, (0.0, 0.0), 1, ground)
    model = laid.model([sand(3e7, 0.5), sand(3e7, 0.5)], DemSettings())
    return model, residual(model, laid, [1], case).strength / 1e3


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_a_ratio_counts_the_load_to_which_the_ground_has_consolidated(share: float) -> None:
    ground, case, place = section(share), Case(residual=0.1), (15.1, 3.1)
    remains = case.remains_of(ground, 1)
    assert remains == RemainingStrength(0.0, 0.0, 0.1)
    expected = 0.1 * (18.0 * 6.9 + share * LOAD)
    assert of_elements(ground, remains, place) == pytest.approx(expected)
    for above in (False, True):
        assert of_bounds(ground, remains, place, above) == pytest.approx(expected)
    assert of_points(ground, remains, 15.0) == pytest.approx(0.1 * share * LOAD)
    assert of_points(ground, remains, 4.0) == pytest.approx(0.0, abs=1e-9)
    model, strength = of_discs(ground, case)
    below = (model.layer == 1) & ~model.fixed & (abs(model.x - 15.0) < 2.0)
    none = of_discs(section(0.0), case)[1]
    assert (strength - none)[below] == pytest.approx(0.1 * share * LOAD)
    assert (strength - none)[(model.layer == 1) & (model.x < 8.0)] == pytest.approx(0.0)


def test_the_mean_stress_that_reports_divide_by_is_the_same() -> None:
    """The sand from 4 to 10 m: 18 x 7 kPa, and a third of the load."""
    assert section(0.0).cohesion_field.mean_effective_stress(1) == pytest.approx(126e3)
    assert section(1.0).cohesion_field.mean_effective_stress(1) == pytest.approx((126.0 + LOAD / 3.0) * 1e3, rel=0.01)


@pytest.mark.parametrize(
    ("case", "counts"),
    [
        (Case(residual=0.1, friction=0.5), RemainingStrength(0.0, 0.5, 0.0)),  # 0.29 σ'v
        (Case(residual=0.1, friction=0.1, cohesion=0.5), RemainingStrength(0.0, 0.0, 0.1)),  # 12.6 kPa for 2 + 7.3
        (Case(residual_strength="5 kPa", cohesion=0.5), RemainingStrength(0.0, 0.0, 0.0, 5e3)),
        (Case(residual_strength="1 kPa", cohesion=0.5), RemainingStrength(0.5, 0.0, 0.0)),
        (Case(friction=0.2), RemainingStrength(0.0, 0.2, 0.0)),
    ],
)
def test_residual_strength_or_what_friction_and_cohesion_leave(case: Case, counts: RemainingStrength) -> None:
    """The larger one at the mean stress of the stratum counts for every method, and never their sum."""
    ground = section(0.0)
    remains = case.remains_of(ground, 1)
    assert remains == counts
    stress = 18.0 * 6.9
    expected = counts.residual * stress + counts.strength / 1e3 + counts.cohesion * 4.0
    assert of_elements(ground, remains, (5.1, 3.1)) == pytest.approx(expected)
    assert of_bounds(ground, remains, (5.1, 3.1), False) == pytest.approx(expected)
    cosine = np.cos(np.arctan(counts.friction * TAN))
    assert of_points(ground, remains, 5.0) == pytest.approx(
        (counts.strength / 1e3 + counts.cohesion * 4.0) * cosine, abs=1e-9
    )
    model, strength = of_discs(ground, case)
    alone = of_discs(ground, Case(residual=0.1))[1] / 0.1  # their own σ'v
    away_from_edge = model.z > model.z[~model.fixed].min() + (2.0 * BAND - 1.0) * RADIUS
    here = (model.layer == 1) & ~model.fixed & (model.x < 8.0) & away_from_edge
    by_discs = (counts.residual + counts.friction * TAN) * alone + counts.strength / 1e3 + counts.cohesion * 4.0
    assert strength[here] == pytest.approx(by_discs[here])
