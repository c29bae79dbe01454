"""The order of the house: what a kernel may import, and what stands at the top level."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

TOP = Path(__file__).parents[2]

# Kernel modules take and fill flat arrays.
KERNELS = (
    "fem/mohr_coulomb.py",
    "fem/return_mapping.py",
    "fem/viscoplastic.py",
    "fem/assembly.py",
    "fem/condensation.py",
    "dem/contact.py",
    "dem/chunks.py",
    "dem/layout.py",
    "dem/neighbours.py",
    "dem/stepping.py",
    "dem/energy.py",
    "dem/stable_step.py",
    "dem/barrier.py",
    "dem/prefetch.py",
)
# llvmlite is the layer of Numba in which its intrinsics are written.
ALLOWED = {"numpy", "numba", "llvmlite", "math"} | set(sys.stdlib_module_names)
LAYOUT = {
    "pyproject.toml",
    "README.md",
    "Makefile",
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
    found: set[str] = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            package = module.split("/")[0] if node.level else ""
            base = ".".join(part for part in (package, node.module) if part)
            kernels_of_base = {f"{base}.{alias.name}" for alias in node.names}
            found |= kernels_of_base if base in {"fem", "dem"} else {base}
    kernels = {name.removesuffix(".py").replace("/", ".") for name in KERNELS}
    return {name for name in found if name.split(".")[0] not in ALLOWED and name not in kernels}


@pytest.mark.parametrize("kernel", KERNELS)
def test_kernels_import_only_numpy_numba_the_standard_library_and_each_other(kernel: str) -> None:
    assert foreign_imports((TOP / kernel).read_text(encoding="utf-8"), kernel) == set()


@pytest.mark.parametrize(
    ("line", "foreign"),
    [
        ("import numpy as np", set()),
        ("from numba import njit", set()),
        ("from collections.abc import Callable", set()),
        ("from fem.return_mapping import point", set()),
        ("from dem import contact", set()),
        ("from . import mohr_coulomb", set()),
        ("from dem import packing", {"dem.packing"}),
        ("def f():\n    import scipy.optimize", {"scipy.optimize"}),
        ("from meshes.section import Section", {"meshes.section"}),
        ("from . import plane_strain", {"fem.plane_strain"}),
        ("import dolfinx, pint", {"dolfinx", "pint"}),
    ],
)
def test_the_check_itself_sees_every_kind_of_import(line: str, foreign: set[str]) -> None:
    assert foreign_imports(line, "fem/mohr_coulomb.py") == foreign


def test_nothing_else_stands_at_the_top_level() -> None:
    if not (TOP / ".git").exists():
        pytest.skip("not a git checkout")
    listed = subprocess.run(["git", "ls-files"], cwd=TOP, capture_output=True, text=True, check=True).stdout
    entries = {name.split("/")[0] for name in listed.splitlines()}
    assert {entry for entry in entries if not entry.startswith(".")} - LAYOUT == set()
    assert {"pyproject.toml", "README.md", "fem", "dem", "workflow", "meshes", "tests"} <= entries


def test_no_file_of_the_packages_is_longer_than_a_reader_likes() -> None:
    lengths = {path: len(path.read_text(encoding="utf-8").splitlines()) for path in TOP.glob("[a-z]*/*.py")}
    assert {str(path.relative_to(TOP)): count for path, count in lengths.items() if count > 450} == {}
