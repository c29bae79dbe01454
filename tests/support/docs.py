"""Reads the pages of the documentation and their content: examples by language, commands, links."""

import importlib.util
import re
import sys
from functools import cache
from pathlib import Path
from textwrap import dedent
from types import ModuleType

from tests.support import TOP

DOCS = TOP / "docs"
PACKAGES = ("meshes", "fem", "dem", "workflow")


@cache
def program(name: str) -> ModuleType:
    """Return a program of the folder `docs` as a module: build, generated or prose."""
    sys.path.insert(0, str(TOP))
    spec = importlib.util.spec_from_file_location(f"docs_{name}", DOCS / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def pages() -> list[Path]:
    """Return README, READMEs of the packages and of the tests, and every page of the documentation."""
    written = [path for path in DOCS.rglob("*.md") if "build" not in path.relative_to(DOCS).parts]
    readmes = [TOP / folder / "README.md" for folder in (*PACKAGES, "tests")]
    return [TOP / "README.md", *readmes, *sorted(written)]


def blocks(language: str, text: str) -> list[str]:
    """Return the examples in a language as a user would type them."""
    return [dedent(block) for block in re.findall(rf"```{language}\n(.*?)```", text, flags=re.DOTALL)]


def commands(text: str) -> list[str]:
    """Return the commands of a page: lines of code, and code within a line that has options."""
    text = re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE)
    matches = re.findall(r"^ {4,}(noshiro [^#\n]+)", text, flags=re.MULTILINE)
    return [*matches, *re.findall(r"`(noshiro [a-z]+ [^`]*--[^`]+)`", text.replace("\n", " "))]
