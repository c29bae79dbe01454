"""Answers of the stages: read as they were written, and those of another version recognised."""

import json
import math
from pathlib import Path
from typing import Any

import pytest

from dem.search.critical import Search
from dem.search.equilibrium import Trial
from dem.slides.slide import Row
from meshes.errors import InputError
from tests.support import dem_fixture
from tests.support.sections import slope
from workflow.config import Config
from workflow.results.calibration import CalibrationAnswer
from workflow.results.cases import CasesAnswer
from workflow.results.continuum import PathStep, displacement_at
from workflow.results.discs import DiscsAnswer
from workflow.results.history import SlideHistory, read_histories, write_histories
from workflow.results.journal import Journal
from workflow.run.store import OtherVersionError, Store


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store(tmp_path)


def cases(count: int = 3) -> CasesAnswer:
    values = {number: dem_fixture.case(0.1, 0.1 * number) for number in range(count, 0, -1)}
    return CasesAnswer(sets={"table2": values, "calibrated": values}, random=None)


def test_an_answer_is_read_as_it_was_written(store: Store) -> None:
    run = Config.parse(slope())
    for answer in (dem_fixture.critical(run, 0.24), dem_fixture.calibration(0.24, True), cases()):
        answer.write(store)
        assert type(answer).read(store) == answer


def test_a_key_without_anything_to_say_is_left_out_and_one_without_a_number_is_null(store: Store) -> None:
    dem_fixture.calibration(0.24, True).write(store)
    tested, failed = json.loads((store.folder / CalibrationAnswer.FILE).read_text())["element_tests"]
    assert "reason" not in tested
    assert tested["assembly"]["c_Pa"] is None
    assert failed == {"stratum": "upper", "packing": "random", "soil": None, "assembly": None,
                      "reason": "did not come to rest"}  # fmt: skip


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"random": ...}, "random: Field required"),
        ({"spare": 1}, "spare: Extra inputs are not permitted"),
        ({"sets": 7}, "sets: Input should be a valid dictionary"),
        ({"version": 0}, "version 0 of this file; expected version 1"),
        ({"version": ...}, "version None of this file"),
    ],
)
def test_another_version_is_recognised(change: dict[str, Any], words: str, store: Store) -> None:
    cases().write(store)
    data = {**store.read_json(CasesAnswer.FILE), **change}
    store.write_json(CasesAnswer.FILE, {key: value for key, value in data.items() if value is not ...})
    with pytest.raises(OtherVersionError, match=words) as caught:
        CasesAnswer.read(store)
    assert "run the stage that writes it" in str(caught.value)


@pytest.mark.parametrize("text", ["[]", "3", "null"])
def test_a_file_of_something_else_is_another_version(text: str, store: Store) -> None:
    store.write_text(DiscsAnswer.FILE, text)
    with pytest.raises(OtherVersionError):
        DiscsAnswer.read(store)


def test_no_file_and_no_json_are_told_as_such(store: Store) -> None:
    with pytest.raises(InputError, match="there is no such file"):
        DiscsAnswer.read(store)
    store.write_text(DiscsAnswer.FILE, "{")
    with pytest.raises(InputError, match="cannot be read"):
        DiscsAnswer.read(store)


def test_cases_come_in_the_order_of_their_numbers(store: Store) -> None:
    """As text 10 would come before 2."""
    cases(11).write(store)
    values = [(name, number) for name, number, _ in CasesAnswer.read(store).each()]
    assert values == [(name, number) for name in ("table2", "calibrated") for number in range(1, 12)]


def row(time: float, cracked: int) -> Row:
    lengths = dict.fromkeys([name for name in Row.__dataclass_fields__ if name != "cracked"], 0.25)
    return Row(**{**lengths, "time_s": time, "cracked": cracked})  # type: ignore[arg-type]


def test_histories(store: Store) -> None:
    """In the order of the numbers, with counts of any size whole."""
    slides = [SlideHistory("calibrated", number, (row(0.5, 1), row(1.0, 1_234_567))) for number in (10, 2, 0)]
    write_histories(store, slides)
    assert read_histories(store) == sorted(slides, key=lambda slide: slide.case)
    (store.folder / "dem/history.csv").write_text("set,case,time_s\ncalibrated,1,0.5\n")
    with pytest.raises(OtherVersionError, match="expected the columns"):
        read_histories(store)


def test_the_journal_gives_back_the_searches_it_was_given(store: Store) -> None:
    """A line that was half written is none; an elastic displacement that is not known is infinite again."""
    probe = Trial(0.02, "stands", "at rest", 1e-5, 1e-9, 0.01, math.inf, 3.0)
    search = Search(0.2, 0.21, "bracketed", "it fails", 0.5, [probe], [(0.02, 0.01)])
    journal = Journal(store, "dem/trials.jsonl")
    journal.add("stiffness", 0.5, search)
    with journal.path.open("a") as file:
        file.write('\n{"parameter": "stiffness", "fac')
    journal.add("", 1.0, search)
    assert journal.known() == {("stiffness", 0.5): search, ("", 1.0): search}


def test_a_path_that_ends_before_kc_is_taken_to_go_on() -> None:
    """What is left to kc halves in every centimetre, from 2 cm on: 1/8 at 5 cm, where the path ends, a hundredth
    after log2(12.5) more of them. A path that came to it is read off."""
    path = [step(0.01 * k, 0.3 * (1.0 - 0.5 ** (k - 2))) for k in range(2, 12)]
    assert displacement_at(path[:4], 0.3, 0.99) == pytest.approx(0.01 * (5.0 + math.log2(12.5)))
    assert displacement_at(path, 0.3, 0.99) == pytest.approx(0.09)


def step(displacement: float, kh: float) -> PathStep:
    return PathStep(
        length=0.0, displacement=displacement, factor=kh, iterations=1, residual=0.0, plastic_share=0.0, cutbacks=0,
        at_rest=True, balanced=True,
    )  # fmt: skip
