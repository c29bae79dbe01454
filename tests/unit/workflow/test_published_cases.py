"""The collection of published cases: that it can be read, and how it is judged."""

import math
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from docs.published_slopes import text
from docs.verify import answer
from docs.verify.case import Value, read_case, read_cases
from docs.verify.record import Answer, version_of
from docs.verify.verdict import judge, outside
from meshes.errors import InputError, NoAnswerError
from tests.support.log_spiral import critical_kh
from tests.support.published import PUBLISHED, cases

GOOD = Answer("acads_1a", lower=0.975, upper=0.995, associated=0.99, davis=0.98)


def test_every_case_is_a_sound_section_with_a_source():
    assert len(cases()) >= 100
    for case in cases().values():
        assert len(case.published.source) > 8, case.name
        assert case.section.layering is not None


def test_enough_of_them_can_be_stated_today():
    assert len(cases()) >= 90


@pytest.mark.parametrize("name", ["log_spiral_45_30_100", "log_spiral_15_10_050", "log_spiral_90_20_250"])
def test_critical_coefficients_by_log_spirals_are_those_in_the_files(name):
    slope, phi, strength = (int(part) for part in name.split("_")[2:])
    published = cases()[name].published.values[0].value
    assert critical_kh(slope, phi, strength / 1000.0) == pytest.approx(published, abs=2e-4)


@pytest.mark.parametrize(
    ("slope", "phi", "height"), [(90, 10, 4.583), (45, 20, 16.16), (45, 30, 35.54), (90, 40, 8.288), (30, 10, 13.50)]
)
def test_log_spirals_are_those_of_chen(slope, phi, height):
    """Chen (1975), table 9.1: γH / c at which a slope without Kh fails."""
    assert critical_kh(slope, phi, 1.0 / height) == pytest.approx(0.0, abs=5e-4)


def test_the_log_spiral_is_that_of_loukidis():
    """0.432 by Spencer's method on log-spirals (Loukidis, Bandini & Salgado 2003, example 1): the same surface."""
    slope = math.degrees(math.atan(1.0 / 3.0))
    assert critical_kh(slope, 30.0, 25.0 / (20.0 * 25.0)) == pytest.approx(0.432, abs=1e-3)


def test_a_case_within_all_tolerances_is_right():
    assert judge(cases()["acads_1a"], GOOD).word == "right"


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"associated": 0.95}, "below the lower bound"),
        ({"associated": 1.06}, "above the upper bound"),
        ({"davis": 1.10}, "more than with ψ = φ"),
        ({"lower": 1.10, "upper": 1.12, "associated": 1.13}, "published"),
        ({"failures": ("section: it did not end",)}, "no answer by section"),
    ],
)
def test_what_contradicts_itself_or_what_was_published_is_wrong(changes, said):
    verdict = judge(cases()["acads_1a"], replace(GOOD, **changes))
    assert verdict.word == "wrong"
    assert any(said in remark for remark in verdict.remarks)


def test_a_published_value_that_is_excluded_is_told():
    sentences = list(outside(cases()["acads_1a"], replace(GOOD, lower=0.96, upper=0.98)))
    assert sentences == [
        "Proven to fail: 1 (Giam & Donald, referee), 0.987 (Slide2 manual, Bishop), 0.986 (Slide2 manual, Spencer), "
        "0.99 (RS2 manual, strength reduction)",
        "Proven to stand: 0.958 (xslope, strength reduction)",
    ]


def test_what_is_far_off_for_a_reason_is_explained():
    """The dam's published values are of one face, the other one fails at tan 45° / tan 30.9° = 1.669."""
    result = Answer("acads_2a", lower=1.65, upper=1.68, associated=1.68, davis=1.67)
    assert judge(cases()["acads_2a"], result).word == "explained"


def test_cases_that_were_not_run_are_not_judged():
    assert judge(cases()["arai_tagyo_1"], None).word == "not run"


def test_a_part_without_an_answer_is_told_and_the_others_are_found(monkeypatch):
    def gives_up(*options):
        raise NoAnswerError("no factor of safety was found", "use another mesh")

    monkeypatch.setattr(answer, "_elements", gives_up)
    monkeypatch.setattr(answer, "_bounds", lambda *options: {"lower": 1.0, "upper": 1.1, "shallow_failure": None})
    random_packings = answer.answer(cases()["taylor_60_10"], ("bounds", "associated"))
    assert (random_packings.lower, random_packings.upper, random_packings.associated) == (1.0, 1.1, None)
    assert random_packings.failures == ("associated: no factor of safety was found; use another mesh",)


def test_problems_of_a_case_are_told_at_once(tmp_path: Path):
    text = (PUBLISHED / "acads_1a.toml").read_text(encoding="utf-8")
    bad = tmp_path / "acads_1a.toml"
    bad.write_text(text.replace('expected = "fs"', 'expected = "safety"').replace("source", "sourse"), encoding="utf-8")
    with pytest.raises(InputError, match=r"(?s)source.*expected|expected.*source"):
        read_case(bad)


def test_a_folder_without_cases_and_a_name_without_one_are_told(tmp_path: Path):
    with pytest.raises(InputError, match="no cases"):
        read_cases(tmp_path)
    with pytest.raises(InputError, match='no case "nobody"'):
        read_cases(PUBLISHED, ["nobody"])
    with pytest.raises(InputError, match='no case "griffith_lane_1"; did you mean griffiths_lane_1'):
        read_cases(PUBLISHED, ["griffith_lane_1"])


def test_names_may_be_written_with_capitals():
    assert [case.name for case in read_cases(PUBLISHED, ["ACADS_1a", "Low"])] == ["acads_1a", "low_2"]


def test_the_page_says_which_versions_its_numbers_are_of():
    def message(*commits: str) -> str:
        answers = {
            name: replace(GOOD, name=name, commit=commit) for name, commit in zip(cases(), commits, strict=False)
        }
        return text(PUBLISHED, list(cases().values()), answers)

    assert "All numbers are of one version of the program, commit 1a2b." in message("1a2b", "1a2b")
    assert "of several versions of the program, by their commits: 1a2b (2), an unknown one (1)." in message(
        "1a2b", "1a2b", ""
    )
    assert "commit" not in message("", "")


def test_the_version_is_the_commit_of_a_checkout(tmp_path: Path):
    assert version_of(tmp_path) == ""
    for command in (["init", "-q"], ["add", "."], ["-c", "user.name=a", "-c", "user.email=a@b", "commit", "-qm", "c"]):
        (tmp_path / "a.py").write_text("a = 1\n")
        subprocess.run(["git", *command], cwd=tmp_path, check=True)
    assert len(version_of(tmp_path)) == 9
    (tmp_path / "a.py").write_text("a = 2\n")
    assert version_of(tmp_path).endswith("+")


def test_a_value_may_be_a_range():
    value = Value(kind="survey", author="a", method="b", value=(1.0, 1.2))
    assert value.ends == (1.0, 1.2)
