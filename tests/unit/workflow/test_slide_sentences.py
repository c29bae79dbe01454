"""Sentences of the report on slides: their end, their interval, and other methods."""

import pytest

from tests.support import dem_fixture
from tests.support.answers import fem, liquefying_config, report_text, results, warned
from tests.support.sections import analysed, slope
from workflow.config import Config
from workflow.report.slide_headline import slide_headline
from workflow.results.cases import CaseAnswer, CasesAnswer
from workflow.texts.report_texts import Texts


@pytest.fixture
def run() -> Config:
    return liquefying_config()


def moving(slide: float) -> CaseAnswer:
    return dem_fixture.case(0.1, slide).model_copy(update={"settled": False, "seconds_simulated": 60.2})


def test_slides_that_end_and_slides_that_do_not(run: Config) -> None:
    sets = {
        "calibrated": {1: dem_fixture.case(0.1, 0.02), 2: dem_fixture.case(0.02, 3.23), 3: moving(39.5)},
        "table2": {1: dem_fixture.case(0.1, 0.33)},
    }
    messages = report_text(results(run, fem=fem(run), cases=CasesAnswer(sets=sets, random=None)))
    assert "In case 1 the surface moves less than 0.1 m." in messages
    assert "In case 2 the surface slides 3.2 m and comes to rest." in messages
    assert (
        "In case 3 the surface had slid 40 m after 60 s and was still moving: these are not final values." in messages
    )
    assert "One packing of discs was computed, so no interval is known" in messages
    assert (
        "For comparison, the following slides are those of discs with the springs of the paper's Table 2 as printed. "
        "In case 1 the surface slides 0.33 m" in messages
    )


def test_the_conclusion_names_the_case_that_a_side_of_the_box_stopped(run: Config) -> None:
    """Of slides of which one reached a side was told that all of them did."""
    still = dem_fixture.case(0.1, 3.0)
    stopped = still.model_copy(update={"stopped_by": "right"})
    for stops, words in (((1, 2), "1 and 2"), ((2,), "2")):
        sets = {"calibrated": {k: stopped if k in stops else still for k in (1, 2, 3)}}
        answer = results(run, fem=fem(run), cases=CasesAnswer(sets=sets, random=None))
        plural = "s" if len(stops) > 1 else ""
        assert f"and in case{plural} {words} reaches a side of the model" in slide_headline(answer, Texts()).conclusion
        assert f"ケース{words.replace(' and ', '、')}では" in slide_headline(answer, Texts("ja")).conclusion


def test_a_slide_that_a_side_of_the_box_stopped_is_told_so(run: Config) -> None:
    """And one that needs no shaking is called a flow failure, however far it slides with it."""
    stopped = {"stopped_by": "right", "flows": True, "slide_by_weight_m": 9.9, "settled": True}
    first = dem_fixture.case(0.1, 47.2).model_copy(update=stopped)
    second = first.model_copy(update={"settled": False, "moved_lately_m": 0.036, "slide_by_weight_m": 12.7})
    third = dem_fixture.case(0.01, 3.0)
    cases = CasesAnswer(sets={"calibrated": {1: first, 2: second, 3: third}}, random=None)
    messages = report_text(results(run, fem=fem(run), cases=cases))
    assert "In case 1 the surface slides 47 m, where the right side of the disc model stops it." in messages
    assert "In case 3 the surface slides 3.0 m and comes to rest." in messages
    assert (
        "In case 2 the surface slides 47 m, where the right side of the disc model stops it; it moved 4 cm in the last "
        "10 s." in messages
    )
    assert "In a longer section the slide of cases 1 and 2 would be longer, because the disc model ends" in messages
    assert (
        "In cases 1 and 2 this is a flow failure: without shaking the surface slides 9.9 and 13 m within 20 s."
        in messages
    )


def test_a_slide_that_came_to_rest_at_the_side_is_not_said_to_move(run: Config) -> None:
    """The river bank: 32 m at rest at the side was "still moving after 38 s"."""
    reason = "the right side of the box stopped the slide: in a longer section it would continue"
    stopped = {"stopped_by": "right", "settled": False, "moved_lately_m": 0.38}
    rests = dem_fixture.case(0.1, 31.5).model_copy(update={**stopped, "reason": reason})
    moves = dem_fixture.case(0.1, 38.2).model_copy(update={**stopped, "reason": "still moving after 60 s; weight"})
    cases = CasesAnswer(sets={"calibrated": {1: rests, 2: moves}}, random=None)
    messages = report_text(results(run, fem=fem(run), cases=cases))
    assert "In case 1 the surface slides 32 m, where the right side of the disc model stops it." in messages
    assert "In case 2 the surface had slid 38 m, against the right side of the disc model, after 20 s and" in messages


def test_methods_that_disagree_are_told_to(run: Config) -> None:
    """Hamada gives 3.2 m for this slope, and the block does not move at Kh = 0.1 with kc = 0.24."""
    far = report_text(
        results(run, fem=fem(run), cases=CasesAnswer(sets={"calibrated": {3: moving(39.5)}}, random=None))
    )
    assert "differ by more than a factor of three: discs 40 m, regression over observed slides 3.2 m and rigid" in far
    assert "rigid block on the slip surface 0 m." in far
    assert "check the stiffness and strength of the liquefied layers" in far
    near = CasesAnswer(sets={"calibrated": {2: dem_fixture.case(0.02, 3.0)}}, random=None)
    messages = report_text(results(run, cases=near))  # without a critical Kh there is no block
    assert "differ by" not in messages


def test_what_was_measured_stands_beside_the_discs() -> None:
    data = slope()
    data["strata"][0]["liquefies_in"] = [1, 2]
    data["slide"] = {"kh": 0}
    places = ({"name": "SI-5", "displacement": "0.2 m", "x": 35.0}, {"name": "SI-2", "displacement": "0.45 m"})
    measured = analysed({**data, "report": {"observed": list(places)}})
    messages = report_text(results(measured))
    assert "The measured displacement" not in messages  # stands beside slides alone, and there are none yet
    along = ((30.0, 0.1), (40.0, 0.5))
    slides = {number: moving(far).model_copy(update={"slide_along": along}) for number, far in ((1, 0.6), (2, 0.9))}
    messages = report_text(results(measured, cases=CasesAnswer(sets={"calibrated": slides}, random=None)))
    assert "0.2 m (SI-5); the discs slide there, at x = 35 m, 0.30 m in cases 1 and 2." in messages
    assert "0.45 m (SI-2); the discs slide at most 0.60 m and 0.90 m in cases 1 and 2." in messages


def test_what_must_be_known_to_believe_a_case_is_told_with_the_discs_own_prediction(run: Config) -> None:
    noted = {number: dem_fixture.case(0.1, 3.0).model_copy(update={"notes": ("discs overlap",)}) for number in (1, 3)}
    cases = CasesAnswer(sets={"calibrated": {**noted, 2: dem_fixture.case(0.1, 3.0)}}, random=None)
    predicted = {"predicted_kc": 0.213, "predicted_ratio": 0.86}
    calibration = dem_fixture.calibration(0.24, True).model_copy(update=predicted)
    result = results(run, fem=fem(run), calibration=calibration, cases=cases)
    assert "Discs overlap (cases 1 and 3)." in warned(result)
    messages = report_text(result)
    assert "Uncalibrated, the discs fail at Kh = 0.213, 0.86 times the critical Kh of the finite elements" in messages
