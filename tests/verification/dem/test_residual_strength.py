"""The strength of liquefied ground, as measured on it, is what was asked for."""

import numpy as np
import pytest

from tests.support.liquefied import ShearedBox

SLOW = 0.046  # 1/s: an inertial number of 0.004 under 300 kPa


@pytest.mark.parametrize(("ratio", "seed"), [(0.05, 1), (0.2, 0), (0.3, 1)])
def test_a_sheared_box_holds_what_was_asked(ratio: float, seed: int) -> None:
    """Every window of 5 % of strain from 5 % on, within a tenth."""
    box = ShearedBox.of(seed, ratio * 3e5)
    held = box.shear(0.5, SLOW)[:, 0]
    windows = np.convolve(held, np.ones(5) / 5.0, "valid")[5:]
    assert windows.min() > 0.9
    assert windows.max() < 1.1


def test_pore_pressure_alone_has_no_strength() -> None:
    """With no residual strength a sheared box holds less than a two-hundredth of its pressure."""
    box = ShearedBox.of(0, 1e-3)
    held, pressure = box.shear(0.5, SLOW, balance=5e-3)[10:].T
    assert np.abs(held * 1e-3 / pressure).mean() < 0.005
