"""What is said of slip circles."""

import pytest

from workflow.report.slices import slices_sentences
from workflow.results.slices import CirclePart, SlicesAnswer


@pytest.mark.parametrize(("kh", "fails"), [(-0.039, True), (0.039, False)])
def test_a_negative_critical_kh_is_told_to_be_a_failure_without_shaking(kh: float, fails: bool) -> None:
    circle = CirclePart.model_construct(
        surface_m=((28.0, 30.0), (72.0, 12.0)), towards="right", bishop=kh, spencer=kh, strengthened=False
    )
    answer = SlicesAnswer.model_construct(factors=(), critical=(circle,), reason="", weak_layers=())
    (sentence,) = slices_sentences(answer)
    assert f"{kh:.3f} by Bishop's method" in sentence
    assert sentence.endswith("the ground fails without shaking.") == fails
