"""Texts of the report in the language that the settings ask for, from one catalogue: ``ja.toml``.

Texts are written in English where they are used, as ``_("the text with {value}", value=...)``; the catalogue has every
text as a key and its translation as the value. `tests/unit/workflow/test_texts.py` sees to it that none is missing.
"""

import re
import tomllib
from functools import cache
from importlib.resources import files
from typing import Any, Literal

Language = Literal["en", "ja"]


SENTENCES = "sentences"  # the table of the catalogue with whole sentences, whose values are written {}
CASES = re.compile(r"cases? ([\d, and]+)")


@cache
def _file(language: Language) -> dict[str, Any]:
    if language == "en":
        return {SENTENCES: {}}
    return tomllib.loads(files("workflow.report").joinpath(f"{language}.toml").read_text(encoding="utf-8"))


@cache
def catalogue(language: Language) -> dict[str, str]:
    """Read the translations of a language, by English text; empty for English itself."""
    return {text: translation for text, translation in _file(language).items() if text != SENTENCES}


@cache
def sentences(language: Language) -> dict[str, str]:
    """Read the translations of whole sentences that stages leave, with {} in the place of their values."""
    translations: dict[str, str] = _file(language)[SENTENCES]
    return translations


@cache
def _pattern(sentence: str) -> re.Pattern[str]:
    return re.compile("(.+?)".join(map(re.escape, sentence.split("{}"))))


class Texts:
    """The texts of one language."""

    def __init__(self, language: Language = "en") -> None:
        self.language = language
        self.translations = catalogue(language)

    def __call__(self, text: str, **values: object) -> str:
        """Translate a text and fill in its values.

        Parameters
        ----------
        text : str
            The English text, with the names of its values in braces.
        **values : object
            What stands in place of the names.

        Returns
        -------
        str
            The text in the language of the report; in English where the catalogue has no translation.
        """
        translated = self.translations.get(text, text)
        words = {name: self._value(value) if isinstance(value, str) else value for name, value in values.items()}
        return translated.format(**words) if words else translated

    def sentence(self, text: str) -> str:
        """Translate a whole sentence that a stage has left, numbers and all; unchanged where none fits it."""
        for english, translation in sentences(self.language).items():
            match = _pattern(english).fullmatch(text)
            if match is not None:
                return translation.format(*map(self._value, match.groups()))
        return text

    def _value(self, text: str) -> str:
        """A value within a text: cases, and the range of two numbers."""
        if self.language == "en":
            return text
        text = CASES.sub(lambda match: f"ケース{match[1].replace(' and ', ', ')}", text)
        return self.translations.get(text, re.sub(r"(?<=\d) to (?=\d)", "~", text))

    def listed(self, words: list[str]) -> str:
        """Join words as people list them: a, b and c."""
        if self.language == "ja":
            return "、".join(words)
        return " and ".join([", ".join(words[:-1]), words[-1]]) if len(words) > 1 else "".join(words)
