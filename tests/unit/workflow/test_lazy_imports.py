"""What a command does not load: so it starts quickly, on any machine."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support import SECTIONS, TOP
from workflow.cli import main

# Prints the packages and modules that are there when a command has ended.
LOOK = """
import json, sys
from workflow.cli import main
try:
    main(sys.argv[1:])
except SystemExit as stop:
    assert not stop.code, stop.code
print(json.dumps(sorted(sys.modules)))
"""
# Each of these takes a tenth of a second or more to load.
COMPUTE = {"numba", "gmsh", "dolfinx", "mpi4py", "scipy", "pyvista", "vtkmodules", "meshio", "clarabel"}
READ = {"pint", "jinja2"}
ANY = {"numpy", "matplotlib", "PIL"}


def loaded(*arguments: object) -> set[str]:
    done = subprocess.run(
        [sys.executable, "-c", LOOK, *map(str, arguments)], cwd=TOP, capture_output=True, text=True, check=True,
        timeout=120,
    )  # fmt: skip
    return set(json.loads(done.stdout.splitlines()[-1]))


@pytest.mark.parametrize("arguments", [["--help"], ["--version"], ["run", "--help"], ["compare", "--help"]])
def test_help_loads_nothing_that_computes_draws_or_reads(arguments: list[str]) -> None:
    there = loaded(*arguments)
    assert there & (COMPUTE | READ | ANY) == set()
    assert "pydantic" not in there or arguments[0] in (
        "run",
        "compare",
    )  # typer itself takes it for a command's options


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["study", "--help"], "the numbers in [uncertain], on all"),
        (["--help"], "the numbers in [uncertain], on all"),
        (["section", "--help"], "[default: the unit stated in the drawing]"),
    ],
)
def test_help_has_its_words_in_brackets(
    arguments: list[str], words: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TERMINAL_WIDTH", "200")
    monkeypatch.setattr("typer.rich_utils.MAX_WIDTH", 200)
    with pytest.raises(SystemExit):
        main(arguments)
    assert words in capsys.readouterr().out


def test_init_loads_nothing_either(tmp_path: Path) -> None:
    assert loaded("init", tmp_path / "s.toml", "--from", "s13") & (COMPUTE | READ | ANY) == set()


def test_a_plan_loads_nothing_that_crashes_on_ctrl_c(tmp_path: Path) -> None:
    """VTK does while it is loaded: so it is loaded where the main thread waits for Ctrl-C, in the work of a stage."""
    there = loaded("run", SECTIONS / "slope_2to1.toml", "--out", tmp_path, "--dry-run")
    assert there & {"pyvista", "vtkmodules", "gmsh", "numba", "matplotlib"} == set()


@pytest.mark.parametrize(
    "section", ["natural_slope", *(pytest.param(name, marks=pytest.mark.slow) for name in ("s13", "slope_2to1"))]
)
def test_check_draws_without_vtk_and_reads_common_units_without_pint(section: str, tmp_path: Path) -> None:
    there = loaded("check", SECTIONS / f"{section}.toml", "--out", tmp_path)
    assert there & (COMPUTE | READ) == set()
    assert there >= {"numpy", "matplotlib"}  # the look itself sees what is there
    assert (tmp_path / "figures/section.png").is_file()
