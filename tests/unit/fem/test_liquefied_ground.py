"""The ground once strata have liquefied."""

import math

import pytest

from fem.liquefied_ground import LEAST, Remains, liquefied_section
from meshes.section.overburden import mean_effective_stress
from meshes.section.quantity import GRAVITY
from tests.support.borings import bored
from workflow.settings import Input


def test_what_is_left_of_a_stratum() -> None:
    """Loose sand from 0 to 6 m, water at 1 m: at its middle 1.9 t/m³ over 3 m less 2 m of water, 36.28 kPa."""
    section = Input.parse(bored())
    stress = mean_effective_stress(section, 0)
    assert stress == pytest.approx(GRAVITY * (3.0 * 1900.0 - 2.0 * 1000.0))
    kept = liquefied_section(section, {0: Remains(0.0, 0.0, 0.1)}).strata[0]
    assert (kept.cohesion, kept.friction_angle, kept.poissons_ratio) == (pytest.approx(0.1 * stress), 0.0, 0.49)
    half = liquefied_section(section, {0: Remains(1.0, 0.5, 0.0)}).strata[0]
    assert math.tan(half.friction_angle) == pytest.approx(0.5 * math.tan(math.radians(32.0)))
    nothing = liquefied_section(section, {0: Remains(0.0, 0.0, 0.0)}).strata
    assert nothing[0].cohesion == pytest.approx(LEAST * stress)
    assert nothing[1] == section.strata[1]
