"""What commands share: help, version, answers as JSON, sections to start from, a mesh that stays, runs compared."""

import json
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pytest
import tomli_w
from matplotlib.image import imread

from meshes import shipped
from meshes.errors import InputError
from tests.support.command_line import run
from tests.support.sections import SOIL, layer, slope, written
from workflow.cli.options import Panel
from workflow.cli.terminal import distinct_warnings
from workflow.config import Config
from workflow.stages import NAMES


def small(folder: Path, **soil: Any) -> Path:
    """A slope that is computed in a second."""
    quick = {"element": "bilinear", "kh": [], "accuracy": 0.0, "direction": "downhill"}
    data = {**slope(), "mesh": {"size": 3.0}, "fem": quick, "bounds": {"max_cells": 200, "gap": 0.3}}
    data["strata"] = [{**stratum, **soil} for stratum in data["strata"]]
    path = folder / "slope.toml"
    path.write_text(tomli_w.dumps(data))
    return path


def message(capsys: pytest.CaptureFixture[str]) -> Any:
    """What was printed, which is one JSON document."""
    return json.loads(capsys.readouterr().out)


def words(capsys: pytest.CaptureFixture[str]) -> str:
    return " ".join(capsys.readouterr().out.replace("│", " ").split())


def test_the_version_is_that_of_the_package(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("--version") == 0
    assert capsys.readouterr().out == f"noshiro {version('noshiro')}\n"


def test_help_lists_the_stages_and_the_sections_that_come_with_it(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("run", "--help") == 0
    assert words(capsys).count(", ".join(NAMES)) == 2
    assert run("init", "--help") == 0
    assert ", ".join(shipped.names()) in words(capsys)


def test_help_has_the_commands_in_groups(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("--help") == 0
    out = capsys.readouterr().out
    places = [out.index(panel) for panel in Panel]
    assert places == sorted(places)
    assert places[0] < out.index("│ check") < places[1] < out.index("│ run") < places[2] < out.index("│ fem")
    assert places[3] < out.index("│ slide") < places[4] < out.index("│ study") < places[5] < out.index("│ compare")


def test_init_from_a_section_that_comes_with_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in shipped.names():
        assert run("init", tmp_path / f"{name}.toml", "--from", name) == 0
        assert Config.load(tmp_path / f"{name}.toml") == Config.load(shipped.file_of(name))
    assert run("init", tmp_path / "none.toml", "--from", "s14") == 2
    assert f"'s14': expected one of {', '.join(shipped.names())}" in " ".join(capsys.readouterr().err.split())
    assert not (tmp_path / "none.toml").exists()


def test_check_as_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("check", written(tmp_path), "--out", tmp_path / "out", "--json") == 0
    checked = message(capsys)
    config = Config.load(tmp_path / "slope.toml")
    assert [item["name"] for item in checked["strata"]] == [item.name for item in config.section.strata]
    assert checked["strata"][0]["friction_angle"] == pytest.approx(config.section.strata[0].friction_angle)
    assert Path(checked["picture"]).is_file()


def test_plan_and_answers_as_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = small(tmp_path)
    assert run("run", path, "--out", tmp_path / "out", "--dry-run", "--json") == 0
    assert [item["stage"] for item in message(capsys)] == list(NAMES)
    assert run("fem", path, "--out", tmp_path / "out", "--json") == 0
    stages = message(capsys)["stages"]
    assert (
        stages["mesh"]["mesh"]["quadrilaterals"]
        == stages["fem"]["answers"]["fem/critical.json"]["mesh"]["quadrilaterals"]
    )
    assert stages["fem"]["outcome"] == "done"
    assert stages["fem"]["answers"]["fem/critical.json"] == json.loads((tmp_path / "out/fem/critical.json").read_text())


def test_without_an_answer_json_says_why(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = small(tmp_path, cohesion="0.1 kPa", friction_angle="0 deg")
    assert run("fem", path, "--out", tmp_path / "out", "--json") == 3
    fem = message(capsys)["stages"]["fem"]
    assert fem["outcome"] == "no answer"
    assert "weight" in fem["reason"]


def test_a_mesh_stays_until_noshiro_mesh_is_called_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, out = small(tmp_path), tmp_path / "out"
    planned = ("run", path, "--out", out, "--only", "mesh", "--dry-run")
    assert run("mesh", path, "--out", out, "--size", 2, "-q") == 0
    assert run(*planned) == 0
    said = words(capsys)
    assert (
        "The mesh has the options of an earlier command: size = 2.0 (noshiro mesh without options removes them)."
        in said
    )
    assert "be reused" in said
    assert Config.load(out / "section.toml").mesh.size == 2.0
    assert run(*planned, "--set", "mesh.size=4") == 0  # what a command says of the mesh counts
    assert "Meshed as before" not in (said := words(capsys))
    assert "inputs changed: [mesh]" in said
    assert run("mesh", path, "--out", out, "-q") == 0
    assert Config.load(out / "section.toml").mesh.size == 3.0
    assert run(*planned) == 0
    assert "Meshed as before" not in words(capsys)


def test_a_mesh_that_no_longer_fits_is_told_with_where_it_comes_from(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, out = written(tmp_path), tmp_path / "out"
    assert run("mesh", path, "--out", out, "--size", 2, "-q") == 0
    (out / ".noshiro/mesh_options.json").write_text('{"size": -1.0}')
    assert run("fem", path, "--out", out) == 2
    said = " ".join(capsys.readouterr().err.split())
    assert "mesh options stored in" in said
    assert "mesh, size = -1.0" in said


@pytest.mark.slow
def test_a_thousand_strata_make_a_picture_that_can_be_looked_at(tmp_path: Path) -> None:
    strata = [layer(f"{k + 1} sand", bottom={"elevation": 5.0 - 0.02 * (k + 1)}) for k in range(999)]
    data = {**slope(), "surface": [[0.0, 5.0], [100.0, 5.0]], "base": {"elevation": -16.0}}
    path = tmp_path / "many.toml"
    path.write_text(tomli_w.dumps({**data, "strata": [*strata, layer("rock")]}))
    assert run("check", path, "--out", tmp_path / "out", "--json", painted=True) == 0
    height, width, _ = imread(tmp_path / "out/figures/section.png").shape
    assert height < 1.2 * width


@pytest.fixture(scope="module")
def two(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Two runs of the continuum with different sides."""
    folder = tmp_path_factory.mktemp("two")
    path = small(folder)
    outs = []
    for sides in ("free-field", "fixed"):
        outs.append(folder / sides)
        only = [word for name in ("mesh", "fem", "report") for word in ("--only", name)]
        more = (*only, "-q", "--set", f"fem.sides={sides}")
        assert run("run", path, "--out", outs[-1], *more) == 0
    return outs


def test_runs_side_by_side(two: list[Path], capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert run("compare", *two, "--page", tmp_path / "both.html") == 0
    said = words(capsys)
    assert "fem.sides free-field fixed" in said
    assert "input free-field fixed" in said  # the runs by the part of their folders that differs
    assert "discs" not in said  # no run has any: such a row would be empty
    kc = [json.loads((out / "summary.json").read_text())["fem"]["kc"] for out in two]
    assert f"{kc[0]:.3f} (plateau) {kc[1]:.3f} (plateau)" in said
    html = (tmp_path / "both.html").read_text()
    assert html.count("<img") == 2 * len(list((two[0] / "figures").glob("*.png")))
    assert run("compare", *two, "--json") == 0
    assert [run["fem"]["kc"] for run in message(capsys).values()] == kc


def test_what_cannot_be_compared_is_told_at_once(
    two: list[Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("compare", two[0], tmp_path / "a", tmp_path / "b") == 2
    said = capsys.readouterr().err
    assert "2 problems" not in said
    for name in ("a", "b"):
        assert str(tmp_path / name) in said.replace("\n", "")


def test_a_wrong_setting_of_the_command_line_is_no_fault_of_the_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = small(tmp_path)
    assert run("fem", file, "--set", "fem.side=fixed") == 2
    assert capsys.readouterr().err.startswith("settings of the command line: 1 problem")
    file.write_text(file.read_text(encoding="utf-8") + "\nfoo = 1\n", encoding="utf-8")
    assert run("fem", file, "--set", "fem.side=fixed") == 2
    assert f"{file}: 2 problems" in capsys.readouterr().err.replace("\n", "")


@pytest.mark.parametrize(
    ("command", "expected"),
    [
        (("liquefied",), "no stratum liquefies in any case; expected liquefies_in for at least one stratum"),
        (("residual",), "no stratum has a post-peak strength; expected residual_cohesion and residual_friction_angle"),
        (("faces",), "structures: missing; expected one table [[structures]] for each structure"),
        (("fem", "--out", "{file}"), "is a file; expected a folder for the results"),
        (("section", "-o", "{folder}/none/slope.dxf"), "there is no folder {folder}/none"),
        (("migrate", "-o", "{folder}/none/slope.toml"), "there is no folder {folder}/none"),
    ],
)
def test_a_command_that_cannot_answer_says_so_before_it_computes(
    command: tuple[str, ...], expected: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = small(tmp_path)
    name, *options = (word.format(file=file, folder=tmp_path) for word in command)
    assert run(name, file, *options) == 2
    assert expected.format(folder=tmp_path) in " ".join(capsys.readouterr().err.split())
    assert list(tmp_path.iterdir()) == [file]


def test_a_number_beyond_its_limit_and_an_unknown_word_are_told_with_what_is_expected() -> None:
    tables = {"fem": {"accuracy": 3, "sides": "rollers"}, "slide": {"kh": "k_maxx"}, "mesh": {"size": True}}
    config = {**slope(), **tables, "structures": [{"name": "levee", "feet": 3}]}
    with pytest.raises(InputError) as caught:
        Config.parse(config)
    said = "\n".join(caught.value.problems)
    assert "fem, accuracy = 3: expected at most 0.5 (largest remaining discretisation error, such as 0.01" in said
    assert "fem, sides = 'rollers': expected \"free-field\" (free horizontally under the K0 stress" in said
    assert "a section file that does not say" not in said
    assert said.count('; did you mean "k_max"?') == 1
    assert "mesh, size = true: " in said
    assert 'structures 1 "levee", feet: unknown key; expected one of name, from, to, kind' in said
    assert 'structures 1 "levee", from: missing; expected x of the left foot of the structure' in said


def test_bounds_and_slices_warn_of_the_water_without_a_mesh(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Free water that is not level was reported by the commands that make a mesh alone."""
    path = tmp_path / "slope.toml"
    data = {
        "name": "bank", "surface": [[0, 8], [20, 8], [32, 2], [50, 2]], "base": {"elevation": 0},
        "water": {"table": [[0, 4], [50, 3]]}, "strata": [{**SOIL, "name": "Silt", "cohesion": "10 kPa"}],
        "bounds": {"max_cells": 200, "gap": 0.3},
    }  # fmt: skip
    path.write_text(tomli_w.dumps(data))
    for command in ("bounds", "slices"):
        run(command, path, "--out", tmp_path / command)
        lines = capsys.readouterr().out.splitlines()
        assert [line[:28] for line in lines].count("Warning: water: water stands") == 1, command


def test_a_warning_that_another_one_repeats_with_a_remedy_is_printed_once() -> None:
    fact = "the pore pressure exceeds the weight above it, most at x = 62.5 m."
    other = "Warning: Other ground fails."
    remedy = f"Contradiction: {fact.capitalize()} To do: check the water levels."
    assert distinct_warnings([f"Warning: {fact}", other, remedy, other]) == [other, remedy]
