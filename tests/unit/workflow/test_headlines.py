"""The three numbers of the first page of the report, and their intervals."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from tests.support.answers import bounds, fem, results
from tests.support.dem_fixture import case
from tests.support.sections import analysed, slope
from workflow.estimates.slide_error import SlideError
from workflow.report.console import fem_sentences
from workflow.report.first_page import headlines
from workflow.report.flow_rule import with_flow
from workflow.report.slide_headline import block_slides
from workflow.results import governing
from workflow.results.bounds import SafetyPart
from workflow.results.cases import CasesAnswer
from workflow.results.continuum import FactorOfSafety, ShallowFailurePart
from workflow.results.lengths import metres
from workflow.results.verdicts import HeadlinePart
from workflow.texts.report_texts import Texts


def test_a_factor_of_safety_is_in_the_headline_only_with_its_error() -> None:
    """One mesh, as S-13 has it: strict bounds of its critical Kh tell its error, else the number stays in the text."""
    run = analysed(slope())
    factor = FactorOfSafety(
        kh=0.0, factor=8.84, upper=8.9, verdict="plateau", reason="", curve=(), shallow_failure=None
    )
    answer = fem(run, 0.2345).model_copy(update={"safety_factors": (factor,)})
    alone = headlines(results(run, fem=answer), Texts())[1]
    assert (alone.value, alone.interval) == ("–", "numerical error not known: one mesh, no strict bounds")
    assert "with a factor of safety of 8.84" in alone.conclusion
    messages = headlines(results(run, fem=answer, bounds=bounds(run, 0.2293, 0.2349)), Texts())[1]
    assert messages.value == "8.84"
    assert messages.interval == "one mesh; the error of the critical Kh on this mesh is at most 3 % by strict bounds"
    meshes = answer.model_copy(update={"safety_factors": (factor.model_copy(update={"remaining_error": 0.01}),)})
    assert headlines(results(run, fem=meshes), Texts())[1].interval == "8.75 to 8.84 by the sequence of meshes"


@pytest.mark.parametrize("above", [0.0004, 0.006])
def test_a_headline_never_lies_above_the_strict_upper_bound(above: float) -> None:
    """Dams with cohesionless shells: elements 1.430, upper bound 1.424, told as 1.43 beside 1.42."""
    run = analysed(slope())
    factor = FactorOfSafety(
        kh=0.0, factor=1.424 + above, upper=1.43, verdict="plateau", reason="", curve=(), shallow_failure=None
    )
    answer = fem(run, 0.2 + above).model_copy(update={"safety_factors": (factor,)})
    part = SafetyPart(kh=0.0, lower=1.297, upper=1.424, cells=100)
    strict = bounds(run, 0.199, 0.2).model_copy(update={"safety": (part,)})
    judged = results(run, fem=answer, bounds=strict)
    kh, safety, *_ = headlines(judged, Texts())
    assert (kh.value, safety.value, safety.interval) == ("0.200", "1.42", "1.30 to 1.42 by strict bounds")
    messages = ["the strict upper bound, which is therefore reported" in part.conclusion for part in (kh, safety)]
    assert messages == [above > 0.001] * 2
    console = " ".join(fem_sentences(answer, run.section, False, judged))
    assert "Factor of safety at Kh = 0: 1.424 with ψ = φ." in console
    assert ("The finite elements give 1.430, 0.4 % above the strict upper bound, which is reported." in console) == (
        above > 0.001
    )


@pytest.mark.parametrize(("davis", "shown"), [(0.093, "0.085"), (0.07, "0.070"), (-1.0, "below 0, it fails")])
def test_daviss_estimate_is_never_told_above_the_value_with_full_dilation(davis: float, shown: str) -> None:
    """Elements of a slope with a toe of no strength had 0.093 for both, above the strict upper bound of 0.085."""
    words = with_flow(0.085, "associated", davis, "Davis's estimate for ψ = 0", "{:.3f}".format)
    assert words.startswith(f"0.085 with ψ = φ; Davis's estimate for ψ = 0, which is no bound: {shown}")


@pytest.mark.parametrize(("lower", "message"), [(1.30, "2.0 % less"), (1.41, "1.0 % less"), (1.424, "")])
def test_a_finer_mesh_cannot_give_less_than_the_strict_lower_bound(lower: float, message: str) -> None:
    """Elements 1.564, a lower bound of 1.562, and yet "a finer mesh may give 1.9 % less"."""
    run = analysed(slope())
    factor = FactorOfSafety(
        kh=0.0,
        factor=1.424,
        upper=1.424,
        verdict="plateau",
        reason="",
        curve=(),
        shallow_failure=None,
        remaining_error=0.02,
    )
    answer = fem(run, 0.2).model_copy(update={"safety_factors": (factor,)})
    part = SafetyPart(kh=0.0, lower=lower, upper=1.44, cells=100)
    judged = results(run, fem=answer, bounds=bounds(run, 0.199, 0.2).model_copy(update={"safety": (part,)}))
    console = " ".join(fem_sentences(answer, run.section, False, judged))
    assert ("A finer mesh may give" in console) == bool(message)
    assert message in console
    interval = headlines(judged, Texts())[1].interval
    low = f"{max(lower, 0.98 * 1.424):.2f}"
    expected = "error below 0.01" if low == "1.42" else f"{low} to 1.42"
    alone = f"; strict bounds alone {lower:.2f} to 1.44"
    assert interval == f"{expected} by strict bounds and the sequence of meshes{alone}"


def test_the_first_page_has_the_shallow_failure_that_the_critical_kh_excludes() -> None:
    """A river bank: 0.163 "(shallow failures excluded)", while its face fails at 0.123, which stood on another page."""
    run = analysed(slope())
    faces = [
        ShallowFailurePart(stratum="Sand", start_x_m=start, end_x_m=end, angle_deg=18.4, kh=kh)
        for start, end, kh in ((40.0, 46.0, 0.15), (58.0, 64.0, 0.123), (70.0, 70.1, 0.05), (80.0, 90.0, 0.2))
    ]
    sentence = 'The cohesionless face of "Sand" from x = 58 to 64 m fails at Kh = 0.123 already; this shallow failure'
    for strict in (None, bounds(run, 0.158, 0.16)):
        answer = fem(run, 0.163).model_copy(update={"shallow_failures": tuple(faces)})
        assert sentence in headlines(results(run, fem=answer, bounds=strict), Texts())[0].conclusion
    falls = fem(run, 0.163).model_copy(update={"shallow_failures": (faces[0].model_copy(update={"kh": -0.05}),)})
    conclusion = headlines(results(run, fem=falls), Texts())[0].conclusion
    assert (
        "x = 40 to 46 m fails by its own weight; this shallow failure is excluded" in conclusion
    )  # was "at Kh = 0.000"
    answer = fem(run, 0.163).model_copy(update={"shallow_failures": tuple(faces[2:])})
    assert "shallow" not in headlines(results(run, fem=answer), Texts())[0].conclusion


@pytest.mark.parametrize(
    ("middle", "message"),
    [
        (1.6, "0.3 to 3 m by the error of material points: they predicted 20 of 28 known slides within a factor of 3"),
        (9.0, "uncertain by a factor of 5: 20 of 30 known slides were predicted within this factor by discs, "),
    ],
)
def test_the_interval_of_a_slide_is_that_of_the_method_nearer_to_known_slides(
    middle: float, message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Discs slide 0.2 m, material points 1 m: of the two the one whose known slides lie closer counts alone."""
    errors = {
        "discs": SlideError("lateral spreads", 5.0, 20, 30, 3.2),
        "mpm": SlideError("lateral spreads", 3.0, 20, 28, middle, "mpm"),
    }
    monkeypatch.setattr(governing, "slide_error", lambda flows, method: errors[method])
    run = analysed(slope())
    slides = CasesAnswer(sets={"calibrated": {1: case(1.0, 0.2)}}, random=None)
    point = SimpleNamespace(
        slide_max_m=1.0, slide_max_low_m=1.0, slide_max_high_m=1.0, settled=True, reason="", stopped_by=None
    )
    both = results(run, cases=slides, mpm=cast(Any, SimpleNamespace(cases={1: point})))
    slide = headlines(both, Texts())[2]
    assert slide.interval.startswith(message)
    value, other = ("1.0 m", "0.20 m") if middle < 3.2 else ("0.20 m", "1.0 m")
    assert slide.value == value
    assert (
        f"the surface slides {value} by {'material points' if middle < 3.2 else 'discs'} (one case)" in slide.conclusion
    )
    assert f", is {other} (" in slide.conclusion.partition("A second opinion, by ")[2]


def slide_by_points(
    points: dict[int, SimpleNamespace], error: SlideError, monkeypatch: pytest.MonkeyPatch
) -> HeadlinePart:
    """Return the headline of slides by material points, which have this error on known slides."""
    monkeypatch.setattr(governing, "slide_error", lambda flows, method: error if method == "mpm" else None)
    return headlines(results(analysed(slope()), mpm=cast(Any, SimpleNamespace(cases=points))), Texts())[2]


@pytest.mark.parametrize(("stopped", "value"), [((), "23 to 48 m"), ((2,), "23 to over 48 m"), ((1, 2), "over 23 m")])
def test_a_slide_that_reaches_a_side_of_the_model_is_open_above(
    stopped: tuple[int, ...], value: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A river bank: "≥ 23 to 48 m" beside "8 to 150 m" could be read as either, and neither end was a limit."""
    error = SlideError("flow slides", 3.0, 20, 28, 1.7, "mpm")
    points = {
        number: SimpleNamespace(
            slide_max_m=far, slide_max_low_m=far, slide_max_high_m=far, settled=number not in stopped, reason="",
            stopped_by="right" if number in stopped else None,
        )
        for number, far in ((1, 23.0), (2, 48.0))
    }  # fmt: skip
    slide = slide_by_points(points, error, monkeypatch)
    assert slide.value == value
    assert f"the surface slides {value} by material points" in slide.conclusion
    assert slide.interval.startswith("8 m or more by the error" if stopped else "8 to 140 m by the error")


def test_a_slide_that_still_moves_is_a_lower_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    """Tailings that move at 9 m/s after 10 s of computation: "22 m" could be read as the final slide."""
    error = SlideError("flow slides", 3.0, 20, 28, 1.7, "mpm")
    point = SimpleNamespace(
        slide_max_m=22.0, slide_max_low_m=22.0, slide_max_high_m=24.0, settled=False, reason="", stopped_by=None
    )
    slide = slide_by_points({1: point}, error, monkeypatch)
    assert slide.value == "over 22 m"
    assert "the surface slides over 22 m by material points" in slide.conclusion
    assert "was still moving when the computation ended" in slide.conclusion
    assert slide.interval.startswith("7 m or more by the error")


def test_a_lower_end_that_the_factor_does_not_give_names_the_numerical_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """S-13: "0 to 3 m" was told of 0.96 m within a factor of 3; its cells alone leave 0 to 0.96 m."""
    error = SlideError("lateral spreads", 3.0, 20, 30, 2.1, "mpm")
    point = SimpleNamespace(
        slide_max_m=0.96, slide_max_low_m=0.0, slide_max_high_m=0.96, settled=True, reason="", stopped_by=None
    )
    slide = slide_by_points({1: point}, error, monkeypatch)
    assert slide.interval == (
        "0 to 3 m by the error of material points: they predicted 20 of 30 known slides within a factor of 3; the "
        "numerical error alone gives 0 to 0.96 m"
    )


def test_the_numerical_error_is_named_beside_an_error_too_large_for_an_interval(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """S-13 again: within a factor of 5 of 0.96 m, and the cells alone leave 0 to 0.96 m, which was unsaid."""
    error = SlideError("lateral spreads", 5.0, 23, 31, 2.3, "mpm")
    point = SimpleNamespace(
        slide_max_m=0.96, slide_max_low_m=0.0, slide_max_high_m=0.96, settled=True, reason="", stopped_by=None
    )
    slide = slide_by_points({1: point}, error, monkeypatch)
    assert not error.bounds_slides
    assert slide.interval.startswith("uncertain by a factor of 5: 23 of 31")
    assert slide.interval.endswith("; the numerical error alone gives 0 to 0.96 m")


def test_where_nothing_liquefies_the_third_number_is_that_of_a_rigid_block_in_the_earthquake() -> None:
    data = {**slope(), "earthquake": {"magnitude": 6.8, "peak_acceleration": "0.3 g"}}
    weak = headlines(results(analysed(data), fem=fem(analysed(data), 0.05)), Texts())[2]
    assert weak.name == "displacement in the earthquake"
    assert weak.conclusion.startswith(
        "No layer of the section liquefies. In the earthquake the ground that fails slides"
    )
    assert "by Newmark's block" in weak.conclusion
    assert weak.value in weak.conclusion or " to " in weak.value
    stable = headlines(results(analysed(data), fem=fem(analysed(data), 0.5)), Texts())[2]
    assert stable.conclusion.count("0 m by") >= 1
    quiet = headlines(results(analysed(slope()), fem=fem(analysed(slope()), 0.05)), Texts())[2]
    assert (quiet.name, quiet.value) == ("slide after liquefaction", "–")


def test_a_block_under_a_record_counts_in_both_directions(tmp_path: Path) -> None:
    """A hillside had "0 to 0.01 m" beside a block that slid 0.13 and 0.23 m under the record of the file: the first
    page had the last of all blocks, that of the mean acceleration."""
    time = np.arange(0.0, 8.0, 0.01)
    acceleration = 0.4 * 9.80665 * np.where(time < 4.0, 1.0, 0.2) * np.sin(2.0 * np.pi * time)
    record = tmp_path / "r.csv"
    lines = [f"{t:.2f},{a:.5f}" for t, a in zip(time, acceleration, strict=True)]
    record.write_text("\n".join(["time (s),acceleration (m/s^2)", *lines]), encoding="utf-8")
    data = {**slope(), "earthquake": {"magnitude": 6.8, "peak_acceleration": "0.1 g"}}
    data["sliding_block"] = {"accelerogram": str(record)}
    run = analysed(data)
    answer = results(run, fem=fem(run, 0.1))
    slides = block_slides(answer)
    directions = [slides[f"rigid block under the accelerogram, {way}"] for way in ("positive", "negative")]
    assert min(directions) > 0.05
    assert not any(method.endswith(", mean") or method == "Newmark's block" for method in slides)
    third = headlines(answer, Texts())[2]
    assert metres(max(slides.values())) in third.value
    assert f"by {len(slides) - 1} methods" in third.interval


def test_bounds_below_the_elements_are_the_one_headline_and_the_picture_has_the_same() -> None:
    """S-13: 0.237 by elements, 0.2338 to 0.235 by bounds. Card and sentence have 0.235, elements only their excess."""
    run = analysed(slope())
    headline = headlines(results(run, fem=fem(run, 0.237), bounds=bounds(run, 0.2338, 0.235)), Texts())[0]
    assert headline.value == "0.235"
    assert "at Kh = 0.235 (" in headline.conclusion
    assert "The finite elements give a Kh that is 0.9 % higher" in headline.conclusion
    assert "0.237" not in headline.conclusion
    far = headlines(results(run, fem=fem(run, 0.237), bounds=bounds(run, 0.15, 0.20)), Texts())[0]
    assert far.value == "≤ 0.200"
    assert "at Kh = 0.200 or less" in far.conclusion
