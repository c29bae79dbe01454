"""The discs driven by the average acceleration of what lies above the slip surface, from the record of the rock on."""

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w

from tests.support.command_line import run
from tests.support.sections import analysed, layer
from workflow.earthquake.column import column_of

pytestmark = pytest.mark.slow

SLIP = 2.0  # m, in the layer that liquefies
SECTION: dict[str, Any] = {
    "name": "shaken",
    "surface": [[0.0, 8.0], [30.0, 6.8]],
    "base": {"depth": 3.7},
    "strata": [
        layer("crust", bottom={"depth": 1.1}, cohesion="1 kPa", friction_angle="25 deg"),
        layer("loose", bottom={"depth": 2.8}, cohesion="0 kPa", friction_angle="25 deg", liquefies_in=[1]),
        layer("firm", cohesion="2 kPa", friction_angle="30 deg"),
    ],
    "mesh": {"columns": 15, "rows": 4},
    "fem": {"element": "bilinear", "kh": [], "rigid_box": False, "direction": "downhill", "safety_factor_at": []},
    "dem": {
        "model": "paper", "radius": "0.55 m", "kh": [], "resolution": 0.08, "parameter": "none", "element_tests": False,
    },
    "slide": {"methods": ["discs"], "duration": 2.0, "frames": 2, "cases": [{"stiffness": 0.1}], "liquefies_at": 1.0},
}  # fmt: skip


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """The section with a burst of 0.3 g at 2 Hz in the rock below."""
    time = np.arange(0.0, 4.0, 0.01)
    burst = 0.3 * np.sin(4.0 * np.pi * time) * np.exp(-(((time - 2.0) / 0.8) ** 2))
    record = tmp_path_factory.mktemp("rock") / "rock.csv"
    lines = "\n".join(f"{t:.2f}, {a:.9f}" for t, a in zip(time, burst, strict=True))
    record.write_text(f"time (s), a (g)\n{lines}\n")
    return {**SECTION, "site_response": {"record": str(record), "slip_depth": SLIP, "x": 15.0}}


@pytest.fixture(scope="module")
def average(data: dict[str, Any], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which that average has driven the discs."""
    out = tmp_path_factory.mktemp("average") / "out"
    assert slid(data, out, accelerogram="average") == 0
    return out


def slid(data: dict[str, Any], out: Path, **settings: Any) -> int:
    """Runs the slide in a folder with some of its settings changed."""
    file = out.with_suffix(".toml")
    file.write_text(tomli_w.dumps({**data, "slide": {**data["slide"], **settings}}))
    return run("slide", file, "--out", out)


def compared(average: Path, folder: Path) -> Path:
    """The same folder once more, so that nothing but the slide is new."""
    return Path(shutil.copytree(average, folder / "out"))


def case(folder: Path) -> dict[str, Any]:
    """The slide with a liquefied layer."""
    loads: dict[str, Any] = json.loads((folder / "dem/cases.json").read_text())["sets"]["calibrated"]["1"]
    return loads


def test_the_discs_go_where_a_record_of_that_average_takes_them(
    data: dict[str, Any], average: Path, tmp_path: Path
) -> None:
    config = analysed(data)
    column = column_of(config.section, config.site_response)
    felt = column.average_above(SLIP)
    lines = "\n".join(f"{column.step * k!r}, {float(a)!r}" for k, a in enumerate(felt))
    (tmp_path / "felt.csv").write_text(f"time (s), a (m/s2)\n{lines}\n")
    again = compared(average, tmp_path)
    assert slid(data, again, accelerogram=str(tmp_path / "felt.csv")) == 0
    assert case(again)["slide_max_m"] == pytest.approx(case(average)["slide_max_m"], rel=1e-9)
    # what the rock does is another motion, and takes them elsewhere
    assert slid(data, again, accelerogram=data["site_response"]["record"]) == 0
    assert abs(case(again)["slide_max_m"] / case(average)["slide_max_m"] - 1.0) > 1e-3


def test_kh_is_k_max_where_it_is_left_to_the_record(data: dict[str, Any], average: Path, tmp_path: Path) -> None:
    config = analysed(data)
    k_max = round(column_of(config.section, config.site_response).k_max(SLIP), 4)
    assert 0.02 < k_max < 0.6
    path = compared(average, tmp_path)
    assert slid(data, path, kh="k_max") == 0
    case_answer = case(path)
    assert slid(data, path, kh=k_max) == 0
    assert case(path) == case_answer
    assert slid(data, path, kh=0.5 * k_max) == 0
    assert case(path)["slide_max_m"] < 0.95 * case_answer["slide_max_m"]
