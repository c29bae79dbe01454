"""What the README shows works as shown."""

import re
import subprocess
import sys
import tomllib
from textwrap import dedent

from meshes.gmsh_model import generate
from meshes.section.polyline import Line
from tests.support import TOP
from tests.support.sections import assert_conforming
from workflow.settings import Input

README = (TOP / "README.md").read_text(encoding="utf-8")


def blocks(language: str, text: str) -> list[str]:
    """The examples in a language, as they would be typed."""
    return [dedent(block) for block in re.findall(rf"```{language}\n(.*?)```", text, flags=re.DOTALL)]


def settings_of(package: str) -> str:
    """The table of settings in the README of a package."""
    return blocks("toml", (TOP / package / "README.md").read_text(encoding="utf-8"))[0]


def test_the_section_and_the_settings_of_the_readmes() -> None:
    section, cases, bottom, borings, uncertain, block = blocks("toml", README)
    meshing, solving = settings_of("meshes"), settings_of("fem")
    texts = (section.replace("[1, 2, 3]", "[1, 2]"), cases, meshing, solving, borings, uncertain, block)
    used = Input.parse({key: value for text in texts for key, value in tomllib.loads(text).items()})
    assert Line.model_validate(tomllib.loads(bottom)["bottom"]).points(0.0, 100.0).shape == (5, 2)
    assert len(used.uncertain.numbers) == 4
    assert [used.cases[0].residual_of("Loose sand"), used.cases[1].strength_of("Loose sand")] == [0.15, 6000.0]
    mesh = generate(used, used.mesh)
    assert mesh.method == "free"
    assert_conforming(mesh, used, used.mesh)
    # ends and kinks of the ground and of the sand, the load, and where the river meets the bank
    assert used.layering.x.tolist() == [0.0, 4.0, 16.0, 20.0, 38.0, 40.0, 44.0, 60.0, 70.0]


def test_pictures_are_there_and_small() -> None:
    pictures = [TOP / name for name in re.findall(r"!\[[^]]+\]\(([^)]+)\)", README)]
    assert len(pictures) == 3
    assert sum(path.stat().st_size for path in pictures) < 300_000


def test_the_example_in_python_runs() -> None:
    (example,) = blocks("python", README)
    done = subprocess.run([sys.executable, "-c", example], cwd=TOP, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    told = dict(line.split(": ") for line in done.stdout.splitlines())
    assert re.fullmatch(r"0\.[23]\d+ plateau", told["finite elements"])
    assert 0.1 < float(told["discs"]) < 0.6
    assert 0.0 < float(told["slide"].removesuffix(" m")) < 20.0
