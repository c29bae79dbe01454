import math
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from meshes.section.polyline import Line, limits, read_points


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ("flat", "expected two or more points [[x, z], ...] from left to right"),
        ([], "expected two or more points"),
        ([[0, 1]], "expected two or more points"),
        ([[0, 1], 2], "point 2 = 2: expected a pair [x, z]"),
        ([[0, 1], [2]], "point 2 = [2]: expected a pair [x, z]"),
        ([[0, 1], [2, 3, 4]], "point 2 = [2, 3, 4]: expected a pair [x, z]"),
        ([[0, 1], [5, 1], [4, 1]], "point 3 at x = 4 m stands after x = 5 m: expected points from left to right"),
        ([[0, 1], [0, 2], [4, 1]], "a vertical step at the end of the line"),
        ([[0, 1], [4, 2], [4, 1]], "a vertical step at the end of the line"),
        ([[0, 1], [4, 2], [4, 1], [4, 0], [9, 0]], "three points at x = 4 m: expected at most two"),
        ([[3, 1], [3, 2]], "all points at x = 3 m: expected a line from left to right"),
        ([[0, math.nan], [4, 1]], "point 1, z = nan: not a finite number; expected a coordinate or depth"),
        ([[0, 1], [math.inf, 1]], "point 2, x = inf: not a finite number; expected a coordinate or depth"),
        ([[0, "1 kPa"], [4, 1]], "point 1, z = '1 kPa': has the wrong dimension (kilopascal); expected a coordinate"),
        ([[0, True], [4, 1]], "point 1, z = True: expected a coordinate or depth"),
    ],
)
def test_refuses_points(points: Any, message: str) -> None:
    with pytest.raises(ValueError, match="expected") as caught:
        read_points(points)
    assert str(caught.value).startswith(message)


def test_a_scanned_ground_of_many_heights_at_one_x_is_told_in_four_lines() -> None:
    with pytest.raises(ValueError, match="three points at x = 2 m") as caught:
        read_points([[0.0, 0.0], *([float(x), float(z)] for x in range(1, 40) for z in range(3)), [50.0, 0.0]])
    assert len(str(caught.value).splitlines()) == 4
    assert str(caught.value).endswith("and 36 more points of this kind")


def test_every_problem_of_a_line_is_told() -> None:
    with pytest.raises(ValueError, match="expected") as caught:
        read_points([[0, "x"], [math.nan, 1], 7])
    assert [text.split(":")[0] for text in str(caught.value).split("\n")] == [
        "point 1, z = 'x'",
        "point 2, x = nan",
        "point 3 = 7",
    ]


def test_points_in_feet_and_with_a_vertical_step() -> None:
    points = read_points([["0 ft", "10 ft"], [5, "2 m"], [5, "1 m"], [9, "1 m"]])
    np.testing.assert_allclose(points, [(0.0, 3.048), (5.0, 2.0), (5.0, 1.0), (9.0, 1.0)], rtol=1e-14)


def test_one_unit_in_feet_does_not_make_the_others_metres() -> None:
    """A crest of "40 ft" beside a crest of 40, meant in feet, made a slope of 28 m on the crest without a word."""
    with pytest.raises(ValueError, match="expected one unit") as caught:
        read_points([[0, "40 ft"], [60, 40], [120, 0], [180, 0]])
    assert str(caught.value).startswith("point 2, z = 40: has no unit, beside '40 ft'; expected one unit for every z")
    points = read_points([[0, "40 ft"], [60, "40 ft"], [120, 0]])
    np.testing.assert_allclose(points, [(0, 12.192), (60, 12.192), (120, 0)], rtol=1e-14)
    assert read_points(read_points([[0, "4 m"], [60, 4], ["61 m", 0]])) == ((0, 4), (60, 4), (61, 0))


@pytest.mark.parametrize("inputs", [{}, {"depth": 1.0, "elevation": 2.0}])
def test_a_line_is_either_depth_or_elevation(inputs: dict[str, float]) -> None:
    with pytest.raises(ValidationError, match="expected either elevation or depth"):
        Line(**inputs)


@pytest.mark.parametrize("depth", [-1.0, [[0.0, 1.0], [5.0, -0.5]]])
def test_a_depth_above_the_ground_is_refused(depth: Any) -> None:
    with pytest.raises(ValidationError, match="expected depths of 0 or more"):
        Line(depth=depth)


def test_a_level_reaches_across() -> None:
    np.testing.assert_array_equal(Line(elevation=-3.0).points(2.0, 8.0), [[2.0, -3.0], [8.0, -3.0]])


def test_limits_differ_at_a_step_only() -> None:
    points = np.array([[0.0, 0.0], [4.0, 8.0], [4.0, 2.0], [8.0, 0.0]])
    left, right = limits(points, np.array([0.0, 1.0, 4.0, 6.0, 8.0]))
    np.testing.assert_allclose(left, [0.0, 2.0, 8.0, 1.0, 0.0])
    np.testing.assert_allclose(right, [0.0, 2.0, 2.0, 1.0, 0.0])
