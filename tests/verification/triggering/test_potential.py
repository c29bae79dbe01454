"""P_L of Iwasaki against its integral in closed form, and against liquepy."""

import pytest

from workflow.earthquake.triggering.potential import potential, risk


def test_closed_form() -> None:
    """∫ (1 - 0.5)(10 - z/2) dz from 2 to 6 m is 0.5 (40 - 8) = 16, as liquepy's calc_lpi has it in the limit (15.992
    with steps of 1 mm); all of 20 m without resistance is 100."""
    assert potential([(2.0, 6.0, 0.5)]) == pytest.approx(16.0)
    assert potential([(0.0, 30.0, 0.0)]) == pytest.approx(100.0)


def test_what_does_not_count() -> None:
    assert potential([(0.0, 2.0, None), (2.0, 6.0, 1.0), (21.0, 30.0, 0.2)]) == 0.0


def test_words() -> None:
    assert [risk(value) for value in (0.0, 3.0, 10.0, 20.0)] == ["very low", "low", "high", "very high"]
