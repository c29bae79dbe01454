"""Sentences of the report on packings of discs, and the order of cases on them."""

import pytest

from dem.settings import SlideSettings
from tests.support import dem_fixture
from tests.support.answers import fem, liquefying_config, report_text, results
from workflow.config import Config
from workflow.report.summary_text import fail_alike, springs_of
from workflow.report.uncertainty import sources_of_uncertainty
from workflow.results.cases import CasesAnswer, Profile, RandomCase, RandomPackings, Seed, Spread


@pytest.fixture
def run() -> Config:
    return liquefying_config()


def test_an_interval_where_there_are_several_packings(run: Config) -> None:
    spread = Spread.of([2.1, 3.0, 4.8])
    case = RandomCase(slide_max_m=spread, settlement_uphill_m=spread, settlement_middle_m=spread)
    random = RandomPackings(seeds=(), cases={2: case})
    sets = {"calibrated": {2: dem_fixture.case(0.02, 3.0)}}
    messages = report_text(results(run, fem=fem(run), cases=CasesAnswer(sets=sets, random=random)))
    # mean 3.3 m, standard deviation 1.37 m, Student's t of two degrees of freedom 4.303: 3.3 -/+ 3.41 m
    assert spread.mean_ci95 == pytest.approx((-0.114, 6.714), abs=2e-3)
    assert spread.from_zero.mean_ci95 == pytest.approx((0.0, 6.714), abs=2e-3)
    assert (
        "On 3 random packings calibrated to the same critical Kh the largest slide is 3.3 m (2.1 to 4.8 m; 95 % "
        "interval of the mean of all packings: 0 to 6.7 m) in case 2." in messages
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
    words = report_text(results(config, fem=fem(config), cases=CasesAnswer(sets=sets, random=random)))
    assert ("Each case slides further than the case before" in words) is message


def test_the_surface_over_packings_has_a_band() -> None:
    flat = ((0.0, 10.0), (100.0, 10.0))
    sunk = [((1.0, 10.0 - k), (99.0, 10.0 - k)) for k in range(5)]
    profile = Profile.of([(flat, line) for line in sunk], points=3)
    assert profile.x == (1.0, 50.0, 99.0)
    assert profile.before == (10.0,) * 3
    assert profile.after == (8.0,) * 3
    assert profile.after_low == pytest.approx((6.0,) * 3)
    assert profile.after_high == pytest.approx((10.0,) * 3)
    many = Profile.of([(flat, line) for line in sunk for _ in range(5)], points=3)
    assert many.after_low == pytest.approx((6.0,) * 3)


def test_a_quantile_of_three_packings_is_their_smallest_value() -> None:
    few, many = Spread.of([1.0, 2.0, 3.0]), Spread.of([float(k) for k in range(1, 22)])
    assert (few.low, few.median, few.high) == (1.0, 2.0, 3.0)
    assert (many.low, many.high) == (2.0, 20.0)


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
        "slides that are the same on random packings and on discs in rows do not depend on the order of the rows"
        in rows["Random packing"]
    )
    off = {"packing": "random", "surface_off_mean_m": 0.104, "surface_off_worst_m": 0.273}
    loose = discs.model_copy(update={"model": discs.model.model_copy(update=off)})
    messages = dict(sources_of_uncertainty(results(run, dem=loose, cases=cases)))
    assert "the discs lies 0.10 m from the section's on average, and 0.27 m at the worst place." in messages["Packing"]
    assert "Another seed gives another packing." in messages["Packing"]  # and two have been tried
    assert not any(word in messages["Packing"] + messages["Random packing"] for word in ("lattice", "rows", "order"))
