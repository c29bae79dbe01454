"""Sentences on residual strengths."""

from typing import Any

import pytest

from workflow.report.residual import residual_details, residual_verdict
from workflow.results.stability import AlongSurface, PeakAndResidual, SoftenedStratum
from workflow.texts.report_texts import Texts


def test_a_stratum_that_zones_divide_is_named_once() -> None:
    """Tailings between three raises of a dam stood in the sentence six times, and those below water once more."""
    names = ("Tailings", "Tailings, part 2", "Tailings, part 3", "Tailings, below water", "Shale")
    strata: Any = tuple(
        SoftenedStratum.model_construct(name=name, cohesion_kPa=0.0, friction_deg=8.0) for name in names
    )
    steps = PeakAndResidual.model_construct(
        strata=strata, peak=None, along=None, notes=(),
        everywhere=None,
    )  # fmt: skip
    assert next(residual_details(steps)) == (
        'The residual strength is c = 0 kPa, φ = 8° in "Tailings" and c = 0 kPa, φ = 8° in "Shale".'
    )


@pytest.mark.parametrize("language", ["en", "ja"])
def test_a_slide_along_the_slip_surface_of_peak_strength_may_stop(language: str) -> None:
    """Of tailings was told that the slide continues, beside a factor of safety of 1.58 along the slip surface."""
    along = AlongSurface(surface_m=(), peak=1.92, residual=1.58)
    steps = PeakAndResidual.model_construct(verdict="would stop", along=along)
    sentence = residual_verdict(steps, Texts(language))
    assert "1.58" in sentence
    assert "continues" not in sentence
    assert ("stops" in sentence) == (language == "en")
