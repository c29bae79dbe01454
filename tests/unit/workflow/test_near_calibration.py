"""Tests of discs that miss the critical Kh of the finite elements by no more than packings scatter."""

import pytest

from dem.search.calibration import Calibration
from dem.search.critical import Search
from dem.settings import DemSettings
from workflow.stages.calibrated_discs import is_near_target


@pytest.mark.parametrize(("kc", "near"), [(0.260, True), (0.303, True), (0.240, False), (0.31, False)])
def test_discs_within_the_scatter_of_packings_slide(kc: float, near: bool) -> None:
    """A quay of sand: with 1.33 times their strength discs fail at 0.260, elements at 0.276; no slide was computed."""
    search = Search(kc_lower=kc - 0.002, kc_upper=kc + 0.002)
    missed = Calibration(0.276, 0.005, "strength", 1.33, (0.75, 1.33), "out of reach", "", search, (), ())
    assert is_near_target(missed, DemSettings()) == near
    assert not is_near_target(missed, DemSettings(model="paper"))
