"""What borings and an earthquake say of a section: stresses, shares of strata, and what cannot be said."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w

from meshes.section.overburden import overburden, water_level
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section
from tests.support import command_line
from tests.support.borings import bored, test
from tests.support.sections import analysed, assessment, problems
from workflow.config import Config
from workflow.earthquake.triggering.methods import reasons_in_one


def message(change: Any) -> str:
    data = bored()
    change(data)
    return "\n".join(problems(data, Config))


def test_stresses_before_the_earthquake() -> None:
    """5 m of 1.9 t/m³ weigh 93.163 kPa, 4 m of water carry 39.227 kPa."""
    section = analysed(bored())
    result = overburden(section.section, 50.0, 5.0)
    assert result.total == pytest.approx(1900.0 * GRAVITY * 5.0)
    assert result.effective == pytest.approx(1900.0 * GRAVITY * 5.0 - 1000.0 * GRAVITY * 4.0)
    assert result.stratum == 0
    assert not overburden(section.section, 50.0, 0.5).below_water


def test_density_and_saturated_density_and_water_on_the_ground() -> None:
    """1 m of 1.7, 4 m of 2.0 t/m³, water at 1 m; then water 3 m above the ground, which adds to neither stress: the
    total one is that of the ground alone."""
    data = bored()
    for stratum in data["strata"]:
        stratum.pop("density_ordinary")
        stratum.pop("density_seismic")
        stratum |= {"density": "1.7 t/m^3", "density_saturated": "2.0 t/m^3"}
    data.pop("water_table")
    result = overburden(analysed({**data, "water": {"table": -1.0}}).section, 50.0, 5.0)
    assert result.total == pytest.approx(GRAVITY * 9700.0)
    assert result.effective == pytest.approx(GRAVITY * 5700.0)
    cut = analysed({**data, "water": {"table": -1.0}})  # the loose sand above the water is a stratum of its own
    assert len(cut.section.strata) == 3
    assert cut.section.strata[0].liquefies_in == ()
    drowned = overburden(analysed({**data, "water": {"table": 3.0}}).section, 50.0, 5.0)
    assert drowned.total == pytest.approx(GRAVITY * 10000.0)
    assert drowned.effective == pytest.approx(GRAVITY * 5000.0)


def test_water_under_pressure_saturates_ground_above_the_table() -> None:
    """A level 0.2 m above the ground, a table 1 m below it: at a depth of 0.5 m there is a pressure of 0.7 m of water,
    so soil may liquefy there; a table is not needed for that."""
    data = bored()
    for stratum in data["strata"]:
        stratum.pop("density_ordinary")
        stratum.pop("density_seismic")
        stratum |= {"density": "1.7 t/m^3", "density_saturated": "2.0 t/m^3", "piezometric_level": 0.2}
    data.pop("water_table")
    for water in ({"water": {"table": -1.0}}, {}):
        section = analysed({**data, **water})
        result = overburden(section.section, 50.0, 0.5)
        assert result.below_water
        assert result.effective == pytest.approx(GRAVITY * (0.5 * 2000.0 - 0.7 * 1000.0))
        assert all(item.reason != "above the water table" for item in assessment(section).tests)


def test_what_tests_stand_for() -> None:
    """B-1 has loose sand from the water, at 1 m, to 6 m; B-2 as much of dense sand: half of it liquefies."""
    result = assessment(analysed(bored()))
    loose, dense = result.strata
    pieces = np.array([(t.top, t.bottom) for t in result.tests[:4]])
    np.testing.assert_allclose(pieces, [(0.0, 1.75), (1.75, 4.0), (4.0, 6.0), (6.0, 20.0)])
    assert result.tests[0].reason == "above the water table"
    assert loose.share == pytest.approx((6.0 - 1.75) / (6.0 + 5.0))
    assert (dense.share, dense.liquefies) == (0.0, False)
    assert (loose.assessed, loose.tests - loose.assessed, loose.reason) == (3, 1, "above the water table")
    assert result.potentials["B-2"] == 0.0
    assert result.potentials["B-1"] > 5.0


def test_a_stratum_that_is_triggered_liquefies_in_all_cases_or_in_none() -> None:
    data = bored()
    assert [stratum.liquefies_in for stratum in analysed(data).section.strata] == [(), ()]
    data["triggering"]["share"] = 0.3
    config = analysed(data)
    assert [tuple(stratum.liquefies_in) for stratum in config.section.strata] == [(1, 2, 3), ()]
    again = analysed({**data, "strata": config.to_data()["strata"]})
    assert 'liquefies_in = "triggered"' in config.to_toml()
    assert again.section.strata == config.section.strata


def test_clay_is_not_judged_by_its_blow_counts() -> None:
    """Ground with φ = 0 that the section does not let liquefy is clay, unless its plasticity says that it is not."""
    data = bored()
    data["strata"][0] |= {"cohesion": "20 kPa", "friction_angle": 0, "liquefies_in": []}
    clay = assessment(analysed(data))
    assert (clay.strata[0].assessed, clay.strata[0].liquefies) == (0, False)
    assert "clay by its strength" in clay.strata[0].reason
    assert clay.potentials["B-1"] == 0.0
    for sample in data["triggering"]["borings"][0]["spt"]:
        sample["plasticity"] = 3.0
    assert assessment(analysed(data)).strata[0].assessed > 0
    data = bored()
    data["strata"][0] |= {"cohesion": "20 kPa", "friction_angle": 0}  # it stays "triggered"
    assert assessment(analysed(data)).strata[0].assessed > 0


def test_what_is_not_known_is_named() -> None:
    assert "earthquake: expected peak_acceleration" in message(lambda data: data["earthquake"].pop("peak_acceleration"))
    assert "earthquake, magnitude: missing" in message(lambda data: data["earthquake"].pop("magnitude"))
    assert "water, table: missing" in message(lambda data: data.pop("water_table"))
    assert "triggering, borings: missing" in message(lambda data: data.pop("triggering"))
    assert "outside the range of Idriss" in message(lambda data: data["earthquake"].update(magnitude=9.0))


@pytest.mark.parametrize(
    ("boring", "expected"),
    [
        ({"x": 120.0, "spt": [test(2.0, 4)]}, "x = 120 m is off the section"),
        ({"x": 50.0, "spt": [test(25.0, 4)]}, "depth = 25 m is below the base"),
        ({"x": 50.0, "spt": [{"N": 4}]}, "depth: missing"),
        ({"x": 50.0, "spt": [{"depth": 3.0}]}, "N: missing"),
        ({"x": 50.0, "spt": [test(3.0, 4), test(2.0, 4)]}, "expected every test below the one before"),
        ({"x": 50.0, "spt": [test(3.0, 4, fines=120.0)]}, "fines = 120.0"),
        ({"x": 50.0, "spt": []}, "spt"),
    ],
)
def test_bad_borings(boring: dict[str, Any], expected: str) -> None:
    assert expected in message(lambda data: data["triggering"]["borings"].append({"name": "B-3", **boring}))


def test_a_stratum_without_a_blow_count_cannot_be_triggered() -> None:
    def shallow(data: dict[str, Any]) -> None:
        data["triggering"]["borings"] = [{"name": "B-1", "x": 20.0, "spt": [test(3.0, 5)]}]

    assert 'strata 2 "dense", liquefies_in = "triggered": no boring has a blow count in it' in message(shallow)


def test_a_record_of_the_surface_says_the_peak(tmp_path: Path) -> None:
    """0.2 g scaled by 1.25 is 0.25 g; it goes before an attenuation, and a peak goes before it."""
    (tmp_path / "surface.csv").write_text("time (s), a (g)\n0.0, 0.0\n0.1, -0.2\n0.2, 0.1\n")
    data = bored()
    data["earthquake"] = {"magnitude": 7.5, "distance": "20 km", "record": "surface.csv", "scale": 1.25}
    path = tmp_path / "bored.toml"
    path.write_text(tomli_w.dumps(data))
    config = Config.load(path)
    motion = assessment(config).motion
    assert motion.median == pytest.approx(0.25 * GRAVITY)
    assert motion.relation == "the peak of surface.csv"
    assert config.files("earthquake") == {"earthquake, record": tmp_path / "surface.csv"}
    assert config.files("slide") == {}
    data["earthquake"] |= {"peak_acceleration": "0.1 g"}
    assert analysed(data).earthquake.motion().median == pytest.approx(0.1 * GRAVITY)
    data["earthquake"] = {"magnitude": 7.5, "record": str(tmp_path / "none.csv")}
    assert "there is no such accelerogram" in "\n".join(problems(data, Config))


def test_a_plain_section_does_not_ask_for_borings() -> None:
    data = bored()
    for name in ("earthquake", "triggering"):
        data.pop(name)
    assert Section.parse(data).strata[0].liquefies_in.triggered


@pytest.mark.parametrize("method", ["idriss_boulanger_2008", "highway_1990", "highway_2012", "highway_2017"])
def test_the_command(method: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    data = bored()
    for boring in data["triggering"]["borings"]:
        for sample in boring["spt"]:
            sample["d50"] = "0.3 mm"
    data["triggering"]["method"] = method
    path = tmp_path / "bored.toml"
    path.write_text(tomli_w.dumps(data))
    assert command_line.run("liquefaction", path, "--out", tmp_path / "run") == 0
    assert '"dense" does not liquefy: F_L is below 1 in 0 % of it' in capsys.readouterr().out
    assert (tmp_path / "run/triggering.json").is_file()
    assert (tmp_path / "run/figures/triggering.png").is_file()
    assert command_line.run("report", tmp_path / "run", "--quiet") == 0
    page = (tmp_path / "run/report.html").read_text(encoding="utf-8")
    assert "Liquefaction by borings" in page


def test_a_cone_is_judged_drawn_and_reported(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Sand of 2 MPa to 6 m, and of 25 MPa below: the loose sand liquefies, and keeps a strength."""
    data = bored()
    cone = [{"depth": 0.25 * k, "qc": "2 MPa" if k < 24 else "25 MPa", "fs": "15 kPa"} for k in range(2, 70)]
    data["triggering"] = {
        "method": "boulanger_idriss_2014", "cases": ["median"], "borings": [{"name": "C-1", "x": 50.0, "cpt": cone}]
    }  # fmt: skip
    data["report"] = {"appendix": True}  # which has every depth of the cone
    config = analysed(data)
    assert [bool(stratum.liquefies_in) for stratum in config.section.strata] == [True, False]
    assert 1e3 < config.cases[0].strength_of("loose") < 10e3
    path = tmp_path / "cone.toml"
    path.write_text(tomli_w.dumps(data))
    assert command_line.run("liquefaction", path, "--out", tmp_path / "run") == 0
    assert '"dense" does not liquefy' in capsys.readouterr().out
    assert command_line.run("report", tmp_path / "run", "--quiet") == 0
    page = (tmp_path / "run/report.html").read_text(encoding="utf-8")
    assert "8 more tests are in triggering.json" in page
    data["triggering"]["method"] = "idriss_boulanger_2008"
    expected = (
        "none has spt, which Idriss & Boulanger (2008) requires; for what they have, set triggering.method to "
        '"boulanger_idriss_2014"'
    )
    assert expected in "\n".join(problems(data, Config))


def test_pore_pressure_of_what_does_not_liquefy_goes_into_the_analysis() -> None:
    """r_u = (2/π) arcsin(F_L^(-1/0.476)) where F_L is above 1; what is given, and what liquefies, stays."""
    data = bored()
    data["triggering"] |= {"share": 0.3, "pore_pressure": True}
    data["triggering"]["borings"] = [{"name": "B-1", "x": 50.0, "spt": [test(3.0, 5), test(8.0, 26), test(14.0, 30)]}]
    data["earthquake"]["peak_acceleration"] = "200 gal"
    config = analysed(data)
    loose, dense = config.section.strata
    tests = [item for item in assessment(config).tests if item.overburden.stratum == 1]
    each = [2.0 / np.pi * np.arcsin(entry.factor ** (-1.0 / 0.476)) for entry in tests]
    assert all(1.0 < entry.factor < 2.0 for entry in tests)
    areas = [element.area for element in tests]
    assert loose.excess_pore_pressure_ratio == 0.0
    assert dense.excess_pore_pressure_ratio == pytest.approx(np.average(each, weights=areas))
    at = np.array([[50.0, -10.0]])
    assert config.section.water_pressure.excess(at, at, np.array([1]))[0] > 0.0
    again = analysed({**data, "strata": config.to_data()["strata"]})
    assert again.section.strata == config.section.strata
    data["strata"][1]["excess_pore_pressure_ratio"] = 0.77
    assert analysed(data).section.strata[1].excess_pore_pressure_ratio == 0.77


def test_what_a_relation_misses_is_told_though_nothing_is_triggered() -> None:
    """`noshiro check` did not miss vs30, nor a magnitude out of range, where no stratum is left to the blow counts."""
    data = bored()
    data.pop("triggering")
    data["strata"] = [{key: value for key, value in item.items() if key != "liquefies_in"} for item in data["strata"]]
    data["earthquake"] = {"magnitude": 9.0, "distance": "20 km", "relation": "boore"}
    data["triggering"] = {"borings": [{"name": "B-1", "x": 400.0, "spt": [test(3.0, 5)]}]}
    said = "\n".join(problems(data, Config))
    assert 'earthquake, relation = "boore": expected vs30' in said
    assert "earthquake, magnitude = 9: outside the range" in said
    assert "boring B-1: x = 400 m is off the section" in said
    data.pop("triggering")
    data["earthquake"] |= {"vs30": 270.0, "magnitude": 9.2}
    assert "magnitude = 9.2: outside the range of Boore et al. (2014)" in "\n".join(problems(data, Config))
    data["earthquake"] |= {"peak_acceleration": "0.2 g"}
    motion = analysed(data).earthquake.motion()
    assert motion is not None
    assert motion.relation == "as given"


def test_bad_input_ends_with_exit_code_2(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    data = bored()
    data["earthquake"] = {"magnitude": 7.5, "distance": "500 km"}
    path = tmp_path / "bored.toml"
    path.write_text(tomli_w.dumps(data))
    assert command_line.run("liquefaction", path, "--out", tmp_path / "run") == 2
    assert "distance = 500 km: outside the range of Fukushima & Tanaka (1990)" in capsys.readouterr().err


def test_cases_by_name_follow_those_of_the_slide() -> None:
    """The three relations at two tests: the median lies between the low and the high strength, and sand drains."""
    data = bored()
    data["triggering"] |= {"share": 0.3, "cases": ["median", "low strength", "high strength"]}
    assert [case.name for case in analysed(data).cases] == data["triggering"]["cases"]  # not the paper's as well
    data["slide"] = {"cases": [{"stiffness": 0.1}, {"stiffness": 0.02}, {"stiffness": 0.01}]}
    config = analysed(data)
    assert tuple(config.section.strata[0].liquefies_in) == (1, 2, 3, 4, 5, 6)
    median, low, high = config.cases[3:]
    assert [case.name for case in config.cases] == ["", "", "", "median", "low strength", "high strength"]
    strengths = [case.strength_of("loose") for case in (low, median, high)]
    assert 1e3 < strengths[0] < strengths[1] < strengths[2] < 10e3
    assert median.strength_of("dense") == median.residual_of("loose") == 0.0
    assert 0.01 < median.volumetric_strain < 0.06
    assert analysed(config.to_data()).cases == config.cases
    data["triggering"] |= {"residual": "ratio"}
    ratios = [case.residual_of("loose") for case in analysed(data).cases[3:]]
    assert 0.02 < ratios[1] < ratios[0] < ratios[2] < 0.2
    assert all(not case.residual_strength for case in analysed(data).cases)


def test_sand_denser_than_all_cases_of_the_relations_counts_as_their_densest() -> None:
    """N = 16 and 22 at 2 g: more strength than N = 8 leaves, and the same for both."""
    data = bored()
    data["earthquake"]["peak_acceleration"] = "20 m/s^2"
    data["triggering"]["cases"] = ["median"]
    stored = []
    for count in (8, 16, 22):
        data["triggering"]["borings"] = [{"name": "B-1", "x": 20.0, "spt": [test(3.0, count), test(8.0, 60)]}]
        stored.append(analysed(data).cases[0].strength_of("loose"))
    assert stored[0] < stored[1] == pytest.approx(stored[2])


@pytest.mark.parametrize(
    ("tables", "names"),
    [
        ({}, ["median", "low strength", "high strength"]),
        ({"triggering": {"cases": ["median"]}}, ["median"]),
        ({"slide": {"cases": [{"name": "mine", "residual": 0.1}]}}, ["mine"]),
    ],
)
def test_blow_counts_give_the_strengths_where_nothing_else_does(tables: dict[str, Any], names: list[str]) -> None:
    data = bored()
    data["triggering"].pop("cases", None)
    for key, table in tables.items():
        data[key] = {**data.get(key, {}), **table}
    config = analysed(data)
    assert [case.name for case in config.cases] == names
    assert not [line for line in config.notices if "no residual strength of liquefied ground is given" in line]


def test_surcharges_spread_into_the_stresses_of_triggering() -> None:
    """A strip of 60 kPa, 4 m wide, adds 2/π (π/4 + 1/2) of it 2 m below its middle and half of it below its ends, near
    the ground (Poulos & Davis 1974, section 3.1); wide loads add all of it, and loads far away nothing. What shakes is
    in σv, what has consolidated the ground in σ'v."""
    data = bored()
    bare = overburden(analysed(data).section, 20.0, 2.0)

    def added(x: float, depth: float, **load: Any) -> tuple[float, float]:
        loads = [{"from": 18.0, "to": 22.0, "pressure": "60 kPa", "consolidated": 0.5, **load}]
        section = analysed({**data, "surcharges": loads}).section
        here, without = overburden(section, x, depth), overburden(analysed(data).section, x, depth)
        return here.total - without.total, here.effective - without.effective

    middle = 60e3 * 2.0 / np.pi * (np.pi / 4.0 + 0.5)
    assert added(20.0, 2.0) == pytest.approx((middle, 0.5 * middle))
    assert added(20.0, 2.0, seismic_share=0.0, consolidated=1.0) == pytest.approx((0.0, middle))
    assert added(22.0, 0.01)[0] == pytest.approx(30e3, rel=5e-3)
    assert added(20.0, 2.0, **{"from": 0.0, "to": 40.0})[0] == pytest.approx(60e3, rel=1e-3)
    rising = added(20.0, 2.0, pressure=["0 kPa", "60 kPa"])[0]
    assert rising + added(20.0, 2.0, pressure=["60 kPa", "0 kPa"])[0] == pytest.approx(middle)
    assert rising == pytest.approx(0.5 * middle)
    assert bare.loads == (0.0, 0.0)


def test_a_load_beside_the_boring_is_told_and_lowers_the_factor() -> None:
    """Traffic on sand that has not consolidated under it shakes with the ground: F_L falls below it."""
    data = bored()
    loads = {"below": (10.0, 30.0), "far": (40.0, 50.0)}
    configs = {
        name: analysed({**data, "surcharges": [{"from": ends[0], "to": ends[1], "pressure": "40 kPa"}]})
        for name, ends in loads.items()
    }
    messages = {
        name: [text for text in config.notices_of_slides if "as on an elastic half-plane" in text]
        for name, config in configs.items()
    }
    assert (len(messages["below"]), messages["far"]) == (1, [])
    lowest = {name: min(s.lowest for s in assessment(c).strata if s.lowest) for name, c in configs.items()}
    assert lowest["below"] < 0.9 * lowest["far"]


def test_a_clay_of_known_plasticity_is_not_called_one_of_unknown_plasticity() -> None:
    """One test of two had an index: "plasticity index 30 % ...; clay by its strength, ..., is not known"."""
    data = bored()
    data["strata"][0] |= {"cohesion": "30 kPa", "friction_angle": "0 deg"}
    data["strata"][0].pop("liquefies_in")
    data["triggering"]["borings"][0]["spt"] = [test(3.0, 5, fines=90, plasticity=30), test(8.0, 40)]
    data["triggering"]["borings"][1]["spt"] = [test(4.0, 6, fines=40), test(10.0, 60)]
    clay, _ = assessment(analysed(data)).strata
    assert clay.assessed == 0
    assert clay.reason == "plasticity index 30 % is at least 7 %: behaves as clay"
    for boring in data["triggering"]["borings"]:
        boring["spt"][0].pop("plasticity", None)
    unknown, _ = assessment(analysed(data)).strata
    assert unknown.reason.startswith("clay by its strength")


def test_reasons_of_many_tests_are_one_reason_with_the_ranges_of_its_numbers() -> None:
    """A cone through 2 m of clay listed the soil behaviour index of each of its readings."""
    indices = [f"soil behaviour index {index} is above 2.6: behaves as clay" for index in ("3.12", "2.7", "11.0")]
    assert reasons_in_one([*indices, "above the water table", indices[0]]) == [
        "soil behaviour index 2.7 to 11.0 is above 2.6: behaves as clay",
        "above the water table",
    ]
    fines = "fines {} % above 35 % with a plasticity index of {} % above 15 %"
    assert reasons_in_one([fines.format(40, 22), fines.format(60, 18)]) == [fines.format("40 to 60", "18 to 22")]
    assert reasons_in_one([]) == []


def test_the_water_of_a_boring_is_that_after_the_drawdown() -> None:
    """The picture of the borings had the table before the drawdown, while stresses were those after it."""
    data = bored()
    data.pop("water_table")
    for stratum in data["strata"]:
        stratum.pop("density_ordinary")
        stratum.pop("density_seismic")
        stratum |= {"density": "1.7 t/m^3", "density_saturated": "2.0 t/m^3", "drains": True}
    lowered = analysed({**data, "water": {"table": -1.0, "after_drawdown": -3.0}}).section
    same = analysed({**data, "water": {"table": -3.0}}).section
    assert water_level(lowered, 50.0) == water_level(same, 50.0) == -3.0
    for depth in (1.0, 2.0, 3.0, 5.0):  # at 1 m stands the water before the drawdown
        after, still = (overburden(section, 50.0, depth) for section in (lowered, same))
        assert (after.effective, after.below_water) == (still.effective, still.below_water), depth
