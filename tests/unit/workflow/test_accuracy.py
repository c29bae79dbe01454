"""How large the numerical error of the critical Kh is: by the sequence of meshes, and by strict bounds."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.answers import bounds, fem, results, variant
from tests.support.sections import slope
from workflow.config import Config
from workflow.report.first_page import headlines
from workflow.report.numbers import numerical_error, range_sentence, rounded_up
from workflow.report.summary_text import findings
from workflow.results.accuracy import Accuracy, accuracy, of_meshes
from workflow.results.bounds import ShallowBoundPart
from workflow.results.continuum import FemAnswer, MeshStep, VariantsAnswer
from workflow.texts.report_texts import Texts

RUN = Config.parse(slope())


def sequence(*values: float, limit: float) -> FemAnswer:
    """An answer on meshes of 500, 1,000, ... cells."""
    meshes = tuple(MeshStep(cells=500 * 2**k, kc=kc) for k, kc in enumerate(values))
    last = {"kc": values[-1], "kc_lower": values[-1], "kc_upper": values[-1]}
    return fem(RUN).model_copy(update={**last, "meshes": meshes, "kc_limit": limit})


def test_a_sequence_that_still_falls_is_not_told_to_leave_nothing_open() -> None:
    """The levee: 0.0549, 0.0388, 0.0367, tending to 0.0324. It was told that nothing is open in these digits."""
    answer = sequence(0.0549, 0.0388, 0.0367, limit=0.0324)
    text = " ".join(findings(results(RUN, fem=answer)))
    assert "leaves nothing open" not in text
    assert "error of the critical Kh is below 0.005, by the sequence of meshes, which tends to 0.032." in text


def test_a_sequence_that_does_not_converge_has_a_wider_interval() -> None:
    sequences = (
        sequence(0.0549, 0.0388, limit=0.0227),
        sequence(0.100, 0.095, 0.085, limit=0.075),
        sequence(0.100, 0.090, 0.094, limit=0.098),
    )
    coarse, falls_faster, rises = (result for each in sequences if (result := of_meshes(each)) is not None)
    assert (coarse.reliable, falls_faster.reliable, rises.reliable) == (False, False, False)
    assert (coarse.low, coarse.high) == pytest.approx((0.0388 - 2 * 0.0161, 0.0388))
    assert (falls_faster.low, falls_faster.high) == pytest.approx((0.085 - 2 * 0.01, 0.085))
    assert (rises.low, rises.high) == pytest.approx((0.094 - 2 * 0.004, 0.098 + 2 * 0.004))
    assert numerical_error(coarse, 0.0388).startswith(
        "The sequence of meshes has not converged: the numerical error may"
    )


def test_strict_bounds_of_the_same_flow_close_the_interval() -> None:
    """Of S-13 with psi = phi: 0.2844 beside 0.2799 to 0.2815; of another flow only the upper bound counts."""
    answer = sequence(0.2844, 0.2826, limit=0.2820)
    result = accuracy(results(RUN, fem=answer, bounds=bounds(RUN, 0.2799, 0.2815)), answer)
    assert result == Accuracy(0.2799, 0.2815, "by strict bounds", True)
    assert (
        numerical_error(result, answer.kc) == "The numerical error of the critical Kh is below 0.003, by strict bounds."
    )
    inside = accuracy(results(RUN, fem=answer, bounds=bounds(RUN, 0.27, 0.30)), answer)
    assert inside is not None
    assert (inside.low, inside.high) == pytest.approx((0.2820, 0.2826))
    assert inside.strict == (0.27, 0.30)
    assert "and the sequence of meshes (by strict bounds alone 0.270 to 0.300)." in numerical_error(inside, answer.kc)
    assert range_sentence(answer, inside).endswith("is 0.282 to 0.283 (by strict bounds alone 0.270 to 0.300).")
    same = accuracy(results(RUN, fem=answer, bounds=bounds(RUN, 0.28201, 0.28259)), answer)
    assert same is not None
    assert "alone" not in numerical_error(same, answer.kc)  # not in these digits
    apart = answer.model_copy(update={"direction": "uphill"})
    assert accuracy(results(RUN, fem=apart, bounds=bounds(RUN, 0.2799, 0.2815)), apart) == of_meshes(answer)
    davis = answer.model_copy(update={"flow": "davis"})  # the upper bound with ψ = φ holds for every ψ ≤ φ
    limited = accuracy(results(RUN, fem=davis, bounds=bounds(RUN, 0.2799, 0.2823)), davis)
    assert limited == Accuracy(0.2820, 0.2823, "by the sequence of meshes, which tends to 0.282", True)


def test_the_first_page_names_all_that_its_interval_follows_from() -> None:
    answer, wide = sequence(0.2844, 0.2826, limit=0.2820), bounds(RUN, 0.27, 0.30)
    face = ShallowBoundPart(stratum="Sand", start=1.0, end=5.0, kh=0.1)
    deeper = wide.model_copy(update={"shallow_failures": (face,)})
    values = [headlines(results(RUN, fem=answer, bounds=item), Texts())[0].interval for item in (wide, deeper, None)]
    assert values == [
        "0.282 to 0.283 by strict bounds and the sequence of meshes; strict bounds alone 0.270 to 0.300",
        "0.282 to 0.283 by strict bounds (shallow failures excluded) and the sequence of meshes; strict bounds alone "
        "0.270 to 0.300",
        "0.282 to 0.283 by the sequence of meshes",
    ]


def test_a_single_mesh_is_judged_by_halved_cells_where_these_were_looked_at() -> None:
    """S-13 by Davis's estimate on 611 and 2,444 cells: a third of the difference is left."""
    answer = fem(RUN, 0.2370).model_copy(update={"kc_upper": 0.2370})
    finer = VariantsAnswer(variants=(variant("mesh", "cells of half the size", 0.2357),))
    result = accuracy(results(RUN, fem=answer, variants=finer), answer)
    assert result is not None
    assert result.low == pytest.approx(0.2357 - 0.0013 / 3.0)
    assert accuracy(results(RUN, fem=answer), answer) is None
    assert "is not known" in numerical_error(None, 0.2370)


@given(st.floats(1e-6, 10.0))
def test_an_error_is_rounded_up_to_one_digit(value: float) -> None:
    messages = rounded_up(value)
    assert value <= messages * (1 + 1e-5)
    assert messages <= max(0.001, 2.0 * value)
    assert len(f"{messages:g}".strip("0.").rstrip("0") or "1") == 1
