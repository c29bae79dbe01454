from typing import Any

import numpy as np
import pytest

from meshes.section.section import Section
from tests.support.sections import layer, slope


def section(surface: Any, base: Any, *bottoms: Any) -> Section:
    strata = [layer(f"layer {k}", bottom=bottom) if bottom else layer(f"layer {k}") for k, bottom in enumerate(bottoms)]
    return Section.parse({"name": "test", "surface": surface, "base": base, "strata": strata})


def shoelace(polygon: np.ndarray) -> float:
    x, z = polygon.T
    return float(0.5 * (x * np.roll(z, -1) - np.roll(x, -1) * z).sum())


def test_areas_of_trapezoids() -> None:
    # 100 m wide: a layer 4 m thick all along, the rest 16 m high on the left and 6 m on the right.
    np.testing.assert_allclose(Section.parse(slope()).layering.areas(), [400.0, 1100.0], rtol=1e-14)


def test_area_of_a_lens_that_pinches_out() -> None:
    # A triangle of 40 m by 3 m: begins and ends on the bottom of the first layer.
    lens = {"depth": [[20.0, 4.0], [30.0, 7.0], [60.0, 4.0]]}
    layers = section([[0.0, 20.0], [100.0, 20.0]], {"elevation": 0.0}, {"depth": 4.0}, lens, None).layering
    np.testing.assert_allclose(layers.areas(), [400.0, 60.0, 1540.0], rtol=1e-14)
    (triangle,) = layers.polygons(1)
    assert {tuple(point) for point in triangle.tolist()} == {(20.0, 16.0), (30.0, 13.0), (60.0, 16.0)}
    assert shoelace(triangle) == pytest.approx(60.0)
    at = layers.stratum_at(np.array([30.0, 30.0, 30.0, 19.0, 61.0]), np.array([17.0, 14.0, 12.0, 15.9, 15.9]))
    np.testing.assert_array_equal(at, [0, 1, 2, 2, 2])


def test_lateral_neighbours_meet_in_a_vertical_face() -> None:
    left, right = {"depth": [[0.0, 5.0], [40.0, 5.0]]}, {"depth": [[40.0, 5.0], [100.0, 5.0]]}
    layers = section([[0.0, 20.0], [100.0, 20.0]], {"elevation": 0.0}, {"depth": 1.0}, left, right, None).layering
    np.testing.assert_allclose(layers.areas(), [100.0, 160.0, 240.0, 1500.0], rtol=1e-14)
    np.testing.assert_array_equal(layers.stratum_at(np.array([39.0, 41.0]), np.array([17.0, 17.0])), [1, 2])
    corners = {tuple(point) for point in layers.polygons(1)[0].tolist()}
    assert corners == {(0.0, 19.0), (0.0, 15.0), (40.0, 15.0), (40.0, 19.0)}


def test_a_layer_that_comes_out_of_the_ground() -> None:
    # Ground falls from 20 to 0 m over 100 m; a level bottom at 10 m meets it at x = 50 m: a triangle of 50 by 10 m.
    layers = section([[0.0, 20.0], [100.0, 0.0]], {"elevation": -10.0}, {"elevation": 10.0}, None).layering
    np.testing.assert_allclose(layers.areas(), [250.0, 1750.0], rtol=1e-14)
    np.testing.assert_allclose(layers.x, [0.0, 50.0, 100.0])


def test_a_vertical_step_of_the_ground() -> None:
    surface = [[0.0, 10.0], [30.0, 10.0], [30.0, 4.0], [50.0, 4.0]]
    cut = section(surface, {"elevation": 0.0}, None)
    assert cut.layering.areas() == pytest.approx([30 * 10 + 20 * 4])
    assert shoelace(cut.outline()) == pytest.approx(380.0)
    assert len(cut.outline()) == 6
    np.testing.assert_array_equal(cut.stratum_at(np.array([29.0, 31.0, 31.0]), np.array([9.0, 9.0, 3.0])), [0, -1, 0])


def test_a_vertical_step_of_an_interface() -> None:
    stepped = {"depth": [[0.0, 2.0], [30.0, 2.0], [30.0, 5.0], [50.0, 5.0]]}
    layers = section([[0.0, 10.0], [50.0, 10.0]], {"elevation": 0.0}, stepped, None).layering
    np.testing.assert_allclose(layers.areas(), [60.0 + 100.0, 240.0 + 100.0], rtol=1e-14)
    assert len(layers.polygons(0)) == 1


def test_one_interface_has_the_heights_of_all() -> None:
    surface = [[0.0, 10.0], [30.0, 10.0], [30.0, 4.0], [50.0, 6.0]]
    layers = section(surface, {"elevation": 0.0}, {"depth": 1.0}, None).layering
    x = np.array([0.0, 12.5, 30.0, 50.0])
    for near in (None, np.array([1.0, 29.0, 29.0, 49.0])):
        for number in (0, 1, -1):
            np.testing.assert_array_equal(layers.interface(number, x, near), layers.interfaces(x, near)[:, number])


def test_pieces_that_touch_in_one_point_are_two_polygons() -> None:
    bottom = {"depth": [[0.0, 2.0], [50.0, 0.0], [100.0, 2.0]]}
    layers = section([[0.0, 10.0], [100.0, 10.0]], {"elevation": 0.0}, bottom, None).layering
    assert [shoelace(polygon) for polygon in layers.polygons(0)] == pytest.approx([50.0, 50.0])


def test_points_outside_belong_to_no_stratum() -> None:
    at = Section.parse(slope()).stratum_at(
        np.array([-1.0, 101.0, 50.0, 50.0, 50.0]), np.array([1.0, 1, 15.1, -0.1, 14])
    )
    np.testing.assert_array_equal(at, [-1, -1, -1, -1, 0])


def test_depths_and_elevations_describe_the_same_line() -> None:
    surface = [[0.0, 20.0], [100.0, 10.0]]
    by_depth = section(surface, {"depth": 12.0}, {"depth": [[0.0, 2.0], [100.0, 6.0]]}, None)
    by_elevation = section(
        surface, {"elevation": [[0.0, 8.0], [100.0, -2.0]]}, {"elevation": [[0.0, 18.0], [100.0, 4.0]]}, None
    )
    np.testing.assert_allclose(by_depth.layering.areas(), by_elevation.layering.areas(), rtol=1e-14)


def test_a_water_table_given_as_depth_follows_the_ground() -> None:
    data = {**slope(), "water_table": {"depth": [[0.0, 2.0], [50.0, 2.0], [50.0, 1.0], [100.0, 1.0]]}}
    points = Section.parse(data).water_points()
    np.testing.assert_allclose(points, [[0.0, 18.0], [50.0, 13.0], [50.0, 14.0], [100.0, 9.0]])


# --- points that are all but one ----------------------------------------------------------------------------------


def test_a_layer_of_a_fifth_of_a_millimetre_is_nothing_there_and_it_is_said() -> None:
    """At x = 40 m the bottom lies 0.2 mm below the ground: less than a centimetre."""
    bottom = {"depth": [[0.0, 3.0], [40.0, 0.0002], [100.0, 2.0]]}
    ground = section([[0.0, 20.0], [100.0, 20.0]], {"elevation": 0.0}, bottom, None)
    assert ground.layering.thickness()[0][1, 0] == 0.0
    (notice,) = ground.notices
    assert notice.startswith('geometry: stratum "layer 0" is 0.2 mm thick at x = 40 m: less than 10 mm is neglected')


def test_a_sound_section_has_nothing_to_be_told() -> None:
    bottom = {"depth": [[0.0, 3.0], [40.0, 0.02], [100.0, 2.0]]}
    ground = section([[0.0, 20.0], [100.0, 20.0]], {"elevation": 0.0}, bottom, None)
    assert (ground.notices, ground.layering.thickness()[0][1, 0]) == ([], pytest.approx(0.02))


def test_a_model_in_a_box_is_measured_in_tenths_of_millimetres() -> None:
    """A box of 0.4 m: a two-thousandth of it, 0.2 mm, is what counts."""
    thin = {"depth": 0.001}
    ground = section([[0.0, 0.4], [1.0, 0.4]], {"elevation": 0.0}, thin, None)
    assert ground.layering.tolerance == pytest.approx(0.0002)
    assert ground.layering.areas()[0] == pytest.approx(0.001)


def test_points_a_millimetre_apart_are_a_vertical_step() -> None:
    cut = section([[0.0, 10.0], [30.0, 10.0], [30.001, 4.0], [50.0, 4.0]], {"elevation": 0.0}, None)
    assert cut.layering.x.tolist() == [0.0, 30.0, 50.0]
    assert cut.layering.areas() == pytest.approx([30 * 10 + 20 * 4])


# --- rock that comes out of the ground ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("base", "area"),
    [
        ([[0.0, 0.0], [100.0, 10.0]], 0.5 * 100 * 20),  # at the right end
        ([[0.0, 20.0], [100.0, 0.0]], 0.5 * 100 * 10),  # at the left end
        ([[0.0, 5.0], [50.0, 15.0], [100.0, 5.0]], 0.5 * 50 * 15 + 0.5 * 50 * 5),  # at one point between
        ([[0.0, 5.0], [40.0, 16.0], [60.0, 14.0], [100.0, 5.0]], 0.5 * 40 * 15 + 0.5 * 40 * 5),  # along a stretch
    ],
)
def test_the_base_may_come_out_of_the_ground(base: Any, area: float) -> None:
    rock = section([[0.0, 20.0], [100.0, 10.0]], {"elevation": base}, None)
    assert rock.layering.areas() == pytest.approx([area])
    assert sum(map(shoelace, rock.layering.polygons(0))) == pytest.approx(area)
    assert rock.notices == []


def test_a_step_within_a_centimetre_of_a_corner_of_a_steep_line() -> None:
    """At the step, 5 mm from the corner, the lines meet; made one point with it the lower line is 20 mm too high."""
    upper = {"elevation": [[0.0, 15.0], [30.005, 15.0], [30.005, 12.0], [31.0, 8.02], [60.0, 8.02]]}
    lower = {"elevation": [[0.0, 11.0], [30.0, 12.02], [31.0, 8.02], [60.0, 8.02]]}
    layers = section([[0.0, 20.0], [60.0, 20.0]], {"elevation": 0.0}, upper, lower, None).layering
    assert layers.areas()[1] == pytest.approx(30.0 * 15.0 - 0.5 * 30.0 * (11.0 + 12.02), abs=0.1)
    with pytest.raises(ValueError, match=r'the bottom of stratum "layer 1" rises above its top by up to 0\.1'):
        section([[0.0, 20.0], [60.0, 20.0]], {"elevation": 0.0}, upper,
                {"elevation": [[0.0, 11.0], [30.0, 12.02], [31.0, 8.12], [60.0, 8.12]]}, None)  # fmt: skip


def test_the_border_of_two_bodies_with_bare_rock_between() -> None:
    """A block of 3 m by 2 m and a triangle with legs of 3 and 4 m; where the base lies at the ground there is none."""
    ground = [[0.0, 2.0], [3.0, 2.0], [3.0, 0.0], [6.0, 0.0], [10.0, 3.0]]
    layers = section(ground, {"elevation": 0.0}, None).layering
    assert layers.perimeter() == pytest.approx(10.0 + 12.0, rel=1e-14)


def test_the_border_of_ground_that_steps() -> None:
    """3 m by 2 m beside 2 m by 1 m: around as a rectangle that holds them."""
    layers = section([[0.0, 2.0], [3.0, 2.0], [3.0, 1.0], [5.0, 1.0]], {"elevation": 0.0}, None).layering
    assert layers.perimeter() == pytest.approx(14.0, rel=1e-14)


@pytest.mark.parametrize(("width", "message"), [(100.0, False), (100e3, True)])
def test_a_section_that_only_millimetres_make_so_wide_is_told(width: float, message: bool) -> None:
    made = section([[0.0, 0.0], [width, 0.1 * width]], {"elevation": -0.1 * width}, None)
    assert made.notices == (
        ["geometry: the section is 100,000 m wide; plain coordinates are metres"] if message else []
    )
