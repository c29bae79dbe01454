"""`noshiro slide --model mpm`: the slides of the continuum, beside no disc at all."""

import json
from pathlib import Path

import numpy as np
import pytest
import tomli_w

from fem.mpm import PointSlide, ground_of
from meshes.executor import Tell
from tests.support import command_line
from tests.support.borings import SAND
from tests.support.sections import layer
from workflow.config import Config
from workflow.run.store import Store
from workflow.stages.mpm import PointRun, _answer, alike_by_strength, at_rest, slide_of_points


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A gentle slope with 4 m of sand in it, that keeps much strength and little, under its weight alone."""
    place = tmp_path_factory.mktemp("mpm")
    data = {
        "name": "gentle",
        "surface": [[0.0, 3.0], [20.0, 3.0], [40.0, 0.0], [60.0, 0.0]],
        "base": {"elevation": -8.0},
        "water_table": {"depth": 2.0},
        "strata": [
            layer("crust", bottom={"depth": 2.0}, **{**SAND, "density_ordinary": "1.9 t/m^3"}),
            layer("sand", bottom={"depth": 6.0}, liquefies_in=[1, 2, 3], **SAND),
            layer("stiff", **{**SAND, "cohesion": "50 kPa"}),
        ],
        "slide": {
            "kh": 0.0, "duration": 5.0, "onset": 1.0, "mpm_cells": 150, "frames": 4,
            "cases": [
                {"residual": 0.5, "name": "much"},
                {"residual": 0.01, "name": "little"},
                {"residual": 0.01, "stiffness": 0.1},
            ],
        },
    }  # fmt: skip
    path = place / "gentle.toml"
    path.write_text(tomli_w.dumps(data))
    assert command_line.run("slide", path, "--model", "mpm", "--out", place / "run", "--quiet") == 0
    return place / "run"


def test_less_strength_slides_further_and_the_method_says_its_interval(folder: Path) -> None:
    answer = json.loads((folder / "mpm/slides.json").read_text())
    much, little = answer["cases"]["1"], answer["cases"]["2"]
    assert much["slide_max_m"] < 0.05
    assert little["slide_max_m"] > 0.2
    for case in (much, little):
        assert case["slide_max_low_m"] <= case["slide_max_m"] <= case["slide_max_high_m"]
        assert abs(case["settlement_crest_m"]) < 3.0
    assert answer["settled_by_m"] < 0.1
    for picture in ("mpm.png", "mpm_case2.png", "mpm_case2.webp"):
        assert (folder / "figures" / picture).is_file()
    assert len(list((folder / "mpm/case2").glob("frame_*.vtp"))) == 4


def test_a_case_that_keeps_the_strength_of_another_slides_alike_and_is_computed_once(folder: Path) -> None:
    config = Config.load(folder.parent / "gentle.toml")
    assert alike_by_strength(config, [1, 2, 3]) == {1: 1, 2: 2, 3: 2}
    assert alike_by_strength(config, [3]) == {3: 3}
    answer = json.loads((folder / "mpm/slides.json").read_text())
    assert answer["cases"]["3"] == answer["cases"]["2"]
    assert not any("case 3" in line for line in (folder / "log.txt").read_text().splitlines() if " s, slide " in line)
    for k in range(4):
        frames = [folder / f"mpm/case{case}/frame_{k:03d}.vtp" for case in (2, 3)]
        assert frames[0].read_bytes() == frames[1].read_bytes()
    assert (folder / "figures/mpm_case3.webp").is_file()


@pytest.mark.parametrize(
    ("coarse", "slower", "low", "high"), [(0.8, 0.85, 1.0, 1.2), (0.8, 0.6, 0.8, 1.2), (1.1, 1.3, 0.9, 1.2)]
)
def test_the_interval_has_what_finer_cells_and_a_slower_decay_come_to(
    folder: Path, coarse: float, slower: float, low: float, high: float
) -> None:
    """A slide of 1.0 m that is 0.8 m in cells twice as large converges to 1.2 m, to the first order; one that is 0.2 m
    shorter there with velocities that decay slower may be 0.8 m."""
    ground = at_rest(Config.load(folder.parent / "gentle.toml", {"slide": {"mpm_cells": 100}}))[0].ground
    surface = np.array([[0.0, 3.0], [30.0, 1.0], [60.0, 0.0]])
    slides = [
        PointSlide([1.0], [far * np.ones(3)], [np.zeros(3)], True, "at rest", surface, surface)
        for far in (1.0, coarse, slower)
    ]
    case = _answer(slides, ground)
    assert case.slide_max_m == 1.0
    assert (case.slide_max_low_m, case.slide_max_high_m) == pytest.approx((low, high))


def test_the_report_has_it_beside_the_discs(folder: Path) -> None:
    assert command_line.run("report", folder, "--quiet") == 0
    assert "Slides by the material point method" in (folder / "report.html").read_text(encoding="utf-8")
    assert set(json.loads((folder / "summary.json").read_text())["cases_mpm"]) == {"1", "2", "3"}


def test_what_material_points_cannot_do_is_told_and_ends_no_run(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fem.mpm.slide.LONGEST_SETTLING", 0.0)
    out = tmp_path / "run"
    assert command_line.run("slide", folder.parent / "gentle.toml", "--model", "mpm", "--out", out, "--quiet") == 0
    answer = json.loads((out / "mpm/slides.json").read_text())
    assert answer["cases"] == {}
    assert "does not come to rest under its weight" in answer["not_possible"]
    assert command_line.run("report", out, "--quiet") == 0
    assert "The material point method cannot compute the slides" in (out / "report.html").read_text(encoding="utf-8")


def test_a_stopped_slide_goes_on_with_the_same_bits(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fem.mpm.slide.CHECKPOINT_INTERVAL", 0.0)
    config = Config.load(folder.parent / "gentle.toml", {"slide": {"duration": 5.0}})
    slider, _ = at_rest(config)
    checkpoint = Store(tmp_path)

    def continued(heard: Tell, where: Store | None) -> PointSlide:
        return slide_of_points(PointRun(config, slider, 2, 10.0, where), heard)

    def stop(message: tuple[float, float, float]) -> None:
        if message[1] > 3.0:
            raise KeyboardInterrupt

    whole = continued(lambda _: None, None)
    with pytest.raises(KeyboardInterrupt):
        continued(stop, checkpoint)
    times: list[float] = []
    again = continued(lambda message: times.append(message[1]), checkpoint)
    assert min(times) > 2.5
    assert again.times == whole.times
    assert np.array_equal(again.slide, whole.slide)
    assert np.array_equal(again.surface_after, whole.surface_after)
    assert (again.reason, again.energy_lost_share) == (whole.reason, whole.energy_lost_share)
    times.clear()
    assert np.array_equal(continued(lambda message: times.append(message[1]), checkpoint).slide, whole.slide)
    assert times == []  # it had come to its end


def test_slides_have_free_field_sides_where_ground_liquefies_at_both_unless_told_otherwise() -> None:
    """Level ends are smooth for the elements, whose sides count in slides if the file names them."""
    data = {
        "name": "face",
        "surface": [[0.0, 3.0], [20.0, 3.0], [26.0, 0.0], [40.0, 0.0]],
        "base": {"elevation": -4.0},
        "strata": [layer("sand", liquefies_in=[1], **SAND)],
        "slide": {"mpm_cells": 200, "cases": [{"residual": 0.1}]},
    }
    config = Config.parse(data)
    assert config.fem.sides == "smooth"
    assert at_rest(config)[0].ground.sides == config.sides_of_slides == "free-field"
    data["fem"] = {"sides": "smooth"}
    assert at_rest(Config.parse(data))[0].ground.sides == "smooth"
    data["slide"]["mpm_sides"] = "fixed"
    assert at_rest(Config.parse(data))[0].ground.sides == "fixed"


@pytest.mark.parametrize(("depth", "expected_text"), [(0.5, True), (2.0, False)])
def test_a_crust_thinner_than_a_cell_is_told_with_the_cells_it_wants(depth: float, expected_text: bool) -> None:
    """200 cells of 1 m: 0.5 m of clay on sand that liquefies wants four times as many, 2 m want no more.

    An endless slope of 2 m of crust moves 2.3 m in cells half as thick, 3.1 and 17 m in cells 1.5 and 2.9 times as
    thick; Port Island E 1.4 m in cells as thick as its crust, and 0.7 m in cells 1.5 times as thick.
    """
    data = {
        "name": "level",
        "surface": [[0.0, 0.0], [20.0, 0.0]],
        "base": {"elevation": -10.0},
        "strata": [
            layer("clay", bottom={"depth": depth}, **{**SAND, "cohesion": "20 kPa"}),
            layer("sand", liquefies_in=[1], **SAND),
        ],
        "slide": {"mpm_cells": 200, "cases": [{"residual": 0.1}]},
    }
    ground = ground_of(Config.parse(data).section, 200)
    assert ground.crust == pytest.approx(depth)
    line = np.array([[0.0, 0.0], [10.0, 0.0], [20.0, 0.0]])
    slide = PointSlide([1.0], [np.zeros(3)], [np.zeros(3)], True, "", line, line, cell=ground.grid.cell)
    notes = [note for note in _answer([slide] * 3, ground).notes if "less than a cell" in note]
    assert ["0.5 m thick" in note and "800 cells" in note for note in notes] == [True] * expected_text
