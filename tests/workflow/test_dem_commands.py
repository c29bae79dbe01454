"""`noshiro calibrate` and `noshiro slide` on a small slope: what they leave, going on after a stop, same bits."""

import csv
import json
import shutil
import signal
import subprocess
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyvista as pv
import tomli_w
from matplotlib.image import imread
from PIL import Image

from tests.support.command_line import line, run
from tests.support.sections import layer
from workflow.results.disc_grids import frame_file, frames
from workflow.run.store import Store

SECTION: dict[str, Any] = {
    "name": "small",
    "title": "Small slope",
    "surface": [[0.0, 8.0], [36.0, 6.5]],
    "base": {"depth": 3.7},
    "strata": [
        layer("crust", bottom={"depth": 1.1}, cohesion="1 kPa", friction_angle="25 deg"),
        layer("loose", bottom={"depth": 2.8}, cohesion="0 kPa", friction_angle="25 deg", liquefies_in=[1, 2]),
        layer("firm", cohesion="2 kPa", friction_angle="30 deg"),
    ],
    "mesh": {"columns": 18, "rows": 4},
    "fem": {"element": "bilinear", "kh": [0.1], "rigid_box": False, "tolerance": 1e-4},
    "dem": {
        "model": "paper", "radius": "0.5 m", "kh": [0.1], "resolution": 0.04, "tolerance": 0.1,
        "out_of_reach": "go on", "element_tests": False, "parameter": "all", "range": [0.25, 4.0],
    },
    "slide": {"methods": ["discs"], "duration": 2.5, "frames": 4, "cases": [{"stiffness": 0.1}, {"stiffness": 0.03}]},
}  # fmt: skip


def written(folder: Path, **changes: dict[str, Any]) -> Path:
    """The section as a file, with some settings changed."""
    data = {
        key: {**value, **changes.get(key, {})} if isinstance(value, dict) else value for key, value in SECTION.items()
    }
    path = folder / "small.toml"
    path.write_text(tomli_w.dumps(data))
    return path


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which the slide was asked for, and so all before it has run."""
    folder = tmp_path_factory.mktemp("dem")
    assert run("slide", written(folder), "--out", folder / "out", painted=True) == 0
    return folder / "out"


def answer(folder: Path, name: str) -> Any:
    return json.loads((folder / "dem" / name).read_text())


def test_the_model_and_the_bracket(whole: Path) -> None:
    random_packings = answer(whole, "critical.json")
    assert random_packings["model"]["packing"] == "box"
    assert random_packings["model"]["unbalanced_ratio"] < 1e-4
    assert random_packings["model"]["pore_springs"] > 2 * random_packings["model"]["elements"]
    for search in (random_packings["before"], random_packings["after"]):
        assert search["verdict"] == "bracketed"
        assert search["kc_upper"] - search["kc_lower"] <= 0.04 * (1.0 + 1e-9)
        stood = [t["kh"] for t in search["trials"] if t["verdict"] == "stands"]
        failed = [t["kh"] for t in search["trials"] if t["verdict"] == "fails"]
        assert max(stood) == search["kc_lower"] < search["kc_upper"]
        assert search["kc_upper"] in failed
        assert all(t["unbalanced_ratio"] <= 4e-4 for t in search["trials"] if t["verdict"] == "stands")
    assert {(state["set"], state["kh"]) for state in random_packings["states"]} == {("before", 0.1), ("after", 0.1)}
    # after calibration these 200 discs sink to both sides, and a line under a sinking crest is no slip surface
    assert all(len(random_packings["slip_surface"][which]) > 1 for which in ("dem_before", "fem"))


def test_the_calibration_meets_the_continuum_or_says_why_not(whole: Path) -> None:
    random_packings = answer(whole, "calibration.json")
    target = json.loads((whole / "fem/critical.json").read_text())["kc"]
    assert random_packings["target_kc"] == target
    if random_packings["verdict"] == "calibrated":
        assert abs(random_packings["kc"] - target) <= 0.1
    else:
        assert "the discs fail at Kh = " in random_packings["reason"]
    rows = {(row["parameter"], row["value"]) for row in random_packings["sensitivity"]}
    assert rows >= {(p, f) for p in ("stiffness", "friction", "pore_strength") for f in (0.5, 1.0, 2.0)}
    assert any(trial["value"] == random_packings["value"] for trial in random_packings["trials"])


def test_the_slides(whole: Path) -> None:
    cases = answer(whole, "cases.json")["sets"]["calibrated"]
    assert set(cases) == {"1", "2"}
    assert cases["2"]["settlement_uphill_m"] > cases["1"]["settlement_uphill_m"] > 0.0
    assert all(case["escaped"] == 0 for case in cases.values())
    with (whole / "dem/history.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert {(row["set"], row["case"]) for row in rows} == {("calibrated", n) for n in "012"}
    last = [row for row in rows if row["case"] == "2"][-1]
    assert float(last["slide_max_m"]) == pytest.approx(cases["2"]["slide_max_m"], rel=1e-5)
    frames = sorted((whole / "dem/case2").glob("frame_*.vtp"))
    assert len(frames) >= 3
    grid = pv.read(frames[-1])
    assert set(np.unique(grid.point_data["stratum"])) == {-1, 0, 1, 2}
    assert "frame_000.vtp" in (whole / "dem/case2.pvd").read_text()


def test_the_pictures(whole: Path) -> None:
    names = ["dem_model", "dem_before_kh_0.10", "dem_after_kh_0.10", "case1", "case2", "history"]
    for name in names:
        assert imread(whole / "figures" / f"{name}.png").shape[1] == 1600
    with Image.open(whole / "figures/case2.webp") as film:
        assert film.n_frames >= 3


@pytest.mark.slow
def test_the_same_bits_with_any_number_of_workers(whole: Path, tmp_path: Path) -> None:
    assert run("slide", written(tmp_path, dem={"workers": 3}), "--out", tmp_path / "out", tasks="side by side") == 0
    for name in ("calibration.json", "cases.json", "history.csv"):
        assert (tmp_path / "out/dem" / name).read_bytes() == (whole / "dem" / name).read_bytes()


def test_states_are_in_the_order_of_their_numbers(tmp_path: Path) -> None:
    files = [frame_file("case1", k) for k in (0, 7, 101, 999, 1000, 1199)]
    for file in files:
        (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / file).touch()
    assert list(frames(Store(tmp_path), "case1").values()) == files


@pytest.mark.slow
def test_killed_it_goes_on_to_the_same_answer(whole: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    shutil.copytree(whole, out)
    for leftover in [*out.glob("dem/*.json"), *out.glob("dem/case*"), *out.glob("dem/slide*/*")]:
        shutil.rmtree(leftover) if leftover.is_dir() else leftover.unlink(missing_ok=True)
    command = line("slide", written(tmp_path), "--out", out, "--force")
    for seconds in (4.0, 5.0):
        running = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(seconds)
        running.send_signal(signal.SIGKILL)
        running.wait()
    assert run("slide", written(tmp_path), "--out", out) == 0
    for name in ("calibration.json", "cases.json", "history.csv"):
        assert (out / "dem" / name).read_bytes() == (whole / "dem" / name).read_bytes()


def test_a_case_by_number(whole: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shutil.copytree(whole, tmp_path / "out")
    assert run("slide", written(tmp_path), "--out", tmp_path / "out", "--case", 2, "--force") == 0
    assert set(answer(tmp_path / "out", "cases.json")["sets"]["calibrated"]) == {"2"}
    assert run("slide", written(tmp_path), "--out", tmp_path / "out", "--case", 7) == 2


@pytest.mark.slow
def test_element_tests_of_every_layer(tmp_path: Path) -> None:
    changes = {"element_tests": True, "parameter": "friction"}
    assert run("calibrate", written(tmp_path, dem=changes), "--out", tmp_path / "out") == 0
    result = answer(tmp_path / "out", "calibration.json")["element_tests"]
    tests = {(test["stratum"], test["packing"]) for test in result}
    assert tests == {(s["name"], p) for s in SECTION["strata"] for p in ("lattice", "random")}
    assert all(test["assembly"]["E_Pa"] > 0.0 for test in result)


@pytest.mark.slow
def test_out_of_reach_is_no_answer(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    narrow = {"parameter": "pore_strength", "range": [0.9, 1.1], "tolerance": 0.001, "out_of_reach": "stop"}
    assert run("calibrate", written(tmp_path, dem=narrow), "--out", tmp_path / "out") == 3
    output = capsys.readouterr()
    assert "the discs fail at Kh = " in " ".join((output.out + output.err).split())
    assert answer(tmp_path / "out", "calibration.json")["verdict"] == "out of reach"
