"""Verdicts, structures and published criteria."""

import pytest

from workflow.criteria.settings import CriteriaSettings, FactorCriterion
from workflow.criteria.structure import Structure, structure_problems
from workflow.criteria.verdict import judge, together


@pytest.mark.parametrize(
    ("low", "high", "at_least", "verdict"),
    [
        (1.3, 1.3, True, "satisfied"),
        (1.2, 1.2, True, "satisfied"),  # the limit itself is kept
        (1.1, 1.1, True, "not satisfied"),
        (1.1, 1.3, True, "not decided"),
        (None, None, True, "not decided"),
        (0.1, 0.3, False, "satisfied"),
        (1.3, 1.4, False, "not satisfied"),
        (1.0, 1.4, False, "not decided"),
    ],
)
def test_an_interval_against_a_limit(low: float | None, high: float | None, at_least: bool, verdict: str) -> None:
    assert judge(low, high, 1.2, at_least) == verdict


def test_several_verdicts() -> None:
    assert together(("satisfied", "satisfied")) == "satisfied"
    assert together(("satisfied", "not decided")) == "not decided"
    assert together(("not decided", "not satisfied")) == "not satisfied"
    assert together(()) == "not decided"


def test_published_criteria_follow_the_peak_acceleration() -> None:
    told = CriteriaSettings(preset="hynes_griffin_franklin_1984").resolved(0.25)
    assert told.factor_of_safety is not None
    assert told.displacement is not None
    assert (told.factor_of_safety.limit, told.factor_of_safety.kh, told.displacement.limit) == (1.0, 0.125, 1.0)
    own = FactorCriterion(limit=1.3)
    told = CriteriaSettings(preset="nchrp_611", factor_of_safety=own).resolved(0.4)
    assert told.factor_of_safety == own
    assert told.displacement is not None
    assert told.displacement.limit == pytest.approx(0.0508, abs=0.001)


def test_structures_that_do_not_fit() -> None:
    names = [("a", 10.0, 5.0), ("b", 10.0, 200.0), ("a", 1.0, 2.0)]
    told = structure_problems([Structure(name=n, start=s, end=e) for n, s, e in names], (0.0, 140.0))
    assert told == [
        'structures 1 "a", from = 10 m, to = 5 m: expected the left foot, then the right one',
        'structures 2 "b", from = 10 m, to = 200 m: lies off the section, which reaches from 0 to 140 m',
        'structures: 2 of them are called "a"; expected every name once',
    ]
