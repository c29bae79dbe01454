"""Sentences on residual strengths."""

from typing import Any

from workflow.report.residual import residual_details
from workflow.results.stability import SoftenedStratum, TwoSteps


def test_a_stratum_that_zones_divide_is_named_once() -> None:
    """Tailings between three raises of a dam stood in the sentence six times."""
    names = ("Tailings", "Tailings, part 2", "Tailings, part 3", "Shale")
    strata: Any = tuple(
        SoftenedStratum.model_construct(name=name, cohesion_kPa=0.0, friction_deg=8.0) for name in names
    )
    steps = TwoSteps.model_construct(
        strata=strata, peak=None, along=None, notes=(),
        everywhere=None,
    )  # fmt: skip
    assert next(residual_details(steps)) == 'Residual strength: "Tailings" 0 kPa and 8° and "Shale" 0 kPa and 8°.'
