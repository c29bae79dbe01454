"""Settings by their dotted names."""

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
import tomli_w

from meshes.errors import InputError
from meshes.section.recorded_kh import in_name
from meshes.settings import MeshSettings
from tests.support import SECTIONS
from tests.support.sections import slope
from workflow.cli.invocation import Invocation, dotted
from workflow.cli.section import example
from workflow.config import Config, merged


@pytest.mark.parametrize(
    ("text", "tables"),
    [
        ("fem.sides=fixed", {"fem": {"sides": "fixed"}}),
        ('fem.sides="fixed"', {"fem": {"sides": "fixed"}}),
        ("fem.kh=[0.1, 0.2]", {"fem": {"kh": [0.1, 0.2]}}),
        ("mesh.refine=2", {"mesh": {"refine": 2}}),
        ("mesh.size=1.5 m", {"mesh": {"size": "1.5 m"}}),
        ("figures.report_animations=false", {"figures": {"report_animations": False}}),
        ('mesh.sizes."Loose sand"=0.8', {"mesh": {"sizes": {"Loose sand": 0.8}}}),
        ("fem.first_step=.05", {"fem": {"first_step": ".05"}}),
        ("sliding_block.accelerogram=a=b.csv", {"sliding_block": {"accelerogram": "a=b.csv"}}),
    ],
)
def test_values_are_toml_or_text(text: str, tables: dict[str, object]) -> None:
    assert dotted([text]) == tables


def test_a_setting_that_is_true_or_false_says_both() -> None:
    with pytest.raises(InputError, match="own_dilation = 'auto': expected true or false; true to compute"):
        Config.parse(slope() | {"fem": {"own_dilation": "auto"}})


def test_several_settings_of_one_table() -> None:
    assert dotted(["fem.sides=fixed", "mesh.sizes.a=1", "mesh.sizes.b=2", "fem.vertical=0.1"]) == {
        "fem": {"sides": "fixed", "vertical": 0.1},
        "mesh": {"sizes": {"a": 1, "b": 2}},
    }


@pytest.mark.parametrize(
    "text", ["fem.sides", "sides=fixed", "name=other", "=x", "fem=fixed", "fem.=2", "a\nb.c=1", ""]
)
def test_what_is_no_setting(text: str) -> None:
    with pytest.raises(InputError) as caught:
        dotted([text])
    assert caught.value.source == "--set"
    assert "expected" in caught.value.problems[0]


def test_the_command_line_stands_above_the_file(tmp_path: Path) -> None:
    path = tmp_path / "slope.toml"
    path.write_text(tomli_w.dumps({**slope(), "fem": {"sides": "fixed", "vertical": 0.1}, "mesh": {"columns": 30}}))
    run = Config.load(path, dotted(["fem.sides=periodic", "mesh.size=2 m"]))
    assert (run.fem.sides, run.fem.vertical) == ("periodic", 0.1)
    assert run.mesh.columns is None  # a size takes its place
    with pytest.raises(InputError, match='fem, sidez: unknown key; did you mean "sides"'):
        Config.load(path, dotted(["fem.sidez=tied"]))
    with pytest.raises(InputError, match="figures, report_width = 10"):
        Config.load(path, dotted(["figures.report_width=10"]))


@pytest.mark.parametrize("name", ["published/acads_2a.toml", "slides/wildlife_1987_w18.toml"])
def test_a_file_of_the_collections_can_be_run_as_it_is(name: str) -> None:
    """What others found on a slope is for `noshiro verify`; a run passes it over."""
    path = Path(__file__).parents[2] / "verification" / name
    written = tomllib.loads(path.read_text())
    assert {"published", "known"} & written.keys()
    assert Config.load(path).section.name == written["name"]


def test_borings_outside_their_table_are_told_where_they_stand() -> None:
    with pytest.raises(InputError, match=r"borings: unknown key; expected triggering, where \[\[triggering.borings"):
        Config.parse({**slope(), "borings": [{"x": 45.0}]})
    with pytest.raises(InputError, match='earthquakes: unknown key; did you mean "earthquake"'):
        Config.parse({**slope(), "earthquakes": [{"magnitude": 7.5}]})


def test_a_ratio_of_residual_strength_is_not_taken_for_a_stress() -> None:
    """0.1 as residual_strength would be 0.1 Pa."""
    with pytest.raises(InputError, match="residual_strength_ratio: unknown key; expected residual, the residual"):
        Config.parse({**slope(), "slide": {"cases": [{"residual_strength_ratio": 0.1}]}})


def test_merging_leaves_its_parts_alone() -> None:
    lower, upper = {"a": {"x": 1, "y": 2}, "b": 1}, {"a": {"y": 3}}
    assert merged(lower, upper) == {"a": {"x": 1, "y": 3}, "b": 1}
    assert lower == {"a": {"x": 1, "y": 2}, "b": 1}


def test_the_fingerprint_of_the_section_knows_neither_settings_nor_title() -> None:
    plain, other = Config.parse(slope()), Config.parse({**slope(), "fem": {"sides": "fixed"}, "title": "another"})
    assert plain.section.sha256() == other.section.sha256()
    assert plain.section.sha256() != Config.parse({**slope(), "beyond": "10 m"}).section.sha256()


def test_a_record_is_looked_for_beside_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a/slope.toml"
    path.parent.mkdir()
    path.write_text(tomli_w.dumps({**slope(), "sliding_block": {"accelerogram": "quake.csv"}}))
    with pytest.raises(InputError, match=r"sliding_block, accelerogram = .*quake\.csv: there is no such file"):
        Config.load(path)
    for folder in (tmp_path, tmp_path / "a"):
        (folder / "quake.csv").touch()
    assert Config.load(path).sliding_block.accelerogram == str(tmp_path / "a/quake.csv")
    monkeypatch.chdir(tmp_path)
    run = Config.load(path, dotted(["sliding_block.accelerogram=quake.csv"]))
    assert run.sliding_block.accelerogram == str(tmp_path / "quake.csv")


def test_the_commented_settings_of_the_example_exist() -> None:
    """Without their comment marks they are a valid input, and but for the examples among them the defaults."""
    text = example()
    section, settings = text[: text.index("[mesh]")], text[text.index("[mesh]") :]
    other = "(?!kh_seconds)"  # which would take the place of kh_cycles
    settings = re.sub(rf"(?m)^# {other}(\w+ = |\[\[)", r"\1", settings)
    run = Config.parse(tomllib.loads(section + settings))
    plain = Config.parse(tomllib.loads(text))
    assert run.mesh.size == 2.0
    assert run.fem.safety_factor_at == (0.0, 0.1)
    assert run.fem.kh == (0.2, 0.25)
    assert run.fem.model_copy(update={"safety_factor_at": (0.0,), "kh": ()}) == plain.fem
    assert run.dem == plain.dem.model_copy(update={"elements": 2500})  # which follows from the layers by default
    assert run.variants == plain.variants
    assert run.figures == plain.figures


@pytest.mark.parametrize("table", ["fem", "dem"])
@pytest.mark.parametrize(
    ("kh", "message"),
    [
        ([0.2, 0.2], "kh: [0.2, 0.2]: expected every seismic coefficient once"),
        ([0.2, 0.3, 0.2004], "two that are equal to 3 decimals would have the same picture"),
        ([-0.1], "kh 1 = -0.1: expected at least 0"),
        ([15.0], "kh 1 = 15.0: expected at most 5"),
    ],
)
def test_a_kh_that_is_kept_twice_or_points_uphill_is_refused(table: str, kh: list[float], message: str) -> None:
    with pytest.raises(InputError) as caught:
        Config.parse({**slope(), table: {"kh": kh}})
    assert f"{table}, kh" in str(caught.value)
    assert message in str(caught.value)
    assert Config.parse({**slope(), table: {"kh": [0.2, 0.3, 0.255]}})


@pytest.mark.parametrize(
    ("case", "message"),
    [
        ({"residual_strength": "-3 kPa"}, ["residual_strength = '-3 kPa': out of range; expected a stress of"]),
        ({"residual_strength": 12}, ['= 12: 0.012 kPa is no residual strength of soil (did you mean "12 kPa"?)']),
        ({"residual_strength": "12000 kPa"}, ['(did you mean "12000 Pa"?)']),
        ({"residual_strength": "12 MPa"}, ['did you mean "12 kPa"?); expected 0, or 0.05 to 1000 kPa']),
        ({"residual": 12}, ["residual = 12: expected at most 1"]),
        (
            {"residual_strength": {"upper": 12, "lower": "-3 kPa"}},
            ["residual_strength, upper = 12: 0.012 kPa", "residual_strength, lower = '-3 kPa': out of range"],
        ),
        ({"residual": "much"}, ["residual = 'much': expected a number (residual strength over"]),
    ],
)  # fmt: skip
def test_a_key_of_several_kinds_has_one_sentence_for_what_was_meant(case: dict[str, Any], message: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        Config.parse({**slope(), "slide": {"cases": [case]}})
    problems = caught.value.problems
    assert len(problems) == len(message)
    for problem, part in zip(problems, message, strict=True):
        assert problem.startswith("slide, cases 1, residual")
        assert part in problem
        assert "[" not in problem.split(";")[0]


def test_every_kh_that_is_kept_has_a_name_of_its_own() -> None:
    assert [in_name(kh) for kh in (0.0, 0.2, 0.25, 0.255, 0.3, 5.0)] == [
        "0.00",
        "0.20",
        "0.25",
        "0.255",
        "0.30",
        "5.00",
    ]


def test_a_case_that_there_is_not_is_refused_before_anything_is_computed(tmp_path: Path) -> None:
    invocation = Invocation.of(SECTIONS / "s13.toml", tmp_path / "run", {}, None)
    invocation.refuse_unknown((1, 3))
    with pytest.raises(InputError, match="9: expected cases in which a stratum liquefies, of 1, 2, 3"):
        invocation.refuse_unknown((2, 9))


def test_cases_are_called_by_number_and_name() -> None:
    data = {**slope(), "slide": {"cases": [{"stiffness": 0.1}, {"stiffness": 0.1, "name": "low strength"}]}}
    config = Config.parse(data)
    assert [config.called(number) for number in (1, 2)] == ["case 1", "case 2, low strength"]


def test_tied_sides_that_differ_are_told_before_anything_runs(tmp_path: Path) -> None:
    path = tmp_path / "slope.toml"
    path.write_text(tomli_w.dumps(slope()))
    with pytest.raises(InputError, match='sides = "periodic": the left and right sides differ'):
        Invocation.of(path, tmp_path, {}, ["fem.sides=periodic"])


def test_factors_of_safety_read_whether_bounds_are_wanted(tmp_path: Path) -> None:
    path = tmp_path / "slope.toml"
    path.write_text(tomli_w.dumps(slope()))
    invocation = Invocation.of(path, tmp_path, {}, ["bounds.run=false", "bounds.gap=0.1"])
    assert invocation.unread(["mesh", "fem"]) == ["bounds.run", "bounds.gap"]
    assert invocation.with_safety_factors().unread(["mesh", "fem"]) == ["bounds.gap"]


def test_a_first_mesh_has_no_more_cells_than_finer_ones_may_have() -> None:
    few = {**slope(), "fem": {"max_cells": 400}}
    assert Config.parse(few).mesh.max_cells == 400
    assert Config.parse({**few, "mesh": {"max_cells": 900}}).mesh.max_cells == 900
    assert Config.parse({**few, "fem": {"max_cells": 50_000}}).mesh.max_cells == MeshSettings().max_cells


@pytest.mark.parametrize(
    ("surface", "sides"),
    [
        ([[0, 10], [30, 10], [50, 0], [90, 0]], "smooth"),
        ([[0, 0.4], [30, 0], [50, 10], [90, 10]], "smooth"),
        ([[0, 10], [30, 10], [50, 2], [90, 0]], "free-field"),
        ([[0, 10], [30, 10], [50, 0], [52, 0]], "free-field"),
    ],
    ids=["level", "falls 1 in 75", "slopes 1 in 20 at one end", "ends at the toe"],
)
def test_sides_hold_level_ground_where_nothing_is_said(surface: list[list[float]], sides: str) -> None:
    data = {**slope(), "surface": surface, "base": {"elevation": -10}}
    assert Config.parse(data).fem.sides == Config.parse(Config.parse(data).to_data()).fem.sides == sides
    assert Config.parse({**data, "fem": {"sides": "fixed"}}).fem.sides == "fixed"
