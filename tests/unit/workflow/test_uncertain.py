"""Distributions against scipy's, what they change in an input, and samples of them."""

import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from meshes.errors import InputError
from tests.support import SECTIONS
from tests.support.sections import slope
from workflow.config import Config
from workflow.uncertain.distribution import Distribution
from workflow.uncertain.sampling import correlated, probabilities, samples
from workflow.uncertain.settings import StudySettings

CHANCES = np.linspace(0.001, 0.999, 41)


def test_quantiles_are_those_of_the_textbooks() -> None:
    sigma = math.sqrt(math.log(1.0 + 0.3**2))
    known = [
        ({"normal": (35.0, 2.0)}, stats.norm(35.0, 2.0)),
        ({"lognormal": (10.0, 3.0)}, stats.lognorm(sigma, scale=10.0 / math.sqrt(1.09))),
        ({"uniform": (-1.0, 3.0)}, stats.uniform(-1.0, 4.0)),
        ({"triangular": (0.0, 1.0, 5.0)}, stats.triang(0.2, 0.0, 5.0)),
        ({"normal": (35.0, 2.0), "truncation": (32.0, 36.0)}, stats.truncnorm(-1.5, 0.5, 35.0, 2.0)),
    ]
    for parameters, exact in known:
        values = [Distribution.model_validate(parameters).at(chance) for chance in CHANCES]
        np.testing.assert_allclose(values, exact.ppf(CHANCES), rtol=1e-9)
    # the parameters of a lognormal number are its own mean and standard deviation
    assert stats.lognorm(sigma, scale=10.0 / math.sqrt(1.09)).stats() == pytest.approx((10.0, 9.0))


def test_a_list_has_its_probabilities() -> None:
    even = Distribution(list=("free-field", "fixed"))
    assert [even.at(chance) for chance in (0.0, 0.49, 0.51, 0.99)] == ["free-field", "free-field", "fixed", "fixed"]
    odd = Distribution(list=(1, 2, 3), probabilities=(1.0, 0.0, 3.0))
    assert [odd.at(chance) for chance in (0.2, 0.3, 0.9)] == [1, 3, 3]
    assert (even.is_words, odd.is_words) == (True, False)


def test_units_are_brought_together() -> None:
    mixed = Distribution(normal=("35 deg", "0.1 rad"))
    assert mixed.unit == "deg"
    assert mixed.at(0.5 + 0.341344746068543) == pytest.approx(35.0 + math.degrees(0.1))
    assert mixed.written(34.5) == "34.5 deg"
    assert Distribution(uniform=("1 tf/m^2", "20 kPa")).at(1.0) == pytest.approx(20.0 / 9.80665)


@given(chance=st.floats(1e-9, 1.0 - 1e-9), low=st.floats(-5.0, 0.0), width=st.floats(0.1, 5.0))
def test_what_is_cut_off_stays_between(chance: float, low: float, width: float) -> None:
    cut = Distribution(normal=(0.0, 1.0), truncation=(low, low + width))
    assert low - 1e-9 <= cut.at(chance) <= low + width + 1e-9


def with_paths(table: dict[str, Any]) -> Config:
    return Config.parse({**slope(), "uncertain": table})


def test_values_go_where_their_paths_lead() -> None:
    table = {
        "strata.upper.friction_angle": {"normal": ["30 deg", "2 deg"]},
        "strata.*.cohesion": {"uniform": [0.5, 1.5], "applied_as": "factor"},
        "strata.upper.bottom": {"uniform": ["-1 m", "1 m"], "applied_as": "shift"},
        "surface.2": {"uniform": [9.0, 11.0]},
        "fem.sides": {"list": ["free-field", "fixed"]},
        "dem.radius": {"uniform": ["1 m", "2 m"]},
    }
    drawn = [31.0, 1.1, 0.25, 9.5, "fixed", 1.5]
    read = with_paths(table).with_drawn(dict(zip(table, drawn, strict=True)))
    assert read.section.strata[0].friction_angle == pytest.approx(math.radians(31.0))
    assert [stratum.cohesion for stratum in read.section.strata] == pytest.approx([16.5e3, 16.5e3])
    assert read.section.strata[0].bottom is not None
    assert read.section.strata[0].bottom.depth == 4.25
    assert read.section.surface == ((0.0, 20.0), (100.0, 9.5))
    assert (read.fem.sides, read.dem.radius) == ("fixed", 1.5)
    assert read.uncertain.numbers == {}


def test_a_line_of_points_is_shifted_as_a_whole_or_point_by_point() -> None:
    data = slope()
    data["strata"][0]["bottom"] = {"depth": [[0.0, "4 m"], [100.0, 3.0]]}
    data["uncertain"] = {
        "strata.1.bottom.depth": {"uniform": ["-50 cm", "50 cm"], "applied_as": "shift"},
        "strata.1.bottom.depth.2": {"uniform": [2.0, 6.0]},
    }
    read = Config.parse(data).with_drawn({"strata.1.bottom.depth": 20.0, "strata.1.bottom.depth.2": 5.0})
    assert read.section.strata[0].bottom is not None
    assert read.section.strata[0].bottom.depth == ((0.0, pytest.approx(4.2)), (100.0, 5.0))


def test_all_that_is_wrong_is_told_at_once() -> None:
    with pytest.raises(InputError) as caught:
        with_paths({
            "strata.uper.cohesion": {"normal": ["10 kPa", "1 kPa"]},
            "strata.upper.friction_angle": {"normal": ["30 kPa", "2 kPa"]},
            "strata.upper.bottom": {"uniform": [-1.0, 1.0], "applied_as": "factor"},
            "fem.sidez": {"list": ["free-field"]},
            "surface": {"uniform": [0.0, 1.0]},
        })  # fmt: skip
    text = "\n".join(caught.value.problems)
    for words in (
        '"strata.uper.cohesion": "uper.cohesion" is unknown; expected one of upper, lower, 1, 2',
        "has the wrong dimension",
        'did you mean "sides"',
        'surface": holds more than one number',
    ):
        assert words in text
    with pytest.raises(InputError) as caught:
        with_paths({
            "a": {"normal": [1.0, 0.0]}, "b": {}, "c": {"uniform": [2.0, 1.0]}, "d": {"normal": ["1 m", "2 deg"]},
            "e": {"list": [1, 2], "probabilities": [1.0]}, "f": {"normal": ["1 m", "1 m"], "applied_as": "factor"},
            "correlated": [{"paths": ["a", "z"], "coefficient": 0.5}],
        })  # fmt: skip
    text = "\n".join(caught.value.problems)
    for words in (
        "above 0",
        "expected exactly one of normal",
        "rising",
        "expected a number in m",
        "one of 0 or more",
        "no unit",
    ):
        assert words in text


def test_numbers_that_cannot_go_together() -> None:
    pairs = [("strata.1.cohesion", "strata.2.cohesion"), ("strata.1.cohesion", "strata.1.friction_angle"),
             ("strata.2.cohesion", "strata.1.friction_angle")]  # fmt: skip
    table: dict[str, Any] = {path: {"normal": [1.0, 0.1], "applied_as": "factor"} for pair in pairs for path in pair}
    table["correlated"] = [
        {"paths": list(pair), "coefficient": sign} for pair, sign in zip(pairs, (0.9, 0.9, -0.9), strict=True)
    ]
    with pytest.raises(InputError, match="no numbers can have these correlations together"):
        with_paths(table)


def test_an_input_with_uncertain_numbers_is_written_and_read_again() -> None:
    read = Config.load(SECTIONS / "s13.toml")
    assert len(read.uncertain.numbers) > 20
    assert Config.parse(tomllib.loads(read.to_toml())) == read


@settings(max_examples=20)
@given(count=st.integers(2, 60), dimensions=st.integers(1, 6))
def test_more_samples_of_a_sequence_go_on_from_fewer(count: int, dimensions: int) -> None:
    longer = probabilities(dimensions, 2 * count, "sobol", 3)
    np.testing.assert_array_equal(longer[:count], probabilities(dimensions, count, "sobol", 3))
    assert ((longer > 0.0) & (longer < 1.0)).all()


def test_a_latin_hypercube_has_one_sample_in_every_row_and_column() -> None:
    rows = np.floor(probabilities(3, 50, "latin", 1) * 50).astype(int)
    assert all(sorted(column) == list(range(50)) for column in rows.T)


def test_correlation_is_that_of_the_normal_variables_and_marginals_stay() -> None:
    points = probabilities(2, 4096, "sobol", 0)
    together = correlated(points, np.array([[1.0, -0.6], [-0.6, 1.0]]))
    assert np.corrcoef(stats.norm.ppf(together).T)[0, 1] == pytest.approx(-0.6, abs=0.01)
    assert stats.kstest(together[:, 1], "uniform").statistic < 0.01


def test_samples_have_what_was_drawn_by_path(tmp_path: Path) -> None:
    table = {"strata.1.cohesion": {"normal": ["10 kPa", "1 kPa"]}, "fem.sides": {"list": ["free-field", "fixed"]}}
    file = tmp_path / "s.toml"
    file.write_text(tomli_w.dumps({**slope(), "uncertain": table, "study": {"samples": 8}}))
    read = Config.load(file)
    drawn = samples(read.uncertain, read.study)
    assert len(drawn) == 8
    assert sorted(item["fem.sides"] for item in drawn) == ["fixed"] * 4 + ["free-field"] * 4
    assert drawn == samples(read.uncertain, StudySettings(samples=16))[:8]


def test_paths_lead_into_the_file_although_water_cuts_its_strata() -> None:
    data = slope()
    data["water"] = {"table": {"depth": 2.0}}
    for stratum in data["strata"]:
        del stratum["density_ordinary"], stratum["density_seismic"]
        stratum |= {"density": "1.8 t/m^3", "density_saturated": "2.0 t/m^3"}
    paths = {"strata.upper.cohesion": "2.5 kPa", "strata.upper.bottom.depth": "5 m"}
    data["uncertain"] = {path: {"list": [value]} for path, value in paths.items()}
    wet = Config.parse(data)
    assert (len(data["strata"]), len(wet.section.strata)) == (2, 3)
    drawn = wet.with_drawn(paths)
    assert [stratum.cohesion for stratum in drawn.section.strata] == [2500.0, 2500.0, 15000.0]  # above water and below
    again = Config.parse(tomllib.loads(wet.to_toml()))
    assert again == wet
    assert again.with_drawn(paths) == drawn


@pytest.mark.parametrize(
    ("table", "message"),
    [
        (
            {"strata": {"Sand": {"cohesion": {"normal": ["2 kPa", "1 kPa"]}}}},
            '"strata.Sand.cohesion" = { ... }, such as',
        ),
        ({"Sand": {"cohesion": {"mean": "2 kPa", "deviation": "1 kPa"}}}, '"Sand.cohesion" = { ... }, such as'),
        ({"strata.*.cohesion": {"mean": "2 kPa"}}, "mean: unknown key; expected one of normal, lognormal, uniform"),
        ({"strata.*.cohesion": 3}, 'expected a distribution, such as { normal = ["10 kPa", "2 kPa"] }'),
    ],
)
def test_paths_without_quotation_marks_and_unknown_kinds_are_told(table: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError) as caught:
        Config.parse({**slope(), "uncertain": table})
    assert message in str(caught.value)
