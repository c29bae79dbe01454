"""The command as a person types it: what it leaves behind, its exit codes, and that no traceback is ever shown."""

import os
import re
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import meshio
import numpy as np
import pytest
import pyvista as pv
import tomli_w
from matplotlib.image import imread

from meshes.quad_mesh import BadMeshError, QuadMesh, read
from meshes.section.section import Section
from meshes.settings import MeshSettings
from tests.support import SECTIONS
from tests.support.borings import bored
from tests.support.command_line import process, run
from tests.support.sections import layer, slope
from workflow.config import Config
from workflow.figures import canvas, colours, ground

FOLDER = SECTIONS
S13 = FOLDER / "s13.toml"
LEFT_BEHIND = [
    "figures/mesh.png",
    "figures/section.png",
    "figures/weights.png",
    "mesh/section.msh",
    "mesh/section.vtu",
    "section.toml",
]


def files(folder: Path) -> list[str]:
    """All files but the log and what is known of the stages."""
    result = {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}
    return sorted(result - {"log.txt", ".noshiro/lock", ".noshiro/stages.json"})


@pytest.fixture
def section(tmp_path: Path) -> Path:
    path = tmp_path / "slope.toml"
    path.write_text(tomli_w.dumps(slope()))
    return path


@pytest.fixture
def out(tmp_path: Path) -> Path:
    return tmp_path / "out"


# --- What it leaves behind ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("command", [("mesh",), ("run", "--only", "mesh")])
def test_s13(command: tuple[str, ...], out: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(*command, S13, "--out", out) == 0
    assert set(LEFT_BEHIND) <= set(files(out))
    output = capsys.readouterr()
    assert "611 quadrilaterals, 672 nodes (mapped)" in output.out
    assert "Smallest scaled Jacobian 0.999" in " ".join(output.out.split())
    assert command[0] == "run" or "Reconstruction." in output.out  # a run says so in its report
    assert re.fullmatch(r"mesh: done in [\d.]+ s\n", output.err)
    note = Section.read(S13).reconstruction_note
    assert note in (out / "mesh/section.msh").read_text(encoding="utf-8")
    assert note in (out / "section.toml").read_text(encoding="utf-8")
    grid = pv.read(out / "mesh/section.vtu")
    assert grid.n_cells == 611
    assert list(grid.field_data["strata"]) == list(read(out / "mesh/section.msh").strata)
    assert list(grid.field_data["reconstruction"]) == [note]
    assert list(grid.field_data["section"]) == ["Section S-13, Noshiro city, 1983"]
    np.testing.assert_array_equal(np.unique(grid.cell_data["stratum"]), range(10))


def test_the_input_as_used(section: Path, out: Path) -> None:
    assert run("mesh", section, "--out", out, "--size", "2 m") == 0
    text = (out / "section.toml").read_text(encoding="utf-8")
    for default in (
        'flow = "auto"',
        "liquefies_in = []",
        "reconstruction = false",
        'method = "auto"',
        "refine = 1",
    ):
        assert default in text
    used = Config.load(out / "section.toml")
    assert used == Config.load(section, {"mesh": {"size": "2 m"}})
    assert used.to_toml() == text
    assert run("mesh", out / "section.toml", "--out", out) == 0
    assert (out / "section.toml").read_text(encoding="utf-8") == text


def test_check_only_draws(section: Path, out: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("check", section, "--out", out) == 0
    assert files(out) == ["figures/section.png"]
    assert "The section is sound" in capsys.readouterr().out


def test_check_draws_the_borings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """To their deepest blow count, 8 and 10 m below the ground."""
    marked: list[tuple[str, float, float]] = []
    monkeypatch.setattr(ground, "mark_borings", lambda axes, section, borings: marked.extend(borings))
    path = tmp_path / "bored.toml"
    path.write_text(tomli_w.dumps(bored()))
    assert run("check", path, "--out", tmp_path / "out") == 0
    assert set(marked) == {("B-1", 20.0, 8.0), ("B-2", 80.0, 10.0)}


def test_the_default_folder(section: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert run("check", section) == 0
    assert files(tmp_path / "runs") == ["slope/figures/section.png"]


@pytest.mark.parametrize("file", sorted(FOLDER.glob("*.toml")), ids=lambda path: path.stem)
def test_every_shipped_section(file: Path, out: Path) -> None:
    assert run("mesh", file, "--out", out) == 0
    assert files(out) == LEFT_BEHIND


@pytest.mark.parametrize(
    ("options", "method", "cells"),
    [
        (["--refine", 2], "mapped", 4 * 611),
        (["--columns", 20], "mapped", 20 * 13),
        (["--rows", 26], "mapped", 47 * 26),
        (["--size", 1.5], "mapped", 133 * 21),  # 200 m and 31.5 m over 1.5 m
        (["--size", "2 m", "--free"], "free", None),
        (["--free"], "free", None),
    ],
)
def test_options_stand_above_the_file(
    options: list[object], method: str, cells: int | None, out: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("mesh", S13, "--out", out, *options) == 0
    assert f"({method})" in capsys.readouterr().out
    mesh = read(out / "mesh/section.msh")
    assert cells is None or len(mesh.cells) == cells
    if "2 m" in options:
        assert 1.0 < len(mesh.cells) / (200 * 31.5 / 4) < 1.4  # some layers are thinner than 2 m


def test_pictures_of_any_proportions(tmp_path: Path) -> None:
    """Nothing but text and frame outside the axes, a second view where the first is too flat to read."""
    heights = {}
    for name, width, height in (("tall", 10.0, 300.0), ("square", 50.0, 50.0), ("flat", 2000.0, 20.0)):
        data = {**slope(), "name": name, "surface": [[0.0, height], [width, height]]}
        (tmp_path / f"{name}.toml").write_text(tomli_w.dumps(data))
        assert run("check", tmp_path / f"{name}.toml", "--out", tmp_path / name, painted=True) == 0
        image = imread(tmp_path / name / "figures/section.png")
        assert image.shape[1] == canvas.WIDTH
        heights[name] = image.shape[0]
    assert heights["tall"] < 1500
    assert 350 < heights["flat"] < heights["square"]


@pytest.mark.parametrize(
    ("width", "height", "views"),
    [(200.0, 40.0, [1]), (2000.0, 20.0, [1, 10]), (1000.0, 1.0, [1, 100]), (5.0, 90.0, [1])],
)
def test_flat_sections_are_drawn_twice(width: float, height: float, views: list[int]) -> None:
    window = canvas.Window.around(np.array([[0.0, 0.0], [width, height]]))
    assert window.exaggerations() == views


def test_many_long_names_in_any_script(out: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    names = [f"{k} a layer with a rather long name" for k in range(14)] + ["$x_{", "_hidden", "4 シルト"]
    strata = [layer(name, description="and more " * 20, bottom={"depth": k / 2 + 0.5}) for k, name in enumerate(names)]
    data = {**slope(), "title": "能代 $\\frac{ [bold]", "strata": [*strata, layer("last")]}
    data |= {"reconstruction": True, "reconstruction_note": "推定。\nTwo lines, \\frac{$ and é."}
    (tmp_path / "many.toml").write_text(tomli_w.dumps(data), encoding="utf-8")
    assert run("mesh", tmp_path / "many.toml", "--out", out) == 0
    assert re.fullmatch(r"mesh: done in [\d.]+ s\n", capfd.readouterr().err)
    assert list(pv.read(out / "mesh/section.vtu").field_data["strata"]) == [*names, "last"]
    assert len({colours.soil_colour(k) for k in range(24)}) == 24


# --- Bad input ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--size", "inf"], "mesh, size = inf: not a finite number"),
        (["--size", "-1"], "mesh, size = -1.0: out of range"),
        (["--size", "abc"], "mesh, size = 'abc': not understood"),
        (["--size", "3 kPa"], "mesh, size = '3 kPa': has the wrong dimension"),
        (["--size", "1e-9"], "quadrilaterals; expected at most 5,000,000"),
        (["--size", "1e-9", "--free"], "quadrilaterals; expected at most 5,000,000"),
        (["--size", "1e6"], "mesh, size = 1e+06 m: expected at most the section's own size"),
        (["--size", "0.3", "--refine", "64"], "quadrilaterals; expected at most 5,000,000"),
        (["--refine", "0"], "mesh, refine = 0"),
        (["--refine", "65"], "mesh, refine = 65"),
        (["--refine", "two"], "Invalid value for '--refine'"),
        (["--columns", "0"], "mesh, columns = 0"),
        (["--free", "--columns", "5"], "mesh, columns and rows: expected none"),
        (["--fre"], "No such option: --fre"),
    ],
)
def test_options_that_are_refused(
    options: list[str], said: str, section: Path, out: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("mesh", section, "--out", out, *options) == 2
    assert said in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.parametrize("command", ["mesh", "check", "run"])
@pytest.mark.parametrize(
    ("content", "said"),
    [
        (None, "there is no such file"),
        ("", "name: missing"),
        ("name = ", "is not TOML"),
        (tomli_w.dumps({**slope(), "mesh": "free"}), "mesh = 'free': expected a table [mesh]"),
        (tomli_w.dumps({**slope(), "mesh": {"methd": "free"}}), 'mesh, methd: unknown key; did you mean "method"?'),
        (tomli_w.dumps({**slope(), "mesh": {"sizes": {"clay": 1.0}}}), 'mesh, sizes: there is no "clay"'),
    ],
)
def test_files_that_are_refused(
    command: str, content: str | None, said: str, tmp_path: Path, out: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "a.toml"
    if content is not None:
        path.write_text(content)
    assert run(command, path, "--out", out) == 2
    output = capsys.readouterr()
    assert said in output.err
    assert output.err.startswith(f"{path}: ")
    assert output.out == ""
    assert not out.exists()


def test_bad_settings_are_told_with_the_rest(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    data = {**slope(), "mesh": {"method": "triangles", "refine": -1}, "base": {"elevation": 12.0}}
    (tmp_path / "a.toml").write_text(tomli_w.dumps(data))
    assert run("mesh", tmp_path / "a.toml") == 2
    err = capsys.readouterr().err
    assert all(part in err for part in ("mesh, method = 'triangles'", "mesh, refine = -1", "rises above the ground"))


def test_no_usable_mesh_is_another_exit_code(
    section: Path, out: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> QuadMesh:
        raise BadMeshError("3 cells are folded")

    monkeypatch.setattr("meshes.gmsh_model.generate", fail)
    assert run("mesh", section, "--out", out) == 3
    assert "No usable mesh: 3 cells are folded" in capsys.readouterr().err
    assert files(out) == []


# --- Failures while it runs ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "kilobytes",
    [4, *(pytest.param(size, marks=pytest.mark.slow) for size in (1, 12, 30))],
)
def test_a_full_disk_leaves_nothing_half_written(kilobytes: int, section: Path, out: Path) -> None:
    """No file may become larger than so many kilobytes: each file is then there whole, or not at all."""

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (1024 * kilobytes, 1024 * kilobytes))

    assert run("mesh", section, "--out", out.with_name("whole"), painted=True) == 0
    done = process("mesh", section, "--out", out, before=limit)
    assert done.returncode == 2
    assert "cannot be written" in done.stderr
    assert "Traceback" not in done.stderr
    assert set(files(out)) < set(LEFT_BEHIND)
    for name in files(out):
        assert (out / name).read_bytes() == (out.with_name("whole") / name).read_bytes()


@pytest.mark.parametrize("place", ["a file", "below a file", "device"])
def test_a_folder_that_cannot_be_made(
    place: str, section: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("precious")
    out = {"a file": tmp_path / "file", "below a file": tmp_path / "file/x", "device": Path("/dev/null/x")}[place]
    words = "is a file; expected a folder" if place == "a file" else "cannot be written: Not a directory"
    for name in ("mesh", "check"):
        assert run(name, section, "--out", out) == 2
        assert words in " ".join(capsys.readouterr().err.split())
    assert (tmp_path / "file").read_text() == "precious"


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_a_read_only_folder(section: Path, out: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (out / "mesh").mkdir(parents=True)
    (out / "mesh").chmod(0o500)
    assert run("mesh", section, "--out", out) == 2
    assert "cannot be written: Permission denied" in capsys.readouterr().err


def test_a_failure_keeps_what_was_there(section: Path, out: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert run("mesh", section, "--out", out) == 0
    before = {name: (out / name).read_bytes() for name in LEFT_BEHIND}

    def fail(*_: object, **_options: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("workflow.figures.canvas.Drawing.save", fail)
    assert run("mesh", section, "--out", out, "--force") == 2
    assert {name: (out / name).read_bytes() for name in files(out)} == before


def test_ctrl_c(section: Path, out: Path) -> None:
    line = [sys.executable, "-m", "workflow.cli", "mesh", str(section), "--out", str(out), "--free", "--size", "0.05"]
    process = subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout is not None
    process.stdout.readline()  # what it says before it meshes for a minute
    time.sleep(0.3)
    process.send_signal(signal.SIGINT)
    _, messages = process.communicate(timeout=60)
    assert process.returncode == 130, messages
    assert messages == "Stopped. Finished results are kept; the same command continues.\n"
    assert files(out) == []


def test_sections_and_meshes_do_without_the_solver() -> None:
    """PETSc takes a third of a second to load and is not everywhere; MPI changes what Ctrl-C and limits do."""
    line = (
        "import sys, workflow.cli; sys.exit(' '.join(m for m in ('petsc4py.PETSc', 'mpi4py.MPI') if m in sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", line], capture_output=True, text=True, timeout=60, check=False)
    assert done.stderr.strip() == ""


def test_without_a_command_it_says_what_there_is(capsys: pytest.CaptureFixture[str]) -> None:
    assert run() == 2
    output = capsys.readouterr()
    assert all(name in output.out + output.err for name in ("check", "mesh", "run"))


def test_meshio_reads_the_mesh_of_a_run(section: Path, out: Path) -> None:
    assert run("mesh", section, "--out", out) == 0
    raw = meshio.read(out / "mesh/section.msh")
    assert {"upper", "lower", "surface", "base", "left", "right"} == set(raw.field_data)


def test_defaults_of_the_settings() -> None:
    chosen = MeshSettings()
    assert (chosen.method, chosen.refine, chosen.size) == ("auto", 1, None)
