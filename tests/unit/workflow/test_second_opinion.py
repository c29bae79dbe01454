"""Discs and material points side by side: when they agree, and which of the two known slides speak for."""

from types import SimpleNamespace
from typing import Any, cast

import pytest

from tests.support.dem_fixture import case
from workflow.estimates.slide_error import SlideError
from workflow.report import second_opinion
from workflow.report.second_opinion import SecondOpinion, agreeing, contradicting, second_opinions
from workflow.results.cases import CasesAnswer


@pytest.fixture(autouse=True)
def _errors(monkeypatch: pytest.MonkeyPatch) -> None:
    """Material points within a factor of two in most known slides; discs in few."""
    errors = {
        "discs": SlideError("lateral spreads", 10.0, 3, 9, 30.0),
        "mpm": SlideError("lateral spreads", 2.0, 6, 9, 1.8, "mpm"),  # 0.5 to 2.2 times what it says
    }
    monkeypatch.setattr(second_opinion, "slide_error", lambda flows, method="discs": errors[method])


def opinion(discs: float, points: float, settled: bool = True) -> SecondOpinion:
    """One case of both."""
    answer = CasesAnswer(sets={"calibrated": {1: case(0.1, discs)}}, random=None)
    point = SimpleNamespace(
        slide_max_m=points, slide_max_low_m=points, slide_max_high_m=1.1 * points, settled=settled, reason="",
        stopped_by=None,
    )  # fmt: skip
    return second_opinions(answer, cast(Any, SimpleNamespace(cases={1: point})))[1]


def test_they_agree_where_they_differ_by_less_than_the_larger_interval() -> None:
    """0.4 m by material points are 0.2 to 0.88 m with their error: 0.68 m wide."""
    assert opinion(1.0, 0.4).points_span == pytest.approx((0.2, 0.88))
    assert opinion(1.0, 0.4).discs_span == (1.0, 1.0)  # the error of the discs says nothing
    assert opinion(1.0, 0.4).agreed
    assert not opinion(1.1, 0.4).agreed


def test_they_agree_within_a_factor_of_1_5_and_within_centimetres(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(second_opinion, "slide_error", lambda flows, method="discs": None)
    assert opinion(3.0, 2.05).agreed
    assert not opinion(3.0, 1.7).agreed
    assert opinion(0.06, 0.015).agreed
    assert not opinion(0.09, 0.015).agreed


def test_slides_that_differ_by_a_factor_of_two_do_not_agree_without_their_interval() -> None:
    """An endless slope: 0.70 m by discs and 1.5 m by points were said to agree, and nothing else."""
    assert opinion(1.0, 0.45).sentence() == (
        "discs slide 1.0 m and material points 0.45 m, which differ by less than the width of the larger interval, "
        "0.2 to 1 m"
    )
    assert opinion(1.0, 0.7).sentence() == "discs slide 1.0 m and material points 0.70 m, and both agree"


def test_a_contradiction_names_the_model_that_was_nearer_to_known_slides() -> None:
    (warning,) = contradicting({1: opinion(3.0, 0.1)})
    assert warning.weight == 1
    assert warning.observation == (
        "Discs slide 3.0 m and material points 0.10 m, which differ by more than the intervals of 3 m and 0.05 to 0.2 "
        "m (case 1)."
    )
    assert warning.remedy == (
        "Rely on material points, which predicted half of the known lateral spreads within a factor of 1.8, while the "
        "other model predicted half of them within 30."
    )
    assert list(agreeing({1: opinion(3.0, 0.1)})) == []


def test_what_does_not_come_to_rest_in_one_model_alone_is_a_contradiction() -> None:
    assert not opinion(1.0, 1.0, settled=False).agreed
    assert "only discs come to rest" in opinion(1.0, 1.0, settled=False).sentence()


def test_a_slide_that_a_side_of_the_model_limits_agrees_with_a_longer_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """The river bank: discs at rest at the side after 32 m, points at rest after 33 m, was called a contradiction."""
    monkeypatch.setattr(second_opinion, "slide_error", lambda flows, method="discs": None)

    def at_side(discs: float, points: float, leaves: bool = False) -> SecondOpinion:
        stopped = case(1.0, discs).model_copy(update={"settled": False, "stopped_by": "right"})
        point = SimpleNamespace(
            slide_max_m=points, slide_max_low_m=points, slide_max_high_m=points, settled=not leaves, reason="",
            stopped_by="right" if leaves else None,
        )  # fmt: skip
        answer = CasesAnswer(sets={"calibrated": {1: stopped}}, random=None)
        return second_opinions(answer, cast(Any, SimpleNamespace(cases={1: point})))[1]

    assert at_side(32.0, 33.0).sentence() == (
        "discs slide 32 m and material points 33 m, and both agree, since a side of the model limits the slide of the "
        "discs"
    )
    although = "both agree, although a side of the model limits the slide of the discs"
    assert at_side(2.3, 1.6).sentence().endswith(although)
    assert at_side(32.0, 90.0).agreed
    assert not at_side(32.0, 10.0).agreed
    assert "differ by more than" in at_side(32.0, 10.0).sentence()
    assert (
        at_side(38.0, 48.0, leaves=True).sentence().endswith("both reach a side of the model, which limits both slides")
    )
