"""Refuses words that the glossary replaced, in the pages of the documentation and in the texts of the program, which
are the strings of its modules and the templates of its reports: `python docs/prose.py`.

Only words that mean nothing else here are listed. Code between backquotes and in blocks is left out: names in it are
those of the program.
"""

import ast
import re
import sys
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent
PACKAGES = ("meshes", "fem", "dem", "workflow")
# Pages on the history, or generated from the texts of the program.
LEFT_OUT = {"docs/changelog.md"}

# The word, as a pattern, and what it is called now.
WORDS = {
    r"at once, without a path": "limit load by finite element limit analysis",
    r"DirectLimit|AtOnce": "the name of the class that is there",
    r"pushed (downhill|uphill)": "seismic force downslope or upslope",
    r"Davis's substitute": "Davis's estimate, or the reduced strength of Davis",
    r"grains (that )?roll(s|ing)? down": "shallow failure of a cohesionless face",
    r"(is|are|was|were) doubtful": "warning",
    r"what is doubtful": "warnings",
    r"these discs are not this soil": "calibration failed",
    r"without any factor": "uncalibrated",
    r"hangs? on": "depends on",
    r"stands? beside": "is compared with, or is shown with",
    r"goes on": "continues",
    r"comes? to (the|a) ": "amounts to",
    r"It has not run yet": "not run",
    r"was made from": "inputs",
    r"\b(it|which|that) tells\b": "reports",
    r"judges?\b(?! computes)": "checks, or second opinion",
    r"ledger|books\b": "energy balance",
    r"swing\b": "added mass",
    r"\bas of last time\b": "history is no part of a page",
    r"utili[sz]e": "use",
    r"in order to": "to",
}
# The same in docstrings of the program, as far as the old word has no other meaning there.
DOCSTRING_WORDS = {
    pattern: WORDS[pattern]
    for pattern in (r"hangs? on", r"stands? beside", r"It has not run yet", r"utili[sz]e", r"in order to")
} | {
    r"goes on\b": "continues",
    r"held against": "compared with, or calibrated to",
    r"Davis's substitute": "Davis's estimate",
    r"\bgrains roll down\b": "shallow failure of a cohesionless face",
    r"``\w+``: (of|in|for|with|by|at|from) ": "a noun after the colon: what the parameter is",
}
# The same in the texts of the program, which use some of these words otherwise.
TEXT_WORDS = {
    pattern: better
    for pattern, better in WORDS.items()
    if pattern not in (r"judges?\b(?! computes)", r"comes? to (the|a) ", r"was made from")
} | {
    r"pushed (downhill|uphill|both)": "seismic force downslope or upslope",
    r"held against|brought to the": "compared with, or calibrated to",
    r"has not run yet": "not run",
    r"\bMind:|^doubtful:": "Warning:",
    r"as far as it was looked for": "where the search ended",
    r"\bgrains\b.*\broll\b": "shallow failure of a cohesionless face",
}


def prose(text: str) -> str:
    """Return a page without its code, with the same number of lines."""
    text = re.sub(r"^```.*?^```", lambda block: "\n" * block[0].count("\n"), text, flags=re.DOTALL | re.MULTILINE)
    text = re.sub(r"^ {4,}\S.*$", "", text, flags=re.MULTILINE)
    return re.sub(r"`[^`\n]*`", "", text)


def faults(text: str) -> Iterator[tuple[int, str, str]]:
    """Yield line, word and replacement of every refused word."""
    yield from _refused(enumerate(prose(text).splitlines(), 1), WORDS)


def _refused(lines: Iterable[tuple[int, str]], words: Mapping[str, str]) -> Iterator[tuple[int, str, str]]:
    for number, line in lines:
        for pattern, better in words.items():
            for match in re.finditer(pattern, line, flags=re.IGNORECASE):
                yield number, match[0].strip(), better


def strings(source: str) -> Iterator[tuple[int, str]]:
    """Yield line and text of every string of several words in a module, except docstrings; {} stands for values."""
    tree = ast.parse(source)
    left_out = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    left_out |= {id(part) for node in ast.walk(tree) if isinstance(node, ast.JoinedStr) for part in node.values}
    for node in ast.walk(tree):
        if id(node) in left_out:
            continue
        if isinstance(node, ast.JoinedStr):
            yield (
                node.lineno,
                "".join(str(part.value) if isinstance(part, ast.Constant) else "{}" for part in node.values),
            )
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and " " in node.value:
            yield node.lineno, node.value


def docstrings(source: str) -> Iterator[tuple[int, str]]:
    """Yield first line and text of every docstring of a module."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and (text := ast.get_docstring(node)):
            yield node.body[0].lineno, text


def texts(path: Path) -> Iterator[tuple[int, str]]:
    """Return line and text of all texts of a module or a template."""
    source = path.read_text(encoding="utf-8")
    return strings(source) if path.suffix == ".py" else iter(enumerate(source.splitlines(), 1))


def pages() -> list[Path]:
    """Return README, the READMEs of the packages, and every page of the documentation."""
    written = [path for path in (TOP / "docs").rglob("*.md") if "build" not in path.relative_to(TOP / "docs").parts]
    written_pages = [TOP / "README.md", *(TOP / package / "README.md" for package in PACKAGES)]
    return [path for path in (*written_pages, *sorted(written)) if str(path.relative_to(TOP)) not in LEFT_OUT]


def main() -> int:
    """Print the faults; return 1 if there are any."""
    messages = [
        f'{path.relative_to(TOP)}:{line}: "{word}": {better}'
        for path in pages()
        for line, word, better in faults(path.read_text(encoding="utf-8"))
    ]
    packages = [path for package in PACKAGES for path in sorted((TOP / package).rglob("*"))]
    messages += [
        f'{path.relative_to(TOP)}:{line}: "{word}": {better}'
        for path in packages
        if path.suffix in (".py", ".jinja", ".toml")
        for line, word, better in _refused(texts(path), TEXT_WORDS)
    ]
    messages += [
        f'{path.relative_to(TOP)}:{line}: "{word}": {better}'
        for path in packages
        if path.suffix == ".py"
        for line, word, better in _refused(docstrings(path.read_text(encoding="utf-8")), DOCSTRING_WORDS)
    ]
    print("\n".join(messages) or "prose: no word of the old language")
    return 1 if messages else 0


if __name__ == "__main__":
    sys.exit(main())
