"""What a stage's code is, found in a copy of the program that is changed here and there."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support import TOP
from workflow.run.source import DATA, PACKAGES, closure

# Prints the fingerprints of all stages as the program stands, and again after each change of a file.
LOOK = """
import json, sys
from pathlib import Path
from workflow.run import fingerprint, source
from meshes import shipped
from workflow.settings import Input
from workflow.stages import STAGES

GIVEN = Input.load(shipped.file_of("s13"))

def look():
    source.imports.cache_clear()
    source.fingerprint.cache_clear()
    return {stage.name: [fingerprint.program(stage), fingerprint.drawing(stage, GIVEN)] for stage in STAGES}

found = {"": look()}
for name in sys.argv[1:]:
    file = Path(name)
    before = file.read_bytes()
    file.write_bytes(before + b"\\n# changed")
    found[name] = look()
    file.write_bytes(before)
print(json.dumps(found))
"""

# A file that is changed, the stages that compute again, and those that only draw again.
CHANGES = {
    "meshes/section/layering.py": ("triggering response mesh fem variants bounds liquefied mpm calibrate slide", ""),
    "fem/kernels/return_mapping.py": ("fem variants liquefied mpm calibrate", ""),
    "fem/solvers/cone_program.py": ("fem variants bounds liquefied mpm calibrate", ""),
    "dem/kernels/contact.py": ("mpm calibrate slide", ""),
    "dem/table2_dem.csv": ("mpm calibrate slide", ""),
    "dem/slides/liquefaction.py": ("slide", ""),
    "workflow/stages/random_packings.py": ("slide", ""),
    "workflow/results/journal.py": ("calibrate slide", ""),
    "workflow/figures/bounds.py": ("bounds", ""),  # its pictures cannot be drawn without computing
    "workflow/figures/discs.py": ("", "calibrate slide"),
    "workflow/figures/canvas.py": ("bounds", "triggering response mesh fem mpm calibrate slide"),
    "workflow/report/template.html.jinja": ("", ""),
    "workflow/example.toml": ("", ""),
    "workflow/cli.py": ("", ""),
    "meshes/sections/s13.toml": ("", ""),
}


@pytest.fixture(scope="module")
def looks(tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[str, list[str]]]:
    """The fingerprints of every stage's results and pictures, by the file that was changed."""
    folder = tmp_path_factory.mktemp("copy")
    for package in PACKAGES:
        shutil.copytree(TOP / package, folder / package, ignore=shutil.ignore_patterns("__pycache__"))
    line = [sys.executable, "-c", LOOK, *CHANGES]
    done = subprocess.run(line, cwd=folder, capture_output=True, text=True, check=True, env={"PYTHONPATH": str(folder)})
    found: dict[str, dict[str, list[str]]] = json.loads(done.stdout)
    return found


@pytest.mark.parametrize("file", CHANGES)
def test_a_change_is_one_for_the_stages_whose_code_it_is(file: str, looks: dict[str, dict[str, list[str]]]) -> None:
    before, after = looks[""], looks[file]
    stages = [name for name in before if name != "report"]
    runs = [name for name in stages if after[name][0] != before[name][0]]
    draws = [name for name in stages if after[name][1] != before[name][1] and name not in runs]
    assert (" ".join(runs), " ".join(draws)) == CHANGES[file]


def test_a_report_is_made_of_its_words_and_of_its_own_pictures(looks: dict[str, dict[str, list[str]]]) -> None:
    made_of = {file for file in CHANGES if looks[file]["report"] != looks[""]["report"]}
    assert {"workflow/report/template.html.jinja", "workflow/figures/canvas.py"} <= made_of
    assert not {"workflow/cli.py", "workflow/example.toml", "meshes/sections/s13.toml"} & made_of


def test_a_room_can_be_left_out_with_what_only_it_imports(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    texts = {
        "__init__": "",
        "stage": "def work():\n    from toy_house import law\n    from toy_house.figures.picture import draw\n",
        "law": "from toy_house.table import number\n",
        "table": "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from toy_house import names\n",
        "names": "",
        "figures/__init__": "",
        "figures/picture": "from toy_house import colours, table\n",
        "colours": "",
        "figures_of_speech": "",
    }
    for name, text in texts.items():
        file = tmp_path / f"toy_house/{name}.py"
        file.parent.mkdir(exist_ok=True)
        file.write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    work = {"stage", "law", "table"}  # what is imported for its types alone changes no result
    whole = work | {"figures.picture", "colours"}
    packages = ("toy_house",)
    assert closure("toy_house.stage", packages=packages) == {f"toy_house.{name}" for name in whole}
    apart = closure("toy_house.stage", without="toy_house.figures", packages=packages)
    assert apart == {f"toy_house.{name}" for name in work}


def test_every_file_of_data_is_named_by_a_module_beside_it() -> None:
    """Else a change in it would be nobody's; the sections in meshes/ are the user's."""
    data = [path for package in PACKAGES for path in (TOP / package).rglob("*") if path.suffix in DATA]
    data = [path for path in data if path.parent != TOP / "meshes/sections"]
    assert data
    for path in data:
        assert any(path.name in module.read_text(encoding="utf-8") for module in path.parent.glob("*.py")), path
