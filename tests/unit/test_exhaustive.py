"""What is looked up by a word of a fixed set has an answer for every word of it."""

import ast
import importlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal, get_args, get_origin, get_type_hints

import pytest

from tests.support import TOP

MODULES = sorted(path for package in ("meshes", "fem", "dem", "workflow") for path in (TOP / package).rglob("*.py"))

# Tables of texts from files and of names, whose lookup is guarded where it stands.
ANY_TEXT = {
    "meshes/borings/blows.py": {"MILLIMETRES"},
    "meshes/borings/table.py": {"PLAIN"},
    "meshes/section/motion_units.py": {"LENGTHS"},
    "workflow/figures/symbols.py": {"SYMBOLS"},
    "workflow/results/cases.py": {"QUANTITIES"},
    "workflow/run/spelling.py": {"SIGNS"},
}


def words_of(kind: object) -> set[Any]:
    """The words of a Literal, or of several; empty of any other type."""
    parts = get_args(kind)
    if get_origin(kind) is Literal:
        return set(parts)
    of_parts = [words_of(part) for part in parts]
    return set().union(*of_parts) if of_parts and all(of_parts) else set()


def tables(tree: ast.Module) -> Iterator[tuple[str, bool]]:
    """The names of a module's tables that are written out with texts as keys, and whether they have a type."""
    for line in tree.body:
        if isinstance(line, ast.Assign | ast.AnnAssign) and isinstance(line.value, ast.Dict) and line.value.keys:
            target = line.target if isinstance(line, ast.AnnAssign) else line.targets[0]
            if isinstance(target, ast.Name) and all(isinstance(key, ast.Constant) for key in line.value.keys):
                yield target.id, isinstance(line, ast.AnnAssign)


def looked_up(tree: ast.Module) -> set[str]:
    """The names that are looked up by something else than a word."""
    values = [node for node in ast.walk(tree) if isinstance(node, ast.Subscript) and isinstance(node.ctx, ast.Load)]
    return {
        node.value.id
        for node in values
        if isinstance(node.value, ast.Name) and not isinstance(node.slice, ast.Constant)
    }


def typed() -> Iterator[Any]:
    for path in MODULES:
        for name, has_type in tables(ast.parse(path.read_text(encoding="utf-8"))):
            if has_type:
                module = ".".join(path.relative_to(TOP).with_suffix("").parts)
                yield pytest.param(module, name, id=f"{module}.{name}")


@pytest.mark.parametrize(("module", "name"), list(typed()))
def test_a_table_has_every_word_of_its_type(module: str, name: str) -> None:
    loaded = importlib.import_module(module)
    kind = get_type_hints(loaded)[name]
    if words := words_of(get_args(kind)[0]):
        assert set(getattr(loaded, name)) == words


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(TOP)))
def test_what_is_looked_up_by_a_word_says_which_words(path: Path) -> None:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    inline = [
        node.lineno for node in ast.walk(tree) if isinstance(node, ast.Subscript) and isinstance(node.value, ast.Dict)
    ]
    assert not inline, "a table that is looked up where it stands; expected match with assert_never, or a typed table"
    untyped = {name for name, has_type in tables(tree) if not has_type}
    assert not untyped & looked_up(tree) - ANY_TEXT.get(path.relative_to(TOP).as_posix(), set()), "expected a type"
