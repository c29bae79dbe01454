"""Numbers sections, tables, figures and notes, so that text can refer to items that follow later."""

from collections.abc import Iterable
from dataclasses import dataclass, field

from workflow.texts.report_texts import Texts


@dataclass
class Labels:
    """Numbers sections, tables and figures in their order on a page. A page is rendered twice, so that the second
    rendering can refer to numbers further down the page.

    Attributes
    ----------
    texts : the texts in the language of the page
    first_rendering : numbers of the first rendering: "Table 3", "Figure 7", by name
    numbers : numbers of this rendering
    sections : headings by name, with their numbers
    contents : the sections of the first rendering
    counts : numbers of items so far, by kind
    """

    texts: Texts = field(default_factory=Texts)
    first_rendering: dict[str, str] = field(default_factory=dict)
    numbers: dict[str, str] = field(default_factory=dict)
    sections: dict[str, str] = field(default_factory=dict)
    contents: dict[str, str] = field(default_factory=dict)
    counts: dict[str, int] = field(default_factory=dict)

    def _next(self, kind: str) -> int:
        self.counts[kind] = self.counts.get(kind, 0) + 1
        return self.counts[kind]

    def table(self, name: str) -> str:
        """Number the table at this place, and return the number."""
        return self._named(name, self.texts("Table {number}", number=self._next("table")))

    def figure(self, name: str) -> str:
        """Number the figure at this place, and return the number."""
        return self._named(name, self.texts("Figure {number}", number=self._next("figure")))

    def section(self, name: str, title: str) -> str:
        """Number the section that begins at this place, and return its heading."""
        self.sections[name] = f"{self._next('section')} {title}"
        return self.sections[name]

    def _named(self, name: str, number: str) -> str:
        self.numbers[name] = number
        return number

    def __contains__(self, name: str) -> bool:
        """Return whether the page has an item with this name."""
        return name in self.first_rendering

    def see(self, name: str) -> str:
        """Return the number of the item with this name, anywhere on the page."""
        return self.first_rendering.get(name, "")


class Notes:
    """Collects the notes below a table, without repetitions; rows refer to the notes by letters."""

    def __init__(self) -> None:
        self.letters: dict[str, str] = {}

    def mark(self, texts: Iterable[str]) -> str:
        """Return the superscript letters of notes, such as "a, b"."""
        for text in texts:
            self.letters.setdefault(text, _letter(len(self.letters)))
        return ", ".join(self.letters[text] for text in texts)


def _letter(place: int) -> str:
    """Return a to z, then aa, ab and so on."""
    again, rest = divmod(place, 26)
    return (_letter(again - 1) if again else "") + chr(ord("a") + rest)
