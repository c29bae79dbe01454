"""From a section to discs: counts, frames, layers, and what is refused."""

import numpy as np
import pytest

from dem.ground import Ground, ground_of, in_stratum, springs_of
from dem.settings import DemSettings
from meshes.errors import InputError
from meshes.section.section import Section
from tests.support import SECTIONS
from tests.support.sections import slope

S13 = SECTIONS / "s13.toml"


def s13(**settings: object) -> tuple[Section, Ground]:
    section = Section.read(S13)
    return section, ground_of(section, DemSettings(model="paper", radius=0.75, **settings))  # type: ignore[arg-type]


def test_s13_has_the_papers_counts() -> None:
    """Sec. 3(3): 3 180 elements and 189 boundary elements, 24 rows (paper-notes: 12 x (133 + 132))."""
    section, ground = s13()
    assert (ground.kind, ground.rows) == ("box", 24)
    assert int(ground.packing.free.sum()) == 3180
    assert int((~ground.packing.free).sum()) == 189
    assert np.degrees(ground.tilt) == pytest.approx(2.6, abs=0.01)
    assert ground.downhill == 1
    assert len(np.unique(ground.packing.layer[ground.packing.free])) == len(section.strata)


def test_rows_lie_along_the_surface_and_discs_in_their_stratum() -> None:
    section, ground = s13()
    free = ground.packing.free
    x, z = ground.to_section(ground.packing.x[free], ground.packing.z[free])
    surface = np.interp(x, *np.array(section.surface).T)
    depth = (surface - z) * np.cos(ground.tilt)
    assert depth.min() == pytest.approx(0.75, abs=1e-9)
    assert depth.max() == pytest.approx(0.75 + 23 * 0.75 * np.sqrt(3.0), abs=1e-9)
    inside = section.stratum_at(x, z)
    assert np.array_equal(ground.packing.layer[free][inside >= 0], inside[inside >= 0])
    assert np.mean(inside < 0) < 0.01  # a box leans out of the vertical sides by a disc


def test_gravity_is_vertical_in_the_section() -> None:
    section, ground = s13()
    model = ground.model(springs_of(section, DemSettings(model="paper", radius=0.75), 0.75), DemSettings(model="paper"))
    gx, gz = ground.to_section_axes(*(np.array(g) for g in model.gravity))
    assert (float(gx), float(gz)) == pytest.approx((0.0, -9.80665), abs=1e-12)
    shaking = ground.shaking(0.0, 0.2, 1.0, 2.0)
    ax, az = ground.to_section_axes(shaking.x, shaking.z)
    assert ax[[0, -1]] == pytest.approx([0.0, 0.2 * 9.80665])
    assert az == pytest.approx(0.0, abs=1e-12)


def test_ground_that_falls_to_the_left_is_the_mirror_image() -> None:
    data = slope()
    data["surface"] = [[0.0, 10.0], [100.0, 20.0]]
    data["base"] = {"depth": 10.0}
    section = Section.parse(data)
    ground = ground_of(section, DemSettings(model="paper", packing="box", radius=0.5))
    assert (ground.downhill, ground.tilt < 0.0) == (-1, True)
    ax, _ = ground.to_section_axes(*(np.array(v) for v in (ground.shaking(0.0, 0.1, 0.0, 1.0).x, np.zeros(65))))
    assert ax[-1] < 0.0


@pytest.mark.parametrize("packing", ["lattice", "random"])
def test_other_sections_are_cut_to_their_outline(packing: str) -> None:
    section = Section.parse(slope())
    ground = ground_of(section, DemSettings(model="paper", packing=packing, elements=400, porosity=0.2))  # type: ignore[arg-type]
    assert ground.kind == packing
    assert ground.packing.free.sum() == pytest.approx(400, rel=0.25)  # none where half a disc would stick out
    assert ground.tilt == 0.0


@pytest.mark.parametrize("elements", [300, *(pytest.param(count, marks=pytest.mark.slow) for count in (100, 1000))])
def test_a_packing_too_dense_for_its_walls_gets_a_little_more_room(elements: int) -> None:
    section = Section.parse(slope())
    ground = ground_of(section, DemSettings(model="paper", packing="random", elements=elements, porosity=0.19))
    solid = np.sum(np.pi * ground.packing.radius[ground.packing.free] ** 2) / section.layering.areas().sum()
    assert 0.71 <= solid <= 0.82


def test_auto_takes_a_box_only_where_it_fits() -> None:
    assert ground_of(Section.parse(slope()), DemSettings(model="paper", elements=300)).kind == "random"
    with pytest.raises(InputError, match='packing = "box": expected a straight surface'):
        ground_of(Section.parse(slope()), DemSettings(model="paper", packing="box", elements=300))


def test_table2_wants_ten_strata_and_settings_that_fit() -> None:
    section = Section.parse(slope())
    settings = DemSettings(model="paper", springs="table2", radius=5.0, range=(2.0, 1.0))
    problems = settings.problems(section)
    assert len(problems) == 3
    assert "ten strata" in problems[0]
    assert "radius = 5 m: expected at most" in problems[1]
    assert "range" in problems[2]


def test_springs_carry_the_names_of_the_strata() -> None:
    section = Section.read(S13)
    for springs in ("soil", "table2"):
        layers = springs_of(section, DemSettings(model="paper", springs=springs), 0.75)  # type: ignore[arg-type]
        assert [layer.name for layer in layers] == [stratum.name for stratum in section.strata]


def test_discs_above_the_surface_or_below_the_base_are_of_the_ground_there() -> None:
    """However far: in a narrow section a disc on top of another stands out by more than 2 % of the width."""
    section = Section.parse(slope())
    x, z = np.array([-1.0, 50.0, 50.0, 50.0, 50.0, 101.0]), np.array([21.0, 40.0, 15.0, 10.9, -9.0, 3.0])
    assert in_stratum(section, x, z).tolist() == [0, 0, 0, 1, 1, 1]
