"""The slip surface lies in the middle of the shear, whether this is a jump or a thick zone."""

import numpy as np
import pytest

from meshes.slip_line import slip_line

X = np.linspace(0.0, 10.0, 11)
Z = np.broadcast_to(np.linspace(0.0, 5.0, 51), (11, 51))


def test_a_jump_is_found_where_it_is() -> None:
    line = slip_line(X, Z, np.where(Z > 2.04, 1.0, 0.0))
    np.testing.assert_allclose(line, np.column_stack([X, np.full(11, 2.05)]))


def test_a_thick_zone_is_cut_half_way() -> None:
    line = slip_line(X, Z, np.clip((Z - 1.0) / 2.0, 0.0, 1.0))
    np.testing.assert_allclose(line[:, 1], 2.0, atol=0.15)


def test_a_thick_zone_is_cut_half_way_where_the_ground_turns() -> None:
    speed = np.linspace(0.8, 1.4, 11)[:, None]
    line = slip_line(X, Z, speed * np.clip((Z - 1.0) / 2.0, 0.0, 1.0))
    np.testing.assert_allclose(line, np.column_stack([X, np.full(11, 2.0)]))


def test_grains_that_roll_ahead_on_the_surface_do_not_draw_it_up() -> None:
    moved = np.clip((Z - 1.0) / 2.0, 0.0, 1.0)
    line = slip_line(X, Z, np.where(Z > 4.85, 2.5, moved))
    np.testing.assert_allclose(line[:, 1], 2.0, atol=0.25)


def test_a_single_node_that_moves_ahead_is_not_the_failing_ground() -> None:
    """The toe of a cracked cut moved 4.5 times as fast as the slope: "fails first in a few cells at its toe"."""
    moved = np.where((Z > 2.04) & (X[:, None] >= 3.0), 1.0, 0.0)
    moved[5, Z[5] > 4.5] = 6.5
    line = slip_line(X, Z, moved)
    np.testing.assert_allclose(line, np.column_stack([X[3:], np.full(8, 2.05)]))


def test_ground_that_fails_in_one_column_alone_stays_there() -> None:
    moved = np.where(Z > 2.04, 0.02, 0.0)
    moved[3, Z[3] > 4.5] = 6.5
    assert slip_line(X, Z, moved)[:, 0].tolist() == [3.0]


def test_what_one_column_alone_has_is_left_out() -> None:
    moved = np.where(Z > 2.04, 1.0, 0.0)
    moved[5, :45] = 0.0
    np.testing.assert_allclose(slip_line(X, Z, moved)[:, 1], 2.05)


def test_ground_of_which_all_shears_is_cut_below_its_middle() -> None:
    """Of a depth of 5 m at (3 * 5 + h)/8 = h, 15/7 m above its base."""
    np.testing.assert_allclose(slip_line(X, Z, Z)[:, 1], 15.0 / 7.0, atol=0.05)


def test_it_ends_where_the_ground_above_is_at_rest_and_the_longest_row_counts() -> None:
    moved = np.where((Z > 2.04) & np.isin(np.arange(11), (0, 1, 4, 5, 6, 7, 10))[:, None], 1.0, 0.0)
    assert slip_line(X, Z, moved)[:, 0].tolist() == [4.0, 5.0, 6.0, 7.0]


def test_ground_below_that_moves_and_places_without_ground_do_not_count() -> None:
    moved = np.where((Z > 2.04) | (Z < 0.5), 1.0, 0.0)
    moved[:, 40:] = np.nan
    np.testing.assert_allclose(slip_line(X, Z, moved)[:, 1], 2.05)


@pytest.mark.parametrize("moved", [0.0, 0.3, np.nan])
def test_where_all_moves_alike_there_is_none(moved: float) -> None:
    assert slip_line(X, Z, np.full(Z.shape, moved)).shape == (0, 2)


def test_below_a_crest_that_sinks_to_both_sides_there_is_no_surface() -> None:
    """The line rises from both ends to the middle of the crest, where all of the wedge goes straight down."""
    moved = np.where(4.0 - 0.6 * np.abs(X - 5.0)[:, None] < Z, 1.0, 0.0)
    assert slip_line(X, Z, moved).shape == (0, 2)
    circle = np.where(1.0 + 0.6 * np.abs(X - 5.0)[:, None] < Z, 1.0, 0.0)
    assert len(slip_line(X, Z, circle)) == 11
