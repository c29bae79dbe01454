"""Every number of the documentation stands in a source that its page names, or in the page's list of definitions.

A page ends with ``<!-- numbers: SOURCE (0.237, 0.96), ...; definitions: 0.65 of the peak, ... -->``, which readers do
not see. A source is a table of `docs/numbers.toml`, or a file of this repository: a generated page, a test that
asserts the numbers, the module of a law. The numbers that the page takes from it stand in parentheses: of all numbers
of a file some are always near to a wrong one. Definitions are constants of laws and numbers of examples. Counts below
ten without a unit, years, code and titles of links are not looked at, nor are the changes, which are history, and the
volumes and pages of references.
The numbers of the README are compared one by one in `test_readme.py`.
"""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.support import TOP
from tests.support.docs import DOCS, pages, program

MARK = re.compile(r"<!-- numbers:\s*(?P<sources>[^;]*?)(?:;\s*definitions:\s*(?P<definitions>.+?))?\s*-->", re.DOTALL)
VALUE = re.compile(r"\d+(?:,\d{3})*(?:\.\d+)?(?:e-?\d+)?")
NUMBER = re.compile(r"(?<![\w.-])\d+(?:,\d{3})*(?:\.\d+)?(?![\w-]|\.\d)")
CODE = re.compile(r"^```.*?^```|^ {4,}.*?$|`[^`]*`|\]\([^)]*\)|<!--.*?-->", re.DOTALL | re.MULTILINE)
SOURCE = re.compile(r"(?P<name>[\w./-]+)\s*\((?P<quoted>[^)]*)\)")
WORDS = ["one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve"]
TIME = re.compile(rf"\b({'|'.join(WORDS)}|\d+)(?= (?:minutes?|hours?)\b)", re.IGNORECASE)
MEASURED = re.compile(r"(?<![\w.-])(\d)(?=(?: to \d+)? ?(?:%|°|(?:mm|cm|m|km|kPa|MPa|s|kN|g|gal|Hz)\b))")
NAMES = re.compile(r"\b(?:1[89]|20)\d\d\b|S-13|2:1|[Ee]q(?:s?\.|uations?) \([\d) to(]+|Table \d|σ'v")


def flat(value: Any) -> Iterator[float]:
    """All numbers of a table or a text."""
    if isinstance(value, dict | list):
        for item in value.values() if isinstance(value, dict) else value:
            yield from flat(item)
    else:
        yield from (float(entry.replace(",", "")) for entry in VALUE.findall(str(value)))


def known(source: str) -> set[float]:
    """The numbers of a source."""
    table = program("generated").numbers().get(source)
    return set(flat((TOP / source).read_text(encoding="utf-8") if table is None else table))


def is_in(entry: str, values: set[float]) -> bool:
    """Whether one of the values is a number as it is written, rounded to its places."""
    return any(
        abs(round(value, len(entry.partition(".")[2])) - float(entry.replace(",", ""))) < 1e-9 for value in values
    )


def unknown(text: str) -> list[str]:
    """The numbers of a page that it takes from no source, and those that a source lacks."""
    mark = MARK.search(text)
    values, lacking = set(flat((mark["definitions"] if mark else None) or "")), []
    for name, quoted in SOURCE.findall(mark["sources"] if mark else ""):
        there, entries = known(name), VALUE.findall(quoted)
        lacking += [f"{entry} of {name}" for entry in entries if not is_in(entry, there)]
        values |= set(flat(quoted))
    plain = NAMES.sub("", CODE.sub("", text))
    times = [str(WORDS.index(word.lower()) + 1) if word.lower() in WORDS else word for word in TIME.findall(plain)]
    long = [entry for entry in NUMBER.findall(plain) if "." in entry or float(entry.replace(",", "")) >= 10]
    wanted = dict.fromkeys([*times, *MEASURED.findall(plain), *long])
    return [*(entry for entry in wanted if not is_in(entry, values)), *lacking]


@pytest.mark.parametrize(
    "page",
    [
        pytest.param(page, id=str(page.relative_to(DOCS)))
        for page in pages()
        if page.is_relative_to(DOCS) and page.name not in ("changelog.md", "references.md")
    ],
)
def test_numbers_of_a_page_stand_in_their_sources(page: Path) -> None:
    assert unknown(page.read_text(encoding="utf-8")) == []


def test_a_number_without_a_source_is_found() -> None:
    assert unknown("S-13 fails at 0.24, slides 12 m in `0.5` s (Newmark 1965), 2 cases in two minutes.") == [
        "2", "0.24", "12",
    ]  # fmt: skip
    text = "It fails at 0.24, not at 0.77, by 0.65 of the peak.\n<!-- numbers: s13{}; definitions: 0.65 of the peak -->"
    assert unknown(text.format(" (0.24)")) == ["0.77"]
    assert unknown(text.format(" (0.24, 0.77)")) == ["0.77 of s13"]
    assert unknown(text.format("")) == ["0.24", "0.77"], "a number somewhere in a file is no source"
    assert unknown("By 4 to 7 % in 3 cases.") == ["4", "7"]
