"""Models of D-Stability as sections. The file is made here, in the form of theirs."""

import json
import tomllib
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meshes.errors import InputError
from meshes.models.stix_file import read_stix
from meshes.section.section import Section
from tests.support.command_line import run

SCENARIO = {
    "Label": "Daily",
    "Stages": [{"Label": "Daily", "GeometryId": "1", "SoilLayersId": "2", "WaternetId": "3", "StateId": "4",
                "LoadsId": "5", "ReinforcementsId": "6"}],
}  # fmt: skip


def points(*pairs: tuple[float, float]) -> list[dict[str, float]]:
    return [{"X": x, "Z": z} for x, z in pairs]


def soil(number: str, name: str, above: str, below: str, weight: float) -> dict[str, Any]:
    """A soil with all of its models."""
    return {
        "Id": number,
        "Name": name,
        "VolumetricWeightAbovePhreaticLevel": weight,
        "VolumetricWeightBelowPhreaticLevel": weight + 1.0,
        "ShearStrengthModelTypeAbovePhreaticLevel": above,
        "ShearStrengthModelTypeBelowPhreaticLevel": below,
        "MohrCoulombAdvancedShearStrengthModel": {"Cohesion": 7.0, "FrictionAngle": 30.0, "Dilatancy": 2.0},
        "SuShearStrengthModel": {"ShearStrengthRatio": 0.25, "StrengthIncreaseExponent": 0.9},
    }


def model() -> dict[str, Any]:
    """A dike of 4 m on 6 m of clay over sand, its water at 2 m, that of the sand at 3 m."""
    return {
        "scenarios/scenario": SCENARIO,
        "geometries/geometry": {
            "Id": "1",
            "Layers": [
                {"Id": "11", "Points": points((0, 0), (8, 4), (12, 4), (20, 0))},
                {"Id": "12", "Points": points((-20, -6), (40, -6), (40, 0), (20, 0), (0, 0), (-20, 0))},
                {"Id": "13", "Points": points((-20, -10), (40, -10), (40, -6), (-20, -6))},
            ],
        },
        "soils": {
            "Soils": [
                soil("21", "Dike", "MohrCoulombAdvanced", "Su", 18.0),
                soil("22", "Clay", "Su", "Su", 14.0),
                soil("23", "Sand", "MohrCoulombAdvanced", "MohrCoulombAdvanced", 19.0),
            ]
        },
        "soillayers/soillayers": {
            "Id": "2",
            "SoilLayers": [{"LayerId": f"1{k}", "SoilId": f"2{k}"} for k in (1, 2, 3)],
        },
        "waternets/waternet": {
            "Id": "3",
            "UnitWeightWater": 9.81,
            "PhreaticLineId": "31",
            "HeadLines": [
                {"Id": "31", "Points": points((-30, -1), (0, -1), (4, 2), (16, 2), (20, -1), (30, -1))},
                {"Id": "32", "Points": points((-20, 3), (40, 3))},
            ],
            "ReferenceLines": [
                {"Points": points((-20, -6), (40, -6)), "TopHeadLineId": "32", "BottomHeadLineId": "32"}
            ],
        },
        "states/state": {
            "Id": "4",
            "StatePoints": [{"LayerId": "11", "Point": {"X": 10.0, "Z": 1.0},
                             "Stress": {"StateType": "YieldStress", "YieldStress": 80.0}}],
            "StateLines": [{"Points": points((-20, 0), (0, 0), (20, 0), (40, 0)),
                            "Values": [{"X": 0.0, "Above": {"StateType": "Pop", "Pop": 3.0},
                                        "Below": {"StateType": "Pop", "Pop": 12.0}}]}],
        },
        "loads/load": {
            "Id": "5", "LineLoads": [{}], "Trees": [], "LayerLoads": [],
            "UniformLoads": [{"Start": 9.0, "End": 11.0, "Magnitude": 13.0, "Consolidations": [
                {"LayerId": "11", "Degree": 100.0}, {"LayerId": "12", "Degree": 30.0},
                {"LayerId": "13", "Degree": 0.0}]}],
            "Earthquake": {"IsEnabled": True, "HorizontalFactor": 0.1},
        },
        "reinforcements/reinforcement": {"Id": "6", "Nails": [{}, {}], "Geotextiles": []},
    }  # fmt: skip


def written(folder: Path, data: dict[str, Any]) -> Path:
    path = folder / "dike.stix"
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in data.items():
            archive.writestr(f"{name}.json", json.dumps(content))
    return path


def test_a_dike_is_a_section(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Above water the dike has c and φ, below it S σ'v OCR^m: at (10, 1) σ'v is 2 x 18 + 19 - u + 0.3 x 13 = 47.864 kPa
    with the least consolidated share of the load, and the yield stress there 80 kPa. Between the phreatic line at 2 m
    and the reference line at -6 m, where the level is 3 m, u rises linearly from 0 to 9 x 9.81 kPa: to an eighth."""
    assert run("section", written(tmp_path, model()), "-o", tmp_path / "dike.toml") == 0
    out = capsys.readouterr().out
    assert "It is sound." in out
    for text in (
        "line loads, 1",
        "earthquake, Kh = 0.1",
        "nails, 2",
        "consolidation that differ",
        "stiffness",
        "tan φ of",
    ):
        assert text in out
    section = Section.read(tmp_path / "dike.toml")
    assert [s.name for s in section.strata] == ["Dike", "Dike, wet", "Clay", "Clay, below water", "Sand"]
    np.testing.assert_allclose(section.layering.areas()[[0, 1, 4]], [16.0 + 8.0 / 3.0, 32.0 - 8.0 / 3.0, 240.0])
    dry, wet, clay, _, sand = section.strata
    assert (dry.cohesion, dry.density_ordinary, wet.density_ordinary) == pytest.approx((7e3, 1835.5, 1937.5), rel=1e-4)
    assert (wet.cohesion, wet.strength_ratio, wet.ocr_exponent) == (0.0, 0.25, 0.9)
    assert wet.pre_overburden_pressure == pytest.approx(80e3 - 47.864e3, rel=1e-3)
    assert clay.pre_overburden_pressure == 12e3
    assert sand.piezometric_level is not None
    assert clay.vertical_flow is not None
    at = np.array([[10.0, 1.0]])
    su = section.cohesion_field.at(at, at, np.array([1]))[0]
    assert su == pytest.approx(0.25 * 47.864e3 * (80.0 / 47.864) ** 0.9, rel=1e-3)
    assert section.surcharges[0].pressure == (13e3, 13e3)


def test_preconsolidation_lasts_from_stage_to_stage(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """At high water there are no states: those of the stage before hold, found by the place of the layer."""
    data = model()
    first = data["scenarios/scenario"]["Stages"][-1]
    layers = [{**item, "Id": f"9{item['Id']}"} for item in data["geometries/geometry"]["Layers"]]
    data["geometries/geometry_1"] = {"Id": "91", "Layers": layers}
    soils = [{**pair, "LayerId": f"9{pair['LayerId']}"} for pair in data["soillayers/soillayers"]["SoilLayers"]]
    data["soillayers/soillayers_1"] = {"Id": "92", "SoilLayers": soils}
    data["states/state_1"] = {"Id": "94", "StatePoints": [], "StateLines": []}
    last = {**first, "Label": "High water", "GeometryId": "91", "SoilLayersId": "92", "StateId": "94"}
    data["scenarios/scenario"] = {**data["scenarios/scenario"], "Stages": [first, last]}
    assert run("section", written(tmp_path, data), "-o", tmp_path / "dike.toml") == 0
    assert f'that of stage "{first["Label"]}"' in " ".join(capsys.readouterr().out.split())
    _, wet, clay, *_ = Section.read(tmp_path / "dike.toml").strata
    assert clay.pre_overburden_pressure == 12e3
    assert wet.pre_overburden_pressure > 20e3
    assert Section.read(tmp_path / "dike.toml").cohesion_field.state is not None


def test_a_later_stage_has_the_preconsolidation_of_the_water_and_the_ground_before(tmp_path: Path) -> None:
    """At high water, beside a new berm: σ'p at (30, -3) is σ'v of the stage before, under water at -1 m, and 12 kPa."""
    data = model()
    before = data["scenarios/scenario"]["Stages"][-1]
    layers = data["geometries/geometry"]["Layers"]
    berm = {"Id": "15", "Points": points((20, 0), (40, 0), (40, 1.5), (22, 1.5))}
    data["geometries/geometry_1"] = {"Id": "91", "Layers": [*layers, berm]}
    soils = [*data["soillayers/soillayers"]["SoilLayers"], {"LayerId": "15", "SoilId": "23"}]
    data["soillayers/soillayers_1"] = {"Id": "92", "SoilLayers": soils}
    waternet = data["waternets/waternet"]
    data["waternets/waternet"] = waternet | {"ReferenceLines": []}
    high = [{"Id": "31", "Points": points((-30, 3), (40, 1))}, waternet["HeadLines"][1]]
    data["waternets/waternet_1"] = waternet | {"Id": "93", "HeadLines": high, "ReferenceLines": []}
    data["states/state_1"] = {"Id": "94", "StatePoints": [], "StateLines": []}
    ids = {"GeometryId": "91", "SoilLayersId": "92", "StateId": "94", "WaternetId": "93"}
    stages = [before, {**before, "Label": "High water", **ids}]
    data["scenarios/scenario"] = {**data["scenarios/scenario"], "Stages": stages}
    section = Section.parse(tomllib.loads(read_stix(written(tmp_path, data), "dike").text))
    at = np.array([[30.0, -3.0]])
    k = section.stratum_at(*at.T)
    state = section.cohesion_field.consolidation_stress(at, at, k, int(k[0]))
    assert state[0] == pytest.approx(1e3 * (3.0 * 15.0 - 2.0 * 9.81), rel=1e-4)
    level = 1.0 + 2.0 * 10.0 / 70.0
    stress = 1e3 * (19.0 * (1.5 - level) + 20.0 * level + 15.0 * 3.0 - 9.81 * (level + 3.0))
    assert section.cohesion_field.effective_stress(at, at, k)[0] == pytest.approx(stress, rel=1e-3)


def test_bad_models_are_told(tmp_path: Path) -> None:
    path = written(tmp_path, model())
    with pytest.raises(InputError, match=r'"Flood": expected a scenario of .*, one of Daily'):
        read_stix(path, "dike", "Flood")
    with pytest.raises(InputError, match="expected a model of D-Stability"):
        read_stix(written(tmp_path, {"projectinfo": {}}), "dike")
    empty = model()
    empty["geometries/geometry"]["Layers"] = []
    with pytest.raises(InputError, match="the stage has no layers; expected at least one"):  # as a new file has none
        read_stix(written(tmp_path, empty), "dike")
    path.write_text("no zip")
    with pytest.raises(InputError, match="cannot be read: File is not a zip file"):
        read_stix(path, "dike")


@pytest.mark.parametrize(
    ("part", "key", "value"),
    [
        ("waternets/waternet", "HeadLines", [{"Id": "31", "Points": points((-20, "high"), (40, 2))}]),
        ("soillayers/soillayers", "SoilLayers", 3),
        ("geometries/geometry", "Layers", [{"Id": "11", "Points": points((0, 0), (8, float("nan")), (12, 4))}]),
        ("waternets/waternet", "UnitWeightWater", "much"),
    ],
)
def test_values_of_another_kind_are_told(tmp_path: Path, part: str, key: str, value: object) -> None:
    data = model()
    data[part][key] = value
    with pytest.raises(InputError, match="expected a model of D-Stability"):
        read_stix(written(tmp_path, data), "dike")


def test_layers_of_one_soil_keep_their_states(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Two layers of the clay have yield stresses of 150 and 250 kPa at 5 m below the ground, where σ'v is
    14 + 15 x 4 - 0.8 x 9 x 9.81 = 3.37 kPa; one of two points in the second is not taken. A soil by no known model of
    strength is asked for one, and a second soil called "Sand" keeps its weight."""
    data = model()
    data["geometries/geometry"]["Layers"][1:2] = [
        {"Id": "12", "Points": points((-20, -6), (10, -6), (10, 0), (0, 0), (-20, 0))},
        {"Id": "14", "Points": points((10, -6), (40, -6), (40, 0), (20, 0), (10, 0))},
    ]
    data["soillayers/soillayers"]["SoilLayers"].append({"LayerId": "14", "SoilId": "22"})
    stress = [{"StateType": "YieldStress", "YieldStress": value} for value in (150.0, 250.0)]
    places = (("12", -10.0, stress[0]), ("14", 35.0, stress[1]), ("14", 30.0, stress[0]))
    data["states/state"]["StatePoints"] = [
        {"LayerId": layer, "Point": {"X": x, "Z": -5.0}, "Stress": place} for layer, x, place in places
    ]
    data["soils"]["Soils"][0]["ShearStrengthModelTypeAbovePhreaticLevel"] = "SigmaTauTable"
    data["soils"]["Soils"][0]["Name"] = "Sand"
    assert run("section", written(tmp_path, data), "-o", tmp_path / "dike.toml") == 0
    out = capsys.readouterr().out
    for text in (
        'preconsolidation that varies within "Clay"',
        'strength of "Sand" by SigmaTauTable',
        "cohesion: expected a cohesion",
    ):
        assert text in out
    strata = tomllib.loads((tmp_path / "dike.toml").read_text())["strata"]
    config = {item["name"].split(",")[0]: item.get("pre_overburden_pressure") for item in strata}
    assert (config["Clay"], config["Clay 2"]) == ("146.6 kPa", "246.6 kPa")
    assert {entry["density"] for entry in strata if entry["name"].startswith("Sand")} == {"18 kN/m^3", "19 kN/m^3"}


def test_tables_of_strengths_and_cohesions_that_only_keep_a_program_from_zero_are_read(tmp_path: Path) -> None:
    data = model()
    clay, sand = data["soils"]["Soils"][1:]
    clay["ShearStrengthModelTypeBelowPhreaticLevel"] = clay["ShearStrengthModelTypeAbovePhreaticLevel"] = "SuTable"
    entries = [{"EffectiveStress": stress, "Su": strength} for stress, strength in ((0, 20), (30, 30), (200, 100))]
    clay["SuTable"] = {"StrengthIncreaseExponent": 0.8, "SuTablePoints": entries}
    sand["MohrCoulombAdvancedShearStrengthModel"] = {"Cohesion": 0.01, "FrictionAngle": 30.0}
    read = read_stix(written(tmp_path, data), "dike")
    section = Section.parse(tomllib.loads(read.text))
    stratum = next(s for s in section.strata if s.name == "Clay")
    assert stratum.strength_table == ((0.0, 20e3), (30e3, 30e3), (200e3, 100e3))
    assert any("is taken at σ'v" in text for text in read.notices)
    assert next(s for s in section.strata if s.name == "Sand").cohesion == 0.0
    assert 'the cohesion of 0.01 kPa of "Sand" is taken as 0' in read.notices


def heads(*lines: tuple[str, float]) -> list[dict[str, Any]]:
    return [{"Id": number, "Points": points((-20, z), (40, z))} for number, z in lines]


def lines_at(*lines: tuple[float, str | None, str | None]) -> list[dict[str, Any]]:
    """Reference lines with the head lines above and below."""
    return [
        {"Points": points((-20, z), (40, z)), "TopHeadLineId": above, "BottomHeadLineId": below}
        for z, above, below in lines
    ]


@pytest.mark.parametrize(
    ("lines", "below_ground"),
    [
        # Hydrostatic down to -2 m, linear to the level of 3 m at -6 m.
        (lines_at((-2, "31", "31"), (-6, "32", "32")), {-1.5: 0.5, -4.0: 0.5 * (1.0 + 9.0), -8.0: 11.0}),
        # A line without head lines, and one whose levels above and below differ.
        (lines_at((-2, None, None), (-6, "32", "31")), {-3.5: 0.5 * 9.0, -6.5: 5.5}),
        # All of it below the phreatic line, with two levels in the sand.
        (lines_at((-6, "31", "32"), (-10, "31", "31")), {-4.0: 3.0, -8.0: 0.5 * (9.0 + 9.0)}),
    ],
)
def test_pore_pressure_between_two_reference_lines_is_linear(
    tmp_path: Path, lines: list[Any], below_ground: dict[float, float]
) -> None:
    """By D-Stability's rule, beside the dike, in m of water: the phreatic line is at -1 m there."""
    data = model()
    waternet = data["waternets/waternet"]
    waternet["HeadLines"] = [waternet["HeadLines"][0], *heads(("32", 3.0))]
    waternet["ReferenceLines"] = lines
    section = Section.parse(tomllib.loads(read_stix(written(tmp_path, data), "dike").text))
    at = np.array([[-15.0, z] for z in below_ground])
    head = section.water_pressure.at_rest(at, at, section.stratum_at(*at.T)) / 9810.0
    np.testing.assert_allclose(head, list(below_ground.values()), rtol=1e-9)


def test_a_vertical_step_of_a_head_line_is_steep(tmp_path: Path) -> None:
    data = model()
    data["waternets/waternet"]["HeadLines"][0]["Points"] = points((-30, -1), (2, -1), (2, 1), (30, 1))
    section = Section.parse(tomllib.loads(read_stix(written(tmp_path, data), "dike").text))
    assert section.water is not None
    assert section.water.table is not None
    assert section.water.table.elevation[1:3] == ((2.0, -1.0), (2.05, 1.0))


def test_a_reference_line_through_a_layer_divides_it_where_the_water_is_another(tmp_path: Path) -> None:
    """The level in the clay is 3 m below -3.1 m, and -1 m above. Where the levels continue, one stratum suffices."""
    data = model()
    data["waternets/waternet"]["ReferenceLines"] = lines_at((-3.1, "31", "32"), (-6, "32", "32"))
    read = read_stix(written(tmp_path, data), "dike")
    assert not any("a reference line within" in text for text in read.notices)
    section = Section.parse(tomllib.loads(read.text))
    names = [stratum.name for stratum in section.strata if stratum.name.startswith("Clay")]
    assert names == ["Clay", "Clay, below water", "Clay, part 2, below water"]
    at = np.array([[-15.0, -2.5], [-15.0, -3.5], [10.0, -5.0]])
    head = section.water_pressure.at_rest(at, at, section.stratum_at(*at.T)) / 9810.0
    np.testing.assert_allclose(head, [1.5, 6.5, 8.0], rtol=1e-9)
    assert {stratum.strength_ratio for stratum in section.strata if stratum.name.startswith("Clay")} == {0.25}
    data["waternets/waternet"]["ReferenceLines"] = lines_at((-2, "31", "31"), (-6, "32", "32"))
    read = read_stix(written(tmp_path, data), "dike")
    assert not any("a reference line within" in text for text in read.notices)
