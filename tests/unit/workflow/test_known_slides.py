"""Known slides: their files, the numbers of theory in them, verdicts, and the error that reports lean on."""

from pathlib import Path

import numpy as np
import pytest

from docs.known_slides import errors, text
from docs.verify.record import read_answers, write_answers
from docs.verify.slides.case import FOLDER, Column, SlideCase, UniformSlope, read_case, read_cases
from docs.verify.slides.record import SlideAnswer
from docs.verify.slides.shaking import shaking_of_slope
from docs.verify.slides.verdict import bias, judge, right
from meshes.errors import InputError
from tests.support.newmark import G, newmark_slide, newmark_slide_speed
from tests.support.published import slides
from workflow.estimates.slide_error import SlideError, error_of
from workflow.report.model_error import error_sentence
from workflow.results.governing import MethodSlides

ROOT = Path(__file__).parents[3]
CASES = slides()


def test_every_case_says_where_its_numbers_are_from() -> None:
    for case in CASES.values():
        assert case.title
        assert case.known.source
        assert case.measured[0] <= case.measured[1]


@pytest.mark.parametrize("name", [name for name in CASES if name.startswith("endless")])
def test_slides_of_endless_slopes_are_newmarks(name: str) -> None:
    """The strength in kPa does not follow Kh, a ratio does: their blocks differ by k sin b in the normal stress."""
    problem = CASES[name].known.problem
    assert isinstance(problem, UniformSlope)
    if problem.seconds is None:
        value = newmark_slide_speed(
            problem.angle, problem.left.residual_of("liquefies"), *shaking_of_slope(problem, CASES[name].folder)
        )
        assert CASES[name].measured[1] == pytest.approx(value, rel=2e-3)
        return
    left, sine, cosine = problem.left, np.sin(problem.angle), np.cos(problem.angle)
    if left.residual:
        expected = newmark_slide(problem.angle, left.residual_of("liquefies"), problem.kh, problem.seconds)
    else:
        ratio = left.strength_of("liquefies") / (problem.density * G * sum(problem.thickness) * cosine)
        on, off = G * (sine + problem.kh * cosine - ratio * cosine), G * (sine - ratio * cosine)
        on = max(on, 0.0)
        expected = 0.5 * on * problem.seconds**2 + (on * problem.seconds) ** 2 / (-2.0 * off)
    assert CASES[name].measured[1] == pytest.approx(expected, abs=6e-4)


@pytest.mark.parametrize("name", [name for name in CASES if name.startswith("clay_slow")])
def test_slumps_are_those_of_the_thin_plastic_layer(name: str) -> None:
    """With u = gamma h / s: gamma L / s = u0 (u0 - pi) / 2 and A gamma^2 / s^2 = u0^3/3 - pi u0^2/4 - pi^3/12."""
    problem = CASES[name].known.problem
    assert isinstance(problem, Column)
    ratio, width = problem.weight_over_strength, problem.width / problem.height
    length = CASES[name].measured[0] + width
    u0 = 0.5 * (np.pi + np.sqrt(np.pi**2 + 8.0 * ratio * length))
    area = u0**3 / 3.0 - np.pi * u0**2 / 4.0 - np.pi**3 / 12.0
    assert area == pytest.approx(width * ratio**2, rel=2e-3)


def answered(*values: float) -> SlideAnswer:
    return SlideAnswer("column_33_100", values, (0.0,) * len(values), (True,) * len(values))


def test_verdicts() -> None:
    case = CASES["column_33_100"]
    assert case.measured == (1.2, 1.39)
    assert judge(case, None).word == "not run"
    assert judge(case, SlideAnswer("column_33_100", failure="no")).word == "failed"
    assert judge(case, answered(1.3, 1.3)).word == "within the band"
    middle = np.sqrt(1.2 * 1.39)
    close = judge(case, answered(0.9, 1.1))
    assert close.word == "within 1.5"
    assert close.ratio == pytest.approx(1.0 / middle)
    assert close.spread == pytest.approx((0.9 / middle, 1.1 / middle))
    assert judge(case, answered(3.0)).word == "within 3"
    assert judge(case, answered(0.0)).word == "beyond 3"
    stands = CASES["vertical_cut_30"]
    assert judge(stands, answered(0.01, 0.02)).word == "stands"
    assert judge(stands, answered(0.01, 0.2)).word == "moved"
    endless = CASES["whiskey_springs_1983_slope_n461"]
    assert judge(endless, SlideAnswer(endless.name, (1600.0,), (0.0,), (False,))).word == "flows"
    assert judge(endless, SlideAnswer(endless.name, (1.0,), (0.0,), (True,))).word == "within 1.5"
    verdicts = [judge(case, answered(item)) for item in (1.3, 0.6, 0.1)] + [judge(stands, answered(0.0))]
    assert right(verdicts, 1.5) == 2
    assert right(verdicts, 3.0) == 3
    assert bias(verdicts) == pytest.approx(0.6 / middle)


def test_answers_are_kept_and_told(tmp_path: Path) -> None:
    write_answers(tmp_path / "answers.json", {"column_33_100": answered(1.3, 1.0)})
    answers = read_answers(tmp_path / "answers.json", SlideAnswer)
    assert answers["column_33_100"].values == (1.3, 1.0)
    cases = [CASES["column_33_100"], CASES["vertical_cut_30"]]
    page = text(tmp_path, cases, answers)
    assert "| 1.3, 1 | 0.89 (0.77 to 1.01) |" in page
    assert "not run" in page
    table = errors(cases, answers).splitlines()
    assert table == ["name,group,kind,method,ratio", "column_33_100,experiment,column,discs,0.89"]
    name = "wildlife_1987_w13"
    both = {name: SlideAnswer(name, values=(0.22,), points=0.11)}
    assert "| 0.22<br>material points 0.11 | 2.00<br>1.00 (within the band) |" in text(tmp_path, [CASES[name]], both)
    assert errors([CASES[name]], both).splitlines()[1:] == [
        f"{name},field,spread,discs,2",
        f"{name},field,spread,mpm,1",
    ]
    (tmp_path / "answers.json").write_text("[1]")
    with pytest.raises(InputError, match="delete the file"):
        read_answers(tmp_path / "answers.json", SlideAnswer)


def test_the_error_of_the_model_is_the_factor_that_holds_two_thirds() -> None:
    assert error_of("spreads", []) is None
    error = error_of("spreads", [1.0, 1.4, 0.5, 2.5, 0.6, 0.9])
    assert error == SlideError("spreads", 2.0, 5, 6, pytest.approx(0.5 * (1.4 + 1.0 / 0.6)))
    assert error.interval(0.5, 1.0) == (0.25, 2.0)
    assert error.sentence() == "Spreads of the collection were predicted by discs within a factor of 2 in 5 of 6 cases"
    assert error_of("spreads", [0.0, 100.0]) == SlideError("spreads", 10.0, 0, 2, float("inf"))


def test_a_file_with_faults_is_refused_in_words(tmp_path: Path) -> None:
    file = tmp_path / "wrong.toml"
    file.write_text('name = "other"\n[known]\ngroup = "theory"\n', encoding="utf-8")
    with pytest.raises(InputError, match="source"):
        read_case(file)
    good = (ROOT / FOLDER / "column_33_100.toml").read_text(encoding="utf-8")
    file.write_text(good, encoding="utf-8")
    with pytest.raises(InputError, match='expected that of the file, "wrong"'):
        read_case(file)
    (tmp_path / "column_33_100.toml").write_text(good.replace("[known]", "[fem]\n[known]"), encoding="utf-8")
    with pytest.raises(InputError, match="fem: not used"):
        read_case(tmp_path / "column_33_100.toml")
    with pytest.raises(InputError, match='there is no case "nowhere"'):
        read_cases(ROOT / FOLDER, ("nowhere",))
    assert isinstance(CASES["column_33_100"], SlideCase)


def test_the_report_says_how_far_off_the_model_was_and_no_more_digits_than_that() -> None:
    def sentence(low: float, high: float, error: SlideError | None) -> str:
        return error_sentence(MethodSlides("discs", {}, (low, high), error))

    near = SlideError("flow failures", 3.0, 6, 9, 2.0)
    messages = sentence(1.234, 2.345, near)
    assert messages == (
        "Flow failures of the collection were predicted by discs within a factor of 3 in 6 of 9 cases; with this error "
        "the largest slide is 0.4 to 7 m."
    )
    assert sentence(0.0, 0.0, near) == ""
    far = SlideError("flow failures", 10.0, 7, 9, 2.9)
    messages = sentence(4.0, 10.0, far)  # by a factor of 10: 0.4 to 100 m, which nobody can use
    assert messages.endswith(
        "in 7 of 9 cases, half of them within a factor of 2.9: use the slide as an order of magnitude."
    )
    seldom = SlideError("lateral spreads", 10.0, 3, 9, 20.0)
    assert sentence(1.0, 1.0, seldom).endswith("is not predicted by these discs.")
    assert sentence(1.0, 1.0, None) == ""
