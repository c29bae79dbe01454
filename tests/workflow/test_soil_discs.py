"""Soil discs from the command line: a small slope, calibrated and slid, and what is told of them."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w

from dem.case import Case
from dem.model import DiscModel
from dem.search.deposit import ground_at_rest
from dem.search.levelling import misfit
from dem.settings import SlideSettings
from dem.slides.liquefaction import Slider
from dem.slides.liquefied_strength import effect_of
from meshes.section.section import Section
from tests.support.command_line import run
from tests.support.sections import layer
from workflow.config import Config
from workflow.run.store import Store
from workflow.stages.discs_at_rest import ground_for

SECTION: dict[str, Any] = {
    "name": "soil",
    "surface": [[0.0, 9.0], [10.0, 9.0], [22.0, 6.0], [32.0, 6.0]],
    "base": {"elevation": 0.0},
    "strata": [
        layer("crust", bottom={"elevation": 6.0}, cohesion="2 kPa", friction_angle="30 deg"),
        layer("loose", bottom={"elevation": 3.0}, cohesion="0 kPa", friction_angle="33 deg", liquefies_in=[1, 2, 3]),
        layer("clay", cohesion="40 kPa", friction_angle="0 deg"),
    ],
    "mesh": {"size": "2 m"},
    "fem": {"element": "bilinear", "kh": [], "accuracy": 0.0, "direction": "downhill", "tolerance": 1e-4},
    "dem": {
        "elements": 110, "kh": [0.1], "resolution": 0.08, "tolerance": 0.05, "out_of_reach": "go on",
        "element_tests": False,
    },
    "slide": {"methods": ["discs"], "seeds": [1], "duration": 2.5, "frames": 3, "kh_seconds": 1.0,
              "cases": [{"stiffness": 0.1, "residual": 0.1}, {"volumetric_strain": 0.03},
                        {"stiffness": 0.1, "residual": 0.1, "damping": 0.3}]},
}  # fmt: skip


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which the slide was asked for, and so all before it has run."""
    folder = tmp_path_factory.mktemp("soil")
    (folder / "soil.toml").write_text(tomli_w.dumps(SECTION))
    assert run("slide", folder / "soil.toml", "--out", folder / "out") == 0
    return folder / "out"


def answer(folder: Path, name: str) -> Any:
    return json.loads((folder / name).read_text())


def test_the_target_has_the_sides_of_the_box(whole: Path) -> None:
    fem = answer(whole, "fem/critical.json")
    calibration = answer(whole, "dem/calibration.json")
    continuum = answer(whole, "dem/continuum.json")
    assert fem["settings"]["sides"] == "smooth"
    assert continuum["sides"] == "fixed"
    assert calibration["continuum_kc"] == [continuum["kc"], continuum["kc_upper"]]
    nearest = np.clip(calibration["predicted_kc"], continuum["kc"], continuum["kc_upper"])
    assert calibration["target_kc"] == pytest.approx(nearest, abs=1e-3)
    assert (continuum["flow"] == "non-associated") == (continuum["instead"] == "")
    assert continuum["flow"] in ("non-associated", "davis")
    assert calibration["parameter"] == "strength"
    assert 0.75 <= calibration["value"] <= 1.33
    assert calibration["predicted_ratio"] == pytest.approx(calibration["predicted_kc"] / continuum["kc"])


def test_the_ground_before_anything_is_the_sections(whole: Path) -> None:
    """Surface within half a radius in every column; weight and horizontal force of the soil; no disc turns."""
    section = Config.load(whole / "section.toml")
    discs = answer(whole, "dem/critical.json")["model"]
    settled = DiscModel.load(whole / "dem/settled.npz")
    assert discs["discs"] == "soil"
    assert settled.law == "soil"
    assert (settled.inertia_ratio[~settled.fixed] > 0.0).tolist() == (settled.layer[~settled.fixed] != 2).tolist()
    ground = ground_at_rest(section.section, section.dem, settled)
    assert ground.section is not None
    away = misfit(ground.section, settled, discs["radius_m"])
    assert np.abs(away).max() <= 0.5 * discs["radius_m"]
    calibrated = np.abs(misfit(ground.section, DiscModel.load(whole / "dem/calibrated.npz"), discs["radius_m"]))
    assert discs["surface_off_mean_m"] == pytest.approx(calibrated.mean())
    assert discs["surface_off_worst_m"] == pytest.approx(calibrated.max())
    areas = section.section.layering.areas()
    mass = sum(area * s.density_seismic for area, s in zip(areas, section.section.strata, strict=True))
    weight = sum(area * s.density_ordinary for area, s in zip(areas, section.section.strata, strict=True))
    free = ~settled.fixed
    assert settled.mass[free].sum() == pytest.approx(mass, rel=0.02)
    assert (settled.mass * settled.weight)[free].sum() == pytest.approx(weight, rel=0.02)
    inside = section.section.stratum_at(*ground.to_section(settled.x[free], settled.z[free]))
    assert (inside == settled.layer[free])[inside >= 0].mean() > 0.9


def test_the_slides(whole: Path) -> None:
    cases = answer(whole, "dem/cases.json")["sets"]["calibrated"]
    assert set(cases) == {"1", "2", "3"}
    for case in cases.values():
        assert case["escaped"] == 0
        assert case["overlap"] < 0.5
        assert case["settlement_uphill_m"] >= 0.0
        assert abs(case["area_lost_share"]) < 0.05
        assert case["slide_max_m"] < 8.0


def test_cases_that_soil_discs_feel_alike_are_one_slide(whole: Path) -> None:
    """Soil discs have no use for a factor on dashpots: case 3 is case 1, states included, and is not computed again."""
    cases = answer(whole, "dem/cases.json")
    assert cases["sets"]["calibrated"]["1"] == cases["sets"]["calibrated"]["3"]
    assert cases["sets"]["calibrated"]["1"] != cases["sets"]["calibrated"]["2"]
    assert sum((whole / f"dem/slide_calibrated_{n}").exists() for n in (1, 3)) == 1
    states = [[file.read_bytes() for file in sorted(whole.glob(f"dem/case{n}/*.vtp"))] for n in (1, 3)]
    assert states[0] == states[1] != []
    for case in cases["random"]["cases"].values():
        assert len(case["slide_max_m"]["values"]) == len(cases["random"]["cases"]["1"]["slide_max_m"]["values"])


def test_what_soil_discs_feel_of_a_case_is_all_that_their_slide_depends_on(whole: Path) -> None:
    """Slides of one effect have the same bits; where stiffness is felt, the effect and the bits are others."""
    config = Config.load(whole / "section.toml")
    start = DiscModel.load(whole / "dem/calibrated.npz")
    ground = ground_for(config.section, Store(whole), config.dem, start)
    settings = config.slide.changed(duration=4.0)  # they liquefy after 2 s

    def slid(case: Case) -> tuple[object, list[float]]:
        slide = Slider(start, ground, [1], case, settings).run()
        return effect_of(case, config.section, [1], "soil"), slide.slide

    potential = {"residual": 0.2, "strain_potential": 0.2}
    item, other = (slid(Case(**potential, stiffness=stiffness, damping=stiffness)) for stiffness in (0.1, 0.01))
    assert item == other
    soft, stiff = (slid(Case(residual=0.1, stiffness=stiffness)) for stiffness in (0.01, 0.5))
    assert soft[0] != stiff[0]
    assert soft[1] != stiff[1]
    drained = slid(Case(**potential, volumetric_strain=0.02))
    assert drained[0] != item[0]
    assert drained[1] != item[1]


def test_settings_of_the_paper_are_refused_with_words(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    wrong = {**SECTION, "dem": {**SECTION["dem"], "parameter": "all", "packing": "box"}}
    (tmp_path / "soil.toml").write_text(tomli_w.dumps(wrong))
    assert run("calibrate", tmp_path / "soil.toml", "--out", tmp_path / "out") == 2
    text = " ".join(capsys.readouterr().err.split())
    assert "soil discs have the stiffness of their soil" in text
    assert 'rows belong to model = "paper"' in text


def test_sections_without_settings_take_soil_discs() -> None:
    data = {key: value for key, value in SECTION.items() if key not in ("dem", "fem", "mesh", "slide")}
    assert isinstance(Section.parse(data), Section)
    assert Config.parse(data).dem.model == "soil"


def test_a_slide_has_an_interval(whole: Path) -> None:
    """Another packing is calibrated and slid; one that cannot be calibrated is named and not counted."""
    assert SlideSettings().packings("soil") == (1, 2)
    assert SlideSettings().packings("paper") == ()
    cases = answer(whole, "dem/cases.json")
    seeds = cases["random"]["seeds"]
    assert [seed["seed"] for seed in seeds][-1] == 1
    counted = sum(seed["verdict"] == "calibrated" for seed in seeds)
    for case in cases["random"]["cases"].values():
        values = case["slide_max_m"]["values"]
        assert len(values) == counted
        assert ("mean_ci95" in case["slide_max_m"]) == (counted > 2), "two packings have no interval"
        if counted > 2:
            low, high = case["slide_max_m"]["mean_ci95"]
            assert low <= np.mean(values) <= high
