"""Tests the window of the picture of a failure mechanism."""

import numpy as np
import pytest

from workflow.figures.bounds import LARGEST_HEIGHT, failure_window
from workflow.figures.canvas import Window

SECTION = Window(-2.8, 142.8, -12.5, 17.5)  # of a levee of 140 m


@pytest.mark.parametrize(
    ("slip", "case"),
    [
        ([[39.0, 5.6], [46.8, 9.0]], "shallow slip of a bank"),
        ([[60.0, 5.0], [64.0, 15.0]], "steep cut"),
        ([[0.0, 14.0], [3.0, 15.0]], "at a side"),
        ([[50.0, 10.0], [50.0, 10.0]], "a single node"),
    ],
)
def test_small_failure_is_drawn_large_with_its_surroundings_in_width_and_in_depth(
    slip: list[list[float]], case: str
) -> None:
    """The window holds the slip, is at most 0.35 times as high as wide, and stays within the section."""
    points = np.array(slip)
    window = failure_window(points, SECTION)
    assert window.holds(points).all(), case
    assert window.proportion <= LARGEST_HEIGHT + 1e-9, case
    assert window.right - window.left < 0.6 * (SECTION.right - SECTION.left), case
    assert SECTION.holds(np.array([[window.left, window.bottom], [window.right, window.top]])).all(), case
    assert window.bottom < points[:, 1].min(), case


def test_wide_failure_is_drawn_with_the_whole_section() -> None:
    """A failure of more than a third of the width leaves no more than twice the size to be gained."""
    assert failure_window(np.array([[30.0, 0.0], [90.0, 15.0]]), SECTION) == SECTION
