"""Borings as others write them: units, refusals, encodings, separators, names of columns; numbers that cannot be."""

import math
import tomllib
from pathlib import Path

import pytest

from meshes.borings.ags4_file import read_ags4
from meshes.borings.blows import is_refusal
from meshes.borings.complaints import folded
from meshes.borings.connect import connected
from meshes.borings.csv_file import read_csv
from meshes.borings.section_text import text_of
from meshes.errors import InputError
from tests.support import command_line
from tests.support.sections import analysed, slope

FOOT = 0.3048
BEYOND = ' is implausible (did you mean "'


def ags(*groups: tuple[str, str, str, str]) -> str:
    """An AGS4 file of groups: name, headings, units, and lines of data."""
    return "\n".join(_group(*group) for group in groups)


def _group(name: str, heads: str, units: str, lines: str) -> str:
    def row(kind: str, text: str) -> str:
        return ",".join(f'"{cell}"' for cell in [kind, *text.split(",")])

    rows = [
        row("GROUP", name),
        row("HEADING", heads),
        row("UNIT", units),
        row("TYPE", ",".join("X" for _ in heads.split(","))),
    ]
    return "\n".join(rows + [row("DATA", line) for line in lines.split("; ")]) + "\n"


LOCA = ("LOCA", "LOCA_ID,LOCA_NATE,LOCA_NATN,LOCA_GL", ",m,m,m", "B1,100,200,12; B2,140,200,8")
GEOL = (
    "GEOL",
    "LOCA_ID,GEOL_TOP,GEOL_BASE,GEOL_GEOL,GEOL_LEG",
    ",m,m,,",
    "B1,0,4,FILL,1; B1,4,10,SAND,2; B2,0,7,SAND,2",
)


def written(folder: Path, text: str | bytes, name: str) -> Path:
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def message(folder: Path, text: str | bytes, name: str) -> list[str]:
    with pytest.raises(InputError) as caught:
        (read_ags4 if name.endswith("ags") else read_csv)(written(folder, text, name))
    return list(caught.value.problems)


def test_every_heading_of_an_ags4_file_has_its_unit(tmp_path: Path) -> None:
    feet = ags(
        ("LOCA", LOCA[1], ",ft,km,ft", "B1,100,0.2,40; B2,140,0.2,30"),
        ("GEOL", GEOL[1], ",ft,cm,,", "B1,0,122,FILL,; B1,4.0026,300,SAND,; B2,0,210,SAND,"),
        ("ISPT", "LOCA_ID,ISPT_TOP,ISPT_NVAL", ",ft,", "B1,10,7"),
        ("WSTG", "LOCA_ID,WSTG_DPTH", ",ft", "B1,6"),
    )
    item, two = read_ags4(written(tmp_path, feet, "feet.ags")).logs
    assert item.location == (pytest.approx(100 * FOOT), 200.0)
    assert (item.ground_level, two.ground_level) == (pytest.approx(40 * FOOT), pytest.approx(30 * FOOT))
    assert item.layers[0].bottom == pytest.approx(1.22)
    assert item.samples[0].depth == pytest.approx(10 * FOOT + 0.3)
    assert item.water_level == pytest.approx(34 * FOOT)
    [bad] = message(tmp_path, feet.replace('"cm"', '"kg"'), "bad.ags")
    assert "unit 'kg' of GEOL_BASE: has the wrong dimension" in bad


def test_counts_energy_and_water_of_an_ags4_file(tmp_path: Path) -> None:
    text = ags(
        LOCA,
        GEOL,
        (
            "ISPT",
            "LOCA_ID,ISPT_TOP,ISPT_NVAL,ISPT_REP,ISPT_ERAT",
            ",m,,,%",
            "B1,3,12,12,45; B1,4.5,9,9,45; B1,4.5,14,14,45; B1,6,,N=50 (25 for 5mm/50 for 15mm),60; B1,7,50,50/75mm,; "
            "B1,8,,,",
        ),
        ("WSTG", "LOCA_ID,WSTG_DPTH", ",m", "B1,3; B1,6"),
        ("WSTD", "LOCA_ID,WSTG_DPTH,WSTD_POST", ",m,m", "B1,3,2.5"),
    )
    read = read_ags4(written(tmp_path, text, "b.ags"))
    item, two = read.logs
    assert [(s.depth, s.N, s.energy_ratio) for s in item.samples] == [
        (pytest.approx(3.3), 12, 45),
        (pytest.approx(4.8), 9, 45),
        (6.3, 50, 60),
        (7.3, 50, None),
    ]
    assert (item.water_level, two.water_level) == (9.5, None)
    notices = "\n".join(read.notices)
    assert "B1, SPT at 4.5 m: N = 9 and 14; the smaller value is used" in notices
    assert "B1, SPT at 8 m: has neither ISPT_NVAL nor ISPT_REP, and is not used" in notices
    assert '6.3 m "N=50 (25 for 5mm/50 for 15mm)", N = 50; B1 at 7.3 m "50/75mm", N = 50' in notices
    assert "departs from rules of AGS4, as python-ags4 counts" in notices
    made = analysed({**tomllib.loads(text_of(connected(read.logs), "made")), **COMPLETED})
    assert [s.energy_ratio for s in made.triggering.borings[0].spt] == [45, 45, 60, None]


COMPLETED = {
    "strata": [
        {
            "name": name,
            "bottom": {"elevation": z},
            "density": "18 kN/m^3",
            "youngs_modulus": "9 MPa",
            "poissons_ratio": 0.3,
            "cohesion": "5 kPa",
            "friction_angle": "30 deg",
        }
        for name, z in (("FILL", [[0, 8], [40, 8]]), ("SAND", [[0, 1], [40, 1]]))
    ]
}


def test_local_coordinates_and_the_column_that_names_layers(tmp_path: Path) -> None:
    loca = (
        "LOCA",
        "LOCA_ID,LOCA_NATE,LOCA_NATN,LOCA_GL,LOCA_LOCX,LOCA_LOCY,LOCA_LOCZ",
        ",m,m,m,m,m,m",
        "B1,,,,5,6,12; B2,,,,5,46,8",
    )
    path = written(tmp_path, ags(loca, GEOL), "local.ags")
    read = read_ags4(path, {"layer": "GEOL_LEG"})
    assert [(log.location, log.ground_level) for log in read.logs] == [((5.0, 6.0), 12.0), ((5.0, 46.0), 8.0)]
    assert [[layer.name for layer in log.layers] for log in read.logs] == [["1", "2"], ["2"]]
    assert any("LOCA_LOCX and LOCA_LOCY are taken" in text for text in read.notices)
    with pytest.raises(InputError, match="--layers GEOL_X: group GEOL has no such column; expected one of GEOL_TOP"):
        read_ags4(path, {"layer": "GEOL_X"})


def test_borings_without_national_coordinates_take_those_of_all(tmp_path: Path) -> None:
    heads = "LOCA_ID,LOCA_NATE,LOCA_NATN,LOCA_GL,LOCA_LOCX,LOCA_LOCY"
    loca = ("LOCA", heads, ",m,m,m,m,m", "B1,100,200,12,5,6; B2,,,8,5,46")
    read = read_ags4(written(tmp_path, ags(loca, GEOL), "some.ags"))
    assert [log.location for log in read.logs] == [(5.0, 6.0), (5.0, 46.0)]
    assert any("not all borings have national coordinates" in text for text in read.notices)
    loca = ("LOCA", "LOCA_ID,LOCA_NATE,LOCA_NATN,LOCA_GL", ",m,m,m", "B1,100,200,12; B2,,200,8")
    assert message(tmp_path, ags(loca, GEOL), "none.ags")[0].startswith(
        "boring B2, LOCA_NATE is missing; expected a coord"
    )


def test_dry_borings_and_depths_below_their_end(tmp_path: Path) -> None:
    water = ("WSTG", "LOCA_ID,WSTG_DPTH", ",m", "B1,3; B2,dry")
    read = read_ags4(written(tmp_path, ags(LOCA, GEOL, water), "dry.ags"))
    assert [log.water_level for log in read.logs] == [9.0, None]
    assert 'boring B2: water "dry" means that no water was struck' in read.notices
    spt = ("ISPT", "LOCA_ID,ISPT_TOP,ISPT_NVAL", ",m,", "B1,30,12; B1,x,12")
    assert message(tmp_path, ags(LOCA, GEOL, (*spt[:3], "B1,30,12")), "deep.ags") == [
        "boring B1: N = 12 at a depth of 30.3 m; the boring ends at 10 m"
    ]
    assert [text.partition(" = ")[0] for text in message(tmp_path, ags(LOCA, GEOL, spt), "x.ags")] == [
        "boring B1, ISPT_TOP"
    ]
    heads = "boring,x,ground_level,top,bottom,layer,water_level\n"
    assert message(tmp_path, f"{heads}A,0,12,0,4,Sand,-30\n", "deep.csv") == [
        "boring A: water at a depth of 42 m; the boring ends at 4 m"
    ]


def test_lines_of_a_boring_that_contradict_each_other(tmp_path: Path) -> None:
    heads = "boring,x,ground_level,top,bottom,layer\n"
    assert message(tmp_path, f"{heads}A,0,1.200,0,4,Sand\nA,1,12,4,6,Clay\n", "b.csv") == [
        "line 3, x = '1': line 2 gives '0' for the same boring A",
        "line 3, ground_level = '12': line 2 gives '1.200' for the same boring A",
    ]
    read_csv(written(tmp_path, f"{heads}A,0,12,0,4,Sand\nA,0.0,,4,6,Clay\n", "same.csv"))


@pytest.mark.parametrize(
    ("encoding", "name"),
    [
        ("utf-8", "REMBLAI À BLOCS β"),
        ("utf-16", "REMBLAI À BLOCS β"),
        ("cp1252", "REMBLAI À BLOCS"),
        ("cp1252", "Ton, weich – ü"),
        ("cp932", "砂質シルト"),
        ("cp932", "粘土"),
        ("cp932", "礫"),
        ("cp932", "ｼﾙﾄ質砂"),
        ("cp1252", "Lehm weiß größer"),
        ("cp1252", "d’eau argileux"),
        ("cp1252", "SÃO JOÃO areia"),
        ("utf-16-le", "砂質シルト"),
        ("utf-16-be", "SABLE"),
    ],
)
def test_names_in_any_encoding(encoding: str, name: str, tmp_path: Path) -> None:
    text = ags(LOCA, (*GEOL[:3], GEOL[3].replace("FILL", "fill"))).replace("fill", name)
    read = read_ags4(written(tmp_path, text.encode(encoding), "names.ags"))
    assert read.logs[0].layers[0].name == name
    assert any(f"read as {encoding}" in notice for notice in read.notices) == encoding.startswith("cp")
    table = f'boring,x,ground_level,top,bottom,layer\nA,0,5,0,2,"{name}"\n'
    assert read_csv(written(tmp_path, table.encode(encoding), "b.csv")).logs[0].layers[0].name == name


def test_decimal_commas_between_commas_shift_no_cells(tmp_path: Path) -> None:
    table = "boring,x,ground_level,top,bottom,layer\nA,0,5,0,2,5,Sand\n"
    assert "line 2: has 7 cells where the heading has 6" in message(tmp_path, table, "b.csv")[0]


def test_a_row_that_is_short_has_the_number_of_its_line(tmp_path: Path) -> None:
    [text] = message(tmp_path, "\n\n" + ags(LOCA, GEOL) + '"DATA","B1","1"\n', "short.ags")
    assert "Line 17 does not have the same number of entries as the HEADING row in GEOL" in text


def test_the_borings_of_a_section_are_chosen(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """One far from the line is told with how to leave it out; the section has a name that a folder can have."""
    loca = (*LOCA[:3], LOCA[3] + "; B3,120,290,9")
    path = written(tmp_path, ags(loca, (*GEOL[:3], GEOL[3] + "; B3,0,7,SAND,2")), "site plan.ags")
    made = tmp_path / "site plan (1).toml"
    assert command_line.run("section", path, "-o", made) == 2
    assert "off the line of the section; --borings selects the borings of the section" in capsys.readouterr().err
    assert command_line.run("section", path, "-o", made, "--borings", "B1,B9") == 2
    assert "there is no boring B9 that can be used; there are B1, B2, B3" in capsys.readouterr().err
    assert command_line.run("section", path, "-o", made, "--borings", "B1,B2") == 0
    assert tomllib.loads(made.read_text(encoding="utf-8"))["name"] == "site_plan_1"


def test_a_blow_count_that_is_not_understood_is_left_out(tmp_path: Path) -> None:
    """One of four is told with file, line and value; where most of them are, the file is refused."""
    head = "boring,x,ground_level,top,bottom,layer,N\n"
    lines = [f"{name},{x},5,{k},{k + 1},sand,{N}\n" for name, x, k, N in
             (("A", 0, 0, 4), ("A", 0, 1, "x7"), ("B", 20, 0, 5), ("B", 20, 1, 9))]  # fmt: skip
    read = read_csv(written(tmp_path, head + "".join(lines), "b.csv"))
    assert [[sample.N for sample in log.samples] for log in read.logs] == [[4.0], [5.0, 9.0]]
    assert [log.layers[-1].bottom for log in read.logs] == [2.0, 2.0]
    [text] = read.notices
    assert text.startswith("b.csv, line 3, N = 'x7': expected the blow count for 30 cm as measured")
    assert text.endswith("; this blow count is left out")
    most = head + "".join(lines).replace(",4\n", ",?\n").replace(",5\n", ",?\n")
    assert "3 of 4 blow counts cannot be read" in message(tmp_path, most, "most.csv")[0]
    spt = ("ISPT", "LOCA_ID,ISPT_TOP,ISPT_NVAL", ",m,", "B1,3,12; B1,4.5,twelve; B2,3,7")
    path = written(tmp_path, "\n\n" + ags(LOCA, GEOL, spt), "b.ags")
    where = next(k for k, line in enumerate(path.read_text().splitlines(), start=1) if "twelve" in line)
    read = read_ags4(path)
    assert [[sample.N for sample in log.samples] for log in read.logs] == [[12.0], [7.0]]
    start = f"b.ags, line {where}, boring B1, SPT at 4.5 m, N = 'twelve'"
    assert any(text.startswith(start) and text.endswith("left out") for text in read.notices)


def test_complaints_of_one_kind_are_told_once(tmp_path: Path) -> None:
    lines = "".join(f"A,0,5,{k},{k + 1},sand,n{k}\n" for k in range(33))
    [text] = message(tmp_path, "boring,x,ground_level,top,bottom,layer,N\n" + lines, "b.csv")
    assert text.startswith("line 2, N = 'n0': expected the blow count for 30 cm")
    assert text.endswith("(and 32 more alike: line 3, N; line 4, N; ...)")
    [text] = message(tmp_path, "boring,x,ground_level (kg),top,bottom,layer,N\nA,0,5,0,1,s,1\nA,0,5,1,2,s,1\n", "b.csv")
    assert text.startswith("column ground_level (kg): has the wrong dimension")
    rows = "; ".join(f"B1,{k / 50:.2f},x{k},1" for k in range(1, 3000))
    cones = ("SCPT", "LOCA_ID,SCPT_DPTH,SCPT_RES,SCPT_FRES", ",m,MPa,kPa", rows)
    [text] = message(tmp_path, ags(LOCA, GEOL, cones), "b.ags")
    assert "and 2998 more alike" in text
    assert folded(["line 1, a: x", "line 2, b: x"]) == ["line 1, a: x", "line 2, b: x"]


TABLE = """\
boring;x;ground_level;top;bottom;layer;N;unit_weight (kN/m3)
B1;0;12,5;0;4,5;Sand;8;18,5
B2;40;8,0;0;3,5;Sand;>50;18
"""


@pytest.mark.parametrize(("old", "new"), [("", ""), (";", "\t"), ("boring;", "sep=;\nboring;")])
def test_semicolons_tabs_and_decimal_commas(old: str, new: str, tmp_path: Path) -> None:
    text = TABLE.replace(old, new) if old else TABLE
    item, two = read_csv(written(tmp_path, text, "b.csv")).logs
    assert (item.ground_level, item.layers[0].bottom, item.layers[0].unit_weight) == (12.5, 4.5, "18.5 kN/m3")
    assert (two.samples[0].N, is_refusal(two.samples[0].N)) == (50.0, True)


def test_columns_of_other_names(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = "Bore No,Chainage [m],Ground Level (ft),From,To,USCS,Stratum,N (blows/ft),Remarks\n"
    text += "A,0,40,0,8,SM,Sand,8,wet\nA,0,40,8,12,CL,Clay,4,\nB,30,35,0,9,SM,Sand,7,\nB,30,35,9,12,CL,Clay,R,\n"
    path = written(tmp_path, text, "b.csv")
    options = ["--columns", "boring=Bore No,x=Chainage,top=From", "--columns", "bottom=To", "--layers", "Stratum"]
    assert command_line.run("section", path, "-o", tmp_path / "made.toml", *options) == 0
    assert "not used: USCS, Remarks" in capsys.readouterr().out
    data = tomllib.loads((tmp_path / "made.toml").read_text(encoding="utf-8"))
    assert [stratum["name"] for stratum in data["strata"]] == ["Sand", "Clay"]
    assert data["surface"][0] == [0, pytest.approx(40 * FOOT, abs=1e-3)]
    assert "# at least: R" in (tmp_path / "made.toml").read_text(encoding="utf-8")
    assert (
        command_line.run("section", path, "-o", tmp_path / "2.toml", "--columns", "layers=USCS", "--columns", "top=F")
        == 2
    )
    err = capsys.readouterr().err
    assert "--columns layers=USCS: expected a column name of noshiro" in err
    assert "--columns top=F: there is no column 'F'; expected one of Bore No" in err


def test_columns_may_be_named_with_their_unit(tmp_path: Path) -> None:
    """As they stand in the file; of two that differ in their unit alone the named one is read."""
    text = "Bore No;Chainage [m];Ground Level (ft);From (m);From (ft);To (ft);Stratum\n"
    path = written(tmp_path, text + "A;0;40;99;0;8;Sand\n", "b.csv")
    named = {"boring": "Bore No", "x": "Chainage [m]", "ground_level": "ground level (ft)", "top": "From (ft)",
             "bottom": "To", "layer": "Stratum"}  # fmt: skip
    (log,) = read_csv(path, named).logs
    assert (log.ground_level, log.layers[0].top, log.layers[0].bottom) == pytest.approx((40 * FOOT, 0.0, 8 * FOOT))


def test_a_grain_size_without_a_unit_is_no_quarter_of_a_metre(tmp_path: Path) -> None:
    head = "boring,x,ground_level,top,bottom,layer,N,d50{},unit_weight\n"
    [text] = message(tmp_path, head.format("") + "A,0,5,0,2,s,4,0.25,18 kN/m^3\n", "b.csv")
    assert text == 'line 2, d50 = 0.25: 250 mm is implausible (did you mean "0.25 mm"?); expected 1e-05 to 10 mm'
    (log,) = read_csv(written(tmp_path, head.format(" (mm)") + "A,0,5,0,2,s,4,0.25,18 kN/m^3\n", "b.csv")).logs
    assert log.samples[0].d50 == pytest.approx(0.25e-3)


@pytest.mark.parametrize(
    ("test", "text"),
    [
        ({"depth": 2, "N": 8, "d50": 0.25}, "spt 1, d50 = 0.25: 250 mm" + BEYOND + "0.25 mm"),
        ({"depth": 2, "N": 210}, "spt 1, N = 210: 210 blows is implausible; expected 0 to 200 blows"),
        ({"depth": 2, "N": 20, "plasticity": 320}, "spt 1, plasticity = 320: 320 % is implausible"),
        ({"depth": 2, "N": 20, "fines": 120}, "spt 1, fines = 120: expected at most 100"),
        ({"depth": 2, "N": ">5x"}, "spt 1, N = '>5x': expected the blow count for 30 cm"),
        ({"depth": 2, "N": 5, "energy_ratio": 0.6}, "energy_ratio = 0.6"),
        ({"depth": 2, "qc": 4.2, "fs": "25 kPa"}, "cpt, largest qc = 4.2: 4.2e-06 MPa" + BEYOND + "4.2 MPa"),
        ({"depth": 2, "qc": "4 MPa", "fs": 25}, "largest fs = 25: 0.025 kPa" + BEYOND + "25 kPa"),
    ],
)
def test_numbers_of_borings_that_cannot_be(test: dict[str, object], text: str) -> None:
    kind = "cpt" if "qc" in test else "spt"
    data = {**slope(), "triggering": {"borings": [{"name": "B", "x": 5.0, kind: [test]}]}}
    with pytest.raises(InputError) as caught:
        analysed(data)
    assert any(text in problem and 'borings 1 "B"' in problem for problem in caught.value.problems), (
        caught.value.problems
    )
    if "is implausible" in text:
        assert analysed({**data, "unusual": True}).triggering.borings


@pytest.mark.parametrize(
    ("table", "text"),
    [
        ({"earthquake": {"magnitude": 7.0, "distance": 27}}, "earthquake, distance = 27: 0.027 km" + BEYOND + "27 km"),
        (
            {"earthquake": {"peak_acceleration": "250 gal", "depth": 14}},
            "earthquake, depth = 14: 0.014 km" + BEYOND + "14 km",
        ),
        ({"triggering": {"rods_above": 150}}, "triggering, rods_above = 150: 150 m" + BEYOND + "150 cm"),
        (
            {"earthquake": {"magnitude": 75, "peak_acceleration": "250 gal"}},
            "earthquake, magnitude = 75: expected at most 9.5 (moment magnitude",
        ),
    ],
)
def test_numbers_of_the_earthquake_that_cannot_be(table: dict[str, dict[str, object]], text: str) -> None:
    with pytest.raises(InputError) as caught:
        analysed({**slope(), **table})
    assert any(text in problem for problem in caught.value.problems), caught.value.problems


def test_the_energy_of_a_hammer_counts_where_it_was_measured() -> None:
    """(N1)60 goes with the energy: 45 % in a test is as 45 % of all."""
    from workflow.earthquake.triggering.blow_count import BlowCount, SurfaceMotion
    from workflow.earthquake.triggering.methods import RELATIONS
    from workflow.earthquake.triggering.settings import TriggeringSettings

    find = RELATIONS["idriss_boulanger_2008"].find
    shaking = SurfaceMotion(0.2, 7.5)
    of_boring = find(BlowCount(5.0, 12.0, 90.0, 60.0, 5.0, energy_ratio=45.0), shaking, TriggeringSettings())
    of_all = find(BlowCount(5.0, 12.0, 90.0, 60.0, 5.0), shaking, TriggeringSettings(energy_ratio=45.0))
    assert of_boring == of_all
    assert of_boring.normalised < find(BlowCount(5.0, 12.0, 90.0, 60.0, 5.0), shaking, TriggeringSettings()).normalised
    assert math.isfinite(of_boring.factor)


def test_rows_of_borings_that_loca_lacks_and_depths_that_no_boring_has(tmp_path: Path) -> None:
    lines = "B1,0,4,FILL,1; B1,4,10,SAND,2; B2,0,7,SAND,2"
    stranger = ags(LOCA, (*GEOL[:3], f"{lines}; B9,0,3,SAND,2"))
    assert (
        "group GEOL, borings B9: not used, since group LOCA does not list these borings"
        in read_ags4(written(tmp_path, stranger, "a.ags")).notices
    )
    upper = ags(LOCA, ("GEOL", GEOL[1], ",M,FT,,", "B1,0,13.1234,FILL,1; B1,4,32.8084,SAND,2; B2,0,22.9659,SAND,2"))
    assert read_ags4(written(tmp_path, upper, "b.ags")).logs[0].layers[0].bottom == pytest.approx(4.0, abs=1e-4)
    deep = ags(LOCA, (*GEOL[:3], "B1,0,4000,FILL,1; B2,0,7,SAND,2"))
    assert "boring B1, depth of its end = 4000: 4000 m is implausible" in message(tmp_path, deep, "c.ags")[0]
