"""Every number of the documentation stands in a source that its page names.

A page ends with ``<!-- numbers: SOURCE (0.237, 10 %), ... -->``, which readers do not see. A source is a table of
`docs/numbers.toml`, a file of this repository (a generated page, a test that asserts the numbers, a section), a
constant or a function of a module as ``module.py#NAME``, or ``page``: examples of the page, which other tests read or
run. The numbers that the page takes from it stand in parentheses: of all numbers of a file some are always near to a
wrong one.
A percentage may stand in its source as a fraction. Counts below ten without a unit, years, code and titles of links are
not looked at, nor are the changes, which are history, and the volumes and pages of references.
The numbers of the README are compared one by one in `test_readme.py`.
"""

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.support import TOP
from tests.support.docs import pages, program

MARK = re.compile(r"<!-- numbers:\s*(?P<sources>[^;]*?)\s*-->", re.DOTALL)
VALUE = re.compile(r"\d+(?:,\d{3})*(?:\.\d+)?(?:e-?\d+)?")
NUMBER = re.compile(r"(?<![\w.-])\d+(?:,\d{3})*(?:\.\d+)?(?![\w-]|\.\d)")
CODE = re.compile(r"^```.*?^```|^ {4,}.*?$|`[^`]*`|\]\([^)]*\)|<!--.*?-->", re.DOTALL | re.MULTILINE)
SOURCE = re.compile(r"(?P<name>[\w./#-]+)\s*\((?P<quoted>[^)]*)\)")
WORDS = ["one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve"]
TIME = re.compile(rf"\b({'|'.join(WORDS)}|\d+)(?= (?:minutes?|hours?)\b)", re.IGNORECASE)
MEASURED = re.compile(r"(?<![\w.-])(\d)(?=(?: to \d+)? ?(?:%|°|(?:mm|cm|m|km|kPa|MPa|s|kN|g|gal|Hz)\b))")
NAMES = re.compile(r"\b(?:1[89]|20)\d\d\b|S-13|Debian \d+|2:1|[Ee]q(?:s?\.|uations?) \([\d) to(]+|Table \d|σ'v")


def flat(value: Any) -> Iterator[float]:
    """All numbers of a table or a text."""
    if isinstance(value, dict | list):
        for item in value.values() if isinstance(value, dict) else value:
            yield from flat(item)
    else:
        yield from (float(entry.replace(",", "")) for entry in VALUE.findall(str(value)))


def known(source: str, text: str) -> set[float]:
    """The numbers of a source; ``text`` is that of the page."""
    if source == "page":
        return set(flat(" ".join(block for block in CODE.findall(text) if block.startswith(("`", " ")))))
    table = program("generated").numbers().get(source)
    path, _, name = source.partition("#")
    code = (TOP / path).read_text(encoding="utf-8") if table is None else ""
    return set(flat(table if table is not None else part(code, name) if name else code))


def part(code: str, name: str) -> str:
    """The statement of a module that assigns a constant, or the function or class of this name."""
    for node in ast.parse(code).body:
        targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
        names = {item.id for target in targets if target for item in ast.walk(target) if isinstance(item, ast.Name)}
        if name in names or getattr(node, "name", "") == name:
            return ast.unparse(node)
    raise AssertionError(f"there is no {name}")


def lacking(quoted: str, values: set[float]) -> list[str]:
    """The quoted numbers that a source lacks; a percentage may be a fraction there."""
    fractions = {100.0 * value for value in values}
    return [
        entry.strip()
        for entry in re.split(r",(?!\d{3}\b)\s*", quoted)
        if not is_in(number := VALUE.findall(entry)[0], values) and not ("%" in entry and is_in(number, fractions))
    ]


def is_in(entry: str, values: set[float]) -> bool:
    """Whether one of the values is a number as it is written, rounded to its places."""
    return any(
        abs(round(value, len(entry.partition(".")[2])) - float(entry.replace(",", ""))) < 1e-9 for value in values
    )


def unknown(text: str) -> list[str]:
    """The numbers of a page that it takes from no source, and those that a source lacks."""
    mark = MARK.search(text)
    values, missing = set[float](), list[str]()
    for name, quoted in SOURCE.findall(mark["sources"] if mark else ""):
        missing += [f"{entry} of {name}" for entry in lacking(quoted, known(name, text))]
        values |= set(flat(quoted))
    plain = NAMES.sub("", CODE.sub("", text))
    times = [str(WORDS.index(word.lower()) + 1) if word.lower() in WORDS else word for word in TIME.findall(plain)]
    long = [entry for entry in NUMBER.findall(plain) if "." in entry or float(entry.replace(",", "")) >= 10]
    wanted = dict.fromkeys([*times, *MEASURED.findall(plain), *long])
    return [*(entry for entry in wanted if not is_in(entry, values)), *missing]


@pytest.mark.parametrize(
    "page",
    [
        pytest.param(page, id=str(page.relative_to(TOP)))
        for page in pages()
        if page != TOP / "README.md" and page.name not in ("changelog.md", "references.md")
    ],
)
def test_numbers_of_a_page_stand_in_their_sources(page: Path) -> None:
    assert unknown(page.read_text(encoding="utf-8")) == []


def test_a_number_without_a_source_is_found() -> None:
    assert unknown("S-13 fails at 0.24, slides 12 m in `0.5` s (Newmark 1965), 2 cases in two minutes.") == [
        "2", "0.24", "12",
    ]  # fmt: skip
    text = "It fails at 0.24, not at 0.77, by 0.65 of the peak.\n<!-- numbers: s13{}, {} -->"
    share = "workflow/earthquake/equivalent_kh.py#SHARE_OF_PEAK (0.65)"
    assert unknown(text.format(" (0.24)", share)) == ["0.77"]
    assert unknown(text.format(" (0.24, 0.77)", share)) == ["0.77 of s13"]
    assert unknown(text.format("", share)) == ["0.24", "0.77"], "a number somewhere in a file is no source"
    other = "workflow/earthquake/equivalent_kh.py#CYCLE_POWER (0.65)"
    assert unknown(text.format(" (0.24)", other)) == ["0.77", f"0.65 of {other.partition(' ')[0]}"], "another constant"
    assert unknown("Of `0.5` and 10 % take 10 %.\n<!-- numbers: page (10 %) -->") == ["10 % of page"]
    assert unknown("Take `0.1`, 10 %.\n<!-- numbers: page (10 %) -->") == []
    assert unknown("By 4 to 7 % in 3 cases.") == ["4", "7"]
