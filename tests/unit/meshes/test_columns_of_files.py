"""Columns that are named for several files of borings at once."""

import tomllib
from pathlib import Path

import pytest

from tests.support import command_line
from workflow.section_import.columns_of_files import columns_of_files

FOOT = 0.3048


def written(folder: Path, text: str, name: str) -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def test_named_columns_hold_for_the_files_that_have_them(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Cones beside borings had no column of the borings, and were refused, as were a .gef file and borings in AGS."""
    borings = "Boring,Station (ft),Ground El. (ft),Top (ft),Bottom (ft),Material,N\n"
    borings += "B1,0,25,0,20,Sand,7\nB1,0,25,20,45,Clay,16\nB2,80,22,0,18,Sand,5\nB2,80,22,18,45,Clay,14\n"
    cones = "boring,x (ft),Ground El. (ft),depth (ft),qc (tsf),fs (tsf)\nC1,40,23.5,9,30,0.25\nC1,40,23.5,12,35,0.22\n"
    files = [written(tmp_path, text, name) for text, name in ((borings, "b.csv"), (cones, "c.csv"))]
    options = ["--columns", "x=Station,ground_level=Ground El."]
    assert command_line.run("section", *files, "-o", tmp_path / "made.toml", *options) == 0
    data = tomllib.loads((tmp_path / "made.toml").read_text(encoding="utf-8"))
    cone = next(boring for boring in data["triggering"]["borings"] if boring["name"] == "C1")
    assert cone["x"] == pytest.approx(40 * FOOT, abs=1e-3)
    assert cone["cpt"][0]["qc"] == f"{30 * 2000 * 4.4482216 / FOOT**2 / 1e6:.5f} MPa"
    assert command_line.run("section", *files, "-o", tmp_path / "2.toml", "--columns", "d50=Grain") == 2
    assert "d50=Grain: none of the files has a column 'Grain' for d50" in capsys.readouterr().err


def test_the_column_of_layers_in_ags_is_none_of_the_cones_beside_it(tmp_path: Path) -> None:
    text = '"GROUP","GEOL"\n"HEADING","LOCA_ID","GEOL_TOP","GEOL_BASE","GEOL_GEOL","GEOL_LEG"\n'
    site = written(tmp_path, text, "site.ags")
    cones = written(tmp_path, "boring,x,depth,qc (MPa),fs (kPa)\nC1,40,3,2,20\nC1,40,4,3,22\n", "c.csv")
    divided = columns_of_files([site, cones], {"layer": "GEOL_LEG"})
    assert divided == [{"layer": "GEOL_LEG"}, {}]
