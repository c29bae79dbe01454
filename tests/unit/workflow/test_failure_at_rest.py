"""Kh and factors of safety of one ground must not contradict each other: a proof that it fails without a seismic force
governs every number."""

import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fem.errors import UnstableError
from fem.limit import safety_bounds
from fem.settings import BoundsSettings, FemSettings
from meshes.executor import OneThread
from meshes.section.section import Section
from tests.support.answers import bounds, fem, results
from tests.support.sections import analysed, layer, slope
from workflow.cli import terminal
from workflow.config import Config
from workflow.criteria.settings import CriteriaSettings
from workflow.figures.front import front
from workflow.report.console import fem_sentences
from workflow.report.faces import MethodValues
from workflow.report.first_page import headlines
from workflow.report.flow_rule import critical_with_flow
from workflow.report.stability import stability_rows
from workflow.report.summary import summary
from workflow.report.verdicts import interval_words, verdicts
from workflow.results.answer import SectionLabel
from workflow.results.bounds import BoundsAnswer, DirectionPart, SafetyPart
from workflow.results.continuum import FactorOfSafety, FailureAnswer, OtherCriticalKh
from workflow.results.governing import estimates_of, governing_factor, governing_kh
from workflow.results.material_points import PointSlidesAnswer
from workflow.results.results import Results
from workflow.results.verdicts import VerdictPart
from workflow.run import pipeline
from workflow.run.plan import Choice
from workflow.run.progress import Verbosity
from workflow.run.record import Entry
from workflow.run.stage import Job
from workflow.run.store import Store
from workflow.stages.bounds import work
from workflow.texts.report_texts import Texts

HALF_DIGIT = 0.0005  # of a critical Kh; ten times this of a factor of safety


def with_excess_pressure() -> Config:
    """Return the config of a slope whose pore pressure rises by shaking."""
    data = slope()
    data["strata"][0]["excess_pore_pressure_ratio"] = 0.3
    return analysed(data)


def factor(value: float, after_shaking: bool = False) -> FactorOfSafety:
    return FactorOfSafety(
        kh=0.0, factor=value, upper=value, verdict="plateau", reason="", curve=(), shallow_failure=None,
        after_shaking=after_shaking, remaining_error=0.001,
    )  # fmt: skip


def dam(rises: bool = True, upper: float | None = -0.0015) -> Results:
    """Return results as those of a dam whose toe is too small for the finite elements: 0.0127 for -0.0015."""
    run = with_excess_pressure() if rises else analysed(slope())
    answer = fem(run, 0.0127).model_copy(
        update={"safety_factors": (factor(1.26),), "after_shaking": factor(1.02, True) if rises else None}
    )
    of_factor = SafetyPart(kh=0.0, lower=1.258 if rises else None, upper=1.264, cells=9)
    lower = None if upper is None else -0.0024
    strict = bounds(run, -0.0024, -0.0015).model_copy(update={"upper": upper, "lower": lower, "safety": (of_factor,)})
    return results(run, fem=answer, bounds=strict)


def slope_proven_to_fail(lower: float, upper: float) -> Results:
    """Return results of elements that stand up to Kh = 0.0127, beside strict bounds."""
    run = analysed(slope())
    return results(run, fem=fem(run, 0.0127), bounds=bounds(run, lower, upper))


def judged_kh(answers: Results) -> tuple[VerdictPart, ...]:
    """Return the verdicts on a critical Kh of at least 0.1."""
    run = answers.config.model_copy(
        update={"criteria": CriteriaSettings.model_validate({"critical_kh": {"limit": 0.1}})}
    )
    return tuple(verdicts(replace(answers, config=run)))


def printed_text(answers: Results) -> str:
    """Return what a command prints of the finite elements."""
    assert answers.fem is not None
    return " ".join(fem_sentences(answers.fem, answers.config.section, False, answers))


def test_a_proof_of_failure_without_shaking_governs_every_number() -> None:
    """The headline was Kh = 0.013 beside bounds that ended with "at most -0.0015"."""
    answers = dam()
    assert answers.kc is None
    assert governing_kh(answers) is None
    kh, safety, _ = headlines(answers, Texts())
    assert kh.value == "< 0"
    assert "by its weight and the excess pore pressure of shaking: its critical Kh is at most -0.0015" in kh.conclusion
    assert "give a critical Kh of 0.013, which does not count" in kh.conclusion
    assert safety.name == "factor of safety before shaking"
    assert safety.value == "1.26"
    assert safety.interval.endswith("; 1.00 after shaking")
    assert "the section does not stand: its factor of safety is at most 1.00" in safety.conclusion
    printed = printed_text(answers)
    assert printed.startswith("No critical Kh. Strict bounds prove that the section fails without a seismic force")
    assert "Factor of safety at Kh = 0 before shaking: 1.260" in printed
    assert "Factor of safety at Kh = 0 after shaking, with its excess pore pressure: 1.000" in printed
    assert [(part.verdict, part.low, part.high) for part in judged_kh(answers)] == [("not satisfied", None, -0.0015)]
    short = summary(answers, 1.0).fem
    assert short is not None
    assert short.kc is short.kc_governing is None
    assert short.after_shaking is not None
    assert (short.safety_factors[0].governing, short.after_shaking.governing) == (1.26, 1.0)
    assert not any("kc = 0.013" in (estimate.note or "") for estimate in estimates_of(answers))
    rows = [row for row in stability_rows(answers, Texts()) if "after shaking" in row.quantity]
    assert [row.value for row in rows] == ["1.02"]
    assert "above 1.00, which the strict upper bound of the critical Kh excludes" in rows[0].conditions


def test_a_factor_that_shaking_leaves_as_it_is_is_told_once() -> None:
    """Of a levee on sand with excess pore pressure only the fill fails, before and after shaking."""
    run = with_excess_pressure()
    answer = fem(run, 0.2).model_copy(update={"safety_factors": (factor(1.96),), "after_shaking": factor(1.96, True)})
    text = " ".join(fem_sentences(answer, run.section, False, results(run, fem=answer)))
    assert text.count("Factor of safety") == 1
    assert "Factor of safety at Kh = 0 before and after shaking: 1.960" in text


def test_ground_without_excess_pore_pressure_has_one_factor() -> None:
    """Its factor of safety of 1.26 is no factor of ground that a mechanism of its Kh proves to fail."""
    answers = dam(rises=False)
    kh, safety, _ = headlines(answers, Texts())
    assert kh.value == "< 0"
    assert "under its own weight" in kh.conclusion
    assert safety.name == "factor of safety"
    assert safety.value == "≤ 1.00"
    assert safety.interval == "by the strict upper bound of the critical Kh"
    assert "does not stand: its factor of safety is at most 1.00" in safety.conclusion
    assert "Factor of safety at Kh = 0: 1.000 with" in printed_text(answers)


def test_a_mechanism_at_free_sides_does_not_limit_a_factor_between_held_sides() -> None:
    """The headline was "at most 1.00" beside a table with 1.26 and its strict bounds, all at once."""
    answers = dam(rises=False)
    assert answers.bounds is not None
    moved = tuple(part.model_copy(update={"leaves": ("right",)}) for part in answers.bounds.directions)
    free = results(answers.config, fem=answers.fem, bounds=answers.bounds.model_copy(update={"directions": moved}))
    kh, safety, _ = headlines(free, Texts())
    assert kh.value == "< 0"
    assert "moves a side of the section, as free-field sides permit" in kh.conclusion
    assert safety.value == "1.26"
    assert "Between sides held horizontally the section stands without shaking" in safety.conclusion
    rows = [row for row in stability_rows(free, Texts()) if "factor" in row.quantity and "elements" in row.quantity]
    assert [(row.value, "which counts" in row.conditions) for row in rows] == [("1.26", False)]


def test_an_upper_bound_of_the_factor_below_1_proves_the_failure_too() -> None:
    """Here the bounds of Kh are missing, as where the solver failed."""
    answers = dam(upper=None)
    assert not answers.fails_at_rest
    assert answers.bounds is not None
    of_factor = SafetyPart(kh=0.0, lower=0.96, upper=0.98, cells=9, after_shaking=True)
    strict = answers.bounds.model_copy(update={"after_shaking": of_factor})
    proven = results(answers.config, fem=answers.fem, bounds=strict)
    kh, safety, _ = headlines(proven, Texts())
    assert kh.value == "< 0"
    assert "its factor of safety is at most 0.98" in kh.conclusion
    assert safety.interval.endswith("; 0.98 after shaking")
    before = SafetyPart(kh=0.0, lower=0.96, upper=0.98, cells=9)
    other = results(answers.config, fem=answers.fem, bounds=answers.bounds.model_copy(update={"safety": (before,)}))
    assert not other.fails_at_rest  # of other ground: that without excess pore pressure


def test_a_factor_between_held_sides_is_no_proof_of_failure() -> None:
    """Where K0 stress alone pushes the ground out, no number is the bound of Kh, and the factor is above 1."""
    kh, *_ = headlines(dam(rises=False, upper=-40.0), Texts())
    assert "no horizontal force could stabilise it" in kh.conclusion
    assert "at most 1.26" not in kh.conclusion


@given(
    st.booleans(), st.floats(0.002, 0.5), st.floats(0.8, 3.0), st.floats(-0.3, 0.4), st.floats(0.0, 0.05),
    st.floats(0.7, 2.0), st.floats(1.0, 1.05),
)  # fmt: skip
def test_kh_and_factor_agree_whatever_elements_and_bounds_are(
    rises: bool, kc: float, by_elements: float, lower: float, gap: float, of_factor: float, ratio: float
) -> None:
    """A number above 0 and a factor below 1, or none above 0 and a factor above 1, contradict each other; no number is
    above the upper bound of its ground."""
    run = with_excess_pressure() if rises else analysed(slope())
    at_rest = factor(by_elements, rises)
    answer = fem(run, kc).model_copy(
        update={"safety_factors": (at_rest,), "after_shaking": None} if not rises
        else {"safety_factors": (factor(3.0),), "after_shaking": at_rest}
    )  # fmt: skip
    part = SafetyPart(kh=0.0, lower=of_factor, upper=ratio * of_factor, cells=9, after_shaking=rises)
    strict = bounds(run, lower, lower + gap).model_copy(
        update={"after_shaking": part} if rises else {"safety": (part,)}
    )
    answers = results(run, fem=answer, bounds=strict)
    counts = governing_factor(answers, at_rest)
    [kh, *_] = headlines(answers, Texts())
    number = re.fullmatch(r"[≤≥]? ?([0-9.]+)", kh.value)
    assert (number is None) == answers.fails_at_rest
    if number is not None:
        assert float(number[1]) <= lower + gap + 2.0 * HALF_DIGIT
        assert counts >= 1.0 - 2.0 * HALF_DIGIT or by_elements < 1.0
        assert lower + gap >= 0.0
    else:
        assert counts <= 1.0 + HALF_DIGIT or of_factor > 1.0  # strict on both sides: the factor is of held sides
    assert counts <= ratio * of_factor * (1.0 + HALF_DIGIT) + HALF_DIGIT


@pytest.mark.parametrize(
    ("upper", "chosen", "ends"), [(-0.001, "fem", True), (0.02, "fem", False), (-0.001, "mesh", False)]
)
def test_bounds_of_an_earlier_command_end_the_command_of_the_elements(
    upper: float, chosen: str, ends: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It printed that the section fails, and ended as if there were a critical Kh."""
    answers = slope_proven_to_fail(-0.002, upper)
    monkeypatch.setattr(Results, "of", classmethod(lambda cls, job: answers))
    monkeypatch.setattr(pipeline, "execute", lambda *what: None)
    choice = Choice((chosen,), requested=(chosen,))
    job = Job(answers.config, answers.store, ())
    if not ends:
        return terminal.execute(job, choice, Verbosity.QUIET)
    with pytest.raises(UnstableError, match=r"Strict bounds prove that .* its critical Kh is at most -0\.001"):
        terminal.execute(job, choice, Verbosity.QUIET)
    return None


@pytest.mark.parametrize(("upper", "none"), [(-0.001, True), (0.001, False)])
def test_an_upper_bound_alone_proves_failure(upper: float, none: bool) -> None:
    """Without a lower bound the bounds were not read at all."""
    strict = bounds(analysed(slope()), 0.0, upper)
    part = DirectionPart(direction="downhill", towards="right", lower=None, upper=upper, leaves=(), history=())
    alone = strict.model_copy(update={"lower": None, "directions": (part,)})
    assert alone.fails_at_rest == none
    assert not alone.has_interval


def test_bounds_that_prove_failure_are_stored(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """They ended as an error without a file, so that the headline did not know of them."""
    data = slope() | {"surface": [[0.0, 20.0], [40.0, 20.0], [50.0, 10.0], [100.0, 10.0]]}
    data["strata"] = [layer("clay", cohesion="33 kPa", friction_angle="0 deg")]
    data["bounds"] = {"max_cells": 400, "safety_factor": True, "seconds": 3.0}
    config, store = analysed(data), Store(tmp_path)
    job = cast(Any, SimpleNamespace(config=config, store=store, executor=OneThread(), progress=lambda *what: None))
    allowed, search = list[float](), safety_bounds.safety_bounds

    def noted(section: Section, fem: FemSettings, settings: BoundsSettings, *further: Any, **named: Any) -> Any:
        allowed.append(settings.seconds)
        return search(section, fem, settings, *further, **named)

    monkeypatch.setattr(safety_bounds, "safety_bounds", noted)
    with pytest.raises(UnstableError, match=r"the critical Kh is at most -0\.\d+; check .* FS <= 0\.\d+ at Kh = 0"):
        work(job)
    answer = BoundsAnswer.read(store)
    spent = sum(mesh.work for part in answer.directions for mesh in part.history)
    assert spent > 0.0
    assert sum(allowed) == pytest.approx(config.bounds.seconds - spent)  # proof of failure, too, counts as work
    assert answer.verdict == "unstable"
    assert answer.fails_at_rest
    assert answer.upper is not None
    assert answer.upper < 0.0
    assert answer.safety[0].upper is not None
    assert answer.safety[0].upper < 1.0
    assert answer.after_shaking is None
    assert results(config, fem=fem(config, 0.01), bounds=answer).kc is None


@pytest.mark.parametrize(("upper", "counts"), [(0.15, True), (0.2002, False)])
def test_an_upper_bound_in_the_other_direction_counts_if_it_is_smaller(upper: float, counts: bool) -> None:
    """The headline was read against the bounds of the direction of the finite elements alone."""
    run = analysed(slope())
    opposite = OtherCriticalKh(kc=0.21, kc_upper=0.21, verdict="plateau", reason="", direction="uphill", at_sides=())
    answer = fem(run, 0.2).model_copy(update={"opposite": opposite})
    strict = bounds(run, 0.19, 0.201)
    uphill = DirectionPart(direction="uphill", towards="left", lower=0.147, upper=upper, leaves=(), history=())
    parts = (uphill, *strict.directions) if upper < 0.201 else (*strict.directions, uphill)
    strict = strict.model_copy(update={"directions": parts, "lower": 0.147, "upper": min(upper, 0.201)})
    answers = results(run, fem=answer, bounds=strict)
    governing = governing_kh(answers)
    assert governing is not None
    assert governing.value == (upper if counts else 0.2)
    [kh, *_] = headlines(answers, Texts())
    assert kh.value == ("0.150" if counts else "0.200")
    assert ("fails upslope, to the left, at Kh = 0.150" in kh.conclusion) == counts
    assert ("gives a Kh that is 40.0 % higher" in kh.conclusion.replace("give a", "gives a")) == counts
    printed = printed_text(answers)
    assert ("Critical Kh = 0.150" in printed) == counts
    assert ("to the left, where the strict upper bound counts: the finite elements give 0.200" in printed) == counts


@pytest.mark.parametrize(
    ("lower", "verdict", "words"),
    [
        (0.12, "satisfied", "0.120 to 0.150"),
        (0.06, "not decided", "0.060 to 0.150"),
        (None, "not decided", "at most 0.150"),
    ],
)
def test_the_criterion_of_kh_is_read_against_the_bounds_that_count(
    lower: float | None, verdict: str, words: str
) -> None:
    """An upper limit of 0.15 whose lower bound is 0.06 was told to satisfy 0.1, as were bounds of the other direction
    that have no lower bound at all."""
    run = analysed(slope())
    answer, strict = fem(run, 0.2), bounds(run, 0.19, 0.201)
    uphill = DirectionPart(direction="uphill", towards="left", lower=lower, upper=0.15, leaves=(), history=())
    strict = strict.model_copy(update={"directions": (uphill, *strict.directions), "lower": lower, "upper": 0.15})
    [part] = judged_kh(results(run, fem=answer, bounds=strict))
    assert (part.subject, part.verdict, interval_words(part)) == ("the section by strict bounds", verdict, words)
    if lower is None:
        return
    [part] = judged_kh(results(run, fem=answer, bounds=bounds(run, lower, 0.15)))
    assert (part.subject, part.verdict, interval_words(part)) == ("the section by finite elements", verdict, words)


def test_the_first_page_of_ground_that_fails_by_its_weight_has_its_factor_of_safety() -> None:
    """It had three dashes, and "No factor of safety: ... its factor of safety is 0.86"."""
    run = analysed(slope())
    failure = FailureAnswer(
        section=SectionLabel.of(run.section), factor=0.86, flow="associated", davis=0.64, associated=None,
        slip_surface=((20.0, 15.0), (40.0, 10.0)),
    )  # fmt: skip
    reason = "the section fails under its own weight; its factor of safety is 0.86 with ψ = φ"
    ended = {"fem": Entry({}, "no answer", reason)}
    known = replace(results(run, failure=failure), ends=ended)
    critical, safety, _ = headlines(known, Texts())
    assert (critical.value, safety.value) == ("< 0", "0.86")
    assert critical.conclusion == "The section fails without shaking, so that it has no critical Kh."
    assert safety.conclusion.startswith(
        "Without shaking the section does not stand: its factor of safety is 0.86 (assoc"
    )
    assert safety.conclusion.endswith("With Davis reduced strength the factor of safety is 0.64.")
    rows = [row.value for row in stability_rows(known, Texts()) if "factor of safety at Kh = 0" in row.quantity]
    assert rows == ["0.86", "0.64"]
    strict = bounds(run, -0.13, -0.0275).model_copy(update={"verdict": "unstable"})
    proven = replace(known, bounds=strict)
    first, second, _ = headlines(proven, Texts())
    assert (first.value, second.value) == ("< 0", "0.86")
    assert "its critical Kh is at most -0.0275" in first.conclusion
    part = SafetyPart(kh=0.0, lower=0.38, upper=0.42, cells=9)
    below = replace(proven, bounds=strict.model_copy(update={"safety": (part,)}))
    [second] = [item for item in headlines(below, Texts()) if item.name == second.name]
    assert second.value == "< 0.42"  # it was "0.86; at most 0.42"
    assert "does not stand: its factor of safety is at most 0.42" in second.conclusion
    picture = front(known)
    assert picture is not None
    labels = {text.get_text() for legend in picture.figure.legends for text in legend.get_texts()}
    assert "slip surface, F_s = 0.86 at Kh = 0" in labels
    for headline in headlines(known, Texts("ja"))[:2]:
        assert re.search("[a-z]{4}", headline.conclusion.replace("Davis", "")) is None
    unknown = replace(results(run), ends={"fem": Entry({}, "no answer", "no state on the path is in equilibrium")})
    assert [headline.value for headline in headlines(unknown, Texts())[:2]] == ["–", "–"]
    reason = "the section fails under its own weight even at 20 times its strength"
    weak = replace(results(run), ends={"fem": Entry({}, "no answer", reason)})
    assert [headline.value for headline in headlines(weak, Texts())[:2]] == ["< 0", "–"]


def test_no_critical_kh_of_zero_stands_for_ground_that_fails_with_reduced_strength() -> None:
    """A quay had "0.000" by Davis's estimate beside a factor of safety of 0.89 by it."""
    run = analysed(slope())
    davis = OtherCriticalKh(
        kc=0.0,
        kc_upper=0.0,
        verdict="plateau",
        reason="the ground fails under its own weight",
        direction="downhill",
        at_sides=(),
    )
    answer = fem(run).model_copy(update={"davis": davis, "flow": "associated"})
    known = results(run, fem=answer)
    values = [row.value for row in stability_rows(known, Texts()) if row.conditions.endswith("Davis reduced strength")]
    assert values == ["< 0"]
    assert critical_with_flow(answer, "{:.3f}".format).endswith("no bound: below 0, it fails under its own weight")
    critical = headlines(known, Texts())[0]
    assert critical.conclusion.endswith("for soil that dilates less, the section fails without shaking.")
    assert MethodValues(elements=0.005, davis=0.0).pair("elements", 3) == ("0.005", "< 0")


def test_the_reason_why_material_points_do_not_slide_is_the_reason_of_the_headline() -> None:
    """ "The slides were not computed" stood beside a stage that had computed for a minute."""
    data = slope()
    data["strata"][0] |= {"liquefies_in": [1]}
    run = analysed(data)
    points = PointSlidesAnswer(section=SectionLabel.of(run.section), not_possible="the ground does not come to rest")
    slide = headlines(results(run, mpm=points), Texts())[2]
    assert slide.conclusion == "The slide after liquefaction is not known: the ground does not come to rest."
