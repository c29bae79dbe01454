"""The highest ground after a slide is called so: the crest of a structure is other ground."""

import pytest

from tests.support.sections import analysed, slope
from workflow.report.console import mpm_sentences
from workflow.results.material_points import PointCase, PointSlidesAnswer


@pytest.mark.parametrize(
    ("settles", "message"), [(0.13, "0.13 m lower"), (-0.17, "0.17 m higher"), (0.003, "as high as before")]
)
def test_the_highest_ground_is_lower_or_higher_and_no_crest_that_settles(settles: float, message: str) -> None:
    """A levee whose crest settled 0.36 m by one sentence had a crest that settled 0.13 m by the sentence before; below
    the sea a crest settled by -0.17 m."""
    data = slope()
    data["strata"][0]["liquefies_in"] = [1]
    case = PointCase.model_construct(
        settlement_crest_m=settles, slide_max_low_m=1.6, slide_max_high_m=2.9, reason="still moving", notes=(),
        surface_before=(), surface_after=(),
    )  # fmt: skip
    [text] = mpm_sentences(analysed(data), PointSlidesAnswer.model_construct(cases={1: case}, not_possible=""))
    assert f"and the highest ground is then {message}; still moving." in text
    assert "crest" not in text
