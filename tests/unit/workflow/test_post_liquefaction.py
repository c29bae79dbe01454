"""Whether the ground stands after liquefaction, in sentences: what strength would do, and what the field says to it."""

import re
from dataclasses import replace

import pytest

from tests.support import dem_fixture
from tests.support.answers import results, warned
from tests.support.sections import analysed, slope
from workflow.report.console import slide_sentences
from workflow.report.post_liquefaction import factors, just_enough
from workflow.report.summary_text import findings
from workflow.results.answer import SectionLabel
from workflow.results.cases import CasesAnswer
from workflow.results.stability import LiquefiedAnswer, LiquefiedCase, LiquefiedStratum
from workflow.texts.report_texts import Texts


def after_liquefaction(number: int, strength: float, factor: float) -> LiquefiedCase:
    """A case that leaves "upper" a strength (kPa) with a factor of safety, known within 2 %."""
    stratum = LiquefiedStratum(
        name="upper", cohesion_kPa=strength, friction_deg=0.0, residual_strength_ratio=strength / 40.0
    )
    flows = factor < 1.0
    return LiquefiedCase(
        cases=(number,), names=(f"case with {strength:g} kPa",), strata=(stratum,),
        verdict="flows" if flows else "stands", reason="of a test", notes=(),
        kc=None if flows else 0.05, kc_lower=None, kc_upper=None,
        factor=factor, factor_lower=0.99 * factor, factor_upper=1.01 * factor,
    )  # fmt: skip


def answered(*cases: LiquefiedCase, **required: tuple[LiquefiedStratum, ...]) -> LiquefiedAnswer:
    """Return an answer of the section of a test."""
    section = SectionLabel(name="slope", sha256="", reconstruction=False)
    return LiquefiedAnswer(section=section, sides="smooth", cases=cases, **required)


def test_the_strength_with_which_it_just_stands() -> None:
    """Straight between two cases; on one side of 1 all that is known is a bound, the strength over the bound of the
    factor; two cases that flow give a line, the steepest that their bounds (1 %) allow, above which the factor cannot
    rise. Cases that are nearly alike give no line: their bounds overlap. The strength that was computed counts before
    any bound."""
    flows, stands = after_liquefaction(1, 4.0, 0.8), after_liquefaction(2, 9.0, 1.3)
    weaker = after_liquefaction(3, 3.0, 0.7)
    line = 4.0 + (1.0 - 0.808) / (0.808 - 0.693)
    nearly = after_liquefaction(4, 3.9, 0.79)
    for cases, how, expected in (((flows, stands), "about", 6.0), ((flows,), "more than", 4.0 / 0.808),
                                 ((flows, weaker), "more than", line),
                                 ((flows, nearly), "more than", 4.0 / 0.808),
                                 ((stands,), "at most", 9.0 / 1.287),
                                 ((after_liquefaction(1, 5.0, 0.995), stands), "about", 5.0)):  # fmt: skip
        enough = just_enough(answered(*cases))
        assert enough is not None
        assert (enough.qualifier, enough.strata[0].cohesion_kPa) == (how, pytest.approx(expected))
        assert enough.strata[0].residual_strength_ratio == pytest.approx(expected / 40.0)
    computed = just_enough(answered(flows, weaker, required=(flows.strata[0].scaled(1.5),)))
    assert computed is not None
    assert (computed.qualifier, computed.strata[0].cohesion_kPa) == ("about", pytest.approx(6.0))
    assert just_enough(answered()) is None


def test_the_required_strength_has_strict_bounds_rounded_to_the_safe_side() -> None:
    """A levee needed "about 17 kPa" by finite elements, and 17.7 kPa by strict bounds."""
    case = after_liquefaction(1, 4.0, 0.3)
    low, about, high = (tuple(s.scaled(m) for s in case.strata) for m in (4.2876, 4.3, 4.4123))
    bracketed = just_enough(answered(case, required=about, required_lower=low, required_upper=high))
    assert bracketed is not None
    assert (
        'is above 17.1 and at most 17.7 kPa in "upper" by strict bounds (at most 0.44 of its' in bracketed.description
    )
    parts = [high[0], high[0].model_copy(update={"name": "upper, part 2", "cohesion_kPa": 30.01})]
    several = replace(bracketed, upper=tuple(parts)).description
    assert "above 17.1 and at most 17.7 to 30.1 kPa in" in several
    for sentence in (bracketed.description, several):
        assert not re.search("[a-z]{4}", Texts("ja").sentence(f"{sentence}.").replace('"upper"', ""))
    one_end = just_enough(answered(case, required=about, required_lower=low))
    assert one_end is not None
    assert "is about 17 kPa" in one_end.description


def test_more_residual_strength_is_not_promised_to_suffice() -> None:
    """A tailings dam that failed before liquefaction, too, was told to "add a case with more residual strength"."""
    enough = just_enough(answered(after_liquefaction(1, 4.0, 0.8)))
    assert enough is not None
    assert enough.description.endswith("to find the required strength, unless other ground fails first")
    assert not re.search("[a-z]{4}", Texts("ja").sentence(f"{enough.description}.").replace('"upper"', ""))


def test_parts_of_a_soil_are_named_once() -> None:
    """A zone divides sand into parts, whose names for the reader are equal."""
    enough = just_enough(answered(after_liquefaction(1, 4.0, 1.0)))
    assert enough is not None
    [sand] = enough.strata
    deeper = sand.model_copy(update={"name": f"{sand.name}, part 2", "residual_strength_ratio": 0.05})
    assert "is at most 300 kPa in" in replace(enough, qualifier="at most", strata=(sand.scaled(75.9),)).description
    words = replace(enough, strata=(sand, deeper)).description
    assert words.endswith(f'about 4 kPa in "{sand.name}" (0.05 to 0.1 of its mean vertical effective stress)')
    weaker = deeper.model_copy(update={"cohesion_kPa": 0.25})
    words = replace(enough, strata=(sand, weaker)).description
    assert f'about 0.25 to 4 kPa in "{sand.name}" (0.05 to 0.1 of' in words


def test_elements_below_the_strict_bounds_say_why() -> None:
    """Bounds are those of ψ = φ: elements that take ψ as it is bear less, and a reader wants to know."""
    case = after_liquefaction(1, 4.0, 0.8)
    assert factors(case) == "0.79 to 0.81 by strict bounds with ψ = φ, 0.80 by finite elements"
    one_bound = case.model_copy(update={"factor_lower": None})
    assert factors(one_bound) == "at most 0.81 by a strict bound with ψ = φ, 0.80 by finite elements"
    less = case.model_copy(update={"factor": 0.7})
    assert factors(less).endswith("0.70 by finite elements, lower since ψ < φ")


def test_elements_above_the_strict_upper_bound_say_that_the_bound_counts() -> None:
    """A slope of shale had "0.51 to 0.53 by strict bounds, 0.54 by finite elements"."""
    more = after_liquefaction(1, 4.0, 0.8).model_copy(update={"factor": 0.83})
    assert factors(more).endswith("0.83 by finite elements, above the strict upper bound, which counts")


def test_a_case_is_called_by_its_name_and_ground_that_rises_does_not_settle() -> None:
    data = slope()
    data["strata"][0]["liquefies_in"] = [1]
    config = analysed({**data, "slide": {"cases": [{"name": "loose", "stiffness": 0.1}]}})
    for settlement, said in ((0.25, "upslope third settles by 0.25 m"), (-0.25, "upslope third rises by 0.25 m")):
        case = dem_fixture.case(0.1, 3.0).model_copy(update={"settlement_uphill_m": settlement})
        messages = list(slide_sentences(config, CasesAnswer(sets={"calibrated": {1: case}}, random=None)))
        left = "stiffness × 0.1, damping × 0.316, friction × 0, cohesion × 0."
        assert messages[0].endswith(f"case 1, loose, upper: {left}")
        assert said in messages[1]


def test_ground_that_hardly_moved_did_not_flow_and_the_report_says_what_that_means() -> None:
    """0.2 m on 10 m of height: at least 1 / (1.01 · 0.8) = 1.24 times what the case that flows has; 3 m: silence."""
    data = slope()
    data["strata"][0]["liquefies_in"] = [1, 2]
    for far, said in (("0.2 m", True), ("3 m", False)):
        config = analysed({**data, "report": {"observed": [{"name": "SI-5", "displacement": far}]}})
        cases = (after_liquefaction(1, 4.0, 0.8), after_liquefaction(2, 9.0, 1.3))
        liquefied_answer = LiquefiedAnswer(section=SectionLabel.of(config.section), sides="free-field", cases=cases)
        text = "\n".join(findings(results(config, liquefied=liquefied_answer)))
        assert (
            'The residual strength required to stand without shaking is about 6 kPa in "upper" (0.15 of its '
            "mean vertical effective stress)." in text
        )
        assert (
            "At most 0.2 m were measured, on 10 m of height, where a flow failure would have moved further." in text
        ) == said
        assert ("at least 1.24 times that of" in text) == said
        assert ("With the measured displacement case 2 (case with 9 kPa) agrees." in text) == said


def test_discs_that_slide_where_the_continuum_stands_are_told() -> None:
    """By their weight alone, 3 m on 10 m of height; 0.5 m is little, and under a Kh that is held they may slide."""
    data = slope()
    data["strata"][0]["liquefies_in"] = [1]
    for kh, far, said in ((0.0, 3.0, True), (0.0, 0.5, False), (0.1, 3.0, False)):
        config = analysed({**data, "slide": {"kh": kh}})
        liquefied_answer = LiquefiedAnswer(
            section=SectionLabel.of(config.section), sides="free-field", cases=(after_liquefaction(1, 9.0, 1.3),)
        )
        slides = CasesAnswer(sets={"calibrated": {1: dem_fixture.case(0.1, far)}}, random=None)
        text = "\n".join(findings(results(config, liquefied=liquefied_answer, cases=slides)))
        assert ("The discs contradict this result: they slide 3.0 m by their weight alone." in text) == said


@pytest.mark.parametrize(
    ("remaining", "friction", "said"),
    [
        ({"residual": 0.1}, "33 deg", True),
        ({"residual": 0.1, "strain_potential": 0.3}, "33 deg", False),
        ({"residual_strength": "9 kPa"}, "0 deg", False),  # clay has none
    ],
)
def test_sand_that_holds_its_residual_strength_at_once_is_warned_of(
    remaining: dict[str, object], friction: str, said: bool
) -> None:
    """Spreads of the field come out several times too short without a strain potential (page of known slides)."""
    data = slope()
    data["strata"][0] |= {"liquefies_in": [1], "friction_angle": friction}
    config = analysed({**data, "slide": {"cases": [remaining]}})
    slides = CasesAnswer(sets={"calibrated": {1: dem_fixture.case(0.1, 0.5)}}, random=None)
    messages = [
        item
        for item in warned(results(config, cases=slides))
        if "has its residual strength without any shear strain in case 1" in item
    ]
    assert bool(messages) == said


@pytest.mark.parametrize(("kh", "said"), [(0.052, True), (0.08, False)])
def test_a_kh_that_is_held_at_the_limit_of_liquefied_ground_is_warned_of(kh: float, said: bool) -> None:
    """The ground of the case stands up to Kh = 0.05: a rigid block under 0.052 slides for ever, under 0.048 never."""
    data = slope()
    data["strata"][0]["liquefies_in"] = [1]
    config = analysed({**data, "slide": {"kh": kh, "cases": [{"residual": 0.1}]}})
    liquefied_answer = LiquefiedAnswer(
        section=SectionLabel.of(config.section), sides="free-field", cases=(after_liquefaction(1, 9.0, 1.3),)
    )
    messages = [
        item for item in warned(results(config, liquefied=liquefied_answer)) if "just stands under Kh = 0.05" in item
    ]
    assert bool(messages) == said
