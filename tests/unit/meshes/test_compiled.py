"""Compiled kernels are those of the sources as they stand; where none can be kept, they are compiled all the same."""

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from meshes.compiled import FORGOTTEN_AFTER, PACKAGES, PREFIX, forget, hash_of_kernels
from tests.support import TOP

# A disc that falls on a spring by the law of a contact, in a kernel that stands in another file than the law.
FALLING = """
from numba import njit
from dem.kernels.contact import spring

@njit(cache=True, error_model="numpy")
def height(steps):
    z, v = 0.5, 0.0
    for _ in range(steps):
        v += 1e-3 * (spring(-z, 1e3, 0.0) - 9.81)
        z += 1e-3 * v
    return z
"""
LAW = "return kn * over if over > -gap else 0.0"
SHOW = "from dem.kernels.falling import height; print(height(600).hex(), len(height.stats.cache_hits))"


def fall(top: Path, **environment: str) -> tuple[str, int]:
    """Height of the disc after 600 steps by the sources in `top`, and how many kernels were found compiled."""
    ran = subprocess.run(
        [sys.executable, "-c", SHOW], cwd=top, env=os.environ | {"PYTHONPATH": str(top)} | environment,
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    height, hits = ran.stdout.split()
    return height, int(hits)


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """The packages that a kernel needs, with a kernel of the test's own."""
    for package in (*PACKAGES, "meshes"):
        shutil.copytree(TOP / package, tmp_path / "top" / package, ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "top" / "dem" / "kernels" / "falling.py").write_text(FALLING)
    return tmp_path / "top"


def change_law(top: Path) -> None:
    contact = top / "dem" / "kernels" / "contact.py"
    text = contact.read_text()
    assert text.count(LAW) == 1
    contact.write_text(text.replace(LAW, "return 2.0 * kn * over if over > -gap else 0.0"))


@pytest.mark.parametrize("variable", ["XDG_CACHE_HOME", pytest.param("NUMBA_CACHE_DIR", marks=pytest.mark.slow)])
def test_a_change_of_the_law_changes_the_motion(copy: Path, tmp_path: Path, variable: str) -> None:
    """What one copy of the program has compiled another one finds, until the law is another."""
    stored = {"NUMBA_CACHE_DIR": "", variable: str(tmp_path / "cache")}
    before, hits = fall(copy, **stored)
    assert hits == 0
    assert fall(shutil.copytree(copy, tmp_path / "elsewhere" / "program"), **stored) == (before, 1)
    change_law(copy)
    after, hits = fall(copy, **stored)
    assert after != before
    assert hits == 0
    assert len(list((tmp_path / "cache").rglob(PREFIX + "*"))) == 2


def test_a_child_takes_the_folder_of_its_own_sources(copy: Path, tmp_path: Path) -> None:
    own_part = tmp_path / "cache" / (PREFIX + "0123456789abcdef")
    fall(copy, NUMBA_CACHE_DIR=str(own_part))
    assert [folder.name for folder in (tmp_path / "cache").iterdir()] == [PREFIX + hash_of_kernels(copy)]


def test_kernels_run_where_nothing_can_be_kept(copy: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no folder")
    (tmp_path / "temporary").mkdir()
    alone = {"NUMBA_CACHE_DIR": str(tmp_path / "file" / "below"), "TMPDIR": str(tmp_path / "temporary")}
    assert fall(copy, **alone)[0] == fall(copy, NUMBA_CACHE_DIR=str(tmp_path / "cache"))[0]
    assert not list((tmp_path / "temporary").iterdir())


def test_every_package_with_kernels_counts() -> None:
    assert sorted(path.parent.name for path in TOP.glob("*/kernels")) == sorted(PACKAGES)


def test_only_folders_long_unused_are_removed(tmp_path: Path) -> None:
    names = ("current", "recent", "old")
    folders = {name: tmp_path / (PREFIX + name) for name in names} | {"foreign": tmp_path / "foreign"}
    for folder in folders.values():
        folder.mkdir()
        (folder / "kernel.nbc").write_bytes(b"")
    then = time.time() - 2.0 * FORGOTTEN_AFTER
    for name in ("current", "old", "foreign"):
        os.utime(folders[name], (then, then))
    forget(tmp_path, folders["current"])
    assert {name for name, folder in folders.items() if folder.exists()} == {"current", "recent", "foreign"}
