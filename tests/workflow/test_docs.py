"""The documentation site is whole, needs no network, and what it shows works as shown."""

import json
import re
import shlex
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest
import typer

from tests.support import TOP
from workflow.cli import app
from workflow.report.reference import keys
from workflow.settings import Input

DOCS = TOP / "docs"
PAGES = [TOP / "README.md", DOCS / "tutorials/river_bank.md", *sorted(TOP.glob("*/README.md"))]
TUTORIAL = (DOCS / "tutorials/river_bank.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def site() -> Path:
    """The site, built as `make docs` builds it: mkdocs fails at any link that leads nowhere."""
    pytest.importorskip("mkdocs")
    done = subprocess.run(
        [sys.executable, str(DOCS / "build.py")], cwd=TOP, capture_output=True, text=True, timeout=120, check=False,
        env={"PYTHONPATH": str(TOP), "PATH": "/usr/bin:/bin"},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return DOCS / "build" / "site"


def test_the_site_is_whole_and_fetches_nothing(site: Path) -> None:
    pages = list(site.rglob("*.html"))
    assert {"index.html", "tutorial.html", "keys.html", "s13.html", "changelog.html"} <= {page.name for page in pages}
    for page in pages:
        text = page.read_text(encoding="utf-8")
        assert re.findall(r'<(?:script|img)[^>]+src="?https?:', text) == [], page
        assert re.findall(r'<link[^>]+rel="?stylesheet"?[^>]+href="?https?:', text) == [], page
        assert "{{" not in re.sub(r"<code>.*?</code>", "", text, flags=re.DOTALL), page


def test_every_key_stands_in_the_reference_with_what_is_checked() -> None:
    found = {(key.table, key.name): key for key in keys()}
    for table in Input.tables():
        for name, field in type(Input.model_fields[table].default).model_fields.items():
            assert found[table, name].words == (field.description or "")
    assert found["fem", "accuracy"].allowed == "a number from 0 to 0.5"
    assert found["fem", "accuracy"].default == "0.01"
    assert found["fem", "sides"].allowed == '"roller", "fixed", "tied"'
    assert found["strata", "youngs_modulus"].default == "must be given"
    assert found["strata", "youngs_modulus"].unit == "Pa"
    assert found["strata", "friction_angle"].allowed == 'from 0 to below 90 deg, such as "35 deg"'
    assert found["slide.cases", "stiffness"].allowed == "a number above 0 to 1"


@cache
def parameters() -> dict[str, set[str]]:
    """The options of every command."""
    command = typer.main.get_command(app)
    return {
        name: {word for parameter in one.params for word in (*parameter.opts, *parameter.secondary_opts)} | {"--help"}
        for name, one in command.commands.items()  # type: ignore[attr-defined]
    }


def lines() -> list[str]:
    """Every command that a page shows: lines of code, and code within a line that has options."""
    found = []
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        found += re.findall(r"^ {4,}(noshiro [^#\n]+)", text, flags=re.MULTILINE)
        found += re.findall(r"`(noshiro [a-z]+ [^`]*--[^`]+)`", text.replace("\n", " "))
    return found


def test_commands_that_are_shown_are_there_with_their_options() -> None:
    shown = lines()
    assert len(shown) > 25
    for line in shown:
        _, name, *rest = shlex.split(re.sub(r"\s+", " ", line))
        assert name in parameters(), line
        for word in rest:
            if word.startswith("-"):
                assert word.partition("=")[0] in parameters()[name], line


def test_the_tutorial_shows_the_section_that_comes_with_the_program() -> None:
    """As it is read on any page: with nothing in it that a builder would have to put in place."""
    shown = re.findall(r"^```toml\n(.*?)^```$", TUTORIAL, flags=re.MULTILINE | re.DOTALL)
    assert shown[0] == (TOP / "meshes/sections/river_bank.toml").read_text(encoding="utf-8")
    for page in PAGES:
        assert "{{" not in page.read_text(encoding="utf-8"), page


def test_the_notebook_of_s13_runs(capsys: pytest.CaptureFixture[str]) -> None:
    cells = json.loads((DOCS / "s13.ipynb").read_text(encoding="utf-8"))["cells"]
    names: dict[str, object] = {}
    for cell in cells:
        if cell["cell_type"] == "code":
            exec("".join(cell["source"]), names)
    said = capsys.readouterr().out
    kc = float(re.findall(r"critical Kh (0\.\d+): plateau", said)[0])
    dilating = float(re.findall(r"with ψ = φ (0\.\d+)", said)[0])
    assert 0.2 < kc < 0.3 < dilating + 0.05
    assert dilating > kc
    assert re.search(r"slides \d+\.\d m, settles -?\d+\.\d m uphill", said)
