"""Texts of the report in the language that the settings ask for, from one catalogue: ``ja.toml``.

Texts are written in English where they are used, as ``_("the text with {value}", value=...)``; the catalogue has every
text as a key and its translation as the value. `tests/unit/workflow/test_texts.py` sees to it that none is missing.
"""

import tomllib
from functools import cache
from importlib.resources import files
from typing import Literal

Language = Literal["en", "ja"]


@cache
def catalogue(language: Language) -> dict[str, str]:
    """Read the translations of a language, by English text; empty for English itself."""
    if language == "en":
        return {}
    return tomllib.loads(files("workflow.report").joinpath(f"{language}.toml").read_text(encoding="utf-8"))


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
        found = self.translations.get(text, text)
        return found.format(**values) if values else found

    def listed(self, words: list[str]) -> str:
        """Join words as people list them: a, b and c."""
        if self.language == "ja":
            return "、".join(words)
        return " and ".join([", ".join(words[:-1]), words[-1]]) if len(words) > 1 else "".join(words)
