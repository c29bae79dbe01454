"""The interval of a slide of material points by its numerical error."""

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from fem.mpm import PointSlide
from meshes.section.section import Section
from tests.support.sections import layer
from workflow.stages.mpm import _answer, numerical_interval


def slide(values: list[float]) -> PointSlide:
    """A slide whose surface has moved by these values (m), from x = 0 to 100 m."""
    x = np.linspace(0.0, 100.0, len(values))
    return PointSlide(times=[60.0], slide=[np.array(values)], surface_before=np.column_stack([x, 0.0 * x]))


def test_the_limit_of_fine_cells_and_another_decay_open_the_interval() -> None:
    """0.9 m in cells of one size and 1.0 m in cells twice as large tend to 0.8 m; the slower decay adds 0.05 m."""
    low, high = numerical_interval([slide([0.5, 0.9, 0.5]), slide([0.5, 1.0, 0.5]), slide([0.5, 1.05, 0.5])])
    assert (low, high) == (pytest.approx(0.8), pytest.approx(0.95))


def test_other_ground_in_coarse_cells_does_not_count() -> None:
    """S-13 slides 0.95 m; in cells thicker than its liquefied layers another part of the surface slides 2.19 m."""
    coarse = slide([1.0, 1.0, 1.4, 2.19, 0.5])
    low, high = numerical_interval([slide([0.94, 0.95, 0.9, 0.7, 0.6]), coarse, coarse])
    assert (low, high) == (pytest.approx(0.9), pytest.approx(0.95))


def test_a_slide_is_not_negative() -> None:
    assert numerical_interval([slide([0.0, 0.1, 0.0]), slide([0.0, 0.4, 0.0]), slide([0.0, 0.4, 0.0])]) == (0.0, 0.1)


def test_a_slide_to_the_other_side_has_the_same_interval() -> None:
    """The upstream shell of a dam slid by metres; "the largest slide" was the 0.1 m of the downstream shell."""
    answers = [slide([-0.5, -0.9, 0.1]), slide([-0.5, -1.0, 0.1]), slide([-0.5, -1.05, 0.1])]
    assert answers[0].slide_max == 0.9
    assert numerical_interval(answers) == (pytest.approx(0.8), pytest.approx(0.95))


def test_thirds_of_a_dam_whose_ends_are_level_begin_at_the_left() -> None:
    """The left end had settled by a hair more, and the report had the debris of the left face in the right third."""
    clay = layer("clay", cohesion="20 kPa", friction_angle="0 deg")
    surface = [[0, 0], [30, 0], [50, 10], [70, 0], [100, 0]]
    dam = Section.parse({"name": "dam", "surface": surface, "base": {"elevation": -5}, "strata": [clay]})
    counts = slide([-3.0, -2.0, 0.0, 0.0, 0.0, 0.0])
    counts.surface_before[0, 1] = -1e-6
    counts.surface_after, counts.settlement = counts.surface_before, [np.array([-0.5, -0.5, 0.0, 0.0, 0.0, 0.0])]
    ground = SimpleNamespace(section=dam, sides="smooth", crust=9.0, softened=(), firm_faces=())
    case = _answer([counts, counts, counts], cast(Any, ground))
    assert (case.slide_uphill_m, case.slide_downhill_m) == (-2.5, 0.0)
    assert (case.settlement_uphill_m, case.settlement_downhill_m) == (-0.5, 0.0)
