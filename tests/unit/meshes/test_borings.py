"""Borings from CSV and AGS4 files, connected to a section; sections as drawings and back."""

import math
import tomllib
from pathlib import Path

import numpy as np
import pytest

from meshes.borings.ags4_file import read_ags4
from meshes.borings.connect import connected, order, placed
from meshes.borings.csv_file import read_csv
from meshes.borings.log import Log, LogLayer
from meshes.borings.section_text import text_of
from meshes.errors import InputError
from meshes.section.cutting import BELOW_WATER
from meshes.section.section import Section
from tests.support import SECTIONS, command_line
from tests.support.sections import analysed
from workflow.config import Config

HEAD = "boring,x (m),ground_level (m),top (m),bottom (m),layer,N,fines,unit_weight (kN/m3),water_level"
LINES = """\
B-1,0,10,0,2,fill,4,10,17,8
B-1,0,10,2,6,sand,8,5,18,8
B-1,0,10,6,15,gravel,40,2,20,8
B-2,40,8,0,1.5,fill,3,12,17,7
B-2,40,8,1.5,3,silt,2,80,16,7
B-2,40,8,3,7,sand,9,6,18,7
B-2,40,8,7,12,gravel,45,3,20,7
B-3,100,5,0,2.5,silt,3,85,16,4.5
B-3,100,5,2.5,6,sand,7,6,18,4.5
"""
AGS4 = """"GROUP","PROJ"
"HEADING","PROJ_ID"
"UNIT",""
"TYPE","ID"
"DATA","1"

"GROUP","LOCA"
"HEADING","LOCA_ID","LOCA_NATE","LOCA_NATN","LOCA_GL"
"UNIT","","m","m","m"
"TYPE","ID","2DP","2DP","2DP"
"DATA","BH1","100.00","200.00","10.00"
"DATA","BH2","130.00","240.00","8.00"
"DATA","TP1","110.00","210.00","9.50"

"GROUP","GEOL"
"HEADING","LOCA_ID","GEOL_TOP","GEOL_BASE","GEOL_DESC","GEOL_GEOL"
"UNIT","","m","m","",""
"TYPE","ID","2DP","2DP","X","PA"
"DATA","BH1","0.00","1.50","Brown, sandy MADE GROUND","MG"
"DATA","BH1","1.50","4.00","Loose SAND","AL"
"DATA","BH1","4.00","6.00","Loose silty SAND","AL"
"DATA","BH1","6.00","12.00","Dense GRAVEL","RTD"
"DATA","BH2","0.00","5.00","Loose SAND","AL"
"DATA","BH2","5.00","10.00","Dense GRAVEL","RTD"

"GROUP","ISPT"
"HEADING","LOCA_ID","ISPT_TOP","ISPT_NVAL"
"UNIT","","m",""
"TYPE","X","2DP","0DP"
"DATA","BH1","2.00","7"
"DATA","BH2","3.00","9"
"""


def written(folder: Path, text: str, name: str = "borings.csv") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def problems(folder: Path, text: str) -> str:
    with pytest.raises(InputError) as caught:
        read_csv(written(folder, text))
    return "\n".join(caught.value.problems)


def test_an_earthquake_beside_a_section_from_borings_shakes_its_slides(tmp_path: Path) -> None:
    """The section must not have a Kh of its own, which would silence [earthquake] when somebody adds it."""
    data = tomllib.loads(text_of(connected(read_csv(written(tmp_path, HEAD + "\n" + LINES)).logs), "made"))
    data["strata"][-2]["liquefies_in"] = [1]
    made = analysed({**data, "earthquake": {"magnitude": 7.5, "peak_acceleration": "250 gal"}})
    assert made.slide.kh == pytest.approx(0.65 * 250.0 / 981.0, abs=1e-3)
    assert made.slide.kh_cycles == pytest.approx(15.0, abs=0.5)


def test_layers_end_half_way_where_the_next_boring_has_none(tmp_path: Path) -> None:
    """Fill is 1.5 m thick at x = 40 m and gone at 70 m; silt begins at 20 m. The gravel below B-3 is that of B-2."""
    logs = read_csv(written(tmp_path, HEAD + "\n" + LINES)).logs
    config = analysed(tomllib.loads(text_of(connected(logs), "made")))
    plain = {s.name.split(",")[0]: s for s in config.section.strata}
    assert list(plain) == ["fill", "silt", "sand", "gravel"]
    x = np.array([0.0, 20.0, 40.0, 70.0, 100.0])
    levels = {}
    for k, stratum in enumerate(config.section.strata):  # strata are cut at the water
        levels[stratum.name.split(",")[0]] = config.section.layering.interfaces(x)[:, k + 1]
    np.testing.assert_allclose(levels["fill"], [8.0, 7.25, 6.5, 6.5, 5.0], atol=1e-6)
    np.testing.assert_allclose(levels["silt"], [8.0, 7.25, 5.0, 3.75, 2.5], atol=1e-6)
    np.testing.assert_allclose(levels["sand"], [4.0, 2.5, 1.0, 1.0, -1.0], atol=2.1)
    assert plain["sand"].density_seismic == pytest.approx(18e3 / 9.80665)
    assert [sample.N for sample in config.triggering.borings[1].spt] == [3.0, 2.0, 9.0, 45.0]


def test_what_lies_below_an_embankment_does_not_rise_into_it(tmp_path: Path) -> None:
    """Fill of 5 m at the crest, clay at the ground of the borings beside it: the clay's top goes straight across."""
    lines = ["boring,x,ground_level,top,bottom,layer", "A,0,10,0,6,clay", "B,20,15,0,5,fill", "B,20,15,5,11,clay"]
    logs = read_csv(written(tmp_path, "\n".join([*lines, "C,50,11,0,7,clay"]))).logs
    result = connected(logs)
    assert result.names == ("fill", "clay")
    np.testing.assert_allclose(result.x, [0.0, 10.0, 20.0, 35.0, 50.0])
    np.testing.assert_allclose(result.bottoms[0], [10.0, 10.0, 10.0, 10.5, 11.0])


def test_a_section_of_borings_on_a_national_grid_keeps_its_decimals(tmp_path: Path) -> None:
    """Chainages of six digits were written in six digits, so that 0.75 m of the section were lost."""
    far = (
        LINES.replace(",0,10,", ",523417.25,10,")
        .replace(",40,8,", ",523457.5,8,")
        .replace(",100,5,", ",1523518.125,5,")
    )
    data = tomllib.loads(text_of(connected(read_csv(written(tmp_path, f"{HEAD}\n{far}")).logs), "far"))
    assert {523417.25, 523457.5, 1523518.125} <= {x for x, _ in data["surface"]}
    assert [boring["x"] for boring in data["triggering"]["borings"]] == [523417.25, 523457.5, 1523518.125]


def test_values_have_units_too(tmp_path: Path) -> None:
    text = "boring,x,ground_level,top,bottom,layer,unit_weight\nA,0 m,10 ft,0,150 cm,sand,1.8 t/m^3\n"
    (log,) = read_csv(written(tmp_path, text)).logs
    assert (log.ground_level, log.layers[0].bottom) == (pytest.approx(3.048), pytest.approx(1.5))
    assert log.layers[0].unit_weight == "1.8 t/m^3"


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("B-4,150,5,,3,sand,7,6,18,4", "line 11, top: missing; expected a coordinate"),
        ("B-4,150,5,0,3,,7,6,18,4", "line 11, layer: missing"),
        (",150,5,0,3,sand,7,6,18,4", "line 11, boring: missing"),
        ("B-4,150,5,3,2,sand,7,6,18,4", "the bottom at 2 m is not below the top"),
        ("B-4,150,5,1,3,sand,7,6,18,4", "its first layer begins at 1 m"),
        ("B-4,150,5,0,3,sand,7,6,18 apples,4", "unit_weight = '18 apples'"),
    ],
)
def test_bad_lines_are_named(line: str, expected: str, tmp_path: Path) -> None:
    assert expected in problems(tmp_path, f"{HEAD}\n{LINES}{line}\n")


def test_bad_columns_are_named(tmp_path: Path) -> None:
    messages = problems(tmp_path, "boring,depth,top,bottom\nA,1,2,3\n")
    assert "column 'depth': expected one of" in messages
    assert "column layer: missing" in messages
    assert "expected column x, or easting and northing" in messages


def log(name: str, place: tuple[float, float], *names: str) -> Log:
    layers = tuple(LogLayer(layer, float(k), float(k + 1)) for k, layer in enumerate(names))
    return Log(name, place, 0.0, layers)


def test_borings_are_projected_on_the_line_of_the_section() -> None:
    """From (0, 0) to (30, 40), 50 m; (15, 20) + 5 m across the line stands at 25 m."""
    logs = [log("A", (0.0, 0.0), "a"), log("B", (30.0, 40.0), "a"), log("C", (11.0, 23.0), "a")]
    assert [(item.log.name, item.x) for item in placed(logs)] == [("A", 0.0), ("C", 25.0), ("B", 50.0)]
    assert abs(placed(logs)[1].off_line) == pytest.approx(5.0)
    with pytest.raises(InputError, match=r"boring C: 5.0 m off the line of the section; .*--off allows more than 2 m"):
        placed(logs, 2.0)


def test_layers_above_and_below_others_have_numbers() -> None:
    """Clay over sand over clay, and clay over sand beside sand over clay: each part is a stratum of its own."""
    result = order([log("A", (0.0, 0.0), "a", "c"), log("B", (1.0, 0.0), "b", "c")])
    assert result is not None
    assert result[-1] == "c"
    for item, other, names in (
        (("a", "b", "a"), ("a", "b"), ("a 1", "b", "a 2")),
        (("a", "b", "a"), ("b", "a"), ("a 1", "b", "a 2")),
        (("a", "b", "a"), ("a", "c", "b", "a", "d"), ("a 1", "c", "b", "a 2", "d")),
        (("a", "b"), ("b", "a"), ("a 1", "b", "a 2")),
        (("a", "b", "a"), ("a 1", "b"), ("a (1)", "a 1", "b", "a (2)")),
    ):
        made = connected([log("A", (0.0, math.nan), *item), log("B", (9.0, math.nan), *other)])
        assert sorted(made.names) == sorted(names)
        assert [name for name in made.names if name.startswith(("a 2", "a (2"))] == [n for n in names if "2" in n]
        assert len(made.notices) == 1
        assert "from the top down, " in made.notices[0]
        assert np.all(np.diff(np.vstack([made.ground, made.bottoms]), axis=0) <= 0.0)


def test_ags4(tmp_path: Path) -> None:
    """A boring without layers (TP1) is left out; neighbours of one name are one layer; N stands 0.3 m below its top.

    The groups of the 87 test files that python-ags4 1.2.0 ships read as that package reads them: 94 groups LOCA, GEOL
    and ISPT, compared by hand since none of them may be copied here."""
    item, two = read_ags4(written(tmp_path, AGS4, "borings.ags")).logs
    assert [(layer.name, layer.top, layer.bottom) for layer in item.layers] == [
        ("MG", 0.0, 1.5), ("AL", 1.5, 6.0), ("RTD", 6.0, 12.0)
    ]  # fmt: skip
    assert [(sample.depth, sample.N) for sample in two.samples] == [(3.3, 9.0)]
    assert [result.x for result in placed([item, two])] == [0.0, 50.0]
    for text, expected in (
        (AGS4.replace('"2.00","7"', '"","7"'), "a blow count N = 7 without a depth"),
        (AGS4.replace('"Loose SAND","AL"', '"Loose SAND",""'), r"has no name \(GEOL_GEOL\)"),
        ("no borings", "holds no GROUP; expected AGS4, with a group LOCA"),
        (AGS4.replace('"GROUP","LOCA"', '"GROUP","HOLE"'), "group LOCA: missing"),
    ):
        with pytest.raises(InputError, match=expected):
            read_ags4(written(tmp_path, text, "bad.ags"))


CONES = """
"GROUP","SCPG"
"HEADING","LOCA_ID","SCPG_TESN","SCPG_CAR"
"UNIT","","",""
"TYPE","ID","X","2DP"
"DATA","CPT1","1","0.80"

"GROUP","SCPT"
"HEADING","LOCA_ID","SCPG_TESN","SCPT_DPTH","SCPT_RES","SCPT_FRES","SCPT_PWP2"
"UNIT","","","m","MN/m2","kN/m2","kN/m2"
"TYPE","ID","X","2DP","2DP","1DP","1DP"
"DATA","CPT1","1","0.00","0.00","0.0","0.0"
"DATA","CPT1","1","2.00","1.50","12.0","50.0"
"DATA","CPT1","1","2.02","1.60","-0.3","-20.0"
"DATA","CPT1","1","2.04","","","15.0"
"DATA","BH2","1","3.00","9.00","45.0",""
"""
SOUNDED = AGS4.replace('"DATA","TP1",', '"DATA","CPT1","115.00","220.00",""\n"DATA","TP1",') + CONES


def test_cones_of_an_ags4_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """qt = 1.5 MPa + (1 - 0.8) 50 kPa; a sleeve friction below zero is none; units are those of the file."""
    item, two, cone = sorted(read_ags4(written(tmp_path, SOUNDED, "cones.ags")).logs, key=lambda log: log.name)
    assert (item.cones, cone.layers) == ((), ())
    assert [(c.depth, c.qc, c.fs) for c in cone.cones] == [
        (2.0, pytest.approx(1.51e6), 12e3),
        (2.02, pytest.approx(1.596e6), 0.0),
    ]
    assert [(c.depth, c.qc) for c in two.cones] == [(3.0, 9e6)]
    kilopascals = SOUNDED.replace('"MN/m2"', '"kPa"').replace('"9.00","45.0"', '"9000","45.0"')
    kilopascals = kilopascals.replace('"1.50","12.0"', '"1500","12.0"').replace('"1.60","-0.3"', '"1600","-0.3"')
    assert read_ags4(written(tmp_path, kilopascals, "cones.ags")).logs[1].cones[0].qc == 9e6
    path = written(tmp_path, SOUNDED, "cones.ags")
    assert command_line.run("section", path, "-o", tmp_path / "made.toml") == 0
    assert "2 borings with layers, cones in 2 of 3" in capsys.readouterr().out
    data = tomllib.loads((tmp_path / "made.toml").read_text(encoding="utf-8"))
    assert [(b["name"], b["x"], len(b.get("cpt", []))) for b in data["triggering"]["borings"]] == [
        ("BH1", 0, 0), ("CPT1", 25, 2), ("BH2", 50, 1)
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('"DATA","CPT1","1","2.06","much","12.0",""', "SCPT_RES = 'much'"),
        ('"DATA","CPT1","1","","2.00","12.0",""', "boring CPT1: a cone resistance without a depth, SCPT_DPTH"),
        ('"DATA","CPT1","1","deep","2.00","12.0",""', "depth"),
    ],
)
def test_a_sounding_with_bad_cones_is_left_out(line: str, message: str, tmp_path: Path) -> None:
    read = read_ags4(written(tmp_path, SOUNDED + line + "\n", "cones.ags"))
    assert [log.name for log in read.logs] == ["BH1", "BH2"]
    assert any(text.startswith("a boring is left out: ") and message in text for text in read.notices)


def test_a_layer_may_have_a_line_for_each_of_its_tests(tmp_path: Path) -> None:
    """Two lines of one layer are that layer with two blow counts; the section made of them goes on past the borings."""
    lines = "A,0,5,0,2,sand,4\nA,0,5,2,4,sand,6\nA,0,5,4,8,clay,3\nB,40,4,0,3,sand,5\nB,40,4,3,8,clay,2\n"
    path = written(tmp_path, "boring,x,ground_level,top,bottom,layer,N\n" + lines)
    first, _ = read_csv(path).logs
    assert [(layer.name, layer.top, layer.bottom) for layer in first.layers] == [("sand", 0.0, 4.0), ("clay", 4.0, 8.0)]
    assert [(sample.depth, sample.N) for sample in first.samples] == [(1.0, 4.0), (3.0, 6.0), (6.0, 3.0)]
    assert 'beyond = "20 m"' in text_of(connected(read_csv(path).logs), "two")


def test_strength_is_estimated_from_blow_counts_without_refusals(tmp_path: Path) -> None:
    """A stone in a clay of N = 4 and 6 gave it a cohesion of 125 kPa; a layer with refusals alone has these."""
    lines = (
        "A,0,5,0,4,clay,4,95\nA,0,5,4,6,clay,R,95\nA,0,5,6,8,rock,R,5\nB,40,4,0,4,clay,6,95\nB,40,4,4,7,rock,>50,5\n"
    )
    path = written(tmp_path, "boring,x,ground_level,top,bottom,layer,N,fines\n" + lines)
    text = text_of(connected(read_csv(path).logs), "stone")
    clay, rock = tomllib.loads(text)["strata"]
    assert (clay["cohesion"], clay["youngs_modulus"]) == ("31.2 kPa", "14 MPa")  # 6.25 kPa and 2.8 MPa times 5
    assert "times N = 5, without 1 refusal (highway code)" in text
    assert rock["youngs_modulus"] == "140 MPa"  # 2.8 MPa times 50
    assert "times N = 50 (highway code)" in text


def test_cones_of_a_csv_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Beside a file of borings; what is wrong has its line, and a sounding beyond the borings its x."""
    borings = written(tmp_path, HEAD + "\n" + LINES)
    text = "boring,x,depth (m),qc (MPa),fs (kPa)\nC-1,20,1.0,2.5,20\nC-1,20,1.1,2600 kPa,21\n"
    (log,) = read_csv(written(tmp_path, text, "cones.csv")).logs
    assert [(c.depth, c.qc, c.fs) for c in log.cones] == [(1.0, 2.5e6, 20e3), (1.1, 2.6e6, 21e3)]
    cones = tmp_path / "cones.csv"
    assert command_line.run("section", borings, cones, "-o", tmp_path / "made.toml") == 0
    assert Config.load(tmp_path / "made.toml").triggering.borings[1].cpt == log.cones
    assert "The section is complete" in capsys.readouterr().out
    messages = problems(tmp_path, text + "C-1,20,1.05,-1,21\nC-1,20,1.0,2,20\n")
    assert "line 4, qc = '-1 MPa'" in messages
    assert "sounding C-1: 1 m follows 1.1 m" in messages
    borings = written(tmp_path, HEAD + "\n" + LINES)
    far = read_csv(written(tmp_path, text.replace("C-1,20", "C-1,120"), "cones.csv")).logs
    with pytest.raises(
        InputError, match=r"sounding C-1: at x = 120 m it stands beyond the borings with layers, 0 to 100"
    ):
        placed([*read_csv(borings).logs, *far])


def test_what_was_not_measured_has_to_be_given(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path, AGS4, "borings.ags")
    assert command_line.run("section", path, "-o", tmp_path / "made.toml", painted=True) == 0
    out = capsys.readouterr().out
    lines = [line for line in out.splitlines() if line.startswith('  - strata 1 "MG"')]
    assert lines == ['  - strata 1 "MG": youngs_modulus, poissons_ratio, cohesion, friction_angle, density']
    assert out.count("density: expected a density or unit weight such as") == 1
    assert (tmp_path / "made.png").stat().st_size > 10_000
    assert command_line.run("section", path, "-o", tmp_path / "made.toml") == 2


@pytest.mark.parametrize("name", ["s13", "natural_slope"])
def test_from_a_section_to_a_drawing_and_back(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Strata in the same order with the same areas, and the same ground; the soils have to be given again."""
    config = Config.load(SECTIONS / f"{name}.toml")
    assert command_line.run("section", SECTIONS / f"{name}.toml", "-o", tmp_path / "drawn.dxf") == 0
    assert command_line.run("section", tmp_path / "drawn.dxf", "-o", tmp_path / "again.toml") == 0
    assert "youngs_modulus: expected a stiffness" in capsys.readouterr().out
    data = tomllib.loads((tmp_path / "again.toml").read_text(encoding="utf-8"))
    data.pop("water", None)
    soils = {stratum.name: stratum for stratum in config.section.strata}
    for stratum in data["strata"]:
        soil = soils[stratum["name"]].model_dump(mode="json", exclude={"name", "bottom", "description", "liquefies_in"})
        stratum |= {key: value for key, value in soil.items() if value is not None}
    again = Section.parse(data)
    areas = dict(zip([s.name for s in again.strata], again.layering.areas(), strict=True))
    expected: dict[str, float] = {}
    for item, area in zip(
        config.section.strata, config.section.layering.areas(), strict=True
    ):  # water cuts some, drawings do not
        whole = item.name.removesuffix(BELOW_WATER)
        expected[whole] = expected.get(whole, 0.0) + area
    assert areas == {key: pytest.approx(value, rel=1e-6) for key, value in expected.items()}
    x = np.linspace(*config.section.extent, 50)
    np.testing.assert_allclose(
        again.layering.interfaces(x)[:, 0], config.section.layering.interfaces(x)[:, 0], atol=1e-6
    )


def test_a_drawing_without_strata(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    import ezdxf

    drawing = ezdxf.new()
    drawing.modelspace().add_line((0.0, 0.0), (1.0, 1.0))
    drawing.saveas(tmp_path / "lines.dxf")
    assert command_line.run("section", tmp_path / "lines.dxf", "-o", tmp_path / "made.toml") == 2
    assert "holds no closed polylines" in capsys.readouterr().err


def test_soundings_without_borings_are_said_to_lack_layers() -> None:
    """Two cones were "fewer than two borings have layers", although no file was one of borings."""
    cones = [Log(f"S{k}", (10.0 * k, math.nan), 2.0, ()) for k in range(2)]
    with pytest.raises(InputError, match="soundings alone have no layers; expected borings with layers"):
        placed(cones)
    with pytest.raises(InputError, match="fewer than two borings have layers"):
        placed([*cones, Log("B", (5.0, math.nan), 2.0, (LogLayer("sand", 0.0, 3.0),))])
