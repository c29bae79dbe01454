"""`noshiro fem` as a person types it: what it leaves behind, what it refuses, and that it runs under mpirun."""

import builtins
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import pyvista as pv
import tomli_w
from matplotlib.image import imread

from tests.support import TOP
from tests.support.command_line import run
from tests.support.sections import layer, slope, written

SMALL = ("--element", "bilinear", "--size", "3 m", "--set", "fem.accuracy=0")
ONE_PATH = ("--direction", "downhill", "--set", "fem.rigid_box=false")
# Two steps, in the second of which a part of the ground yields: processes that have to share a core wait a few
# milliseconds for each message, and a path to the plateau has ten times as many.
SHORT_PATH = (*ONE_PATH, "--set", "fem.first_step=0.1", "--set", "fem.kh_limit=0.1", "--kh", "0.1")


@pytest.fixture(scope="module")
def short_path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the section and, in `out`, its answer for one direction, up to a limit of Kh."""
    folder = tmp_path_factory.mktemp("short_path")
    assert run("fem", written(folder), "--out", folder / "out", *SHORT_PATH, *SMALL) == 0
    return folder


def test_leaves_the_answer_its_path_fields_and_pictures(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    assert run("fem", written(tmp_path), "--out", out, "--kh", "0.1", "--kh", "5.0", *SMALL, painted=True) == 0
    messages = capsys.readouterr().out
    answer = json.loads((out / "fem/critical.json").read_text())
    assert f"Critical Kh = {answer['kc']:.3f}" in messages
    assert answer["verdict"] in ("plateau", "peak")
    assert 0.1 < answer["kc"] == answer["kc_lower"] <= answer["kc_upper"] < 5.0
    assert answer["kc"] <= max(step["factor"] for step in answer["curve"]) <= answer["kc_upper"]
    tolerance = answer["settings"]["tolerance"]
    assert all(step["residual"] <= tolerance for step in answer["curve"])
    past = {state["kh"]: state["past_equilibrium"] for state in answer["states"]}
    assert past[0.1] is False
    assert past[5.0] is True

    collection = pv.PVDReader(str(out / "fem/fields.pvd"))
    assert collection.time_values[0] == 0.1
    assert all(time < 5.0 for time in collection.time_values)
    fields = collection.read()[0]
    assert set(fields.cell_data) >= {"stratum", "mobilised_strength", "stress_xx_yy_zz_xy_Pa", "plastic_shear_strain"}
    assert "displacement_m" in fields.point_data
    for name in ("fem_kh_0.100", "fem_kh_5.000", "fem_plateau", "fem_curve"):
        assert imread(out / f"figures/{name}.png").shape[1] == 1600
    assert [path.name for path in out.rglob(".*")] == [".noshiro"]


def test_factors_of_safety_fall_with_kh_and_pass_one_at_the_critical_kh(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    options = ("--kh", "0.1", "--associated", "--safety-factor", "--sides", "fixed", "--set", "bounds.max_cells=200")
    assert run("fem", written(tmp_path), "--out", out, *options, *ONE_PATH, *SMALL) == 0
    answer = json.loads((out / "fem/critical.json").read_text())
    still, seismic = answer["safety_factors"]
    assert still["kh"] == 0.0
    assert still["factor"] > seismic["factor"] > 1.0
    assert answer["kc"] > 0.1
    said = capsys.readouterr().out
    for factor in (still, seismic):
        assert factor["verdict"] == "plateau"
        assert len(factor["slip_surface"]) > 5
        assert f"{factor['factor']:.3f} with ψ = φ; Davis's estimate for ψ = 0" in " ".join(said.split())
        assert 1.0 < factor["davis"] < factor["factor"]
    assert said.count("The ground slips from x =") == 3  # that of the critical Kh, too
    assert imread(out / "figures/fem_safety.png").shape[1] == 1600
    strict = json.loads((out / "fem/bounds.json").read_text())["safety"]
    assert [part["kh"] for part in strict] == [0.0, 0.1]
    for part, factor in zip(strict, (still, seismic), strict=True):
        assert 0.99 * part["lower"] < factor["factor"] < 1.1 * part["upper"]  # a coarse mesh that is not adapted


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--sides", "loose"), "fem, sides = 'loose'"),
        (("--element", "cubic"), "fem, element = 'cubic'"),
        (("--vertical", "2"), "fem, vertical = 2.0"),
        (("--kh", "nan"), "fem, kh"),
        (("--sides", "periodic"), 'sides = "periodic": the left and right sides differ'),
    ],
)
def test_settings_that_cannot_be(
    arguments: tuple[str, ...], words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("fem", written(tmp_path), "--out", tmp_path / "out", *SMALL, *arguments) == 2
    assert words in capsys.readouterr().err


def test_a_stratum_without_strength_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path, cohesion=0.0, friction_angle="0 deg")
    assert run("fem", path, "--out", tmp_path / "out", *SMALL) == 2
    assert "cohesion and friction angle are both 0" in capsys.readouterr().err


def test_ground_that_fails_by_itself_is_no_answer(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path, cohesion="0.1 kPa", friction_angle="0 deg")
    assert run("fem", path, "--out", tmp_path / "out", *SMALL) == 3
    assert "fails under its own weight" in capsys.readouterr().err


def test_ground_that_stands_only_as_it_dilates_is_told_by_both_factors(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Sand of φ = 26.6° at 26.6°, failures from half a metre of depth on; Davis's φ for ψ = 0 is 24.1°, with a tangent
    0.894 times as large."""
    data = slope()
    data["surface"] = [[0.0, 20.0], [20.0, 20.0], [40.0, 10.0], [100.0, 10.0]]
    data["strata"] = [layer("sand", cohesion=0.0, friction_angle="26.6 deg", dilation_angle=0.0)]
    (tmp_path / "sand.toml").write_text(tomli_w.dumps(data))
    assert (
        run("fem", tmp_path / "sand.toml", "--out", tmp_path / "out", "--size", "3 m", "--set", "fem.accuracy=0") == 3
    )
    text = " ".join(capsys.readouterr().err.split())
    factors = re.search(
        r"safety is ([\d.]+) by Davis's estimate for ψ = 0, and ([\d.]+) with ψ = φ; the ground slips .*; with fem",
        text,
    )
    assert factors is not None
    assert float(factors[1]) == pytest.approx(0.894 * float(factors[2]), abs=0.01)
    assert float(factors[1]) < 1.0 < float(factors[2])


def test_without_dolfinx_it_says_how_to_get_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    ordinary = builtins.__import__

    def importing(name: str, *more: Any, **rest: Any) -> Any:
        if name.split(".")[0] == "dolfinx":
            raise ImportError("No module named 'dolfinx'")
        return ordinary(name, *more, **rest)

    monkeypatch.setattr(builtins, "__import__", importing)
    assert run("fem", written(tmp_path), "--out", tmp_path / "out", *SMALL) == 2
    err = capsys.readouterr().err
    assert "apt-get install python3-dolfinx" in err
    assert "conda install" in err


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("mpirun") is None, reason="there is no mpirun")
def test_two_processes_find_the_same_and_one_writes(short_path: Path, tmp_path: Path) -> None:
    """As they do up to the plateau on S-13: tests/verification/fem/test_s13.py."""
    outs = (short_path / "out", tmp_path / "two")
    # This process is an MPI program of its own by now, and mpirun would take its variables for its parent's.
    outside_mpi = {key: value for key, value in os.environ.items() if not key.startswith(("OMPI_", "PMIX_"))}
    outside_mpi["OMPI_MCA_mpi_yield_when_idle"] = "1"  # where both share a core, one that waits lets the other compute
    outside_mpi["OMP_NUM_THREADS"] = "1"
    done = subprocess.run(
        ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", "2", sys.executable, "-m", "workflow.cli", "fem",
         str(short_path / "slope.toml"), "--out", str(outs[1]), *SHORT_PATH, *SMALL],
        capture_output=True, text=True, timeout=600, stdin=subprocess.DEVNULL, check=True, cwd=TOP, env=outside_mpi,
    )  # fmt: skip
    assert done.stdout.count("Critical Kh") == 1
    alone, two = (json.loads((out / "fem/critical.json").read_text()) for out in outs)
    assert two["kc"] == pytest.approx(alone["kc"], rel=1e-9)
    assert len(two["curve"]) == len(alone["curve"]) >= 2
    for item, other in zip(two["curve"], alone["curve"], strict=True):
        for quantity in ("factor", "displacement", "plastic_share"):
            assert item[quantity] == pytest.approx(other[quantity], rel=1e-9), quantity
    assert two["curve"][-1]["plastic_share"] > 0.2


def test_a_mesh_made_elsewhere_gives_the_same_answer(short_path: Path, tmp_path: Path) -> None:
    config = short_path / "out/mesh/section.msh"
    options = (*SHORT_PATH, "--element", "bilinear", "--mesh", config)
    assert run("fem", short_path / "slope.toml", "--out", tmp_path / "given", *options) == 0
    of_stage, other = (
        json.loads((out / "fem/critical.json").read_text()) for out in (short_path / "out", tmp_path / "given")
    )
    assert other["mesh"]["method"] == "given"
    assert other["kc"] == pytest.approx(of_stage["kc"], rel=1e-9)


def test_a_mesh_without_the_groups_of_the_section_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path)
    assert run("mesh", path, "--out", tmp_path / "own") == 0
    renamed = tmp_path / "other.msh"
    renamed.write_text((tmp_path / "own/mesh/section.msh").read_text().replace('"upper"', '"top"'))
    capsys.readouterr()
    assert run("fem", path, "--out", tmp_path / "out", "--mesh", renamed) == 2
    err = capsys.readouterr().err
    assert 'there is no surface group "upper"' in err
    assert 'the surface group "top" is no stratum' in err
