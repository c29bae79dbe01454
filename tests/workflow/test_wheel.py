"""What is installed from a wheel is whole: it works without the checkout."""

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from tests.support import TOP

# What a build reads.
SOURCES = ("meshes", "fem", "dem", "workflow", "pyproject.toml", "README.md", "LICENSE")
BUILD = "import sys; from setuptools.build_meta import build_wheel; print(build_wheel(sys.argv[1]))"


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder into which a wheel was unpacked."""
    source, built = tmp_path_factory.mktemp("source"), tmp_path_factory.mktemp("built")
    for name in SOURCES:
        copy = shutil.copytree if (TOP / name).is_dir() else shutil.copy
        copy(TOP / name, source / name)
    subprocess.run([sys.executable, "-c", BUILD, str(built)], cwd=source, capture_output=True, check=True)
    (wheel,) = built.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(built / "site")
    return built / "site"


def test_a_wheel_holds_every_file_of_the_packages(installed: Path) -> None:
    kinds = (".py", ".csv", ".toml", ".jinja", ".js")
    for package in ("meshes", "fem", "dem", "workflow"):
        files = {str(path.relative_to(TOP)) for path in (TOP / package).rglob("*") if path.suffix in kinds}
        assert files <= {str(path.relative_to(installed)) for path in (installed / package).rglob("*")}


def test_a_wheel_checks_a_section_and_plans_a_run(installed: Path, tmp_path: Path) -> None:
    section = str(installed / "meshes/sections/slope_2to1.toml")
    for arguments in (["check", section], ["run", section, "--dry-run"]):
        done = subprocess.run(
            [sys.executable, "-m", "workflow.cli", *arguments],
            cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(installed)}, capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
    assert (tmp_path / "runs/slope_2to1/figures/section.png").is_file()
