"""Provides the texts of the report in the language that the settings request, from one catalogue: ``ja.toml``.

Texts are written in English where they are used, as ``_("the text with {value}", value=...)``; the catalogue has every
text as a key and its translation as the value. `tests/unit/workflow/test_texts.py` checks that none is missing.
"""

import re
from collections.abc import Sequence

from workflow.config.tables import Language
from workflow.texts.catalogue import catalogue, translation_of

CASES = re.compile(r"cases? (\d(?:[\d, and]*\d)?)")
# A page is cut at scripts and at all tags but those within a sentence; a paragraph is cut behind its sentences.
CUT = re.compile(r"(<(?:script|style)\b.*?</(?:script|style)>|<(?!/?(?:i|sub|a|br)\b)[^>]*>)", re.DOTALL)
END = re.compile(r"(?<=[.。])(?<!al\.)(?<!eq\.)(?<!Sec\.) (?=[A-Z]|[^\x00-\x7f])")
EDGES = re.compile(r"([\s:;,]*)(.*?)((?:\s|<br>)*)", re.DOTALL)
VALUE = r"((?:(?!\.\ [A-Z]).)+?)"  # within one sentence
LIST = re.compile(r", and | and |, ")
CASE_NAMES = re.compile(r"(ケース[\d、]+) ?\(([^()]+)\)")
SEPARATOR = re.compile(r", and | and |, |、")
QUOTES = (("&#34;", '"'), ("&#39;", "'"))


def listed(words: Sequence[str]) -> str:
    """Return words in an English list: a, b and c.

    Parameters
    ----------
    words : words or phrases

    Returns
    -------
    The list; empty without words.
    """
    return " and ".join([", ".join(words[:-1]), words[-1]]) if len(words) > 1 else "".join(words)


class Texts:
    """Translates texts of the report into one language.

    Parameters
    ----------
    language : language of the report, "en" or "ja"
    """

    def __init__(self, language: Language = "en") -> None:
        self.language = language
        self.translations = catalogue(language)

    def __call__(self, text: str, **values: object) -> str:
        """Translate a text and fill in its values.

        Parameters
        ----------
        text : str
            English text with the names of its values in braces.
        **values : object
            Values that replace the names.

        Returns
        -------
        The text in the language of the report; in English where the catalogue has no translation.
        """
        translated = self.translations.get(text, text)
        words = {name: self._value(value) if isinstance(value, str) else value for name, value in values.items()}
        return translated.format(**words) if words else translated

    def setting(self, description: str) -> str:
        """Translate the description of a setting; unchanged if there is no translation."""
        return catalogue(self.language, "settings").get(description, description)

    def sentence(self, text: str) -> str:
        """Translate a whole sentence of a stage, with its numbers; unchanged if there is no translation."""
        if text in self.translations:
            return self.translations[text]
        whole = translation_of(text, self.language, ("sentences",), VALUE)
        if whole is None:
            return text
        translation, values = whole
        return translation.format(*map(self._value, values))

    def page(self, html: str) -> str:
        """Translate the remaining English of a page, sentence by sentence; scripts and styles are unchanged."""
        if self.language == "en":
            return html
        parts = CUT.split(html)
        return "".join(part if index % 2 else self._paragraph(part) for index, part in enumerate(parts))

    def _paragraph(self, text: str) -> str:
        """Return the sentences between two tags of a page."""
        before, words, after = EDGES.fullmatch(text).groups()  # type: ignore[union-attr]
        for code, letter in QUOTES:
            words = words.replace(code, letter)
        words = " ".join(words.split())
        whole = self._note(words)
        if whole != words:
            translation = self._on_page(words, whole)
        else:
            parts = (self._on_page(part, self.sentence(part)) for part in END.split(words))
            translation = "".join(part if part.endswith("。") else f"{part} " for part in parts).strip()
        return before + translation + after if translation != words else text

    def _note(self, text: str) -> str:
        """Translate a sentence, or a note below a table, which may end with ";". A note of a case has the words of the
        warning that names the case.
        """
        whole = self.sentence(text)
        plain = text.rstrip(";.")
        if whole != text or plain == text:
            return whole
        end, sentence = text[len(plain) :].replace(".", ""), self.sentence(f"{plain}.")
        if sentence != f"{plain}.":
            return sentence.removesuffix("。") + (end or "。")
        what, _, remedy = plain.partition(": ")
        warning, advice = f"{what[:1].upper()}{what[1:]} (case 0).", f"{remedy[:1].upper()}{remedy[1:]}."
        translations = self.sentence(warning), self.sentence(advice) if remedy else ""
        if warning == translations[0] or (remedy and advice == translations[1]):
            return text
        observation = self._plain(translations[0]).removesuffix("。").replace("(ケース0)", "")
        return observation + (f":{translations[1].removesuffix('。')}" if remedy else "") + (end or "。")

    def _on_page(self, text: str, translation: str) -> str:
        """Return the translation of a text, or the English sentence if only a part of it would be translated."""
        return text if text.endswith(".") and not translation.endswith("。") else self._plain(translation)

    def _value(self, text: str) -> str:
        """Translate a value within a text: a whole text, cases, or a range of two numbers."""
        if self.language == "en":
            return text
        translation = self.sentence(text)
        if translation == text and " and " in text:
            return "、".join(map(self._value, LIST.split(text)))
        return self._plain(translation)

    def _plain(self, text: str) -> str:
        """Translate cases, their names and ranges of numbers in a text."""
        text = CASES.sub(lambda match: f"ケース{LIST.sub('、', match[1])}", text)
        text = CASE_NAMES.sub(
            lambda match: f"{match[1]}({'、'.join(map(self._name, re.split(SEPARATOR, match[2])))})", text
        )
        return re.sub(r"(?<=\d) to (?=\d)", "~", text)

    def _name(self, name: str) -> str:
        """Return the translation of the name of a default case; names in a section file are unchanged."""
        return self.translations.get(name, catalogue(self.language, "sentences").get(name, name))

    def listed(self, words: list[str]) -> str:
        """Join words in a list: a, b and c."""
        return "、".join(words) if self.language == "ja" else listed(words)
