"""Sentences of the report: every number in them is one that was found, with the digits it deserves."""

import pytest

from dem.settings import SlideSettings
from tests.support import dem_fixture
from tests.support.answers import bounds, fem, results, variant, warned
from tests.support.sections import analysed, slope
from workflow.config import Config
from workflow.report.first_page import conclusions, headlines
from workflow.report.numbers import about, between, coefficient, listed, rough, rough_range, span
from workflow.report.stability import stability_rows
from workflow.report.summary_text import fail_alike, findings, springs_of
from workflow.report.texts import Texts
from workflow.report.uncertainty import sources_of_uncertainty
from workflow.report.warnings import joined
from workflow.results.cases import CaseAnswer, CasesAnswer, Profile, RandomCase, RandomPackings, Seed, Spread
from workflow.results.continuum import OtherWay, PathStep, ResultWarning, ShallowFailurePart, VariantsAnswer
from workflow.results.dem_counterpart import DemCounterpart
from workflow.results.lengths import metres
from workflow.results.results import Results
from workflow.run.record import Entry
from workflow.run.store import Store


@pytest.fixture
def run() -> Config:
    data = slope()
    data["strata"][0]["liquefies_in"] = [1, 2, 3]
    return analysed(data)


def text(outcome: Results) -> str:
    numbers = [headline.conclusion for headline in headlines(outcome, Texts())]
    return "\n".join([*numbers, *conclusions(outcome, Texts()), *findings(outcome)])


def moving(slide: float) -> CaseAnswer:
    return dem_fixture.case(0.1, slide).model_copy(update={"settled": False, "seconds_simulated": 60.2})


def test_before_anything_was_computed_all_is_open(run: Config) -> None:
    messages = text(results(run))
    assert "No critical Kh: the finite element analysis was not run." in messages
    assert "The slide after liquefaction is not known: the slides were not computed." in messages


def test_ground_that_is_not_said_to_liquefy_is_not_asked_how_far_it_slides() -> None:
    messages = text(results(analysed(slope())))
    assert "No layer of the section liquefies, so no slide was computed." in messages
    assert "The slide after liquefaction" not in messages


def test_a_critical_kh_with_what_it_hangs_on(run: Config) -> None:
    variants = VariantsAnswer(
        variants=(
            variant("element", "bilinear element instead of quadratic", 0.268),
            variant("sides", "sides fixed instead of free-field", 0.338),
            variant("dilation", "ψ = φ instead of ψ as given", None),
        )
    )
    result = results(run, fem=fem(run, 0.2345), variants=variants, bounds=bounds(run, 0.2293, 0.2349))
    messages = text(result)
    assert "The section fails downslope, to the right, at Kh = 0.234 (2.3 m/s²), with free-field sides, ass" in messages
    assert headlines(result, Texts())[0].interval == "0.229 to 0.235 by strict bounds"
    assert "The numerical error of the critical Kh is below 0.006, by strict bounds." in messages
    assert "The assumptions matter more: kc = 0.338 with sides fixed instead of free-field." in messages
    assert "instead of ψ as given" not in messages  # that one came to nothing
    [sides] = [item for item in warned(result) if item.startswith("With sides")]
    assert sides.startswith("With sides fixed instead of free-field the critical Kh is 0.338 instead of 0.234, so that")
    assert sides.endswith('Move the sides away by beyond = "50 m".')


def test_another_flow_that_bears_more_than_strict_bounds_allow_is_left_out(run: Config) -> None:
    """No smaller ψ bears more than ψ = φ (Radenkovic 1961): a path above that was followed on too coarse a mesh."""
    more = variant("dilation", "the non-associated path with the given ψ instead of ψ = φ", 0.30)
    less = variant("dilation", "the path with less", 0.235)
    result = results(run, fem=fem(run), variants=VariantsAnswer(variants=(more, less)), bounds=bounds(run, 0.27, 0.28))
    assert "kc = 0.235 with the path with less." in text(result)
    assert "ψ as given instead" not in text(result)


def test_one_mesh_without_bounds_leaves_the_numerical_error_open(run: Config) -> None:
    same = variant("sides", "sides fixed instead of free-field", 0.2331)
    answer = fem(run, 0.2345).model_copy(update={"kc_upper": 0.2346})
    result = results(run, fem=answer, variants=VariantsAnswer(variants=(same,)))
    messages = text(result)
    assert not warned(result)
    assert "The numerical error of the critical Kh is not known, since there is one mesh" in messages
    assert "With other assumptions: kc = 0.233 with sides fixed instead of free-field." in messages


def test_what_stands_beside_the_critical_kh(run: Config) -> None:
    """The other direction, what ψ = φ would give, faces without cohesion, and what contradicts the answer."""
    other = OtherWay(kc=0.173, kc_upper=0.18, verdict="plateau", reason="", direction="uphill", at_sides=("left",))
    face = ShallowFailurePart(stratum="upper", start_x_m=20.0, end_x_m=44.0, angle_deg=26.0, kh=0.05)
    warning = ResultWarning(what="A finer mesh gives 0.20.", remedy="refine it", contradiction=True)
    known = ResultWarning(what="The base is near.", remedy="go deeper", contradiction=False)
    more = {
        "flow": "davis",
        "opposite": other,
        "associated": other.model_copy(update={"kc": 0.3057}),
        "shallow_failures": (face,),
    }
    answer = fem(run).model_copy(update={**more, "warnings": (warning, known)})
    messages = text(results(run, fem=answer, bounds=bounds(run, 0.30, 0.31)))
    assert "With ψ = φ the ground slides out of the section at the left side." in messages
    assert "At Kh = 0.050 already, the cohesionless face of upper from x = 20 to 44 m fails as an infinite" in messages
    rows = {(row.value, row.conditions) for row in stability_rows(results(run, fem=answer), Texts())}
    assert ("0.306", "free-field sides, associated flow, ψ = φ") in rows
    assert ("0.173", "seismic force upslope; slides out at the side of the section") in rows
    assert warned(results(run, fem=answer))[0] == "A finer mesh gives 0.20. Refine it."
    stands = fem(run).model_copy(update={"opposite": other.model_copy(update={"verdict": "no failure", "kc": 1.5})})
    assert "> 1.500" in [row.value for row in stability_rows(results(run, fem=stands), Texts())]


def test_a_limit_load_that_the_path_did_not_come_to_is_no_plateau(run: Config) -> None:
    """The river bank's path rises almost straight to 0.95 of what its elements bear."""
    assert fem(run, 0.1096).ended == "plateau"
    assert fem(run, 0.1096).model_copy(update={"kc_lower": 0.1041}).ended == "limit load"


def test_a_slope_that_stands_and_one_that_does_not(run: Config) -> None:
    stands = text(results(run, fem=fem(run, 1.5, "no failure")))
    assert "The section stands at every Kh up to 1.500, where the search ended." in stands
    ended = Entry({}, "no answer", reason="the section fails under its own weight")
    falls = text(Results(run, Store("nowhere"), {"fem": ended}, {}))
    assert "No critical Kh: the section fails under its own weight." in falls


def test_slides_that_end_and_slides_that_do_not(run: Config) -> None:
    sets = {
        "calibrated": {1: dem_fixture.case(0.1, 0.02), 2: dem_fixture.case(0.02, 3.23), 3: moving(39.5)},
        "table2": {1: dem_fixture.case(0.1, 0.33)},
    }
    messages = text(results(run, fem=fem(run), cases=CasesAnswer(sets=sets, random=None)))
    assert "In case 1 the surface moves less than 0.1 m." in messages
    assert "In case 2 the surface slides 3.2 m and comes to rest." in messages
    assert (
        "In case 3 the surface had slid 40 m after 60 s and was still moving: these are not final values." in messages
    )
    assert "One packing of discs was computed, so no interval is known" in messages
    assert (
        "For comparison, discs with the springs of the paper's Table 2 as printed: In case 1 the surface slides 0.33 m"
        in messages
    )


def test_a_slide_that_a_side_of_the_box_stopped_is_told_so(run: Config) -> None:
    """And one that needs no shaking is called a flow failure, however far it slides with it."""
    stopped = {"stopped_by": "right", "flows": True, "slide_by_weight_m": 9.9, "settled": True}
    first = dem_fixture.case(0.1, 47.2).model_copy(update=stopped)
    second = first.model_copy(update={"settled": False, "moved_lately_m": 0.036, "slide_by_weight_m": 12.7})
    third = dem_fixture.case(0.01, 3.0)
    cases = CasesAnswer(sets={"calibrated": {1: first, 2: second, 3: third}}, random=None)
    messages = text(results(run, fem=fem(run), cases=cases))
    assert "In case 1 the surface slides 47 m, where the right side of the disc model stops it." in messages
    assert "In case 3 the surface slides 3.0 m and comes to rest." in messages
    assert (
        "In case 2 the surface slides 47 m, where the right side of the disc model stops it; it moved 4 cm in the last "
        "10 s." in messages
    )
    assert "in a longer section the slide would be longer" in messages
    assert (
        "In cases 1 and 2 this is a flow failure: without shaking the surface slides 9.9 and 13 m in 20 s." in messages
    )


def test_an_interval_where_there_are_several_packings(run: Config) -> None:
    spread = Spread.of([2.1, 3.0, 4.8])
    case = RandomCase(slide_max_m=spread, settlement_uphill_m=spread, settlement_middle_m=spread)
    random = RandomPackings(seeds=(), cases={2: case})
    sets = {"calibrated": {2: dem_fixture.case(0.02, 3.0)}}
    messages = text(results(run, fem=fem(run), cases=CasesAnswer(sets=sets, random=random)))
    # mean 3.3 m, standard deviation 1.37 m, Student's t of two degrees of freedom 4.303: 3.3 -/+ 3.41 m
    assert spread.mean_ci95 == pytest.approx((-0.114, 6.714), abs=2e-3)
    assert spread.from_zero.mean_ci95 == pytest.approx((0.0, 6.714), abs=2e-3)
    assert (
        "On 3 random packings calibrated to the same critical Kh the largest slide is 3.3 m (2.1 to 4.8 m; mean of all "
        "packings 0 to 6.7 m with 95 %) in case 2." in messages
    )


def test_where_the_continuum_leaves_its_kh_open_the_packings_are_told_to_lie_within(run: Config) -> None:
    open_end = dem_fixture.calibration(0.24, True).model_copy(update={"continuum_kc": (0.16, 0.2), "tolerance": 0.005})
    assert (
        fail_alike(results(run, calibration=open_end)) == "calibrated to within the uncertainty of the finite elements"
    )
    met = open_end.model_copy(update={"continuum_kc": (0.16, 0.164)})
    assert fail_alike(results(run, calibration=met)) == "calibrated to the same critical Kh"
    untouched = met.model_copy(update={"verdict": "not asked for", "continuum_kc": None})
    assert "not calibrated to the finite elements" in fail_alike(results(run, calibration=untouched))
    assert "not calibrated to" in springs_of(results(run, calibration=untouched))["calibrated"]


def test_the_order_of_cases_goes_by_packings() -> None:
    def entry(*values: float) -> RandomCase:
        return RandomCase(
            slide_max_m=Spread.of(values), settlement_uphill_m=Spread.of(values), settlement_middle_m=Spread.of(values)
        )

    random = RandomPackings(seeds=(), cases={1: entry(1.0, 2.0, 3.0), 2: entry(1.5, 1.9, 3.1)})
    assert random.rising == 2
    assert RandomPackings(seeds=(), cases={1: entry(1.0, 2.0), 2: entry(1.0, 2.0)}).rising == 0, (
        "cases that slide alike"
    )
    assert RandomPackings(seeds=(), cases={1: entry(1.0, 2.0)}).rising is None


@pytest.mark.parametrize(
    ("cases", "message"),
    [
        ([{"residual": 0.2}, {"residual": 0.15}, {"residual": 0.13}], True),
        ([{"stiffness": k, "residual": 0.2} for k in (0.1, 0.02, 0.01)], True),
        ([{"stiffness": k, "residual": 0.25 - k} for k in (0.1, 0.02, 0.01)], False),
        ([{"residual": 0.2}] * 3, False),
        ([{"residual": {"Sand": k}} for k in (0.2, 0.15, 0.1)], False),
    ],
)
def test_the_order_of_cases_is_told_where_each_leaves_less(
    run: Config, cases: list[dict[str, object]], message: bool
) -> None:
    def rising(first: float) -> RandomCase:
        spread = Spread.of([first, first + 0.1, first + 0.2])
        return RandomCase(slide_max_m=spread, settlement_uphill_m=spread, settlement_middle_m=spread)

    random = RandomPackings(seeds=(), cases={k: rising(float(k)) for k in range(1, len(cases) + 1)})
    sets = {"calibrated": {k: dem_fixture.case(0.1, float(k)) for k in random.cases}}
    config = run.model_copy(update={"slide": SlideSettings.model_validate({"cases": cases})})
    words = text(results(config, fem=fem(config), cases=CasesAnswer(sets=sets, random=random)))
    assert ("Each case slides further than the case before" in words) is message


def test_methods_that_disagree_are_told_to(run: Config) -> None:
    """Hamada gives 3.2 m for this slope, and the block does not move at Kh = 0.1 with kc = 0.24."""
    far = text(results(run, fem=fem(run), cases=CasesAnswer(sets={"calibrated": {3: moving(39.5)}}, random=None)))
    assert "differ by more than a factor of three: discs 40 m, regression over observed slides 3.2 m and rigid" in far
    assert "rigid block on the slip surface 0 m." in far
    assert "check the stiffness and strength of the liquefied layers" in far
    near = CasesAnswer(sets={"calibrated": {2: dem_fixture.case(0.02, 3.0)}}, random=None)
    messages = text(results(run, cases=near))  # without a critical Kh there is no block
    assert "differ by" not in messages


def test_what_was_measured_stands_beside_the_discs() -> None:
    data = slope()
    data["strata"][0]["liquefies_in"] = [1, 2]
    data["slide"] = {"kh": 0}
    places = ({"name": "SI-5", "displacement": "0.2 m", "x": 35.0}, {"name": "SI-2", "displacement": "0.45 m"})
    measured = analysed({**data, "report": {"observed": list(places)}})
    messages = text(results(measured))
    assert "The measured displacement" not in messages  # stands beside slides alone, and there are none yet
    along = ((30.0, 0.1), (40.0, 0.5))
    slides = {number: moving(far).model_copy(update={"slide_along": along}) for number, far in ((1, 0.6), (2, 0.9))}
    messages = text(results(measured, cases=CasesAnswer(sets={"calibrated": slides}, random=None)))
    assert "0.2 m (SI-5); the discs slide there, at x = 35 m, 0.30 m in cases 1 and 2." in messages
    assert "0.45 m (SI-2); the discs slide at most 0.60 m and 0.90 m in cases 1 and 2." in messages


def test_what_must_be_known_to_believe_a_case_is_told_with_the_discs_own_prediction(run: Config) -> None:
    noted = {number: dem_fixture.case(0.1, 3.0).model_copy(update={"notes": ("discs overlap",)}) for number in (1, 3)}
    cases = CasesAnswer(sets={"calibrated": {**noted, 2: dem_fixture.case(0.1, 3.0)}}, random=None)
    predicted = {"predicted_kc": 0.213, "predicted_ratio": 0.86}
    calibration = dem_fixture.calibration(0.24, True).model_copy(update=predicted)
    result = results(run, fem=fem(run), calibration=calibration, cases=cases)
    assert "Discs overlap (cases 1 and 3)." in warned(result)
    messages = text(result)
    assert "Uncalibrated, the discs fail at Kh = 0.213, 0.86 times the critical Kh of the finite elements" in messages


def test_what_is_doubtful_is_told(run: Config) -> None:
    guessed = analysed({**slope(), "reconstruction": True, "reconstruction_note": "drawn from memory"})
    calibration = dem_fixture.calibration(0.24, True)
    discs = dem_fixture.critical(guessed, 0.24)
    warnings = warned(results(guessed, dem=discs, calibration=calibration))
    assert warnings[0] == "The ground is a reconstruction. Confirm the depths of the layers by borings."
    assert "only with the stiffness of the contacts multiplied by 0.0075." in warnings[1]
    assert warnings[-1].startswith("The discs are in rows, which must climb over each other to slide.")
    model = discs.model.model_copy(update={"packing": "random"})
    loose = warned(results(guessed, dem=discs.model_copy(update={"model": model}), calibration=calibration))
    assert "rows" not in " ".join(loose)
    slid = CasesAnswer(sets={"calibrated": {3: dem_fixture.case(0.1, 3.0)}}, random=None)
    assert "discs calibrated to the critical Kh of the finite" in text(
        results(run, calibration=calibration, cases=slid)
    )
    out_of_reach = results(run, calibration=dem_fixture.calibration(0.24, False), cases=slid)
    assert "discs whose calibration failed, with the critical Kh nearest to that of the finite elements" in text(
        out_of_reach
    )
    [failed] = [item for item in warned(out_of_reach) if item.startswith("Calibration")]
    assert failed.startswith("Calibration failed, since no factor on the strength of the discs gives the critical Kh")


def test_notes_that_say_the_same_of_cases_are_one_warning() -> None:
    """With a range where their numbers differ, and the remedy of the first; numbers in names are no numbers."""
    notes = {
        1: (
            "1.2 % of the area is gone: beyond 3 m²",
            'stratum "layer 4" is 2.4 m thick: take less',
            "sand of Ac1 is thin",
        ),
        2: ("it slides 10 m within 20 s, a flow failure: mind", "3.4 % of the area is gone: beyond 8 m²"),
        3: ("it slides 9.9 m within 20 s, a flow failure: mind", 'stratum "layer 5" is 2.4 m thick: take less'),
    }
    assert list(joined(notes)) == [
        "it slides 9.9 to 10 m within 20 s, a flow failure (cases 2 and 3): mind",
        "1.2 to 3.4 % of the area is gone (cases 1 and 2): beyond 3 m²",
        'stratum "layer 4" is 2.4 m thick (case 1): take less',
        'stratum "layer 5" is 2.4 m thick (case 3): take less',
        "sand of Ac1 is thin (case 1)",
    ]


def test_a_target_of_the_discs_that_is_not_sharp_is_told(run: Config) -> None:
    """Where the path of the continuum went on far above its last equilibrium."""
    step = PathStep(
        length=1.0, displacement=0.02, factor=0.16, iterations=3, residual=0.0, plastic_share=0.3, cutbacks=0,
        at_rest=False, balanced=True,
    )  # fmt: skip
    like = DemCounterpart.of(fem(run, 0.16).model_copy(update={"curve": (step,)}))
    result = results(run, dem=dem_fixture.critical(run, 0.16), dem_counterpart=like)
    assert not any("boundary conditions of the discs" in item for item in warned(result))
    wide = like.model_copy(update={"kc_upper": 0.226, "flow": "section"})
    warnings = warned(results(run, dem=dem_fixture.critical(run, 0.16), dem_counterpart=wide))
    assert (
        "of the discs (free-field sides, ψ as given) fail between Kh = 0.160 and 0.226. Discs that fail" in warnings[0]
    )


def test_discs_that_fail_elsewhere_than_the_continuum_are_told(run: Config) -> None:
    discs = dem_fixture.critical(run, 0.16)

    def message(**slip: object) -> list[str]:
        surfaces = discs.slip_surface.model_copy(update=slip)
        return warned(results(run, dem=discs.model_copy(update={"slip_surface": surfaces})))

    height = float(run.section.outline()[:, 1].max() - run.section.outline()[:, 1].min())
    assert any("m apart on average" in warning for warning in message(mean_distance_m=0.3 * height))
    assert not any("m apart on average" in warning for warning in message(mean_distance_m=0.2 * height))
    messages = message(mean_distance_m=None, dem=((0.0, 1.0), (9.0, 1.0)), fem=((20.0, 1.0), (31.0, 1.0)))
    assert any("from x = 0 to 9 m, the finite elements from 20 to 31 m" in warning for warning in messages)
    assert not any("Discs fail from" in warning for warning in message(mean_distance_m=None, fem=()))


def test_discs_that_fail_below_their_critical_kh_where_it_is_held_are_told(run: Config) -> None:
    """Those of the fixture fail at 0.3."""
    assert (
        "calibrated discs fail under a constant Kh = 0.3, below their critical Kh of 0.360 under prescribed"
        in " ".join(warned(results(run, dem=dem_fixture.critical(run, 0.36))))
    )
    assert not any("constant Kh" in item for item in warned(results(run, dem=dem_fixture.critical(run, 0.24))))


@pytest.mark.parametrize(
    ("value", "words"),
    [(39.53, "40 m"), (19.3, "19 m"), (7.13, "7.1 m"), (3.23, "3.2 m"), (1.44, "1.4 m"), (0.853, "0.85 m")],
)
def test_a_slide_has_the_same_digits_in_sentences_headlines_and_tables(value: float, words: str) -> None:
    assert (about([value]), span([value, value]), metres(value)) == (words, words, words)


def test_numbers_in_sentences() -> None:
    assert about([39.53, 19.3, 7.13]) == "40, 19 and 7.1 m"
    assert (span([7.13, 39.5]), span([2.1, 2.2])) == ("7.1 to 40 m", "2.1 to 2.2 m")
    assert (rough_range(0.33, 7.13), rough_range(3.1, 2.9)) == ("0.3 to 7 m", "3 m")
    assert rough(0.0) == 0.0
    assert [coefficient(kh) for kh in (0.2345, 0.0341, 1.5, 0.0996)] == ["0.234", "0.034", "1.500", "0.100"]
    assert (between([0.2345, 0.2387]), between([0.231, 0.232])) == ("0.234 to 0.239", "0.231 to 0.232")
    assert [listed(words) for words in ([], ["a"], ["a", "b"], ["a", "b", "c"])] == ["", "a", "a and b", "a, b and c"]
    assert [metres(value) for value in (None, 0.0, 0.33, -1.047, 39.53)] == ["–", "0 m", "0.33 m", "-1.0 m", "40 m"]


def test_the_surface_over_packings_has_a_band() -> None:
    flat = ((0.0, 10.0), (100.0, 10.0))
    sunk = [((1.0, 10.0 - k), (99.0, 10.0 - k)) for k in range(5)]
    profile = Profile.of([(flat, line) for line in sunk], points=3)
    assert profile.x == (1.0, 50.0, 99.0)
    assert profile.before == (10.0,) * 3
    assert profile.after == (8.0,) * 3
    assert profile.after_low == pytest.approx((6.2,) * 3)
    assert profile.after_high == pytest.approx((9.8,) * 3)


def test_packings_by_their_seeds_or_by_their_number() -> None:
    assert SlideSettings(seeds=(4, 7)).packings("soil") == (4, 7)
    assert len(SlideSettings(seeds=36).packings("soil")) == 36
    assert (SlideSettings().packings("soil"), SlideSettings().packings("paper")) == ((1, 2), ())
    with pytest.raises(ValueError, match="seeds"):
        SlideSettings(seeds=0)


def test_what_is_said_of_a_packing_is_of_its_kind(run: Config) -> None:
    """Rows climb over each other on a lattice alone, and only random packings have another seed."""
    spread = Spread.of([2.1, 3.0])
    case = RandomCase(slide_max_m=spread, settlement_uphill_m=spread, settlement_middle_m=spread)
    seeds = tuple(
        Seed(seed=seed, kc_before=0.3, parameter="strength", value=1.0, kc=0.3, verdict="calibrated", reason="")
        for seed in (0, 1)
    )
    cases = CasesAnswer(sets={}, random=RandomPackings(seeds=seeds, cases={1: case}))
    discs = dem_fixture.critical(run, 0.24)
    rows = dict(sources_of_uncertainty(results(run, dem=discs, cases=cases)))
    assert "rows must climb over each other" in rows["Packing"]
    assert "Another seed" not in rows["Packing"]
    assert (
        "results that they share with the discs in rows are not due to the order of the rows" in rows["Random packing"]
    )
    off = {"packing": "random", "surface_off_mean_m": 0.104, "surface_off_worst_m": 0.273}
    loose = discs.model_copy(update={"model": discs.model.model_copy(update=off)})
    messages = dict(sources_of_uncertainty(results(run, dem=loose, cases=cases)))
    assert "the discs lies 0.10 m from the section's on average, and 0.27 m at the worst place." in messages["Packing"]
    assert "Another seed gives another packing." in messages["Packing"]  # and two have been tried
    assert not any(word in messages["Packing"] + messages["Random packing"] for word in ("lattice", "rows", "order"))
