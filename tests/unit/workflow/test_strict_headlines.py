"""Every number that is reported as the answer lies within its own strict bounds, wherever it is reported."""

import re

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from tests.support.answers import bounds, fem, results
from tests.support.sections import analysed, slope
from workflow.config import Config
from workflow.figures.front import front
from workflow.report.assumptions import assumptions
from workflow.report.console import fem_sentences, meshes_sentences
from workflow.report.first_page import headlines
from workflow.report.stability import stability_rows
from workflow.report.summary import summary
from workflow.results import governing
from workflow.results.bounds import DirectionPart, SafetyPart
from workflow.results.continuum import FactorOfSafety, MeshStep, OtherCriticalKh
from workflow.results.governing import governing_factor, governing_kh, governing_value
from workflow.results.results import Results
from workflow.texts.report_texts import Texts

HALF_DIGIT = 0.0005 + 1e-9  # of the last digit of a critical Kh; ten times this of a factor of safety
ROUNDING = 0.001  # elements this share beyond a bound do not contradict it

RUN = analysed(slope())

kh_values = st.floats(0.02, 0.8)
factors = st.floats(1.3, 4.0)  # an upper bound below 1 proves that there is no critical Kh
shares = st.floats(0.9, 1.1)
widths = st.floats(1.0, 1.1)


def judged(
    run: Config, kh: float, factor: float, share: float, width: float, shallow: tuple[float | None, float | None]
) -> Results:
    """Return results with bounds of ``width`` whose lower one is ``share`` times the finite elements, in both
    directions, and of the factor of safety; ``shallow`` failures by elements and by bounds."""
    by_elements, by_bounds = shallow
    of_factor = FactorOfSafety(
        kh=0.0, factor=factor, upper=factor, verdict="plateau", reason="", curve=(), shallow_failure=by_elements
    )
    other = OtherCriticalKh(kc=1.5 * kh, kc_upper=1.5 * kh, verdict="plateau", reason="", direction="uphill",
                            at_sides=())  # fmt: skip
    answer = fem(run, kh).model_copy(update={"safety_factors": (of_factor,), "opposite": other})
    part = SafetyPart(kh=0.0, lower=share * factor, upper=share * width * factor, cells=100, shallow_failure=by_bounds)
    strict = bounds(run, share * kh, share * width * kh)
    opposite = DirectionPart(direction="uphill", towards="left", lower=1.5 * share * kh,
                             upper=1.5 * share * width * kh, leaves=(), history=())  # fmt: skip
    strict = strict.model_copy(update={"safety": (part,), "directions": (*strict.directions, opposite)})
    return results(run, fem=answer, bounds=strict)


def is_within(value: float, lower: float, upper: float, half_digit: float) -> bool:
    """Return whether a printed value lies within bounds, to half of its last digit and to rounding."""
    return lower * (1.0 - ROUNDING) - 2.0 * half_digit <= value <= upper * (1.0 + ROUNDING) + 2.0 * half_digit


@given(kh_values, factors, shares, widths)
def test_every_reported_number_lies_within_its_strict_bounds(
    kh: float, factor: float, share: float, width: float
) -> None:
    """A headline lay 2 % below its own strict lower bound: only upper bounds were known to the choice of the number."""
    run = analysed(slope())
    answers = judged(run, kh, factor, share, width, (None, None))
    of_kh, of_factor = (share * kh, share * width * kh), (share * factor, share * width * factor)
    first, safety, *_ = headlines(answers, Texts())
    assert is_within(float(first.value.lstrip("≤≥ ")), *of_kh, HALF_DIGIT)
    assert is_within(float(safety.value), *of_factor, 10.0 * HALF_DIGIT)
    console = " ".join(fem_sentences(answers.fem, run.section, False, answers))
    printed = re.search(r"Critical Kh [=≤≥] ([0-9.]+)", console)
    other = re.search(r"seismic force upslope the critical Kh is ([0-9.]+), with", console)
    of_safety = re.search(r"Factor of safety at Kh = 0: ([0-9.]+) with", console)
    assert printed
    assert other
    assert of_safety
    assert is_within(float(printed[1]), *of_kh, HALF_DIGIT)
    assert is_within(float(other[1]), 1.5 * of_kh[0], 1.5 * of_kh[1], HALF_DIGIT)
    assert is_within(float(of_safety[1]), *of_factor, HALF_DIGIT)


@pytest.mark.parametrize(("share", "words"), [(1.02, "below the strict lower bound of"), (0.9, "above the strict")])
def test_picture_table_and_summary_have_the_bound_that_counts(share: float, words: str) -> None:
    run = analysed(slope())
    answers = judged(run, 0.2, 1.4, share, 1.01, (None, None))
    counts = share * (1.0 if share > 1.0 else 1.01)
    sheet = front(answers)
    assert sheet is not None
    labels = [text.get_text() for legend in sheet.figure.legends for text in legend.get_texts()]
    assert any(f"Kh = {0.2 * counts:.3f}" in label for label in labels)
    rows = [row.conditions for row in stability_rows(answers, Texts()) if words in row.conditions]
    assert len(rows) == 3  # both directions, and the factor of safety
    answer = summary(answers, 1.0)
    assert answer.fem is not None
    assert answer.fem.kc == 0.2
    assert answer.fem.kc_governing == pytest.approx(0.2 * counts)
    assert answer.fem.safety_factors[0].governing == pytest.approx(1.4 * counts)


def test_finite_elements_below_a_strict_lower_bound_are_told() -> None:
    run = analysed(slope())
    near, wide = (headlines(judged(run, 0.2, 1.4, 1.02, width, (None, None)), Texts()) for width in (1.01, 1.1))
    assert near[0].value == "0.204"
    assert "a Kh that is 2.0 % lower, but a stress field in equilibrium proves" in near[0].conclusion
    assert near[1].value == "1.43"
    assert "a factor of safety that is 2.0 % lower, but a stress field" in near[1].conclusion
    assert wide[0].value == "≥ 0.204"
    assert "at Kh = 0.204 or more" in wide[0].conclusion


def test_a_lower_bound_of_strengthened_ground_is_none_of_elements_without() -> None:
    """Shallow ground may fail in the elements before the slope below the strengthened faces does."""
    run = analysed(slope())
    for by_elements, expected in ((None, 1.4), (1.2, 1.428)):
        answers = judged(run, 0.2, 1.4, 1.02, 1.01, (by_elements, 1.2))
        assert answers.fem is not None
        assert governing_factor(answers, answers.fem.safety_factors[0]) == pytest.approx(expected)


def test_a_rigid_block_resists_with_the_critical_kh_that_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    """Elements above their upper bound would give a block too small a slide."""
    used: list[float | None] = []
    monkeypatch.setattr(governing, "estimates", lambda section, config, kc, surface: used.append(kc) or [])
    assert governing.estimates_of(judged(analysed(slope()), 0.2, 1.4, 0.9, 1.01, (None, None))) == []
    assert used == [pytest.approx(0.2 * 0.9 * 1.01)]


def test_rounding_is_no_contradiction() -> None:
    assert governing_value(0.1997, 0.2, 0.21) == 0.1997
    assert governing_value(0.1990, 0.2, 0.21) == 0.2
    assert governing_value(0.2120, 0.2, 0.21) == 0.21
    assert governing_value(0.1, None, None) == 0.1


def test_the_headline_lies_in_its_printed_interval() -> None:
    """0.2135 by elements, 0.2134 as upper bound: the first page had "0.214; 0.212 to 0.213 by strict bounds"."""
    answers = judged(RUN, 0.21353, 1.7852, 0.2120 / 0.21353, 0.21338 / 0.2120, (None, None))
    first, safety, *_ = headlines(answers, Texts())
    for headline in (first, safety):
        low, high = re.findall(r"\d\.\d+", headline.interval)[:2]
        assert float(low) <= float(headline.value) <= float(high)
    assert (first.value, first.interval[:14]) == ("0.214", "0.212 to 0.214")


@pytest.mark.parametrize("flow", ["associated", "davis", "non-associated"])
def test_an_upper_bound_without_a_lower_one_limits_the_headline(flow: str) -> None:
    """The headline of a dam with a key trench, whose lower bounds the solver did not find, was 3 % above its strict
    upper bound, beside a warning of this contradiction."""
    answer, strict = fem(RUN, 0.1865), bounds(RUN, 0.15, 0.181)
    parts = tuple(part.model_copy(update={"lower": None}) for part in strict.directions)
    strict = strict.model_copy(update={"lower": None, "directions": parts})
    answers = results(RUN, fem=answer.model_copy(update={"flow": flow}), bounds=strict)
    kh = governing_kh(answers)
    assert kh is not None
    assert (kh.value, kh.bound, kh.text) == (0.181, "upper", "≤ 0.181")
    [headline, *_] = headlines(answers, Texts())
    assert (headline.value, headline.interval) == ("≤ 0.181", "by this strict bound alone")
    assert "reported as an upper limit" in headline.conclusion
    rows = [row for row in stability_rows(answers, Texts()) if row.quantity == "critical Kh, finite elements"]
    assert "above the strict upper bound of 0.181, which counts" in rows[0].conditions
    text = " ".join(fem_sentences(answers.fem, RUN.section, False, answers)) if answers.fem else ""
    assert "Critical Kh ≤ 0.181" in text


@given(st.floats(0.02, 0.5), st.none() | st.floats(0.01, 0.5), st.none() | st.floats(0.01, 0.5))
def test_no_headline_lies_beyond_a_strict_bound(kc: float, lower: float | None, upper: float | None) -> None:
    assume(lower is None or upper is None or lower <= upper)
    strict = bounds(RUN, lower or 0.0, upper or 1.0)
    parts = tuple(part.model_copy(update={"lower": lower, "upper": upper}) for part in strict.directions)
    strict = strict.model_copy(update={"lower": lower, "upper": upper, "directions": parts})
    kh = governing_kh(results(RUN, fem=fem(RUN, kc), bounds=strict))
    assert kh is not None
    assert upper is None or kh.value <= upper + 6e-4
    assert lower is None or kh.value >= lower - 6e-4


def test_a_limit_of_meshes_outside_the_strict_bounds_is_not_reported() -> None:
    """Two meshes of a quay, 0.1434 and 0.1389, "converged to 0.1259", below the strict lower bound of 0.1348."""
    meshes = (MeshStep(cells=1322, kc=0.1434), MeshStep(cells=1773, kc=0.1389))
    answer = fem(RUN, 0.1389).model_copy(update={"meshes": meshes, "kc_limit": 0.1259})
    for lower, said in ((0.1348, False), (0.1200, True)):
        sentences = " ".join(meshes_sentences(answer, results(RUN, fem=answer, bounds=bounds(RUN, lower, 0.1390))))
        assert ("converges to 0.1259" in sentences) == said
        assert "0.1434 (1322 cells), 0.1389 (1773 cells)" in sentences


def test_the_inertia_of_free_water_is_among_the_assumptions() -> None:
    moved = analysed({**slope(), "water": {"table": 8.0, "westergaard": True}})
    for run, said in ((moved, True), (analysed({**slope(), "water": {"table": 8.0}}), False)):
        assert ("inertia of free water" in dict(assumptions(run))["Water"]) == said
