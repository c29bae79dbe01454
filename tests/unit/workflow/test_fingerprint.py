"""The fingerprint of the program: any of its sources decides, and what is the user's does not."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support import TOP
from workflow.run.fingerprint import PACKAGES

# Prints the fingerprint of the program as it stands, and after a change of each file.
LOOK = """
import json, sys
from pathlib import Path
from workflow.run.fingerprint import program

def changed(name):
    program.cache_clear()
    file = Path(name)
    before = file.read_bytes()
    file.write_bytes(before + b"\\n# changed")
    found = program()
    file.write_bytes(before)
    return found

before = program()
print(json.dumps([name for name in sys.argv[1:] if changed(name) != before]))
"""
SOURCES = (
    "meshes/section/layering.py", "fem/kernels/return_mapping.py", "dem/table2_dem.csv", "workflow/figures/canvas.py",
    "workflow/report/template.html.jinja",
)  # fmt: skip
OTHERS = ("meshes/sections/s13.toml", "workflow/cli/example.toml")


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The program by itself."""
    folder = tmp_path_factory.mktemp("copy")
    for package in PACKAGES:
        shutil.copytree(TOP / package, folder / package, ignore=shutil.ignore_patterns("__pycache__"))
    return folder


def test_a_change_of_any_source_is_one_of_the_program_and_of_a_section_none(copy: Path) -> None:
    line = [sys.executable, "-c", LOOK, *SOURCES, *OTHERS]
    done = subprocess.run(line, cwd=copy, capture_output=True, text=True, check=True, env={"PYTHONPATH": str(copy)})
    assert json.loads(done.stdout) == list(SOURCES)
