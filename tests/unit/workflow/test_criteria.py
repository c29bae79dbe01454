"""Verdicts, structures and published criteria."""

import tomllib

import pytest

from meshes.errors import InputError
from meshes.section.structure import Structure, structure_problems
from tests.support import TOP
from workflow.config import Config
from workflow.config.renamed import current, notices
from workflow.criteria.settings import (
    PRESETS,
    CriteriaSettings,
    FactorCriterion,
    FreeboardCriterion,
    common_verdict,
    judge,
)


@pytest.mark.parametrize(
    ("low", "high", "at_least", "verdict"),
    [
        (1.3, 1.3, True, "satisfied"),
        (1.2, 1.2, True, "satisfied"),  # the limit itself is kept
        (1.1, 1.1, True, "not satisfied"),
        (1.1, 1.3, True, "not decided"),
        (None, None, True, "not decided"),
        (0.1, 0.3, False, "satisfied"),
        (1.3, 1.4, False, "not satisfied"),
        (1.0, 1.4, False, "not decided"),
    ],
)
def test_an_interval_against_a_limit(low: float | None, high: float | None, at_least: bool, verdict: str) -> None:
    assert judge(low, high, 1.2, at_least) == verdict


def test_several_verdicts() -> None:
    assert common_verdict(("satisfied", "satisfied")) == "satisfied"
    assert common_verdict(("satisfied", "not decided")) == "not decided"
    assert common_verdict(("not decided", "not satisfied")) == "not satisfied"
    assert common_verdict(()) == "not decided"


def test_published_criteria_follow_the_peak_acceleration() -> None:
    messages = CriteriaSettings(preset="hynes_griffin_franklin_1984").resolved(0.25)
    assert messages.factor_of_safety is not None
    assert messages.displacement is not None
    assert (messages.factor_of_safety.limit, messages.factor_of_safety.kh, messages.displacement.limit) == (
        1.25,  # 1.0 with 80 % of the strengths
        0.125,
        1.0,
    )
    criterion = FactorCriterion(limit=1.3)
    messages = CriteriaSettings(preset="nchrp_611", factor_of_safety=criterion).resolved(0.4)
    assert messages.factor_of_safety == criterion
    assert messages.displacement is not None
    assert messages.displacement.limit == pytest.approx(0.0508, abs=0.001)
    messages = CriteriaSettings(preset="nchrp_611", factor_of_safety=criterion).resolved(
        None
    )  # its displacement needs no peak
    assert messages.factor_of_safety == criterion
    assert messages.displacement is not None


@pytest.mark.parametrize(("undrained", "factor"), [(False, 1.25), (True, 1.4)])
def test_eurocode_divides_strengths_by_its_partial_factors_at_half_of_the_peak(undrained: bool, factor: float) -> None:
    """EN 1998-5:2004, 4.1.3.3: F_H = 0.5 α S W; EN 1997-1, table A.4: 1.25 for tan φ', 1.4 for c_u, and no other
    limit."""
    limits = CriteriaSettings(preset="eurocode_8_5").resolved(0.3, undrained)
    assert limits.factor_of_safety is not None
    assert (limits.factor_of_safety.limit, limits.factor_of_safety.kh) == (factor, 0.15)
    assert limits.factor_of_safety.source.startswith("EN 1998-5:2004")
    assert (limits.displacement, limits.freeboard) == (None, None)
    assert CriteriaSettings(preset="eurocode_8_5").lacks_peak


def test_the_old_name_of_a_preset_is_read_with_a_notice() -> None:
    """It was the name of a guideline whose text was not checked; no result may print it."""
    old = {"criteria": {"preset": "river_levee_mlit"}}
    assert current(old)["criteria"]["preset"] == "crest_above_water"
    assert any("crest_above_water" in notice for notice in notices(old))
    assert not PRESETS["crest_above_water"].source


def test_the_crest_of_a_river_levee_stays_above_the_water_outside() -> None:
    limits = CriteriaSettings(preset="crest_above_water")
    assert not limits.lacks_peak  # it needs a slide, and no acceleration
    limits = limits.resolved(None)
    assert limits.freeboard is not None
    assert (float(limits.freeboard.limit), limits.freeboard.water) == (0.0, None)
    assert (limits.factor_of_safety, limits.displacement) == (None, None)
    higher = FreeboardCriterion.model_validate({"limit": "0.5 m", "water": 12.5})
    assert CriteriaSettings(preset="crest_above_water", freeboard=higher).resolved(None).freeboard == higher


def test_structures_that_do_not_fit() -> None:
    names = [("a", 10.0, 5.0), ("b", 10.0, 200.0), ("a", 1.0, 2.0)]
    messages = structure_problems([Structure(name=n, start=s, end=e) for n, s, e in names], (0.0, 140.0))
    assert messages == [
        'structures 1 "a", from = 10 m, to = 5 m: expected the left foot, then the right foot',
        'structures 2 "b", from = 10 m, to = 200 m: lies off the section, which reaches from 0 to 140 m',
        'structures: 2 structures are called "a"; expected different names',
    ]


def test_a_limit_that_is_wrong_has_one_sentence() -> None:
    data = tomllib.loads((TOP / "tests/support/levee/levee.toml").read_text(encoding="utf-8"))
    del data["sliding_block"]

    def problems(**tables: object) -> tuple[str, ...]:
        with pytest.raises(InputError) as caught:
            Config.parse({**data, **tables})
        return tuple(caught.value.problems)

    wanted = "expected the least factor of safety, such as 1.2"
    assert problems(criteria={"factor_of_safety": {"kh": 0.1}}) == (
        f"criteria, factor_of_safety, limit: missing; {wanted}",
    )
    assert problems(criteria={"factor_of_safety": {"limit": -1}}) == (
        "criteria, factor_of_safety, limit = -1: expected a number above 0 (the least factor of safety, such as 1.2)",
    )
    assert problems(criteria={"freeboard": {"limit": "-1 m"}}) == (
        "criteria, freeboard, limit = '-1 m': out of range; expected a height of 0 or more, such as \"0.5 m\"",
    )
    (unknown,) = problems(criteria={"preset": "eurocode"})
    assert unknown.startswith(
        "criteria, preset = 'eurocode': expected a named criterion: \"hynes_griffin_franklin_1984\""
    )
    assert problems(structures=[{"name": "a", "from": 9, "to": 5}]) == (
        'structures 1 "a", from = 9 m, to = 5 m: expected the left foot, then the right foot',
    )


def test_a_preset_needs_a_peak_acceleration() -> None:
    section = {
        "name": "slope",
        "surface": [[0, 10], [20, 10], [40, 0], [60, 0]],
        "base": {"elevation": -10},
        "strata": [
            {
                "name": "clay", "density": "18 kN/m^3", "youngs_modulus": "10 MPa", "poissons_ratio": 0.3,
                "cohesion": "20 kPa", "friction_angle": "10 deg",
            }
        ],
        "criteria": {"preset": "nchrp_611"},
    }  # fmt: skip
    with pytest.raises(InputError) as caught:
        Config.parse(section)
    assert tuple(caught.value.problems) == (
        'criteria, preset = "nchrp_611": expected peak_acceleration, or magnitude and distance, in [earthquake]',
    )
    config = Config.parse({**section, "earthquake": {"peak_acceleration": "0.3 g"}})
    assert config.criteria.factor_of_safety is not None
    assert config.criteria.factor_of_safety.kh == pytest.approx(0.15)
    assert Config.parse(tomllib.loads(config.to_toml())).criteria == config.criteria
    european = {**section, "criteria": {"preset": "eurocode_8_5"}, "earthquake": {"peak_acceleration": "0.3 g"}}
    for angle, limit in (("10 deg", 1.25), (0, 1.4)):
        european["strata"][0]["friction_angle"] = angle
        factor = Config.parse(european).criteria.factor_of_safety
        assert factor is not None
        assert factor.limit == limit


@pytest.mark.parametrize(
    "earthquake",
    [{"peak_acceleration": "0.3 g"}, {"magnitude": 7.0, "distance": "20 km"}, {"magnitude": 12.0, "distance": "20 km"}],
)
def test_another_fault_of_a_file_does_not_make_the_peak_of_a_preset_missing(earthquake: dict[str, object]) -> None:
    """A negative cohesion, or a magnitude of 12, was followed by "expected peak_acceleration, or magnitude and
    distance"."""
    stratum = {
        "name": "clay", "density": "18 kN/m^3", "youngs_modulus": "10 MPa", "poissons_ratio": 0.3,
        "cohesion": "-20 kPa", "friction_angle": "10 deg",
    }  # fmt: skip
    section = {
        "name": "slope", "surface": [[0, 10], [20, 10], [40, 0], [60, 0]], "base": {"elevation": -10},
        "strata": [stratum], "criteria": {"preset": "nchrp_611"}, "earthquake": earthquake,
    }  # fmt: skip
    with pytest.raises(InputError) as caught:
        Config.parse(section)
    problems = caught.value.problems
    assert any("cohesion = '-20 kPa'" in problem for problem in problems)
    assert not any("preset" in problem for problem in problems)
