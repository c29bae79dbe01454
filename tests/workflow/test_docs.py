"""The documentation is whole, needs no network, and what it shows works as shown."""

import fnmatch
import importlib
import os
import re
import runpy
import shlex
import shutil
import subprocess
import sys
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

import matplotlib as mpl
import pytest
import typer

from docs.section_keys import keys
from meshes.section.polyline import Line
from tests.support import SECTIONS, TOP
from tests.support.command_line import run
from tests.support.docs import DOCS, PACKAGES, blocks, commands, pages, program
from workflow.cli import app
from workflow.config import Config
from workflow.stages import declared

TUTORIALS = sorted((DOCS / "tutorials").glob("*.md"))
EXAMPLES = sorted((DOCS / "examples").glob("*.py"))
# Examples that take less than a second once everything is imported; the others are run by `make test-all`.
QUICK_EXAMPLES = {"layers", "mesh", "liquefaction", "newmark", "strength_of_discs"}


@pytest.fixture(scope="module")
def site() -> Path:
    """The site, built as `make docs` builds it: mkdocs fails at any link or anchor that leads nowhere."""
    pytest.importorskip("mkdocs")
    pytest.importorskip("mkdocstrings_handlers.python")
    done = subprocess.run(
        [sys.executable, str(DOCS / "build.py")], cwd=TOP, capture_output=True, text=True, timeout=300, check=False,
        env={"PYTHONPATH": os.pathsep.join((str(TOP), os.environ.get("PYTHONPATH", ""))), "PATH": "/usr/bin:/bin"},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return DOCS / "build" / "site"


@pytest.mark.slow
def test_the_site_is_whole_and_fetches_nothing(site: Path) -> None:
    values = {str(page.relative_to(site)): page.read_text(encoding="utf-8") for page in site.rglob("*.html")}
    made = {str(Path(page).with_suffix(".html")) for page in program("build").MADE}
    assert {"index.html", "glossary.html", "tutorials/first_run.html", "changelog.html"} | made <= set(values)
    for page, text in values.items():
        assert re.findall(r'<(?:script|img)[^>]+src="?https?:', text) == [], page
        assert re.findall(r'<link[^>]+rel="?stylesheet"?[^>]+href="?https?:', text) == [], page
        assert "{{" not in re.sub(r"<(code|pre).*?</\1>", "", text, flags=re.DOTALL), page
        assert re.findall(r"<p>(?:noshiro|make|\.venv/bin/\w+) [a-z]+[^<]*</p>", text) == [], f"{page}: no code"
    for package in ("meshes", "fem", "dem"):
        for name in importlib.import_module(package).__all__:
            assert f'.{name}"' in values["reference/python.html"], name


def test_every_link_leads_somewhere() -> None:
    """To a file that is there before the site is built, to a function in its file, or to a heading of the page."""
    build = program("build")
    seen = 0
    for page in pages():
        for target, leads_to, anchor in build.links(page):
            seen += 1
            assert leads_to.exists(), f"{page}: {target}"
            if anchor and leads_to.suffix == ".py":
                assert anchor in build.names_in(leads_to), f"{page}: {target}#{anchor}"
    assert seen > 100


def test_every_key_stands_in_the_reference_with_what_is_checked() -> None:
    values = {(key.table, key.name): key for key in keys()}
    for table in Config.tables():
        for name, field in type(Config.model_fields[table].default).model_fields.items():
            assert values[table, name].description == (field.description or "")
    assert values["fem", "accuracy"].allowed == "a number from 0 to 0.5"
    assert values["fem", "accuracy"].default == "0.01"
    assert values["strata", "youngs_modulus"].default == "must be given"
    assert values["strata", "youngs_modulus"].unit == "Pa"
    assert values["strata", "friction_angle"].allowed == 'from 0 to below 90 deg, such as "35 deg"'
    assert values["slide.cases", "stiffness"].allowed == "a number above 0 to 1"
    assert values["earthquake", "peak_acceleration"].unit == "m/s^2"
    assert values["earthquake", "peak_acceleration"].allowed.startswith('above 0 and below 50 m/s^2, such as "250 gal"')
    assert values["site_response", "plasticity"].allowed == "a number from 0 to 200 by stratum"


def test_every_file_of_a_run_stands_in_the_reference() -> None:
    text = (DOCS / "reference/files.md").read_text(encoding="utf-8")
    named = re.findall(r"`([^` ]+)`", text)
    for stage in declared.STAGES:
        for file in (*stage.results, *stage.pictures):
            assert any(fnmatch.fnmatch(file.replace("*", "x"), pattern) for pattern in named), f"{stage.name}: {file}"


def test_the_glossary_has_every_setting_of_the_sides() -> None:
    text = (DOCS / "glossary.md").read_text(encoding="utf-8")
    (sides,) = (key for key in keys() if (key.table, key.name) == ("fem", "sides"))
    for word in sides.allowed.split(", "):
        assert f"`{word}`" in text


def _base(page: Path) -> dict[str, Any]:
    """The section to which a page's examples of single tables are added."""
    if page.stem.startswith("levee"):
        return tomllib.loads((TOP / "tests/support/levee/levee.toml").read_text(encoding="utf-8"))
    if shipped := re.search(r"noshiro init --from (\w+)", page.read_text(encoding="utf-8")):
        return tomllib.loads((SECTIONS / f"{shipped[1]}.toml").read_text(encoding="utf-8"))
    base = tomllib.loads(blocks("toml", (DOCS / "how-to/section.md").read_text(encoding="utf-8"))[0])
    base["strata"][0]["liquefies_in"] = [1, 2]  # of the cases that every example has
    return base


def _blocks(page: Path) -> list[str]:
    """The examples of files on a page; the second one of the README goes on where the first one ends."""
    each = blocks("toml", page.read_text(encoding="utf-8"))
    return [each[0], "".join(each)] if page == TOP / "README.md" else each


def _examples_of_files() -> list[Any]:
    return [
        pytest.param(page, block, id=f"{page.stem}-{number}")
        for page in pages()
        for number, block in enumerate(_blocks(page))
    ]


@pytest.mark.parametrize(("page", "block"), _examples_of_files())
def test_every_example_of_a_file_is_read(page: Path, block: str) -> None:
    """Whole sections as they are, tables beside a section, a line by itself."""
    data = tomllib.loads(block)
    if set(data) == {"bottom"}:
        assert Line.model_validate(data["bottom"]).points(0.0, 100.0).shape[0] >= 3
        return
    base = {} if "strata" in data else _base(page)
    tables = {key: base[key] | value for key, value in data.items() if isinstance(base.get(key), dict)}
    Config.parse(base | data | tables)


@cache
def parameters() -> dict[str, set[str]]:
    """The options of every command."""
    command = typer.main.get_command(app)
    return {
        name: {word for parameter in item.params for word in (*parameter.opts, *parameter.secondary_opts)} | {"--help"}
        for name, item in command.commands.items()  # type: ignore[attr-defined]
    }


def test_commands_that_are_shown_are_there_with_their_options() -> None:
    shown = [line for page in pages() for line in commands(page.read_text(encoding="utf-8"))]
    assert len(shown) > 50
    for line in shown:
        _, name, *rest = shlex.split(re.sub(r"\s+", " ", line))
        assert name in parameters(), line
        for word in rest:
            if word.startswith("-") and word != "-":
                assert word.partition("=")[0] in parameters()[name], line


def test_the_tutorial_shows_the_section_that_comes_with_the_program() -> None:
    text = (DOCS / "tutorials/river_bank.md").read_text(encoding="utf-8")
    assert blocks("toml", text)[0] == (TOP / "meshes/sections/river_bank.toml").read_text(encoding="utf-8")


# So that the commands of a tutorial take minutes: little of everything.
SMALL = {
    "mesh.size": "4 m", "fem.accuracy": "0", "fem.direction": "downhill", "bounds.max_cells": "1000",
    "variants.which": '["sides"]', "dem.elements": "250", "dem.resolution": "0.05", "dem.tolerance": "0.05",
    "dem.out_of_reach": "go on", "dem.element_tests": "false", "slide.seeds": "[]", "slide.duration": "2",
    "slide.frames": "2", "slide.mpm_cells": "200",
}  # fmt: skip
QUICK = ("init", "check", "section", "liquefaction")


def _run_tutorial(page: Path, folder: Path, quick: bool) -> None:
    text = page.read_text(encoding="utf-8")
    if page.stem == "first_run":
        (folder / "my_slope.toml").write_text(blocks("toml", text)[0], encoding="utf-8")
    if page.stem.startswith("levee"):
        shutil.copytree(TOP / "tests/support/levee", folder, dirs_exist_ok=True)
    for line in commands(text):
        name, *rest = shlex.split(line)[1:]
        if quick and name not in QUICK and "--dry-run" not in rest:
            continue
        small = list(SMALL.items()) if name in ("run", "fem", "bounds", "liquefied") else []
        if name == "study":
            small = list(SMALL.items())[:3]
            rest[rest.index("--samples") + 1] = "2"
        if name == "mesh":
            rest[rest.index("--size") + 1] = "4"
        more = [word for key, value in small if f"{key}=" not in line for word in ("--set", f"{key}={value}")]
        assert run(name, *rest, *more, painted=not quick) == 0, line


@pytest.mark.parametrize("page", [p for p in TUTORIALS if p.stem != "discs"], ids=lambda page: page.stem)
def test_the_quick_commands_of_a_tutorial_run(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    _run_tutorial(page, tmp_path, quick=True)


@pytest.mark.slow
@pytest.mark.parametrize("page", [p for p in TUTORIALS if p.stem != "discs"], ids=lambda page: page.stem)
def test_all_commands_of_a_tutorial_run(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    _run_tutorial(page, tmp_path, quick=False)


@pytest.mark.slow
def test_the_tutorial_in_python_runs(capsys: pytest.CaptureFixture[str]) -> None:
    names: dict[str, object] = {}
    for block in blocks("python", (DOCS / "tutorials/discs.md").read_text(encoding="utf-8")):
        exec(block, names)
    said = capsys.readouterr().out
    kc = float(re.findall(r"critical Kh (0\.\d+): plateau", said)[0])
    dilating = float(re.findall(r"with ψ = φ (0\.\d+)", said)[0])
    assert 0.2 < kc < 0.3 < dilating + 0.05
    assert dilating > kc
    assert re.search(r"slides \d+\.\d m, settles -?\d+\.\d m uphill", said)


@pytest.mark.parametrize("name", ["docs/theory/discs.md", "meshes/README.md", "fem/README.md", "dem/README.md"])
def test_other_examples_in_python_run(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    first = blocks("toml", (TOP / "README.md").read_text(encoding="utf-8"))[0]
    (tmp_path / "my_slope.toml").write_text(first, encoding="utf-8")
    for block in blocks("python", (TOP / name).read_text(encoding="utf-8")):
        exec(block, {})


@pytest.mark.parametrize(
    "script", [pytest.param(p, marks=[] if p.stem in QUICK_EXAMPLES else pytest.mark.slow, id=p.stem) for p in EXAMPLES]
)
def test_every_example_of_the_gallery_runs_and_has_its_picture(
    script: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    mpl.use("agg")
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(script))
    assert capsys.readouterr().out
    assert (tmp_path / f"{script.stem}.png").stat().st_size > 5000
    gallery = (DOCS / "examples/README.md").read_text(encoding="utf-8")
    assert f"({script.stem}.png)" in gallery
    assert f"[code]({script.name})" in gallery
    assert script.with_suffix(".png").stat().st_size < 200_000


def test_the_gallery_has_at_least_eight_scripts() -> None:
    assert len(EXAMPLES) >= 8
    assert {path.stem for path in EXAMPLES} >= QUICK_EXAMPLES


def test_words_that_the_glossary_replaced_are_seen_in_a_page() -> None:
    """That no page has them is a check of `make lint`, which `make test` begins with."""
    prose = program("prose")
    assert [word for _, word, _ in prose.faults("What Kh hangs on, `hangs on`.\n\n    hangs on\n")] == ["hangs on"]


def test_usage_that_proselint_refuses_is_seen_in_a_page() -> None:
    """That no page has any is a check of `make lint`; terms of the glossary and code are never refused."""
    usage = program("usage")
    usage.CheckRegistry().register_many(usage.__register__)
    text = "The slope\nis a very very unique slope (R) with x x 3.\n\nWith x x 3 discs."
    findings = [(line, message.rpartition(" [")[2]) for line, message in usage.faults(text, frozenset())]
    assert {name.partition(".")[0].strip("]") for line, name in findings if line == 2} == {
        "lexical_illusions", "uncomparables", "weasel_words",
    }  # fmt: skip
    assert len(findings) == sum(line == 2 for line, _ in findings)
    assert list(usage.faults("It is a weak layer of sand sand.", frozenset({"sand sand"}))) == []
    assert "seismic coefficient" in usage.glossary()


def test_names_without_a_noun_are_refused() -> None:
    names = program("names")
    source = (
        "STILL = 1e-3\nREST_DISPLACEMENT = 1e-3\nstill = told = 1\n@dataclass\nclass A:\n    least: int\n    gap: int\n"
    )
    assert {(line, name) for line, name, _ in names.faults(source)} == {(1, "STILL"), (3, "told"), (6, "least")}


def test_a_page_names_date_and_command_of_its_numbers() -> None:
    generated = program("generated")
    page = (DOCS / "validation/moss_landing.md").read_text(encoding="utf-8")
    date = generated.numbers()["moss_landing"]["date"]
    assert generated.dates(page).startswith(f"\n- Generated {date}")
    assert generated.dates(page).endswith("Again: `python -m tests.benchmarks moss_landing`.")
    assert generated.dates("No numbers.") == ""


def test_parameters_that_a_docstring_lacks_are_refused() -> None:
    """That no docstring lacks one is a check of `make lint`."""
    source = 'def add(a, b, c, d):\n    """Add a, b and c."""\n\n\ndef add_few(a, b, c):\n    """Add."""\n'
    assert list(program("docstrings").unnamed(source)) == [(1, "d")]


def test_parameters_may_have_a_shape_or_a_type() -> None:
    def moved(x, z, by, where):  # type: ignore[no-untyped-def]
        """Return moved points.

        Parameters
        ----------
        x, z (n,) : coordinates (m)
        by : array (2,)
            Displacement (m).

        Returns
        -------
        The new coordinates (2, n) in m.
        """

    assert list(program("docstrings").faults(moved)) == ["where is not under Parameters"]


def test_what_a_room_takes_from_a_module_of_another_room_is_shared() -> None:
    shared = set(program("docstrings").shared())
    assert {("fem.errors", "UnstableError"), ("fem.kernels.mohr_coulomb", "update")} <= shared
    assert ("fem.kernels.mohr_coulomb", "_check") not in shared


def test_readmes_of_packages_are_a_page() -> None:
    for package in PACKAGES:
        text = (TOP / package / "README.md").read_text(encoding="utf-8")
        assert len(text.splitlines()) <= 60
        rooms = {path.parent.name for path in (TOP / package).glob("*/__init__.py")}
        assert {room for room in rooms if f"`{room}/`" not in text} == set()
