"""Borings beside the ground of a drawing or of a section file."""

import tomllib
from pathlib import Path
from typing import Any

import pytest
import tomli_w

from tests.support import command_line
from tests.support.sections import slope

BORINGS = """boring,x,ground_level,top,bottom,layer,N,fines,unit_weight,water_level
B1,20,18,0,4,Upper,6,10,17 kN/m^3,15
B1,20,18,4,12,lower,20,60,19 kN/m^3,15
B2,80,13.5,0,4,Upper,9,10,17 kN/m^3,10
"""


def made(folder: Path, *names: str, expected: int = 0) -> dict[str, Any]:
    """Return the section of files in a folder, by the command; an empty one if it is refused."""
    out = folder / f"made{len(list(folder.iterdir()))}.toml"
    assert command_line.run("section", *(folder / name for name in names), "-o", out) == expected
    return tomllib.loads(out.read_text(encoding="utf-8")) if out.exists() else {}


def test_borings_give_a_drawing_its_soils_and_its_water(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Layers have the mean of their blow counts in both borings, whatever the case of their names."""
    pytest.importorskip("ezdxf")
    (tmp_path / "slope.toml").write_text(tomli_w.dumps(slope()))
    (tmp_path / "b.csv").write_text(BORINGS)
    assert command_line.run("section", tmp_path / "slope.toml", "-o", tmp_path / "slope.dxf") == 0
    capsys.readouterr()
    section = made(tmp_path, "slope.dxf", "b.csv")
    upper, lower = section["strata"]
    assert (upper["name"], upper["density"], upper["youngs_modulus"]) == ("upper", "17 kN/m^3", "21 MPa")
    assert (lower["name"], lower["cohesion"], lower["friction_angle"]) == ("lower", "125 kPa", "0 deg")
    assert section["water"]["table"] == [[0, 15], [20, 15], [80, 10], [100, 10]]
    assert [[test["N"] for test in boring["spt"]] for boring in section["triggering"]["borings"]] == [[6, 20], [9]]
    text = " ".join(capsys.readouterr().out.split())
    assert "boring B2 begins at 13.5 m" in text
    assert "lies at 12.00 m there" in text
    assert "boring B1" not in text


def test_a_layer_that_no_boring_has_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The keys of its soil are to be given."""
    pytest.importorskip("ezdxf")
    (tmp_path / "slope.toml").write_text(tomli_w.dumps(slope()))
    (tmp_path / "b.csv").write_text(BORINGS.replace("lower", "marl"))
    assert command_line.run("section", tmp_path / "slope.toml", "-o", tmp_path / "slope.dxf") == 0
    section = made(tmp_path, "slope.dxf", "b.csv")
    assert "cohesion" in section["strata"][0]
    assert "cohesion" not in section["strata"][1]
    text = " ".join(capsys.readouterr().out.split())
    assert 'no boring has a layer named as the strata "lower"; the borings have "Upper", "marl"' in text
    assert 'strata 2 "lower": youngs_modulus, poissons_ratio, cohesion, friction_angle, density' in text


def test_borings_are_added_to_a_section_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The section stays as it is; borings of one name twice, off the ground or with a northing are refused."""
    (tmp_path / "slope.toml").write_text(tomli_w.dumps(slope()))
    (tmp_path / "b.csv").write_text(BORINGS)
    section = made(tmp_path, "slope.toml", "b.csv")
    assert [boring["name"] for boring in section.pop("triggering")["borings"]] == ["B1", "B2"]
    assert section == slope()
    (tmp_path / "both.toml").write_text(tomli_w.dumps(section | {"triggering": {"borings": [
        {"name": "B1", "x": 3.0, "spt": [{"depth": 1.0, "N": 5}]}]}}))  # fmt: skip
    (tmp_path / "far.csv").write_text(BORINGS.replace("B2,80", "B2,180"))
    places = BORINGS.replace("x,ground", "easting,northing,ground").replace(",20,18", ",20,0,18")
    (tmp_path / "places.csv").write_text(places.replace(",80,13.5", ",80,0,13.5"))
    line = '[triggering]\nborings = [{ name = "A", x = 3.0, spt = [{ depth = 1.0, N = 5 }] }]\n'
    (tmp_path / "line.toml").write_text(tomli_w.dumps(slope()) + line)
    for ground, borings, message in (
        ("line.toml", "b.csv", "expected a table [[triggering.borings]] for each of its borings"),
        ("both.toml", "b.csv", "boring B1: several borings have this name"),
        ("slope.toml", "far.csv", "boring B2: x = 180 m; expected 0 to 100 m"),
        ("slope.toml", "places.csv", "boring B1: it has easting and northing; expected its x"),
    ):
        assert not made(tmp_path, ground, borings, expected=2)
        assert message in " ".join(capsys.readouterr().err.split())
