"""`noshiro liquefied`: whether the ground still stands, before any slide."""

import json
from pathlib import Path

import pytest
import tomli_w

from tests.support import command_line
from tests.support.borings import SAND
from tests.support.sections import layer


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A gentle slope, 60 m long, with 4 m of sand in it: three cases leave it nothing, a little, and much strength. A
    third of the command's triangles bound it well enough."""
    place = tmp_path_factory.mktemp("liquefied")
    data = {
        "name": "gentle",
        "surface": [[0.0, 3.0], [60.0, 0.0]],
        "base": {"elevation": -8.0},
        "water_table": {"depth": 2.0},
        "strata": [
            layer("crust", bottom={"depth": 2.0}, **{**SAND, "density_ordinary": "1.9 t/m^3"}),
            layer("sand", bottom={"depth": 6.0}, liquefies_in=[1, 2, 3, 4], **SAND),
            layer("stiff", **{**SAND, "cohesion": "50 kPa"}),
        ],
        "mesh": {"size": "3 m"},
        "fem": {"direction": "downhill", "accuracy": 0.0, "element": "bilinear", "tolerance": 1e-4},
        "bounds": {"max_cells": 200, "gap": 0.3},
        "slide": {
            "cases": [{"stiffness": 0.1}, {"residual": 0.02}, {"residual": 0.2, "name": "much"}, {"stiffness": 0.5}]
        },
    }
    path = place / "gentle.toml"
    path.write_text(tomli_w.dumps(data))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("workflow.stages.bearing.CELLS", 800)
        # ground that its sides let slide out needs no closer bounds between held sides
        patch.setattr("workflow.stages.bearing._closer", lambda *_: pytest.fail("closer bounds, which nobody reads"))
        assert command_line.run("liquefied", path, "--out", place / "run", "--quiet") == 0
    return place / "run"


def test_strength_decides_whether_it_stands(folder: Path) -> None:
    """On an infinite slope of 5 % a strength of 0.02 σ' flows, for the shear stress is 0.05 of the total weight, and
    one of 0.2 σ' stands. Between held sides that of 0.02 σ' would be enough, but the section's own let it slide out."""
    nothing, little, much = json.loads((folder / "fem/liquefied.json").read_text())["cases"]
    assert (nothing["cases"], nothing["verdict"], nothing["factor"]) == ([1, 4], "flows", None)
    assert "there is no factor of safety" in " ".join(nothing["notes"])
    assert little["verdict"] == "flows"
    assert little["reason"].startswith("a mechanism that leaves the section at a side")
    assert (little["factor_lower"], little["factor_upper"]) == (None, None)
    assert (much["names"], much["verdict"]) == (["much"], "stands")
    assert much["factor_lower"] > 1.0
    assert 0.9 * much["kc_lower"] < much["kc"] < 1.1 * much["kc_upper"]


def test_the_report_tells_it(folder: Path) -> None:
    assert command_line.run("report", folder, "--quiet") == 0
    text = (folder / "report.html").read_text(encoding="utf-8")
    assert "Stability after liquefaction" in text
    assert "1, 4" in text


@pytest.mark.slow
def test_an_embankment_with_a_weak_face_uphill_fails_there_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A dam whose steep face looks to the right, away from its lower toe: pushed to the left, downhill by its ends, it
    bears Kh = 0.250 in cells of 2 m, and 0.210 to the right. Liquefied sand lies below all of it. A third of the
    command's triangles bound it well enough."""
    monkeypatch.setattr("workflow.stages.bearing.CELLS", 800)
    data = {
        "name": "dam",
        "surface": [[0.0, 5.0], [30.0, 5.0], [60.0, 15.0], [70.0, 15.0], [82.0, 5.2], [110.0, 5.2]],
        "base": {"elevation": 0.0},
        "strata": [
            layer("fill", bottom={"elevation": 1.0}, **{**SAND, "cohesion": "12 kPa", "friction_angle": "25 deg"}),
            layer("sand", liquefies_in=[1], **SAND),
        ],
        "mesh": {"size": "3 m", "method": "free"},
        "slide": {"cases": [{"residual_strength": "62 kPa"}]},
    }
    path = tmp_path / "dam.toml"
    path.write_text(tomli_w.dumps(data))
    assert command_line.run("liquefied", path, "--out", tmp_path / "run", "--quiet") == 0
    (messages,) = json.loads((tmp_path / "run/fem/liquefied.json").read_text())["cases"]
    assert messages["direction"] == "uphill"
    assert messages["kc"] == pytest.approx(0.21, abs=0.01)
    assert 0.9 * messages["kc_lower"] < messages["kc"] < 1.1 * messages["kc_upper"]
