import math
from dataclasses import asdict

import numpy as np
import pytest

from meshes.quality import areas, quality, scaled_jacobians

CELL = np.array([[0, 1, 2, 3]])


def test_a_square_is_perfect() -> None:
    points = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    result = quality(points, CELL)
    assert asdict(result) == pytest.approx(
        {
            "quadrilaterals": 1,
            "nodes": 4,
            "smallest_scaled_jacobian": 1.0,
            "smallest_angle": 90.0,
            "largest_angle": 90.0,
            "largest_aspect_ratio": 1.0,
        }
    )
    assert areas(points, CELL) == pytest.approx([4.0])


@pytest.mark.parametrize("slant", [30.0, 75.0, 140.0])
def test_a_slanted_parallelogram(slant: float) -> None:
    angle = math.radians(slant)
    side = np.array([math.cos(angle), math.sin(angle)])
    points = np.array([[0.0, 0.0], [3.0, 0.0], [3.0 + side[0], side[1]], side])
    result = quality(points, CELL)
    assert result.smallest_scaled_jacobian == pytest.approx(math.sin(angle))
    assert result.smallest_angle == pytest.approx(min(slant, 180.0 - slant))
    assert result.largest_angle == pytest.approx(max(slant, 180.0 - slant))
    assert result.largest_aspect_ratio == pytest.approx(3.0 * 8.0 / (4.0 * 3.0 * math.sin(angle)))


@pytest.mark.parametrize(
    ("corner", "sign"),
    [([0.6, 0.6], 1.0), ([0.5, 0.5], 0.0), ([0.2, 0.2], -1.0)],
    ids=["convex", "flat corner", "folded corner"],
)
def test_the_sign_tells_a_folded_cell(corner: list[float], sign: float) -> None:
    points = np.array([[0.0, 0.0], [1.0, 0.0], corner, [0.0, 1.0]])
    assert np.sign(np.round(scaled_jacobians(points, CELL), 12)) == pytest.approx([sign])


def test_a_clockwise_cell_and_a_cell_without_an_edge_are_bad() -> None:
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    assert scaled_jacobians(square, CELL[:, ::-1]) == pytest.approx([-1.0])
    square[1] = square[0]
    assert scaled_jacobians(square, CELL)[0] <= 0.0
