"""The program's own text: of which modules a module is made, and the fingerprint of their text."""

import hashlib
from collections.abc import Iterator, Mapping
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from workflow.run.interrupts import postponed

PACKAGES = ("meshes", "fem", "dem", "workflow")
DRAWING = "workflow.figures"  # the room whose modules draw, and change no result
DATA = (".csv", ".jinja", ".toml", ".js")  # what a module reads stands beside it, and the module names it


@cache
def imports(packages: tuple[str, ...] = PACKAGES) -> Mapping[str, frozenset[str]]:
    """For every module of some packages those that it imports from them, inside functions too; not for types alone."""
    import grimp

    with postponed():  # else grimp panics
        graph = grimp.build_graph(*packages, cache_dir=None, exclude_type_checking_imports=True)
    return {name: frozenset(graph.find_modules_directly_imported_by(name)) for name in graph.modules}


def closure(module: str, without: str = "", packages: tuple[str, ...] = PACKAGES) -> frozenset[str]:
    """A module and all that it imports, directly or not, but for the room ``without`` and what only that imports."""
    found: set[str] = set()
    ahead = [module]
    while ahead:
        name = ahead.pop()
        if name in found or (without and f"{name}.".startswith(f"{without}.")):
            continue
        found.add(name)
        ahead.extend(imports(packages)[name])
    return frozenset(found)


@cache
def fingerprint(modules: frozenset[str]) -> str:
    """Of the text of some modules, and of the data that they read."""
    total = hashlib.sha256()
    for path in sorted({file for module in modules for file in _files(module)}):
        total.update(f"{path.parent.name}/{path.name}\n".encode() + path.read_bytes())
    return total.hexdigest()


def _files(module: str) -> Iterator[Path]:
    """A module's own file, and the data files beside it that it names."""
    top, *inside = module.split(".")
    spec = find_spec(top)  # of the package at the top only: this imports nothing
    assert spec is not None
    assert spec.origin is not None
    place = Path(spec.origin).parent.joinpath(*inside)
    package = place / "__init__.py"
    file = package if package.is_file() else place.with_suffix(".py")
    yield file
    text = file.read_text(encoding="utf-8")
    yield from (path for path in file.parent.iterdir() if path.suffix in DATA and path.name in text)
