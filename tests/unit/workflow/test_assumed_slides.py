"""What is assumed of slides where an input says neither how the ground shakes nor what liquefied ground keeps."""

import tomllib
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from dem.case import LOOSE_SAND, PAPER_CASES, Case
from meshes.errors import InputError
from tests.support.sections import analysed, slope
from workflow.earthquake.triggering.consequences import limiting_shear_strain
from workflow.earthquake.triggering.residual import Penetration, olson_stark
from workflow.report.tables import parameter_rows
from workflow.stages.liquefaction import liquefying


def liquefied(**tables: Any) -> dict[str, Any]:
    data = {**slope(), **tables}
    data["strata"][0]["liquefies_in"] = [1, 2, 3]
    return data


@pytest.mark.parametrize(("case", "count"), [*zip(LOOSE_SAND, (8.0, 3.0, 12.0), strict=True)], ids=lambda v: str(v)[:9])
def test_loose_sand_keeps_what_the_published_relations_say(case: Case, count: float) -> None:
    """Olson & Stark (2002), and the limiting shear strain of Idriss & Boulanger (2008), of the same blow count."""
    assert case.residual == pytest.approx(olson_stark(count, Penetration(count, 0.0, 50.0)))
    assert case.strain_potential == pytest.approx(limiting_shear_strain(count), abs=5e-3)


def test_strengths_are_the_ratios_times_the_mean_stress_of_the_soil() -> None:
    config = analysed(liquefied(water={"table": {"depth": 1.0}}))
    numbers = liquefying(config)[1]
    areas, stress = config.section.layering.areas(), config.section.cohesion_field.mean_effective_stress
    mean = sum(areas[k] * stress(k) for k in numbers) / sum(areas[k] for k in numbers)
    for case, ratio in zip(config.cases, LOOSE_SAND, strict=True):
        assert all(
            case.strength_of(config.section.strata[k].name) == pytest.approx(ratio.residual * mean, abs=1.0)
            for k in numbers
        )
        assert (case.name, case.residual) == (ratio.name, 0.0)
    [assumed] = [text for text in config.notices if text.startswith("no residual strength")]
    assert "loose sand" in assumed
    again = analysed(tomllib.loads(config.to_toml()))
    assert (again.cases, again.notices) == (config.cases, config.notices)
    assert [row[2] for row in parameter_rows(again) if "case" in row[0]] == ["default"] * 3


def test_the_paper_s_discs_have_the_paper_s_cases_and_its_kh() -> None:
    config = analysed(liquefied(dem={"model": "paper"}))
    assert config.cases == PAPER_CASES
    assert (config.slide.kh, config.slide.kh_cycles) == (0.1, None)
    assert not [text for text in config.notices if text.startswith("slide")]


def test_ground_shakes_in_the_cycles_of_magnitude_7_5_where_nothing_says_how() -> None:
    config = analysed(liquefied())
    assert (config.slide.kh, config.slide.kh_cycles, config.slide.kh_period) == (0.1, 15.0, 0.65)
    [assumed] = [text for text in config.notices if text.startswith("no shaking")]
    assert "Kh = 0.1 in both directions (15 cycles, period 0.65 s)" in assumed
    again = analysed(tomllib.loads(config.to_toml()))
    assert (again.slide, again.notices) == (config.slide, config.notices)
    assert {row[0]: row[2] for row in parameter_rows(again)}["shaking of the slides"] == "default"


@given(
    st.sampled_from([{"kh": 0.05}, {"kh": 0.0}, {"kh_seconds": 8.0}, {"kh": 0.1, "kh_cycles": 3.0, "kh_period": 1.0}])
)
def test_what_is_written_of_the_shaking_stays(written: dict[str, float]) -> None:
    config = analysed(liquefied(slide=written))
    for key in ("kh", "kh_seconds", "kh_cycles", "kh_period"):
        assert getattr(config.slide, key) == written.get(key, 0.1 if key == "kh" else None)
    assert not [text for text in config.notices if text.startswith("no shaking")]


def test_cases_that_are_written_stay() -> None:
    config = analysed(liquefied(slide={"cases": [{"residual": 0.1}] * 3}))
    assert [case.residual for case in config.cases] == [0.1] * 3
    assert not [text for text in config.notices if text.startswith("no residual strength")]
    with pytest.raises(InputError, match="expected cases from 1 to 1"):
        analysed(liquefied(slide={"cases": [{"residual": 0.1}]}))


def test_ground_that_does_not_liquefy_is_left_as_it_was_written() -> None:
    config = analysed(slope())
    assert config.slide.model_fields_set == set()
    assert not [text for text in config.notices if text.startswith("slide")]
