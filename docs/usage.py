"""Checks English usage with proselint, in the pages of the documentation and in the texts of the program, which are the
strings of its modules and the templates of its reports: `python -m docs.usage`.

Terms of the glossary are never refused. Code is left out, as in `docs/prose.py`, which refuses words of this project
that were replaced.
"""

import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from proselint.checks import __register__
from proselint.config import DEFAULT
from proselint.registry import CheckRegistry
from proselint.tools import LintFile

from docs.prose import PACKAGES, TOP, pages, prose, texts

# Checks that make no sense here, and why.
LEFT_OUT = (
    "typography.symbols.curly_quotes",  # values of settings stand in straight quotes, as they are typed
    "typography.symbols.ellipsis",  # "..." stands for what is left out of code and tables
    "typography.symbols.trademark",  # (R) is a symbol of an equation, not a registered trademark
    "typography.symbols.multiplication",  # x is a coordinate
    "typography.punctuation.hyperbole",  # "?!" occurs in regular expressions only
    "typography.punctuation.exclamation",  # so does "!"
)
CHECKS: dict[str, Any] = {**DEFAULT, "max_errors": 10_000}
# A phrase at the end of a heading and at the start of its paragraph, or of two texts, is not repeated.
APART = "\n\n"
# Neither is a symbol or a number: "μ_r R", "margin: 0 0".
SYMBOLS = re.compile(r"[\d\W]*|(\S*\d\S*)( \1)+|\S( \S)+")
# In templates, what is no text: styles, programs, tags, and statements of the template language.
MARKUP = re.compile(r"<style.*?</style>|<script.*?</script>|<[^>]*>|\{[%#].*?[%#]\}|\{\{.*?\}\}", re.DOTALL)
# Classes of the risk of liquefaction damage, in the words of Iwasaki et al. (1982)
CLASSES = frozenset({"very low", "very high"})
INLINE_CODE = re.compile(r"(?<!`)`[^`\n]+`(?!`)")


def glossary() -> frozenset[str]:
    """Return the terms of the glossary in small letters: the first cells of its tables."""
    rows = re.findall(r"^\| (.*?) \|", (TOP / "docs" / "glossary.md").read_text(encoding="utf-8"), re.MULTILINE)
    return frozenset(term.strip().lower() for row in rows for term in row.split(","))


def faults(text: str, terms: frozenset[str]) -> Iterator[tuple[int, str]]:
    """Yield line and message of every finding in a text, except terms of the glossary."""
    if not text.strip():
        return
    for finding in LintFile("text", text).lint(CHECKS):
        result = finding.check_result
        begin, end = result.span
        phrase = f"\n{text}\n"[begin:end].strip()
        left_out = phrase.lower() in terms or APART in phrase or SYMBOLS.fullmatch(phrase)
        if not left_out and not result.check_path.startswith(LEFT_OUT):
            yield finding.pos[0], f"{' '.join(result.message.split())} [{result.check_path}]"


def page(path: Path) -> str:
    """Return a page with the word "code" in the place of code in a line, and without blocks of code."""
    return prose(INLINE_CODE.sub("code", path.read_text(encoding="utf-8")))


def texts_of_the_program() -> Iterator[tuple[Path, list[tuple[int, str]]]]:
    """Yield every module or template of the packages with the lines and texts in it."""
    for package in PACKAGES:
        for path in sorted((TOP / package).rglob("*.py")):
            yield path, [part for part in texts(path) if part[1] not in CLASSES]
        for path in sorted((TOP / package).rglob("*.jinja")):
            plain = MARKUP.sub(lambda part: "\n" * part[0].count("\n"), path.read_text(encoding="utf-8"))
            yield path, list(enumerate(plain.splitlines(), 1))


def messages() -> Iterator[str]:
    """Yield a line for every finding."""
    terms = glossary()
    for path in pages():
        for line, message in faults(page(path), terms):
            yield f"{path.relative_to(TOP)}:{line}: {message}"
    for path, parts in texts_of_the_program():
        # one text a line, and an empty line between two of them: proselint takes longer to begin than to read
        joined = APART.join(" ".join(text.split()) for _, text in parts)
        for line, message in faults(joined, terms):
            yield f"{path.relative_to(TOP)}:{parts[(line - 1) // 2][0]}: {message}"


def main() -> int:
    """Print the findings; return 1 if there are any."""
    CheckRegistry().register_many(__register__)
    findings = list(messages())
    print("\n".join(findings) or "usage: no finding of proselint")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
