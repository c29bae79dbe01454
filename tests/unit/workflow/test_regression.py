"""Hamada's regression, and what it is fed with."""

import math
from dataclasses import replace

import pytest

from meshes.section.section import Section
from tests.support import SECTIONS
from tests.support.answers import results
from tests.support.sections import analysed, layer, slope
from workflow.config import Config
from workflow.estimates.comparison import estimates
from workflow.estimates.estimate import Estimate, mean_inclination, with_flow_failure
from workflow.estimates.regression import hamada, hamada_as_printed, liquefied
from workflow.figures import displacements

S13 = SECTIONS / "s13.toml"


def test_both_forms() -> None:
    """H = 4 m, θ = 8 %: 0.75 x 2 x 2 = 3 m; with the cube root of H 0.75 x 1.5874 x 2 = 2.381 m."""
    assert hamada(4.0, 8.0) == pytest.approx(3.0)
    assert hamada_as_printed(4.0, 8.0) == pytest.approx(2.3811, abs=1e-4)
    assert hamada(1.0, 8.0) == hamada_as_printed(1.0, 8.0)


def test_thickness_and_gradient_of_a_layer() -> None:
    """Ground from 20 to 10 m over 100 m: 10 %; the layer is 4 m thick, or 6 to 2 m with a base that falls by 6 %."""
    data = slope()
    data["strata"][0]["liquefies_in"] = [1]
    ground = liquefied(Section.parse(data), 1)
    assert ground is not None
    assert ground.thickness == pytest.approx(4.0)
    assert ground.gradient == pytest.approx(10.0)
    data["strata"][0]["bottom"] = {"depth": [[0.0, 2.0], [100.0, 6.0]]}
    steeper = liquefied(Section.parse(data), 1)
    assert steeper is not None
    assert steeper.thickness == pytest.approx(4.0)
    assert steeper.gradient == pytest.approx(14.0)
    assert liquefied(Section.parse(data), 2) is None


def test_ground_that_is_added_beyond_the_ends_does_not_flatten_the_slope() -> None:
    """With 100 m of level ground at either end 10 % were 3.3 % on average."""
    data = slope()
    data["strata"][0]["liquefies_in"] = [1]
    longer = Section.parse({**data, "beyond": "100 m"})
    assert longer.extent == pytest.approx((-100.0, 200.0))
    assert math.tan(mean_inclination(longer)) == pytest.approx(0.1)
    assert liquefied(longer, 1) == liquefied(Section.parse(data), 1)


def test_a_lens_counts_where_it_is() -> None:
    data = slope()
    lens = layer("lens", bottom={"depth": [[20.0, 4.0], [40.0, 7.0], [60.0, 4.0]]}, liquefies_in=[1])
    data["strata"].insert(1, lens)
    ground = liquefied(Section.parse(data), 1, 4000)
    assert ground is not None
    assert ground.thickness == pytest.approx(1.5, abs=0.01)
    assert ground.thickest == pytest.approx(3.0, abs=0.01)


def test_s13_thicknesses_of_its_two_layers() -> None:
    """Layers 4 and 6: 2.7 + 2.0 m on the left, 1.0 + 0.9 m on the right; the ground is the steeper one."""
    ground = liquefied(Section.read(S13), 3)
    assert ground is not None
    assert ground.thickness == pytest.approx((4.7 + 1.9) / 2, abs=0.01)
    assert ground.gradient == pytest.approx(4.54, abs=0.01)


def test_level_ground_below_an_embankment_has_no_slope_for_a_regression() -> None:
    """A road on level ground: "regression over observed slides 0 m" stood beside slides of 4 m."""
    data = slope()
    data["surface"] = [[0.0, 10.0], [40.0, 10.0], [48.0, 14.0], [52.0, 14.0], [60.0, 10.0], [100.0, 10.0]]
    data["strata"][0] |= {"bottom": {"elevation": 6.0}, "liquefies_in": [1]}
    config = Config.parse(data)
    rows = [row for row in estimates(config.section, config, None) if row.kind in ("regression", "truss")]
    assert [(row.kind, row.displacement_m, row.applies) for row in rows] == [("regression", None, False)]
    assert rows[0].description.endswith("does not apply: the ground and its layers are level")
    data["surface"][-1][1] = 8.0
    config = Config.parse(data)
    [falls] = [row for row in estimates(config.section, config, None) if row.kind == "regression"]
    assert falls.displacement_m is not None
    assert falls.displacement_m > 0.5


def test_a_relation_that_does_not_apply_has_no_point_beside_the_slides(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its displacement is that of other ground; the picture of all methods has the reason in its place."""
    row = Estimate("spread", "Youd", 0.29, "M 7", "", "")
    flowing, level = with_flow_failure([row], [0.33]), replace(row, displacement_m=None, applies=False)
    level = replace(level, description="H = 2 m; does not apply: the ground and its layers are level")
    monkeypatch.setattr(displacements, "estimates_of", lambda _: [row, *flowing, level])
    points = list(displacements._others(results(analysed(slope()))))
    assert [point.displacement for point in points] == [0.29, None, None]
    assert points[1].reason == (
        "does not apply: the liquefied ground does not stand without shaking (factor of safety 0.33)"
    )
    assert points[2].reason == "does not apply: the ground and its layers are level"
