"""Refuses identifiers that hold no noun of the field, in the packages, the documentation and the tests, and modules of
the packages that are too long: `python docs/names.py`.

A name says what it holds: `fixed` components, not `held`; `messages`, not `told`; `REST_DISPLACEMENT`, not `STILL`.
Fields of pydantic models are left out, since they are keys of files; so are the names of tests, which are sentences.
"""

import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent
PACKAGES = ("meshes", "fem", "dem", "workflow")
FOLDERS = (*PACKAGES, "docs", "tests")
MOST_LINES = 400  # of a module

# Words that are refused anywhere in an identifier, and what to write instead.
PARTS = {
    "push": "force, acceleration or seismic force",
    "pushed": "loaded or displaced",
    "pushes": "accelerations",
    "held": "fixed, constant or in equilibrium",
    "beside": "other, neighbour, compared or temporary",
    "kept": "stored, remaining or limited",
    "ahead": "next, following or predictor",
    "shaken": "seismic, with excess pressure or base motion",
    "turned": "rotated, reversed or opposite",
    "carried": "supported, stored or scaled",
    "calm": "at rest",
    "told": "message, text or warnings",
    "theirs": "the noun",
    "mine": "the noun",
    "meanwhile": "concurrent",
    "begun": "started or future",
}
# Words that are refused as whole identifiers.
WHOLE = {
    "found": "what it is: bounds, result, answer",
    "given": "what it is: config, argument, inputs",
    "asked": "requested",
    "one": "what it is: item, entry, row",
    "its": "the noun",
    "own": "what it is of",
    "some": "subset",
}
# Words that are refused as whole names of constants, which are named after the quantity that they limit.
NO_QUANTITY = {
    "little", "much", "more", "hard", "sure", "short", "nearly", "every", "together", "later", "early", "late",
    "lately", "nothing", "deep", "full", "fine", "large", "larger", "best", "seen", "unlike", "often", "safe",
    "still", "alike", "steep", "narrow", "thin", "most", "least", "alone", "slips", "moves", "stands", "settles",
    "rests", "lasts", "leaves", "fades", "touches", "risen", "changed", "keep", "tell", "warm", "poor", "met",
}  # fmt: skip

# Words that are refused as whole names of fields of dataclasses and named tuples: a reader sees the field far from its
# class. Fields of pydantic models are keys of files.
NO_FIELD = {
    "first", "last", "least", "most", "other", "near", "far", "rest", "tells", "how", "why", "where", "which", "still",
    "came", "enough", "needed", "wanted", "every",
}  # fmt: skip


def fields(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Yield line and name of every field of a dataclass or a named tuple."""
    for node in ast.walk(tree):
        if isinstance(node, ast.ClassDef):
            kinds = " ".join(ast.unparse(each) for each in (*node.decorator_list, *node.bases))
            if "dataclass" in kinds or "NamedTuple" in kinds:
                targets = [item.target for item in node.body if isinstance(item, ast.AnnAssign)]
                yield from ((target.lineno, target.id) for target in targets if isinstance(target, ast.Name))


def bound(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Yield line and name of everything that a module defines or assigns, except tests and fields of pydantic
    models."""
    yield from fields(tree)
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            if not node.name.startswith("test_"):
                yield node.lineno, node.name
        elif isinstance(node, ast.arg):
            yield node.lineno, node.arg
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store) and not _annotated(tree, node):
            yield node.lineno, node.id
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            yield node.lineno, node.attr


def _annotated(tree: ast.Module, name: ast.Name) -> bool:
    """Return whether a name is an annotated field of a class."""
    return name in {
        item.target
        for node in tree.body
        if isinstance(node, ast.ClassDef)
        for item in node.body
        if isinstance(item, ast.AnnAssign)
    }


def faults(source: str) -> Iterator[tuple[int, str, str]]:
    """Yield line, identifier and better words of every refused identifier."""
    tree = ast.parse(source)
    yield from ((line, name, "the quantity that the field holds") for line, name in fields(tree) if name in NO_FIELD)
    for line, name in bound(tree):
        words = [word.lower() for word in re.findall(r"[A-Z]?[a-z]+|[A-Z]+", name)]
        if (whole := name.strip("_").lower()) in WHOLE and name != "ONE":  # the number 1 of kernels
            yield line, name, WHOLE[whole]
        if name.isupper() and whole in NO_QUANTITY:
            yield line, name, "the quantity that the constant limits"
        yield from ((line, name, PARTS[word]) for word in words if word in PARTS)


def messages() -> list[str]:
    """Return one line for every refused identifier and every module that is too long."""
    modules = [path for package in PACKAGES for path in sorted((TOP / package).rglob("*.py"))]
    lengths = {path: len(path.read_text(encoding="utf-8").splitlines()) for path in modules}
    long = [
        f"{path.relative_to(TOP)}: {count} lines, at most {MOST_LINES} are allowed"
        for path, count in lengths.items()
        if count > MOST_LINES
    ]
    return long + [
        f'{path.relative_to(TOP)}:{line}: identifier "{name}": {better}'
        for folder in FOLDERS
        for path in sorted((TOP / folder).rglob("*.py"))
        if "build" not in path.relative_to(TOP).parts
        for line, name, better in faults(path.read_text(encoding="utf-8"))
    ]


def main() -> int:
    """Print the faults; return 1 if there are any."""
    refused = messages()
    print("\n".join(refused) or "names: every identifier has a noun")
    return 1 if refused else 0


if __name__ == "__main__":
    sys.exit(main())
