"""Checks docstrings: `python docs/docstrings.py`.

An exported function names each of its parameters under Parameters, and has Returns or Yields unless it returns
nothing; an exported class names its attributes or parameters, unless it is an error without any, or has a description
for every field if it holds settings (numpydoc).
The docstring of every function and class begins with a verb, such as "Return" or "Holds": it does not begin as a noun
phrase or as a question. The docstring of an error is a sentence on what happened. The docstring of a module begins with
a verb in the third person, such as "Computes". A public function with four or more parameters names each of them in its
docstring; the parameters of commands are described by their help.

What another room imports, or takes from a module that it imports, is documented as what a package exports, and has
Raises if it raises. A room is a folder in a package, such as `fem/limit`. `python docs/docstrings.py fem/limit` lists
what is missing in this room.
"""

import ast
import importlib
import inspect
import re
import sys
import textwrap
from collections.abc import Iterator
from pathlib import Path

from pydantic import BaseModel

TOP = Path(__file__).resolve().parent.parent
PACKAGES = ("meshes", "fem", "dem")
ALL_PACKAGES = (*PACKAGES, "workflow")
# First words of docstrings that have no verb in front.
NO_VERB = re.compile(
    r"(The|An?|This|These|Such|All|Every|Each|Both|One|Two|Some|Whether|What|Which|Where|Who|How|Why)\b"
)
# First word of the docstring of a module: a verb in the third person, not a plural noun ("Kernels", "Points of").
THIRD_PERSON = re.compile(r"Warns of|(?!Kernels\b)[A-Z][a-z]*s (?!(of|for)\b)")

# Names of one entry under Parameters: "x, z (n,) : coordinates (m)", or "x : array (n,)" with the meaning below.
PARAMETER = re.compile(r"^(\w+(?:, \w+)*)(?: \(.*\))?(?: :|$)", flags=re.MULTILINE)

MANY_PARAMETERS = 4  # so many need names in the docstring
# Modules whose functions are commands: the help of each option describes it.
COMMANDS = {f"workflow/cli/{name}.py" for name in ("commands", "section", "study")}


def exported(package: str) -> Iterator[tuple[str, object]]:
    """Yield name and object of everything that a package exports."""
    module = importlib.import_module(package)
    for name in module.__all__:
        yield name, getattr(module, name)


def section(text: str, head: str) -> str:
    """Return the text below a heading of numpydoc; empty without the heading."""
    match = re.search(rf"^{head}\n-+\n(.*?)(?=^\w[\w ]*\n-+\n|\Z)", text, flags=re.MULTILINE | re.DOTALL)
    return match[1] if match else ""


def faults(what: object) -> Iterator[str]:
    """Yield the missing parts of the docstring of a function or a class."""
    text = inspect.getdoc(what) or ""
    first = text.partition("\n")[0]
    if not first.endswith("."):
        yield "its first line is no sentence"
    if inspect.isclass(what):
        if issubclass(what, BaseModel):
            yield from (
                f"{name} has no description" for name, field in what.model_fields.items() if not field.description
            )
        elif (not issubclass(what, Exception) or "__init__" in vars(what)) and not any(
            section((base.__doc__ and inspect.cleandoc(base.__doc__)) or "", head)
            for base in what.__mro__
            for head in ("Attributes", "Parameters")
        ):
            yield "no Attributes or Parameters"
    elif inspect.isfunction(what):
        named = set(PARAMETER.findall(section(text, "Parameters")))
        named = {name for names in named for name in names.split(", ")}
        yield from (
            f"{name} is not under Parameters" for name in inspect.signature(what).parameters if name not in named
        )
        if inspect.signature(what).return_annotation not in (None, "None") and not (
            section(text, "Returns") or section(text, "Yields")
        ):
            yield "no Returns"


def raises(what: object) -> bool:
    """Return whether a function raises an error of its own."""
    if not inspect.isfunction(what):
        return False
    tree = ast.parse(textwrap.dedent(inspect.getsource(what)))
    return any(isinstance(node, ast.Raise) and node.exc is not None for node in ast.walk(tree))


def room(module: str) -> str:
    """Return the room of a module, such as "fem/limit", or its package if it is in no room."""
    parts = module.split(".")
    return "/".join(parts[:2]) if (TOP / parts[0] / parts[1]).is_dir() else parts[0]


def shared() -> Iterator[tuple[str, str]]:
    """Yield module and name of everything that a room imports from another room, once. What it takes from a module that
    it imports, such as ``cholmod.available``, is among them."""
    names = set()
    for package in ALL_PACKAGES:
        for path in sorted((TOP / package).rglob("*.py")):
            importer = ".".join(path.relative_to(TOP).with_suffix("").parts)
            tree, modules = ast.parse(path.read_text(encoding="utf-8")), {}
            for node in ast.walk(tree):
                if (
                    isinstance(node, ast.ImportFrom)
                    and (node.module or "").partition(".")[2]
                    and node.module.partition(".")[0] in ALL_PACKAGES
                    and room(node.module) != room(importer)
                ):
                    names |= {(node.module, alias.name) for alias in node.names}
                    modules |= {alias.asname or alias.name: f"{node.module}.{alias.name}" for alias in node.names}
            names |= {
                (modules[node.value.id], node.attr)
                for node in ast.walk(tree)
                if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in modules
            }
    yield from sorted((module, name) for module, name in names if (TOP / f"{module.replace('.', '/')}.py").exists())


def shared_faults(places: tuple[str, ...]) -> Iterator[str]:
    """Yield the faults of the docstrings of what other rooms import from packages or rooms."""
    for module, name in shared():
        if module.partition(".")[0] in places or room(module) in places:
            what = inspect.unwrap(getattr(importlib.import_module(module), name, None))  # None: a module
            what = getattr(what, "py_func", what)  # of a compiled kernel
            if getattr(what, "__module__", None) == module:
                yield from (f"{module}.{name}: {fault}" for fault in faults(what))
                if raises(what) and not section(inspect.getdoc(what) or "", "Raises"):
                    yield f"{module}.{name}: no Raises"


def without_verb(source: str) -> Iterator[tuple[int, str]]:
    """Yield line and beginning of every docstring that does not begin with a verb."""
    module = ast.parse(source)
    text = ast.get_docstring(module)
    if text is not None and not THIRD_PERSON.match(text):
        yield 1, text.partition("\n")[0]
    for node in ast.walk(module):
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.endswith("Error"):
            text = ast.get_docstring(node) or ""
            if NO_VERB.match(text):
                yield node.body[0].lineno, text.partition("\n")[0]


def functions(tree: ast.AST) -> Iterator[ast.FunctionDef]:
    """Yield the public functions of a module and the public methods of its public classes."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.ClassDef | ast.FunctionDef) and not node.name.startswith("_"):
            if isinstance(node, ast.ClassDef):
                yield from functions(node)
            else:
                yield node


def unnamed(source: str) -> Iterator[tuple[int, str]]:
    """Yield line and name of every parameter of a public function with many parameters that its docstring lacks."""
    for node in functions(ast.parse(source)):
        arguments = (*node.args.posonlyargs, *node.args.args, node.args.vararg, *node.args.kwonlyargs, node.args.kwarg)
        names = [argument.arg for argument in arguments if argument and argument.arg not in ("self", "cls")]
        text = ast.get_docstring(node) or ""
        if len(names) >= MANY_PARAMETERS:
            yield from ((node.lineno, name) for name in names if not re.search(rf"\b{name}\b", text))


def main() -> int:
    """Print the faults; return 1 if there are any."""
    if sys.argv[1:]:
        messages = list(shared_faults(tuple(sys.argv[1:])))
        print("\n".join(messages) or "docstrings: everything that other rooms import is documented")
        return 1 if messages else 0
    messages = [
        f"{package}.{name}: {fault}"
        for package in PACKAGES
        for name, what in exported(package)
        for fault in faults(what)
    ]
    messages += [
        f"{path.relative_to(TOP)}:{line}: begins without a verb: {text}"
        for package in ALL_PACKAGES
        for path in sorted((TOP / package).rglob("*.py"))
        for line, text in without_verb(path.read_text(encoding="utf-8"))
    ]
    messages += [
        f"{path.relative_to(TOP)}:{line}: parameter {name} is not in the docstring"
        for package in ALL_PACKAGES
        for path in sorted((TOP / package).rglob("*.py"))
        if str(path.relative_to(TOP)) not in COMMANDS
        for line, name in unnamed(path.read_text(encoding="utf-8"))
    ]
    messages += shared_faults(ALL_PACKAGES)
    print("\n".join(messages) or "docstrings: every exported name is documented")
    return 1 if messages else 0


if __name__ == "__main__":
    sys.exit(main())
