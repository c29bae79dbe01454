"""`noshiro slide --model mpm`: the slides of the continuum, beside no disc at all."""

import json
from pathlib import Path

import pytest
import tomli_w

from tests.support import command_line
from tests.support.borings import SAND
from tests.support.sections import layer


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
            layer("sand", bottom={"depth": 6.0}, liquefies_in=[1, 2], **SAND),
            layer("stiff", **{**SAND, "cohesion": "50 kPa"}),
        ],
        "slide": {
            "kh": 0.0, "duration": 12.0, "onset": 1.0, "mpm_cells": 300,
            "cases": [{"residual": 0.5, "name": "much"}, {"residual": 0.01, "name": "little"}],
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
    assert (folder / "figures/mpm.png").stat().st_size > 10_000


def test_the_report_has_it_beside_the_discs(folder: Path) -> None:
    assert command_line.run("report", folder, "--quiet") == 0
    assert "The same by the material point method" in (folder / "report.html").read_text(encoding="utf-8")
    assert set(json.loads((folder / "summary.json").read_text())["cases_mpm"]) == {"1", "2"}


def test_loads_on_the_ground_are_not_passed_over(folder: Path, tmp_path: Path) -> None:
    text = (folder.parent / "gentle.toml").read_text()
    loaded = tmp_path / "loaded.toml"
    loaded.write_text(text + '\n[[surcharges]]\nfrom = 2.0\nto = 8.0\npressure = "20 kPa"\n')
    assert command_line.run("slide", loaded, "--model", "mpm", "--out", tmp_path / "run", "--quiet") == 3
    assert not (tmp_path / "run/mpm/slides.json").exists()
