"""Published cases: two by their bounds and two by elements each time, all by both in the long run."""

from dataclasses import replace

import pytest

from docs.verify.answer import answer
from docs.verify.case import case_files
from docs.verify.record import FILE, Answer, read_answers
from docs.verify.verdict import judge
from fem.settings import BoundsSettings
from tests.support.published import PUBLISHED, cases

RECORDED = read_answers(PUBLISHED / FILE, Answer)
QUICK = 4.0  # s of processor time for bounds to 3 %
ROUGHLY = BoundsSettings(gap=0.05, max_cells=1500)


def _selection() -> list[str]:
    """Four of those that are quick, from all over the collection, the same ones each time."""
    quick = sorted(
        name
        for name, item in RECORDED.items()
        if None not in (item.lower, item.upper, item.bounds_seconds) and item.bounds_seconds < QUICK
    )
    return quick[:: max(1, len(quick) // 4)][:4]


@pytest.mark.parametrize("name", _selection()[::2])
def test_bounds_are_those_of_the_page_and_agree_with_what_was_published(name):
    before = RECORDED[name]
    rough_answer = answer(cases()[name], ["bounds"], bounds=ROUGHLY)
    # Some of the published values are compared with Davis's estimate.
    rough_answer = replace(rough_answer, davis=before.davis, davis_upper=before.davis_upper)
    assert rough_answer.lower <= before.upper
    assert rough_answer.upper >= before.lower
    assert rough_answer.upper - rough_answer.lower <= 0.08 * rough_answer.upper
    assert judge(cases()[name], rough_answer).word in ("right", "explained")


@pytest.mark.parametrize("name", _selection()[1::2])
def test_elements_agree_with_what_was_published_and_with_the_bounds_of_the_page(name):
    before = RECORDED[name]
    verdict = judge(cases()[name], answer(cases()[name], ["associated"], known=before))
    assert verdict.word in ("right", "explained"), verdict.remarks


def test_the_page_tells_of_every_case():
    page = (PUBLISHED / "README.md").read_text(encoding="utf-8")
    for name in cases():
        assert f"({name}.toml)" in page
        assert (PUBLISHED / "pictures" / f"{name}.png").exists()


def test_nothing_recorded_is_wrong():
    wrong = [name for name, case in cases().items() if judge(case, RECORDED.get(name)).word == "wrong"]
    assert len(wrong) <= 0.05 * len(cases()), wrong


@pytest.mark.slow
@pytest.mark.parametrize("name", [path.stem for path in case_files(PUBLISHED, ())])
def test_elements_and_bounds_are_right(name):
    verdict = judge(cases()[name], answer(cases()[name], known=Answer(name)))
    assert verdict.word in ("right", "explained"), verdict.remarks
