"""The order of the house: what a kernel may import, and what stands at the top level."""

import ast
import re
import shutil
import subprocess
import sys
from graphlib import TopologicalSorter
from pathlib import Path

import grimp
import pytest

from tests.support import TOP

# Kernel modules take and fill flat arrays.
KERNELS = sorted(str(path.relative_to(TOP)) for path in TOP.glob("*/kernels/*.py"))
PACKAGES = ("meshes", "fem", "dem", "workflow")
# llvmlite is the layer of Numba in which its intrinsics are written.
ALLOWED = {"numpy", "numba", "llvmlite", "math"} | set(sys.stdlib_module_names)
SOURCES = {
    str(path.relative_to(TOP)): path.read_text(encoding="utf-8")
    for package in PACKAGES
    for path in sorted((TOP / package).rglob("*.py"))
}
LONGEST_FILE = 400
LAYOUT = {
    "pyproject.toml",
    "README.md",
    "Makefile",
    "docs",
    "LICENSE",
    "CITATION.cff",
    "fem",
    "dem",
    "workflow",
    "meshes",
    "tests",
}


def foreign_imports(source: str, module: str) -> set[str]:
    """Modules that a kernel's source imports and may not."""
    room = ".".join(module.split("/")[:-1])
    result: set[str] = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            result |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{module}: write the import in full"
            inside = {f"{node.module}.{alias.name}" for alias in node.names}
            result |= inside if node.module in PACKAGES else {str(node.module)}
    return {name for name in result if name.split(".")[0] not in ALLOWED and f"{name}.".find(f"{room}.") != 0}


@pytest.mark.parametrize("kernel", KERNELS)
def test_kernels_import_only_numpy_numba_the_standard_library_and_each_other(kernel: str) -> None:
    assert foreign_imports((TOP / kernel).read_text(encoding="utf-8"), kernel) == set()


@pytest.mark.parametrize(
    ("line", "foreign"),
    [
        ("import numpy as np", set()),
        ("from numba import njit", set()),
        ("from collections.abc import Callable", set()),
        ("from fem.kernels.return_mapping import point", set()),
        ("from fem.kernels import mohr_coulomb", set()),
        ("from dem.kernels import contact", {"dem.kernels"}),
        ("from fem import plane_strain", {"fem.plane_strain"}),
        ("from fem.continuum.loads import DOWNHILL", {"fem.continuum.loads"}),
        ("def f():\n    import scipy.optimize", {"scipy.optimize"}),
        ("from meshes.section.section import Section", {"meshes.section.section"}),
        ("import dolfinx, pint", {"dolfinx", "pint"}),
    ],
)
def test_the_check_itself_sees_every_kind_of_import(line: str, foreign: set[str]) -> None:
    assert foreign_imports(line, "fem/kernels/mohr_coulomb.py") == foreign


# Imports that must not be, and the contract in pyproject.toml that each breaks.
BREACHES = [
    ("fem/continuum/loads.py", "import dem.springs", "Data flows one way"),
    ("meshes/triangles.py", "import workflow.config", "Data flows one way"),
    ("dem/springs.py", "def f():\n    import dem.ground", "in no circle"),
    ("workflow/run/store.py", "import workflow.run.log", "in no circle"),
    ("dem/kernels/contact.py", "from meshes import errors", "Kernels know"),
    ("fem/kernels/mohr_coulomb.py", "import workflow.config", "Kernels know"),
    ("dem/kernels/contact.py", "import dem.engine.engine", "The rooms of the discs"),
    ("fem/limit/bounds.py", "import fem.continuum.discretisation", "Limit analysis does without dolfinx"),
    ("fem/continuum/loads.py", "import fem.limit.bounds", "do without limit analysis"),
    ("dem/engine/engine.py", "import dem.search.critical", "The rooms of the discs"),
    ("meshes/borings/log.py", "import meshes.drawings.shapes", "The rooms of the meshes"),
    ("workflow/run/plan.py", "import workflow.stages", "The floors of the workflow"),
    ("workflow/attic.py", "", "The floors of the workflow"),
]
LINT = """
import sys
from importlinter.cli import lint_imports
for number in range(0, len(sys.argv) - 1, 2):
    name, line = sys.argv[1 + number : 3 + number]
    with open(name, "a+b") as file:
        before = file.tell()
        file.write(b"\\n" + line.encode())
        file.flush()
        print("BREACH", flush=True)
        lint_imports(no_cache=True)
        file.truncate(before)
"""


def test_every_contract_breaks_where_it_should(tmp_path: Path) -> None:
    for name in (*PACKAGES, "pyproject.toml"):
        copy = shutil.copytree if (TOP / name).is_dir() else shutil.copy
        copy(TOP / name, tmp_path / name)
    breaches = [word for name, line, _ in BREACHES for word in (name, line)]
    done = subprocess.run(
        [sys.executable, "-c", LINT, "pyproject.toml", "", *breaches], cwd=tmp_path, capture_output=True, text=True,
        check=True, env={"PYTHONPATH": str(tmp_path)},
    )  # fmt: skip
    stored, *result = done.stdout.split("BREACH")[1:]
    assert "BROKEN" not in stored
    for (name, line, contract), item in zip(BREACHES, result, strict=True):
        assert re.search(rf"{contract}[^\n]*(\n[^\n]*)?BROKEN", item), (name, line, item)


def test_nothing_else_stands_at_the_top_level() -> None:
    if not (TOP / ".git").exists():
        pytest.skip("not a git checkout")
    listed = subprocess.run(["git", "ls-files"], cwd=TOP, capture_output=True, text=True, check=True).stdout
    entries = {name.split("/")[0] for name in listed.splitlines()}
    assert {entry for entry in entries if not entry.startswith(".")} - LAYOUT == set()
    assert {"pyproject.toml", "README.md", "fem", "dem", "workflow", "meshes", "tests"} <= entries


def test_no_file_of_the_packages_is_longer_than_a_reader_likes() -> None:
    lengths = {name: len(text.splitlines()) for name, text in SOURCES.items()}
    assert {name: length for name, length in lengths.items() if length > LONGEST_FILE} == {}


def test_no_file_imports_another_in_a_circle() -> None:
    graph = grimp.build_graph(*PACKAGES, cache_dir=None)
    imported = {module: graph.find_modules_directly_imported_by(module) for module in graph.modules}
    list(TopologicalSorter(imported).static_order())  # raises CycleError, which names the circle


def test_every_room_says_what_it_is_for() -> None:
    rooms = {path.parent / "__init__.py" for package in PACKAGES for path in (TOP / package).rglob("*.py")}
    silent = [room for room in rooms if not ast.get_docstring(ast.parse(room.read_text(encoding="utf-8")))]
    assert silent == []


def test_no_two_classes_have_one_name() -> None:
    files: dict[str, list[str]] = {}
    for name, text in SOURCES.items():
        for node in ast.parse(text).body:
            if isinstance(node, ast.ClassDef):
                files.setdefault(node.name, []).append(name)
    assert {name: places for name, places in files.items() if len(places) > 1} == {}
