"""`noshiro bounds` as a person types it."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import tomli_w
from matplotlib.image import imread

from tests.support import SECTIONS
from tests.support.command_line import TOP, run
from tests.support.sections import layer, slope, written

SMALL = ("--max-cells", "400", "--gap", "0.2", "--sides", "fixed")


def test_leaves_the_bracket_how_good_it_is_and_pictures(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    assert run("bounds", written(tmp_path), "--out", out, "--davis", *SMALL, painted=True) == 0
    answer = json.loads((out / "fem/bounds.json").read_text())
    messages = capsys.readouterr().out
    for bracket in (answer, answer["substitute"]):
        assert f"{bracket['lower']:.4f} <= Kh <= {bracket['upper']:.4f}" in messages
    assert 0.0 < answer["lower"] < answer["upper"]
    assert answer["gap"] <= 0.2
    assert answer["verdict"] == "bracketed"
    assert answer["sides"] == "fixed"
    assert answer["substitute"]["upper"] < answer["upper"]
    assert answer["shallow_failures"] == []
    assert answer["residuals"]["lower"]["yield_slack"] >= 0.0
    assert answer["residuals"]["upper"]["flow_slack"] >= 0.0
    assert answer["cells"] == answer["history"][-1]["cells"]
    assert answer["lower"] == max(item["lower"] for item in answer["history"] if item["lower"] is not None)
    for name in ("bounds_mechanism", "bounds_stress", "bounds_mesh"):
        assert imread(out / f"figures/{name}.png").shape[1] == 1600
    assert not [path for path in out.rglob("*/.*") if path.is_file()]


def test_the_factor_of_safety_is_bounded_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """That the factor of the elements lies between them is seen in test_fem_command.py."""
    path, out = written(tmp_path), tmp_path / "out"
    coarse = ("--max-cells", "200", "--gap", "0.3", "--no-davis", "--sides", "fixed")
    assert (
        run("bounds", path, "--out", out, "--safety-factor", "--set", "fem.safety_factor_at=[0.0, 0.2]", *coarse) == 0
    )
    still, seismic = json.loads((out / "fem/bounds.json").read_text())["safety"]
    assert f"{still['lower']:.3f} <= FS <= {still['upper']:.3f} at Kh = 0" in " ".join(capsys.readouterr().out.split())
    assert 1.0 < seismic["lower"] < seismic["upper"] < still["lower"] < still["upper"]


def test_a_section_that_fails_is_told_its_factor(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "weak.toml"
    soil = layer("clay", cohesion="8 kPa", friction_angle="0 deg")
    steep = {"name": "weak", "surface": [[0.0, 0.0], [6.0, 0.0], [12.0, 6.0], [24.0, 6.0]], "base": {"elevation": -2.0}}
    path.write_text(tomli_w.dumps({**steep, "strata": [soil]}))
    assert run("bounds", path, "--out", tmp_path / "out", "--safety-factor", *SMALL) != 0
    assert "<= FS <= 0." in " ".join(capsys.readouterr().err.split())


def test_davis_s_substitute_is_left_out_where_there_is_none(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path)
    assert run("bounds", path, "--out", tmp_path / "not", "--no-davis", *SMALL) == 0
    assert run("bounds", path, "--out", tmp_path / "same", *SMALL) == 0  # where ψ = φ is the flow, nobody asks for it
    for name in ("not", "same"):
        assert json.loads((tmp_path / name / "fem/bounds.json").read_text())["substitute"] is None
    assert "Davis" not in capsys.readouterr().out


def test_grains_that_roll_down_are_told_and_the_slope_as_a_whole_is_bounded(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, out = tmp_path / "bank.toml", tmp_path / "out"
    sand = layer("sand", cohesion=0, friction_angle="35 deg", bottom={"elevation": -2.0})
    bank = {"name": "bank", "surface": [[0.0, 5.0], [10.0, 5.0], [20.0, 0.0], [30.0, 0.0]], "base": {"elevation": -4.0}}
    path.write_text(tomli_w.dumps({**bank, "strata": [sand, layer("clay", cohesion="60 kPa", friction_angle="0 deg")]}))
    assert run("bounds", path, "--out", out, "--no-davis", *SMALL, "--max-cells", "200") == 0
    answer = json.loads((out / "fem/bounds.json").read_text())
    [face] = answer["shallow_failures"]
    assert answer["upper"] > face["kh"] == pytest.approx(0.1482, abs=1e-4)
    text = " ".join(capsys.readouterr().out.split())
    assert 'Shallow failure of the face of "sand" from x = 10 to 20 m at Kh = 0.148' in text
    assert "Bounds of failures below the cohesionless faces (the faces given a cohesion) with ψ = φ" in text
    assert "Strict bounds" not in text  # they are none of the ground as it is given


def test_the_limit_of_cells_ends_with_a_wide_bracket(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    options = ("--max-cells", "150", "--gap", "0.001", "--sides", "fixed")
    assert run("bounds", written(tmp_path), "--out", tmp_path / "out", *options) == 0
    answer = json.loads((tmp_path / "out/fem/bounds.json").read_text())
    assert answer["verdict"] == "wide"
    assert "150 allowed" in answer["reason"]
    assert "150 allowed; the gap is widest near x = " in " ".join(capsys.readouterr().out.split())


def test_settings_stand_in_the_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "slope.toml"
    path.write_text(tomli_w.dumps({**slope(), "bounds": {"gap": 2.0}}))
    assert run("bounds", path, "--out", tmp_path / "out") == 2
    assert "bounds, gap = 2.0" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_ground_that_fails_by_itself_is_no_answer(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path, cohesion="0.1 kPa", friction_angle="0 deg")
    assert run("bounds", path, "--out", tmp_path / "out", *SMALL) == 3
    assert "fails under its own weight" in capsys.readouterr().err


@pytest.mark.slow
def test_ctrl_c_stops_it(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "workflow.cli", "bounds", str(SECTIONS / "s13.toml"), "--gap", "0.0001"]
    done = subprocess.Popen(
        [*command, "--out", str(tmp_path / "out")],
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=TOP,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )  # fmt: skip
    while not (tmp_path / "out/mesh").exists() and not (tmp_path / "out/log.txt").exists():
        assert done.poll() is None
        time.sleep(0.1)
    time.sleep(3.0)  # the bounds take more than twenty seconds
    done.send_signal(signal.SIGINT)
    _, messages = done.communicate(timeout=60)
    assert done.returncode == 130
    assert "Stopped." in messages
    assert not (tmp_path / "out/fem/bounds.json").exists()


def test_it_needs_no_dolfinx() -> None:
    code = (
        "import sys; sys.modules.update(dolfinx=None, petsc4py=None, mpi4py=None); "
        "import fem.limit.bounds, workflow.figures.bounds, workflow.stages"
    )
    subprocess.run([sys.executable, "-c", code], cwd=TOP, check=True, timeout=120)
