"""Workbooks of xslope are read as sections: lines, materials, water, loads, and a sentence for what is not taken."""

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import openpyxl
import pytest

from meshes.errors import InputError
from meshes.models.xslope_file import read_xslope
from meshes.section.section import Section
from tests.support import command_line

HEADS = ["mat", "name", "g", "option", "c", "f", "c/p", "r-elev", "d", "ψ", "u"]
DAM = [
    [(0.0, 0.0), (40.0, 20.0), (50.0, 20.0), (90.0, 0.0)],
    [(-40.0, 0.0), (130.0, 0.0)],
    [(-40.0, -6.0), (130.0, -6.0)],
]
SOILS: list[list[Any]] = [
    ["Fill", 20, "mc", 5, 32, "", "", "", "", "piezo"],
    ["Clay", 17, "cp", "", "", 1.5, 4, "", "", "none"],
    ["Sand", 19, "mc", 0, 35, "", "", "", "", "piezo"],
]
TABLE = [(-40.0, 12.0), (24.0, 12.0), (90.0, 0.0), (130.0, 0.0)]
Lines = Sequence[Sequence[tuple[float, ...]]]


def workbook(
    path: Path,
    lines: Lines = DAM,
    soils: Sequence[Sequence[Any]] = SOILS,
    loads: Lines = (),
    main: Mapping[str, float] | None = None,
) -> Path:
    """A workbook of metres and kN, laid out as the template of xslope."""
    book = openpyxl.Workbook()
    sheets = {name: book.create_sheet(name) for name in ("main", "profile", "mat", "piezo", "dloads", "reinforce")}
    config = {"Unit weight of water:": 9.81, "Tension crack depth:": 0.0, "Seismic coefficient (k):": 0.0} | dict(
        main or {}
    )
    for row, (words, value) in enumerate(config.items(), start=19):
        sheets["main"].cell(row, 3, words)
        sheets["main"].cell(row, 4, value)
    sheets["profile"].append(["Max Depth:", -10.0])
    for k, line in enumerate(lines):
        _table(sheets["profile"], 4, 1 + 3 * k, f"Profile Line #{k + 1}", ("x", "y"), line)
    for j, head in enumerate(HEADS, start=1):
        sheets["mat"].cell(3, j, head)
    for k, soil in enumerate(soils, start=1):
        for j, value in enumerate([k, *soil], start=1):
            sheets["mat"].cell(3 + k, j, value if value != "" else None)
    _table(sheets["piezo"], 2, 1, "Piezometric Line 1", ("x", "y"), TABLE)
    for k, load in enumerate(loads):
        _table(sheets["dloads"], 3, 2 + 4 * k, f"Distributed Load #{k + 1}a", ("X", "Y", "N"), load)
    book.save(path)
    return path


def _table(
    sheet: Any, row: int, column: int, title: str, heads: Sequence[str], points: Sequence[Sequence[float]]
) -> None:
    sheet.cell(row, column, title)
    for i, values in enumerate([heads, *points], start=1):
        for j, value in enumerate(values):
            sheet.cell(row + i, column + j, value)


def section(path: Path) -> Section:
    return Section.parse(tomllib.loads(read_xslope(path, "read").text))


def test_a_dam_of_a_workbook_is_the_section_that_was_drawn(tmp_path: Path) -> None:
    """The fill has 70 m x 20 m - 2 x 40 x 20 / 2 of the box around it, and the layers below are level."""
    read = section(workbook(tmp_path / "dam.xlsx"))
    assert read.ground.tolist() == [
        [-40.0, 0.0], [0.0, 0.0], [40.0, 20.0], [50.0, 20.0], [90.0, 0.0], [130.0, 0.0],
    ]  # fmt: skip
    whole = {name: 0.0 for name in ("Fill", "Clay", "Sand")}
    for stratum, area in zip(read.strata, read.layering.areas(), strict=True):
        whole[stratum.name.split(",")[0]] += float(area)
    assert whole == pytest.approx({"Fill": 1000.0, "Clay": 170.0 * 6.0, "Sand": 170.0 * 4.0})
    clay = next(stratum for stratum in read.strata if stratum.name == "Clay")
    assert (clay.cohesion_increase, clay.pore_pressure_ratio) == (1500.0, 0.0)
    at = np.array([[100.0, -4.0]])
    assert read.cohesion_field.at(at, at, read.stratum_at(*at.T))[0] == pytest.approx(1500.0 * 8.0)


def test_a_line_inside_another_is_ground_of_its_own_and_a_step_stays_one(tmp_path: Path) -> None:
    core = [(40.0, 0.0), (44.0, 18.0), (46.0, 18.0), (50.0, 0.0)]
    cut = [(-40.0, -3.0), (60.0, -3.0), (60.0, -6.0), (130.0, -6.0)]
    lines = [DAM[0], core, DAM[1], cut]
    soils = [SOILS[0], ["Core", 19, "mc", 20, 25, "", "", "", "", "piezo"], *SOILS[1:]]
    read = section(workbook(tmp_path / "dam.xlsx", lines, soils))
    areas = dict.fromkeys(("Fill", "Core", "Clay", "Sand"), 0.0)
    for stratum, area in zip(read.strata, read.layering.areas(), strict=True):
        areas[stratum.name.split(",")[0]] += float(area)
    assert areas == pytest.approx(
        {"Fill": 1000.0 - 108.0, "Core": 108.0, "Clay": 100.0 * 3.0 + 70.0 * 6.0, "Sand": 100.0 * 7.0 + 70.0 * 4.0}
    )


def test_loads_of_free_water_are_the_water_and_others_are_surcharges(tmp_path: Path) -> None:
    pond = [(-40.0, 0.0, 9.81 * 12.0), (0.0, 0.0, 9.81 * 12.0), (24.0, 12.0, 0.0)]
    road = [(41.0, 20.0, 10.0), (49.0, 20.0, 20.0)]
    imported_section = read_xslope(workbook(tmp_path / "dam.xlsx", loads=[pond, road]), "read")
    assert any("loads of free water are not read" in text for text in imported_section.notices)
    assert imported_section.text.count("[[surcharges]]") == 1
    assert 'pressure = [\n    "10 kPa",\n    "20 kPa",\n]' in imported_section.text


def test_what_is_not_taken_is_told(tmp_path: Path) -> None:
    soils = [*SOILS[:2], ["Sand", 19, "mc", 0, 35, "", "", 10, 20, "seep"]]
    main = {"Tension crack depth:": 2.0, "Seismic coefficient (k):": 0.15}
    text = " ".join(read_xslope(workbook(tmp_path / "dam.xlsx", soils=soils, main=main), "read").notices)
    assert "a tension crack 2 deep; see [tension_crack]" in text
    assert "a seismic coefficient of 0.15; fem.safety_factor_at = [0.15]" in text
    assert 'the seepage solution of "Sand"' in text
    assert 'the undrained strength of "Sand" after drawdown' in text


def test_feet_and_pounds(tmp_path: Path) -> None:
    soils = [[name, 6.2 * weight, *rest] for name, weight, *rest in SOILS]
    read = section(workbook(tmp_path / "dam.xlsx", soils=soils, main={"Unit weight of water:": 62.4}))
    assert float(read.ground[-1, 0]) == pytest.approx(130.0 * 0.3048)
    assert read.strata[0].cohesion == pytest.approx(5.0 * 47.88026, rel=1e-3)


def test_bad_workbooks(tmp_path: Path) -> None:
    """A sentence with the file, what is wrong with it and what is expected; exit code 2."""
    wrong = [["Fill", 20, "power", 5, 32], *SOILS[1:]]
    for path, item in (
        (
            workbook(tmp_path / "a.xlsx", soils=wrong),
            'material "Fill" has the strength option "power"; expected one of mc, cp',
        ),
        (
            workbook(tmp_path / "b.xlsx", soils=SOILS[:2]),
            "3 profile lines and 2 materials; expected a material for each line",
        ),
        (workbook(tmp_path / "c.xlsx", lines=[]), "0 profile lines"),
    ):
        with pytest.raises(InputError, match=item):
            read_xslope(path, "read")
    (tmp_path / "d.xlsx").write_text("no zip")
    with pytest.raises(InputError, match="expected a workbook of xslope"):
        read_xslope(tmp_path / "d.xlsx", "read")
    with pytest.raises(InputError, match="--part"):
        read_xslope(workbook(tmp_path / "e.xlsx"), "read", "Shaken")


def test_the_command_makes_a_section(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "dam.toml"
    assert command_line.run("section", workbook(tmp_path / "dam.xlsx"), "-o", out) == 0
    assert "It is sound." in capsys.readouterr().out
