"""What the README shows works as shown."""

import re
import tomllib
from textwrap import dedent

from meshes.gmsh_model import generate
from meshes.section.polyline import Line
from tests.support import TOP
from tests.support.sections import assert_conforming
from workflow.settings import Input

README = (TOP / "README.md").read_text(encoding="utf-8")


def test_the_section_and_the_settings_of_the_readme() -> None:
    section, meshing, solving, bottom, block = map(dedent, re.findall(r"```toml\n(.*?)```", README, flags=re.DOTALL))
    texts = (section, meshing, solving, block)
    used = Input.parse({key: value for text in texts for key, value in tomllib.loads(text).items()})
    assert Line.model_validate(tomllib.loads(bottom)["bottom"]).points(0.0, 100.0).shape == (5, 2)
    mesh = generate(used, used.mesh)
    assert mesh.method == "free"
    assert_conforming(mesh, used, used.mesh)
    assert used.layering.x.tolist() == [0.0, 20.0, 40.0, 44.0, 60.0, 70.0]


def test_pictures_are_there_and_small() -> None:
    pictures = [TOP / name for name in re.findall(r"!\[[^]]+\]\(([^)]+)\)", README)]
    assert len(pictures) == 3
    assert sum(path.stat().st_size for path in pictures) < 300_000
