"""Sentences of the report on the critical Kh: its number, its error, and what it is compared with."""

from dataclasses import replace

import pytest

from tests.support.answers import bounds, fem, liquefying_config, report_text, results, variant, warned
from tests.support.sections import analysed, slope
from workflow.config import Config
from workflow.report.console import fem_sentences
from workflow.report.first_page import headlines
from workflow.report.flow_rule import how_to_get_own_dilation, own_dilation_sentences
from workflow.report.numbers import range_sentence
from workflow.report.stability import stability_rows
from workflow.results.accuracy import Accuracy
from workflow.results.bounds import SafetyPart
from workflow.results.continuum import (
    FactorOfSafety,
    MeshStep,
    OtherCriticalKh,
    OwnDilationPart,
    ResultWarning,
    ShallowFailurePart,
    VariantsAnswer,
)
from workflow.results.results import Results
from workflow.run.record import Entry
from workflow.run.store import Store
from workflow.texts.report_texts import Texts


@pytest.fixture
def run() -> Config:
    return liquefying_config()


def test_before_anything_was_computed_all_is_open(run: Config) -> None:
    messages = report_text(results(run))
    assert "No critical Kh: the finite element analysis was not run." in messages
    assert "The slide after liquefaction is not known: the slides were not computed." in messages


def test_ground_that_is_not_said_to_liquefy_is_not_asked_how_far_it_slides() -> None:
    messages = report_text(results(analysed(slope())))
    assert "No layer of the section liquefies, so no slide was computed." in messages
    assert "The slide after liquefaction" not in messages


def test_a_critical_kh_with_what_it_hangs_on(run: Config) -> None:
    variants = VariantsAnswer(
        variants=(
            variant("element", "the bilinear element instead of the quadratic element", 0.268),
            variant("sides", "sides fixed instead of free-field", 0.338),
            variant("dilation", "ψ = φ instead of the given ψ", None),
        )
    )
    result = results(run, fem=fem(run, 0.2345), variants=variants, bounds=bounds(run, 0.2293, 0.2349))
    messages = report_text(result)
    assert "The section fails downslope, to the right, at Kh = 0.234 (2.3 m/s²), with free-field sides, ass" in messages
    assert headlines(result, Texts())[0].interval == "0.229 to 0.235 by strict bounds"
    assert "The numerical error of the critical Kh is below 0.006, by strict bounds." in messages
    assert (
        "The assumptions matter more than the numerical error. With sides fixed instead of free-field the critical Kh "
        "is 0.338." in messages
    )
    assert "instead of the given ψ" not in messages  # that one came to nothing
    [sides] = [item for item in warned(result) if item.startswith("With sides")]
    assert sides.startswith("With sides fixed instead of free-field the critical Kh is 44 % larger, so that")
    assert sides.endswith('Move the sides away by beyond = "50 m".')


def test_another_flow_that_bears_more_than_strict_bounds_allow_is_left_out(run: Config) -> None:
    """No smaller ψ bears more than ψ = φ (Radenkovic 1961): a path above that was followed on too coarse a mesh."""
    more = variant("dilation", "the flow rule of the given ψ (equilibrium path) instead of ψ = φ", 0.30)
    less = variant("dilation", "the path with less", 0.235)
    result = results(run, fem=fem(run), variants=VariantsAnswer(variants=(more, less)), bounds=bounds(run, 0.27, 0.28))
    assert "With the path with less the critical Kh is 0.235." in report_text(result)
    assert "the given ψ instead" not in report_text(result)


def test_one_mesh_without_bounds_leaves_the_numerical_error_open(run: Config) -> None:
    same = variant("sides", "sides fixed instead of free-field", 0.2331)
    answer = fem(run, 0.2345).model_copy(update={"kc_upper": 0.2346})
    result = results(run, fem=answer, variants=VariantsAnswer(variants=(same,)))
    messages = report_text(result)
    assert not warned(result)
    assert "The numerical error of the critical Kh is not known, since there is one mesh" in messages
    assert "With sides fixed instead of free-field the critical Kh is 0.233." in messages


def test_what_stands_beside_the_critical_kh(run: Config) -> None:
    """The other direction, what ψ = φ would give, faces without cohesion, and what contradicts the answer."""
    other = OtherCriticalKh(
        kc=0.173, kc_upper=0.18, verdict="plateau", reason="", direction="uphill", at_sides=("left",)
    )
    face = ShallowFailurePart(stratum="upper", start_x_m=20.0, end_x_m=44.0, angle_deg=26.0, kh=0.05)
    warning = ResultWarning(observation="A finer mesh gives 0.20.", remedy="refine it", contradiction=True)
    known = ResultWarning(observation="The base is near.", remedy="go deeper", contradiction=False)
    more = {
        "flow": "davis",
        "opposite": other,
        "associated": other.model_copy(update={"kc": 0.3057}),
        "shallow_failures": (face,),
    }
    answer = fem(run).model_copy(update={**more, "warnings": (warning, known)})
    messages = report_text(results(run, fem=answer, bounds=bounds(run, 0.30, 0.31)))
    assert "With ψ = φ the failing ground reaches the left side of the section." in messages
    assert "At Kh = 0.050 already, the cohesionless face of upper from x = 20 to 44 m fails as an infinite" in messages
    rows = {(row.value, row.conditions) for row in stability_rows(results(run, fem=answer), Texts())}
    assert ("0.306", "free-field sides, associated flow, ψ = φ") in rows
    assert ("0.173", "seismic force upslope; the failing ground reaches the side of the section") in rows
    assert warned(results(run, fem=answer))[0] == "A finer mesh gives 0.20. Refine it."
    stands = fem(run).model_copy(update={"opposite": other.model_copy(update={"verdict": "no failure", "kc": 1.5})})
    assert "> 1.500" in [row.value for row in stability_rows(results(run, fem=stands), Texts())]


def test_table_says_which_value_of_the_finite_elements_gives_way_to_its_strict_bound(run: Config) -> None:
    """The headline told 0.235 and the table 0.237 without a word."""
    factor = FactorOfSafety(
        kh=0.0, factor=1.15, upper=1.15, verdict="plateau", reason="", curve=(), shallow_failure=None
    )
    strict = bounds(run, 0.234, 0.235).model_copy(
        update={"safety": (SafetyPart(kh=0.0, lower=1.07, upper=1.09, cells=100),)}
    )
    answer = fem(run, 0.237).model_copy(update={"safety_factors": (factor,)})
    above = results(run, fem=answer, bounds=strict)
    rows = {row.value: row.conditions for row in stability_rows(above, Texts())}
    assert headlines(above, Texts())[0].value == "0.235"
    assert rows["0.237"].endswith("; above the strict upper bound of 0.235, which counts")
    assert rows["1.15"].endswith("; above the strict upper bound of 1.09, which counts")
    below = answer.model_copy(update={"kc": 0.2345, "safety_factors": (factor.model_copy(update={"factor": 1.08}),)})
    assert not any(
        "which counts" in row.conditions for row in stability_rows(results(run, fem=below, bounds=strict), Texts())
    )


def test_a_third_number_is_about_so_much_and_one_that_did_not_settle_says_why(run: Config) -> None:
    third = OwnDilationPart(kc=0.129, low=0.128, high=0.134, cells=(350, 450, 600), reason="")
    answer = fem(run).model_copy(update={"own_dilation": third, "dilation_deg": {"Soil": 0.0}})
    assert list(own_dilation_sentences(answer)) == [
        "The critical Kh is about 0.129 for ψ = 0, 0.128 to 0.134 on three meshes. This Kh was found by iteration, "
        "and depends on element and mesh by 5 to 15 %."
    ]
    rows = {(row.value, row.interval) for row in stability_rows(results(run, fem=answer), Texts())}
    assert ("about 0.129", "0.128 to 0.134") in rows
    open_ = third.model_copy(update={"kc": None, "reason": "pressures still change by 0.3 %"})
    unsettled = answer.model_copy(update={"own_dilation": open_})
    assert list(own_dilation_sentences(unsettled)) == [
        "A critical Kh for ψ = 0 was not found: pressures still change by 0.3 %."
    ]


@pytest.mark.parametrize(("davis", "far_apart"), [(0.12, True), (0.20, False)])
def test_a_third_number_is_offered_where_the_two_lie_far_apart(davis: float, far_apart: bool, run: Config) -> None:
    low = OtherCriticalKh(kc=davis, kc_upper=davis, verdict="plateau", reason="", direction="downhill", at_sides=())
    answer = fem(run, 0.21).model_copy(update={"davis": low, "dilation_deg": {"Soil": 0.0}})
    offer = " The option --set fem.own_dilation=true also computes an approximate critical Kh for ψ = 0."
    assert how_to_get_own_dilation(answer) == (offer if far_apart else "")
    third = OwnDilationPart(kc=0.129, low=0.128, high=0.134, cells=(350, 450, 600), reason="")
    assert how_to_get_own_dilation(answer.model_copy(update={"own_dilation": third})) == ""
    assert how_to_get_own_dilation(fem(run, 0.21)) == ""


def test_a_limit_load_that_the_path_did_not_come_to_is_no_plateau(run: Config) -> None:
    """The river bank's path rises almost straight to 0.95 of what its elements bear."""
    assert fem(run, 0.1096).end_reason == "plateau"
    assert fem(run, 0.1096).model_copy(update={"kc_lower": 0.1041}).end_reason == "limit load"


def test_a_slope_that_stands_and_one_that_does_not(run: Config) -> None:
    stands = report_text(results(run, fem=fem(run, 1.5, "no failure")))
    assert "The section stands at every Kh up to 1.500, the largest Kh of the search." in stands
    ended = Entry({}, "no answer", reason="the section fails under its own weight")
    falls = report_text(Results(run, Store("nowhere"), {"fem": ended}, {}))
    assert "No critical Kh: the section fails under its own weight." in falls


def test_console_tells_where_the_ground_slips_and_that_the_other_direction_has_one_mesh(run: Config) -> None:
    """A Kh of one mesh stood there to three places, 6 % from that of the mirror image; the place of the critical Kh
    was told for the factor of safety only, which may slip elsewhere; 0.2658 stood beside a range up to 0.265."""
    other = OtherCriticalKh(kc=0.3998, kc_upper=0.41, verdict="plateau", reason="", direction="uphill", at_sides=())
    state = fem(run).states[-1].model_copy(update={"slip_surface": ((12.0, 9.0), (20.0, 4.0), (31.5, 5.0))})
    steps = (MeshStep(cells=500, kc=0.27), MeshStep(cells=1000, kc=0.2658))
    changes = {"opposite": other, "states": (state,), "meshes": steps, "kc": 0.2658, "kc_limit": 0.2645}
    answer = fem(run).model_copy(update=changes)
    text = " ".join(fem_sentences(answer, run.section, every=False, results=results(run, fem=answer)))
    assert "The ground slips from x = 12.0 to 31.5 m, down to z = 4.0 m. The range" in text
    assert "With the seismic force upslope the critical Kh is about 0.40, by one mesh." in text
    rows = [row.value for row in stability_rows(results(run, fem=answer), Texts())]
    assert "about 0.40" in rows
    finer = answer.model_copy(update={"opposite": other.model_copy(update={"meshes": 2})})
    assert "0.400" in [row.value for row in stability_rows(results(run, fem=finer), Texts())]
    interval = Accuracy(0.2638, 0.2655, "by strict bounds", reliable=True)
    assert range_sentence(answer, interval) == "The range by strict bounds is 0.264 to 0.266."
    assert "0.266, 0.7 % above this range, whose upper end" in range_sentence(answer, replace(interval, high=0.2640))
