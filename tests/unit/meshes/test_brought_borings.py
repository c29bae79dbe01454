"""Borings as practitioners bring them: titles above the heading, units below it, slips that stand in every number."""

import math
from pathlib import Path

import pytest

from meshes.borings.ags4_file import read_ags4
from meshes.borings.blows import is_refusal, read_blows
from meshes.borings.boring import Boring
from meshes.borings.connect import connected
from meshes.borings.csv_file import read_csv
from meshes.borings.log import Log
from meshes.borings.plausible import implausible_tests
from meshes.errors import InputError
from tests.unit.meshes.test_boring_files import GEOL, LOCA, ags

HEAD = "boring,x,ground_level,top,bottom,layer,N,fines,d50,water_level"
LINES = """B1,0,10,0,3,Fill,8,20,0.2 mm,8
B1,0,10,3,8,Sand,12,5,0.3 mm,8
B2,40,12,0,4,Fill,7,20,0.2 mm,9
B2,40,12,4,9,Sand,14,5,0.3 mm,9
"""


def read(folder: Path, text: str, name: str = "borings.csv") -> tuple[list[Log], list[str]]:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    result = (read_ags4 if name.endswith("ags") else read_csv)(path, {})
    return result.logs, result.notices


def problems(folder: Path, text: str) -> list[str]:
    with pytest.raises(InputError) as caught:
        read(folder, text)
    return list(caught.value.problems)


@pytest.mark.parametrize(
    ("text", "notice"),
    [
        (f"Project: quay;; of 2024\nBy A. Engineer\n\n{HEAD}\n{LINES}", "the heading is read from line 4"),
        (f"{HEAD}\n,m,m,m,m,,,%,mm,m\n{LINES}".replace(" mm", ""), ""),
        ("".join(f"{line},,,\n" for line in f"{HEAD}\n{LINES}".splitlines()) + ",,,,,,,,,,,,\n", ""),
        (f"{HEAD},driller\n" + "".join(f"{line},X\n" for line in LINES.splitlines()), "not used: driller"),
        (f"{HEAD}\n" + "".join(sorted(LINES.splitlines(True), reverse=True)), ""),
        (
            f"{HEAD}\n{LINES}".replace("water_level", "water_depth").replace(",8\n", ",2\n").replace(",9\n", ",3\n"),
            "",
        ),
        (f"{HEAD}\n{LINES}".replace("ground_level", "ground_level (m AHD)").replace("top", "top (mbgl)"), ""),
        (f"{HEAD}\n,m,T.P.+m,GL-m,m bgl,,,%,mm,m+NAP\n{LINES}".replace(" mm", ""), ""),
    ],
)
def test_sheets_as_they_come_say_what_the_plain_one_says(text: str, notice: str, tmp_path: Path) -> None:
    plain, _ = read(tmp_path, f"{HEAD}\n{LINES}")
    logs, notices = read(tmp_path, text)
    assert sorted(logs, key=lambda log: log.name) == plain
    assert notice in " ".join(notices)
    assert bool(notice) == bool(notices)


def test_a_count_is_doubted_beside_a_grain_size_with_its_unit(tmp_path: Path) -> None:
    [problem] = problems(tmp_path, f"{HEAD}\n{LINES.replace('Sand,12', 'Sand,300')}")
    assert problem.startswith("line 3, N = 300: 300 blows is implausible")


def test_shares_of_one_are_no_percent(tmp_path: Path) -> None:
    _, notices = read(tmp_path, f"{HEAD}\n{LINES.replace(',20,', ',0.2,').replace(',5,', ',0.05,')}")
    assert notices == [
        "the fines contents are 0.2 % at most: these may be fractions; expected percent, such as 15 for 15 %"
    ]
    tests = [
        {"depth": depth, "N": 10.0, "fines": fines, "plasticity": 12.0} for depth, fines in ((1.0, 0.15), (2.0, 0.9))
    ]
    boring = Boring.model_validate({"name": "B-1", "x": 0.0, "spt": tests})
    [messages] = implausible_tests([boring])
    assert messages.startswith("triggering, borings: the fines contents are 0.9 % at most")
    washed = boring.model_copy(update={"spt": [test.model_copy(update={"fines": 0.0}) for test in boring.spt]})
    assert implausible_tests([washed]) == []


@pytest.mark.parametrize(
    ("qc", "fs", "message"),
    [
        ("4 MPa", "20 MPa", 'largest fs = "20 MPa": 20000 kPa is implausible (did you mean "20 kPa"?)'),
        ("4 kPa", "20 kPa", 'largest qc = "4 kPa": 0.004 MPa is implausible (did you mean "4 MPa"?)'),
        ("0.4 MPa", "0.5 MPa", "fs: half of the readings are above 125 % of qc; expected a friction ratio below 20 %"),
        ("4 MPa", "20 kPa", ""),
    ],
)
def test_a_sounding_is_doubted_by_its_units(qc: str, fs: str, message: str) -> None:
    boring = Boring.model_validate({"name": "C-1", "x": 0.0, "cpt": [{"depth": 1.0, "qc": qc, "fs": fs}]})
    messages = implausible_tests([boring])
    assert len(messages) == bool(message)
    assert not message or messages[0].startswith(f'triggering, borings 1 "C-1", cpt, {message}')


def test_elevations_are_no_depths(tmp_path: Path) -> None:
    text = f"{HEAD}\nB1,0,10,10,7,Fill,8,20,,8\nB1,0,10,7,-2,Sand,12,5,,8\n"
    [problem] = problems(tmp_path, text)
    assert problem.startswith("line 3, top = 7, bottom = -2: expected depths below the ground, from 0 downwards")


def test_names_that_differ_in_capitals_and_blanks_are_one_stratum(tmp_path: Path) -> None:
    logs, _ = read(tmp_path, f"{HEAD}\n{LINES.replace('B2,40,12,4,9,Sand', 'B2,40,12,4,9,SAND ')}")
    result = connected(logs)
    assert result.names == ("Fill", "Sand")
    assert result.notices == ('"Sand" and "SAND" are read as one stratum, "Sand"',)


def test_water_above_the_ground_of_a_boring_is_told(tmp_path: Path) -> None:
    logs, _ = read(tmp_path, f"{HEAD}\n{LINES}".replace(",8\n", ",13\n"))
    [notice] = connected(logs).notices
    assert notice.startswith("boring B1: the water level, 13 m, is 3 m above its ground")


@pytest.mark.parametrize(
    ("text", "count", "refused"),
    [("50以上", 50.0, True), ("モンケン自沈", 0.0, False), ("R/100mm", 50.0, True), ("refusal for 4 in", 50.0, True)],
)
def test_counts_as_logs_write_them(text: str, count: float, refused: bool) -> None:
    assert (float(read_blows(text)), is_refusal(read_blows(text))) == (count, refused)


def test_the_drive_of_an_ags4_file_is_its_count(tmp_path: Path) -> None:
    """30 blows for 50 mm are a refusal, whatever ISPT_NVAL extrapolates; 18 for 300 mm are N = 18."""
    text = ags(
        LOCA, GEOL, ("ISPT", "LOCA_ID,ISPT_TOP,ISPT_MAIN,ISPT_NPEN,ISPT_NVAL", ",m,,mm,",
                     "B1,1,18,300,; B1,2,30,50,180; B1,3,12,300,12"),
    )  # fmt: skip
    logs, notices = read(tmp_path, text, "drives.ags")
    assert [(sample.depth, float(sample.N)) for sample in logs[0].samples] == [
        (pytest.approx(1.3), 18.0), (pytest.approx(2.3), 50.0), (pytest.approx(3.3), 12.0)
    ]  # fmt: skip
    assert any("a refusal counts as the smallest possible N: B1 at 2.3 m" in notice for notice in notices)


def test_a_reading_that_a_logger_lost_is_no_reading(tmp_path: Path) -> None:
    text = ags(
        LOCA, GEOL, ("SCPT", "LOCA_ID,SCPT_DPTH,SCPT_RES,SCPT_FRES", ",m,MPa,kPa", "B1,1,2,20; B1,2,3,-999; B1,3,4,-2"),
    )  # fmt: skip
    logs, _ = read(tmp_path, text, "cones.ags")
    assert [(cone.depth, float(cone.fs)) for cone in logs[0].cones] == [(1.0, 20e3), (3.0, 0.0)]
    assert not math.isnan(logs[0].ground_level)


@pytest.mark.parametrize(
    ("encoding", "heading"),
    [
        ("utf-8", "Borehole ID,Chainage (m),Ground elevation,Depth from (m),Depth to (m),Soil type,SPT N,FC (%)"),
        ("cp932", "孔番号,距離（m）,孔口標高（m）,上端深度（m）,下端深度（m）,土質名,Ｎ値（回）,細粒分含有率（％）"),
        ("utf-8", "Bohrung;Stationierung;Ansatzhöhe;von;bis;Bodenart;Schlagzahl;Feinkorn"),
        ("cp1252", "Bohrung;x;Geländehöhe [m];von;bis;Schicht;N30;Feinkornanteil [%]"),
        ("utf-16", "sondeo;x;ground level;desde;hasta;estrato;N;fines"),
    ],
)  # fmt: skip
def test_common_headings_are_understood_and_told(encoding: str, heading: str, tmp_path: Path) -> None:
    """Every column had to be named with --columns."""
    separator = ";" if ";" in heading else ","
    lines = ["B-1,0,12,0,4,A,8,12", "B-1,0,12,4,9,B,12,80", "B-2,40,8,0,3,A,7,10"]
    path = tmp_path / "logs.csv"
    path.write_bytes("\n".join([heading, *(line.replace(",", separator) for line in lines)]).encode(encoding))
    result = read_csv(path)
    logs, notices = result.logs, result.notices
    assert [(log.name, log.location[0], log.ground_level) for log in logs] == [("B-1", 0.0, 12.0), ("B-2", 40.0, 8.0)]
    assert [(layer.name, layer.top, layer.bottom) for layer in logs[0].layers] == [("A", 0.0, 4.0), ("B", 4.0, 9.0)]
    assert [(test.depth, test.N, test.fines) for test in logs[0].samples] == [(2.0, 8.0, 12.0), (6.5, 12.0, 80.0)]
    assert any("read by their usual meaning" in text and "as top" in text for text in notices)


def test_a_heading_that_may_be_either_of_two_is_not_guessed(tmp_path: Path) -> None:
    """Two names of the soil, and a level that may be the ground's or the water's."""
    path = tmp_path / "logs.csv"
    path.write_text("borehole,x,Level,from,to,Stratum,Geology\nB-1,0,12,0,4,A,C\n")
    with pytest.raises(InputError) as caught:
        read_csv(path)
    assert "column layer: missing" in caught.value.problems
    assert "column ground_level: missing" in caught.value.problems
    named = read_csv(path, {"layer": "Geology", "ground_level": "Level"})
    assert named.logs[0].layers[0].name == "C"
    assert any(text.endswith("not used: Stratum") for text in named.notices)


def test_comments_below_the_heading_are_no_borings(tmp_path: Path) -> None:
    """Lines that hold a comment alone are passed over, also with the separators of a spreadsheet behind them; a boring
    may be called #1."""
    lines = LINES.replace("B2,", "#1,").splitlines(keepends=True)
    commented = "".join([HEAD, "\n# Kommentar\n", *lines[:2], "# second boring,,,,,,,,,\n", *lines[2:]])
    logs, notices = read(tmp_path, commented)
    assert [log.name for log in logs] == ["B1", "#1"]
    assert logs == read(tmp_path, HEAD + "\n" + "".join(lines))[0]
    assert not notices
