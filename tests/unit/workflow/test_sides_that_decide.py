"""What the report asks for where the condition at the sides decides the critical Kh."""

import numpy as np
import pytest

from tests.support.answers import fem, results, variant, warned
from tests.support.sections import slope
from workflow.config import Config
from workflow.report.texts import Texts
from workflow.results.continuum import VariantsAnswer
from workflow.results.results import Results


def test_sides_are_held_where_level_ground_slides_out_at_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """A slip surface that ends 4 m below level ground at the right side; farther away it would end there just so."""
    run = Config.parse(slope())
    _, right = run.section.extent
    level = run.section.surface[-1][1]
    line = np.array([[right - 8.0, level - 1.0], [right - 0.1, level - 4.0]])
    monkeypatch.setattr(Results, "slip_surface", property(lambda _: line))
    held = VariantsAnswer(variants=(variant("sides", "sides fixed instead of free-field", 0.338),))
    [sides] = [one for one in warned(results(run, fem=fem(run, 0.2345), variants=held)) if one.startswith("With sides")]
    remedy = 'Take fem.sides = "smooth" if the ground continues beyond the right side, where it slides out.'
    assert sides.endswith(remedy)
    japanese = 'すべりが抜け出る右側の外に地盤が続く場合は、fem.sides = "smooth"とする。'
    assert Texts("ja").sentence(remedy) == japanese
