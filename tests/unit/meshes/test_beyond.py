"""A section that goes on past its ends: ground, layers, base and water, in every shape that lines can have."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshes.gmsh_model import generate
from meshes.section.section import Section
from meshes.settings import MeshSettings
from meshes.triangles import triangulate
from tests.support.sections import assert_conforming, layer, sections, slope


def continued(**changes: Any) -> Section:
    return Section.parse({**slope(), "beyond": "50 m", **changes})


def test_level_ground_goes_on_at_the_height_of_the_ends() -> None:
    """20 m high at x = 0 and 10 m at x = 100; the upper layer is 4 m thick all along."""
    section = continued()
    assert (section.extent, section.given_extent) == ((-50.0, 150.0), (0.0, 100.0))
    np.testing.assert_allclose(section.layering.areas(), [4.0 * 200.0, 1100.0 + 50.0 * 16.0 + 50.0 * 6.0])
    assert section.stratum_at(np.array([-49.0, 149.0]), np.array([15.0, 7.0])).tolist() == [1, 0]
    assert section.notices == [
        "beyond: ground, layers and water continue for 50 m past x = 0 and 100 m, level",
    ]


def test_ground_that_goes_on_by_its_slope_keeps_every_thickness() -> None:
    section = continued(beyond_slope="parallel")
    np.testing.assert_allclose(section.ground, [[-50, 25], [0, 20], [100, 10], [150, 5]])
    at_left, at_right = section.layering.thickness()
    np.testing.assert_allclose([at_left[0], at_right[-1]], [[4.0, 16.0], [4.0, 6.0]])


def test_water_goes_on_too() -> None:
    points = continued(water_table={"elevation": [[0, 12], [100, 6]]}).water_points()
    np.testing.assert_allclose(points, [[-50, 12], [0, 12], [100, 6], [150, 6]])
    deep = continued(water_table={"depth": 2.0}).water_points()
    assert deep is not None
    np.testing.assert_allclose(deep[[0, -1]], [[-50, 18], [150, 8]])


def test_a_layer_that_ends_inside_does_not_come_again() -> None:
    lens = layer("lens", bottom={"depth": [[20, 4], [50, 6], [80, 4]]})
    strata = [slope()["strata"][0], lens, slope()["strata"][1]]
    given_area, area = (
        Section.parse({**slope(), "strata": strata, **more}).layering.areas()[1] for more in ({}, {"beyond": "50 m"})
    )
    assert area == pytest.approx(given_area)


@settings(deadline=None)
@given(section=sections(), distance=st.floats(1.0, 300.0), ends=st.sampled_from(["level", "parallel"]))
def test_inside_its_ends_a_section_is_what_it_was(section: Section, distance: float, ends: str) -> None:
    wide = Section.model_validate({**dict(section), "beyond": distance, "beyond_slope": ends})
    rng = np.random.default_rng(1)
    left, right = section.extent
    x = rng.uniform(left, right, 200)
    z = rng.uniform(section.ground[:, 1].min() - 5.0, section.ground[:, 1].max(), 200)
    assert np.mean(wide.stratum_at(x, z) == section.stratum_at(x, z)) > 0.97  # points of lines snap a millimetre apart
    assert wide.extent == pytest.approx((left - distance, right + distance))
    first, last = wide.layering.thickness()[0][0], wide.layering.thickness()[1][-1]
    np.testing.assert_allclose(first, section.layering.thickness()[0][0], atol=0.011)
    np.testing.assert_allclose(last, section.layering.thickness()[1][-1], atol=0.011)


def test_quadrilaterals_and_triangles_reach_the_far_sides_with_larger_cells_there() -> None:
    section, wanted = continued(), MeshSettings(method="free", size=1.5)
    mesh = generate(section, wanted)
    assert_conforming(mesh, section, wanted)
    x = mesh.points[mesh.cells].mean(axis=1)[:, 0]
    size = np.ptp(mesh.points[mesh.cells][..., 0], axis=1)
    assert np.median(size[x < -20.0]) > 2.0 * np.median(size[(x > 0.0) & (x < 100.0)])
    assert np.ptp(triangulate(section, 3.0).points[:, 0]) == pytest.approx(200.0)
