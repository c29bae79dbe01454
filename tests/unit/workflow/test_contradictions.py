"""What contradicts itself is found, and told with what to do; what does not is let pass."""

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from dem.case import Case
from dem.settings import SlideSettings
from tests.support import dem_fixture
from tests.support.answers import bounds, fem, results, warned
from tests.support.sections import analysed, slope
from workflow.config import Config
from workflow.report.console import fem_sentences, safety_sentence, slide_sentences
from workflow.report.contradictions import (
    LEAST_END,
    deepest_fall,
    is_weaker,
    of_curve,
    of_ends,
    of_order,
    of_settlement,
    of_sides,
)
from workflow.report.first_page import headlines
from workflow.report.summary_text import at_rest
from workflow.results.bounds import SafetyPart
from workflow.results.cases import CasesAnswer, RandomCase, RandomPackings, Spread
from workflow.results.continuum import FactorOfSafety, OtherCriticalKh
from workflow.results.discs import DiscsAnswer
from workflow.results.material_points import PointCase, PointSlidesAnswer
from workflow.texts.report_texts import Texts

LEVEE = (
    {"name": "median", "residual_strength": "9 kPa", "strain_potential": 0.3},
    {"name": "low strength", "residual_strength": "6 kPa", "strain_potential": 0.3},
)


@pytest.fixture
def run() -> Config:
    data = slope()
    data["strata"][0]["liquefies_in"] = [1, 2]
    return analysed(data)


def slides(run: Config, *lengths: float, **more: Any) -> CasesAnswer:
    """Cases of the levee, which slid so far (m)."""
    cases = {k: dem_fixture.case(0.1, slide).model_copy(update=more) for k, slide in enumerate(lengths, start=1)}
    return CasesAnswer(sets={"calibrated": cases}, random=None)


def with_cases(run: Config, *cases: dict[str, Any]) -> Config:
    return run.model_copy(update={"slide": SlideSettings.model_validate({"cases": cases})})


def test_low_strength_that_slides_less_than_median_is_found(run: Config) -> None:
    """The levee: 48 m with the median strength, 45 m with the low one."""
    levee = with_cases(run, *LEVEE)
    [warnings] = warned(results(levee, cases=slides(levee, 48.0, 45.0)))
    assert warnings.startswith(
        "Case 2 (low strength) has less residual strength than case 1 (median) and slides less by discs, 45 m and 48 m"
    )
    assert "(setting beyond) if a side stops the slides, more packings (slide.seeds) otherwise" in warnings
    assert warned(results(levee, cases=slides(levee, 45.0, 48.0))) == []
    assert warned(results(levee, cases=slides(levee, 48.0, 47.9))) == [], "what packings differ by is no contradiction"


def test_the_order_of_cases_goes_by_the_mean_of_packings_where_there_are_several(run: Config) -> None:
    def single(*values: float) -> RandomCase:
        spread = Spread.of(values)
        return RandomCase(slide_max_m=spread, settlement_uphill_m=spread, settlement_middle_m=spread)

    levee = with_cases(run, *LEVEE)
    several = RandomPackings(seeds=(), cases={1: single(3.0, 4.0), 2: single(5.0, 6.0)})
    result = slides(levee, 3.4, 3.0).model_copy(update={"random": several})
    assert warned(results(levee, cases=result)) == []


@given(st.lists(st.tuples(st.floats(0.0, 1.0), st.floats(0.0, 1.0)), min_size=2, max_size=4), st.data())
def test_no_order_is_found_where_more_strength_slides_less(
    remaining: list[tuple[float, float]], data: st.DataObject
) -> None:
    """Slides that fall with strength contradict nothing, however the cases stand; and of two cases one is weaker."""
    cases = {k: Case(stiffness=0.1, residual=r, friction=f) for k, (r, f) in enumerate(remaining)}
    lengths = {k: 10.0 - 4.0 * r - 4.0 * f for k, (r, f) in enumerate(remaining)}
    assert list(of_order(cases, lengths, {key: ["upper"] for key in cases})) == []
    item, other = (data.draw(st.sampled_from(sorted(cases))) for _ in range(2))
    here = ["upper"], ["upper"]
    assert not (is_weaker(cases[item], cases[other], *here) and is_weaker(cases[other], cases[item], *here))


def test_a_ratio_and_a_strength_are_not_compared() -> None:
    ratio, strength = Case(residual=0.1), Case.model_validate({"residual_strength": {"upper": "6 kPa"}})
    assert not is_weaker(ratio, strength, ["upper"], ["upper"])
    assert not is_weaker(strength, ratio, ["upper"], ["upper"])
    more = Case.model_validate({"residual_strength": {"upper": "9 kPa"}})
    assert is_weaker(strength, more, ["upper"], ["upper"])


def test_a_case_in_which_more_strata_liquefy_is_the_weaker_one(run: Config) -> None:
    """As strong in what liquefies in both: with a second stratum that liquefies the ground slides no less."""
    case = Case(residual=0.1)
    assert is_weaker(case, case, ["upper", "lower"], ["upper"])
    assert not is_weaker(case, case, ["upper"], ["upper", "lower"])
    assert not is_weaker(Case(residual=0.05), case, ["upper"], ["upper", "lower"]), "the lower one keeps all it had"
    data = slope()
    data["strata"][0]["liquefies_in"], data["strata"][1]["liquefies_in"] = [1, 2], [2]
    data["slide"] = {"cases": [{"residual_strength": "9 kPa", "strain_potential": 0.3}] * 2}
    both = analysed(data)
    [warnings] = [text for text in warned(results(both, cases=slides(both, 5.0, 2.0))) if "assumed" not in text]
    assert warnings.startswith(
        "Case 2 has less residual strength than case 1 and slides less by discs, 2.0 m and 5.0 m"
    )
    assert [text for text in warned(results(both, cases=slides(both, 2.0, 5.0))) if "assumed" not in text] == []


def test_a_side_of_the_box_that_stops_a_slide_is_no_rest(run: Config) -> None:
    fixed = slides(run, 48.0, 45.0, stopped_by="right")
    [messages] = of_sides(fixed.sets["calibrated"])
    assert messages.startswith("the right side of the disc model stopped the slide in cases 1 and 2: 45 to 48 m is")
    assert messages.endswith("take a longer section (setting beyond)")
    assert list(of_sides(slides(run, 3.0).sets["calibrated"])) == []
    assert any("side of the disc model stopped" in item for item in warned(results(run, cases=fixed)))


def test_a_crest_that_falls_much_further_than_the_uphill_third_settles_is_told(run: Config) -> None:
    """0.24 m in the median of the uphill third of a levee whose crest, in the middle, lost 5 m."""
    before = ((0.0, 2.0), (40.0, 2.0), (50.0, 7.0), (60.0, 2.0), (100.0, 2.0))
    after = ((0.0, 1.9), (40.0, 2.0), (50.0, 2.0), (60.0, 2.5), (100.0, 2.1))
    lost = {"surface_before": before, "surface_after": after, "settlement_uphill_m": 0.24}
    case = dem_fixture.case(0.1, 20.0).model_copy(update=lost)
    assert case.largest_fall == (5.0, 50.0)
    [messages] = of_settlement({1: (case, 0.24)})
    assert (
        "the surface falls by 5.0 m at x = 50 m in case 1, far more than the median settlement of the upslope third"
        in messages
    )
    answer = CasesAnswer(sets={"calibrated": {1: case}}, random=None)
    assert any(
        "the surface falls by 5.0 m at x = 50 m" in slide_sentence for slide_sentence in slide_sentences(run, answer)
    )
    assert list(of_settlement({1: (case, 4.0)})) == []
    at_side = {
        "surface_before": ((0.0, 2.0), (2.0, 2.0), *before[1:]),
        "surface_after": ((0.0, 2.0), (4.0, 0.0), *before[1:]),
    }
    hollow = case.model_copy(update=at_side)
    [messages] = of_settlement({1: (hollow, 0.24)})
    assert "falls by 2.0 m at x = 4 m in case 1, where it slides away from the left side of the model" in messages
    assert list(of_settlement({1: (case.model_copy(update={"surface_after": ()}), 0.24)})) == []


def test_a_disc_that_is_missing_beside_the_side_of_the_box_is_no_settlement(run: Config) -> None:
    """S-13: 3.4 m at x = 1 m, beside the side, and 1.2 to 1.9 m in the ground next to it."""
    before = ((0.6, 9.0), (2.2, 8.9), (4.0, 8.8), (100.0, 4.5), (200.0, 0.0))
    after = ((1.3, 5.6), (2.1, 7.7), (3.9, 6.9), (100.0, 4.6), (200.0, -2.2))
    lost = {"surface_before": before, "surface_after": after}
    fall, x = dem_fixture.case(0.1, 4.0).model_copy(update=lost).largest_fall
    assert 1.8 < fall < 2.0
    assert 3.9 <= x <= 4.0


def displaced(run: Config, kc: float, *curve: tuple[float, float]) -> DiscsAnswer:
    """Soil discs whose push took these Kh at these displacements (m)."""
    answer = dem_fixture.critical(run, kc)
    trials = tuple(answer.after.trials[0].model_copy(update={"displacement_m": u, "kh": kh}) for u, kh in curve)
    search = answer.after.model_copy(update={"kc": kc, "trials": trials})
    model = answer.model.model_copy(update={"discs": "soil"})
    return answer.model_copy(update={"model": model, "after": search, "states": ()})


def test_a_critical_kh_behind_a_fall_of_the_curve_is_told(run: Config) -> None:
    """0.148 told, of discs that bore 0.13 before and fell to 0.08."""
    falls = displaced(run, 0.148, (0.0, 0.0), (0.02, 0.13), (0.03, 0.08), (0.05, 0.15), (0.07, 0.02))
    assert deepest_fall(falls.after, soil=True) == (0.13, 0.08)
    [messages] = of_curve(falls)
    assert "the Kh of the discs falls from 0.130 to 0.080 before it reaches their critical Kh of 0.148" in messages
    assert "dem.elements" in messages
    rises = displaced(run, 0.148, (0.0, 0.0), (0.02, 0.10), (0.03, 0.09), (0.05, 0.15), (0.07, 0.02))
    assert list(of_curve(rises)) == [], "what grains do, and what comes after the critical Kh, is none"
    twice = displaced(run, 0.204, (0.0, 0.0), (0.02, 0.206), (0.03, 0.097), (0.05, 0.204), (0.07, 0.02))
    assert list(of_curve(twice)) == [], "under a constant Kh these discs fail at their critical Kh"
    assert any("falls from 0.130 to 0.080" in item for item in warned(results(run, dem=falls)))


def messages_by_bounds(run: Config, **more: Any) -> list[str]:
    """What bounds of 0.2799 to 0.2815 (S-13, psi = phi) say to a critical Kh of 0.237 by Davis's estimate and more."""
    other = OtherCriticalKh(kc=0.2844, kc_upper=0.2844, verdict="plateau", reason="", direction="downhill", at_sides=())
    answer = fem(run, 0.237).model_copy(update={"flow": "davis", "associated": other, **more.pop("fem", {})})
    strict = bounds(run, 0.2799, 0.2815, more.pop("direction", "downhill")).model_copy(update=more)
    return [f"{warning.observation} {warning.remedy}" for warning in results(run, fem=answer, bounds=strict).warnings]


def test_elements_with_psi_equal_to_phi_above_a_strict_upper_bound_are_told(run: Config) -> None:
    """S-13: 0.2844 beside 0.2815; found for other sides or the other direction, too."""
    [messages] = messages_by_bounds(run)
    assert messages.startswith("The critical Kh with ψ = φ of 0.284 lies 1.0 % above the strict upper bound, 0.281.")
    assert messages.endswith("take 0.281 as an upper limit and refine the mesh")
    assert len(messages_by_bounds(run, sides="fixed")) == 1, "held sides bear no less"
    assert messages_by_bounds(run, direction="uphill") == []
    opposite = OtherCriticalKh(kc=0.31, kc_upper=0.31, verdict="plateau", reason="", direction="uphill", at_sides=())
    [uphill] = messages_by_bounds(run, direction="uphill", fem={"opposite": opposite})
    assert uphill.startswith("The critical Kh upslope of 0.310 lies 10.1 % above the strict upper bound")
    near = results(run, fem=fem(run, 0.2844), bounds=bounds(run, 0.2799, 0.2815))
    far = results(run, fem=fem(run, 0.2904), bounds=bounds(run, 0.2799, 0.2815))
    assert [item.contradiction for item in (*near.warnings, *far.warnings)] == [False, True], "1 and 3.2 % above it"
    assert any("Take 0.281 as an upper limit" in entry for entry in warned(
        results(run, fem=fem(run, 0.2844), bounds=bounds(run, 0.2799, 0.2815))
    ))  # fmt: skip


def test_a_difference_within_the_error_of_the_meshes_is_no_contradiction(run: Config) -> None:
    """Above a thin seam elements had 0.0624 with a limit of 0.0611 by their meshes, the upper bound was 0.0602: the
    bound was taken and told, then called a contradiction 0.0002 beyond the tolerance of a mesh."""
    seam = fem(run, 0.06237).model_copy(update={"kc_limit": 0.06107})
    for answer, expected in ((seam, False), (seam.model_copy(update={"kc_limit": 0.0622}), True)):
        answers = results(run, fem=answer, bounds=bounds(run, 0.0589, 0.0602))
        [warning] = answers.warnings_by_bounds()
        assert warning.contradiction == expected
        printed = " ".join(fem_sentences(answer, run.section, False, answers))
        assert "The finite elements give 0.062, 3.6 % above this range" in printed
        assert printed.count("above the strict upper bound") == expected


def test_the_console_has_the_interval_of_strict_bounds_and_what_they_contradict(run: Config) -> None:
    """An endless clay slope under water: elements had 0.090 with a range by meshes of 0.089 to 0.092, strict bounds
    0.0875 to 0.0890, and `noshiro fem` printed the one beside the other without a word.
    """
    answer = fem(run, 0.0899)
    messages = list(
        fem_sentences(answer, run.section, False, results(run, fem=answer, bounds=bounds(run, 0.0875, 0.089)))
    )
    assert messages[0].endswith(
        "The range by strict bounds is 0.087 to 0.089. The finite elements give 0.090, 1.0 % above this range, whose "
        "upper end is the critical Kh."
    )
    assert messages[0].startswith("Critical Kh = 0.089 with ψ = φ.")
    far = results(run, fem=answer, bounds=bounds(run, 0.078, 0.08))
    assert any(text.startswith("Contradiction: The critical Kh of 0.090 lies 12.4 % above the strict upper bound")
               for text in fem_sentences(answer, run.section, False, far))  # fmt: skip
    assert not any(text.startswith("Contradiction") for text in fem_sentences(answer, run.section))


def test_level_ground_has_no_factor_of_safety_but_one_above_where_the_search_ends(run: Config) -> None:
    factor = FactorOfSafety(
        kh=0.0, factor=20.242, upper=33.6, verdict="no failure", reason="", curve=(), shallow_failure=None
    )
    text = safety_sentence(factor, fem(run))
    assert text == "Factor of safety at Kh = 0: above 20, where the search ended."
    answer = fem(run).model_copy(update={"safety_factors": (factor,)})
    safety = headlines(results(run, fem=answer), Texts())[1]  # it had "> 20.24"
    assert (safety.value, safety.conclusion) == (
        "> 20", "Without shaking the section stands with its strength divided by 20."
    )  # fmt: skip


def test_a_slip_surface_of_no_length_is_told_as_a_place(run: Config) -> None:
    """A cut in young clay failed at its toe: "it slips from x = 41.6 to 41.6 m"."""
    factor = FactorOfSafety(
        kh=0.0, factor=1.338, upper=1.338, verdict="plateau", reason="", curve=(), shallow_failure=None
    )
    for line, item in (
        (((41.62, -4.0), (41.64, -4.0)), "The ground fails first in a few cells at x = 41.6 m, z = -4.0 m."),
        (((30.0, 0.0), (42.0, -4.0)), "The ground slips from x = 30.0 to 42.0 m, down to z = -4.0 m."),
    ):
        assert safety_sentence(factor.model_copy(update={"slip_surface": line}), fem(run)).endswith(item)


def test_a_factor_of_safety_above_its_strict_upper_bound_is_told(run: Config) -> None:
    """A face of sand after a seepage fault: 1.15 told, whose grains' own factor is 1.08."""
    factor = FactorOfSafety(
        kh=0.0, factor=1.15, upper=1.15, verdict="plateau", reason="", curve=(), shallow_failure=None
    )
    part = SafetyPart(kh=0.0, lower=1.07, upper=1.09, cells=100)
    answer = fem(run).model_copy(update={"safety_factors": (factor,)})
    strict = bounds(run, 0.22, 0.26).model_copy(update={"safety": (part,)})
    [warning] = results(run, fem=answer, bounds=strict).warnings
    assert warning.observation.startswith(
        "The factor of safety at Kh = 0 with ψ = φ of 1.150 lies 5.5 % above the strict upper bound"
    )
    assert warning.contradiction
    sound = answer.model_copy(update={"safety_factors": (factor.model_copy(update={"factor": 1.08}),)})
    assert results(run, fem=sound, bounds=strict).warnings == []


def point_slide(along: list[tuple[float, float]], **more: Any) -> PointCase:
    """A slide by material points of ground that falls to the right, with slides (m) along its surface."""
    surface = tuple((x, 10.0 - 0.1 * x) for x, _ in along)
    values = {"slide_max_m": max(u for _, u in along), "stopped_by": None, "settled": True, "slide_along": tuple(along)}
    return PointCase.model_construct(**{**values, "surface_before": surface, "surface_after": surface, **more})


def ends_of(cases: dict[int, PointCase], sides: str = "free-field") -> list[str]:
    """The warnings of slides by material points with such sides of the section."""
    return list(of_ends(PointSlidesAnswer.model_construct(cases=cases, sides=sides)))


def with_points(run: Config, *cases: PointCase, sides: str = "fixed") -> list[str]:
    """The warnings of a report with these slides by material points."""
    plain = {"notes": (), "settlement_crest_m": 0.0, "reason": "rest"}
    slid = {
        k: case.model_copy(
            update=plain
            | {"slide_max_low_m": case.slide_max_m, "slide_max_high_m": case.slide_max_m}
            | dict(case.__dict__)
        )
        for k, case in enumerate(cases, start=1)
    }
    return warned(results(run, mpm=PointSlidesAnswer.model_construct(cases=slid, sides=sides)))


def test_material_points_of_low_strength_that_slide_less_than_those_of_median_are_found(run: Config) -> None:
    levee = with_cases(run, *LEVEE)
    long, short = (point_slide([(0.0, 0.0), (40.0, far), (80.0, 0.0)]) for far in (48.0, 45.0))
    [messages] = with_points(levee, long, short)
    assert messages.startswith(
        "Case 2 (low strength) has less residual strength than case 1 (median) and slides less by material"
    )
    assert "finer cells (slide.mpm_cells) otherwise" in messages
    assert with_points(levee, short, long) == []


def test_material_points_that_a_side_stopped_are_not_at_rest(run: Config) -> None:
    """They lie still at the wall: the slide is a least value, told as one, and no interval ends there."""
    point_case = point_slide([(0.0, 0.0), (40.0, 20.0)], stopped_by="right")
    for sides, end in (("fixed", "reach the fixed side of"), ("smooth", "leave")):
        [warning] = ends_of({1: point_case}, sides)
        assert warning.startswith(f"material points {end} the section in case 1: 20")
    assert not at_rest(point_case)
    assert at_rest(point_slide([(0.0, 0.0), (40.0, 20.0)]))
    stands = dem_fixture.case(0.1, 20.0).model_copy(update={"settled": False, "moved_lately_m": 0.0})
    assert at_rest(stands), "as good as still"
    assert not at_rest(stands.model_copy(update={"stopped_by": "right"})), "still, at the wall"


def test_a_levee_whose_crest_material_points_lower_more_than_the_highest_point_is_told(run: Config) -> None:
    """A terrace uphill is the highest point, and stays; the levee before it loses 5 m."""
    before = ((0.0, 9.0), (40.0, 2.0), (50.0, 7.0), (60.0, 2.0), (100.0, 2.0))
    after = ((0.0, 9.0), (40.0, 2.0), (50.0, 2.0), (60.0, 2.5), (100.0, 2.1))
    slid = point_slide([(0.0, 0.0), (50.0, 20.0)], surface_before=before, surface_after=after)
    [messages] = [text for text in with_points(run, slid) if "assumed" not in text]
    assert messages.startswith(
        "The surface of material points falls by 5.0 m at x = 50 m in case 1, far more than the highest ground"
    )


def test_points_that_leave_the_section_or_take_its_uphill_end_along_are_found() -> None:
    assert list(of_ends(None)) == []
    stays = point_slide([(0.0, 0.0), (40.0, 20.0), (80.0, 5.0)])
    as_one = point_slide([(0.0, 4.0), (40.0, 4.2), (80.0, 4.1)])
    assert ends_of({1: stays, 2: as_one}) == []
    leaves = point_slide([(0.0, 0.0), (40.0, 63.0)], stopped_by="right", settled=False)
    [warning] = ends_of({1: leaves, 2: stays})
    assert warning.startswith("material points leave the section in case 1: 63 m is a lower limit")
    [warning] = ends_of({1: leaves, 2: stays}, "fixed")
    assert warning.startswith("material points reach the fixed side of the section in case 1: 63 m is")
    [warning] = ends_of({3: point_slide([(0.0, 8.0), (40.0, 20.0)])})
    assert warning.startswith("the upslope end of the section moves with the slide by 8.0 m in case 3")
    falls_left = point_slide([(0.0, 20.0), (40.0, 8.0)], surface_before=((0.0, 0.0), (40.0, 10.0)))
    [warning] = ends_of({3: falls_left})
    assert "8.0 m" in warning


def test_an_uphill_end_that_slides_along_in_a_short_slide_is_no_warning() -> None:
    """Below `LEAST_END` the ground behind the section changes little, whatever share of the slide its end moves."""
    assert ends_of({1: point_slide([(0.0, 0.7), (40.0, LEAST_END - 0.1)])}) == []
    assert len(ends_of({1: point_slide([(0.0, 0.7), (40.0, LEAST_END + 0.1)])})) == 1


def test_a_factor_at_which_shallow_ground_slips_is_not_told_as_that_of_one_face() -> None:
    """Elements tell the face's own tan φ / tan β; where faces of unlike water meet, ground slips before either."""
    part = SafetyPart(kh=0.0, lower=1.872, upper=1.881, cells=100, shallow_failure=1.844)
    assert "shallow ground, of one face or where two meet, fails before, at 1.844 at most" in part.description
    open_part = part.model_copy(update={"shallow_failure": 1.881})
    assert "may fail before: no bound close to these was found for it" in open_part.description
