"""Reads the catalogue of texts of a language, and finds the translation of a text in it.

The catalogue is the file ``<language>.toml`` of the report, with the English texts as keys. Texts of the report stand
at its top; their values have names in braces. The other tables have whole sentences of the stages and texts of
pictures; their values are written {}.
"""

import re
import tomllib
from functools import cache
from importlib.resources import files
from typing import Any, Literal

from workflow.config.tables import Language

Table = Literal["report", "sentences", "pictures", "settings"]


@cache
def _file(language: Language) -> dict[str, Any]:
    """Return the content of the catalogue of a language; empty tables for English."""
    if language == "en":
        return {"sentences": {}, "pictures": {}, "settings": {}}
    return tomllib.loads(files("workflow.report").joinpath(f"{language}.toml").read_text(encoding="utf-8"))


@cache
def catalogue(language: Language, table: Table = "report") -> dict[str, str]:
    """Return the translations in one table of the catalogue.

    Parameters
    ----------
    language : Language
        Language of the translations.
    table : "report", "sentences", "pictures" or "settings"
        Table of the catalogue.

    Returns
    -------
    The translations by English text; empty for English itself.
    """
    data = _file(language)
    texts: dict[str, str] = data if table == "report" else data[table]
    return {text: translation for text, translation in texts.items() if isinstance(translation, str)}


@cache
def _patterns(language: Language, tables: tuple[Table, ...], value: str) -> tuple[tuple[re.Pattern[str], str], ...]:
    """Return the regular expressions of texts whose values have no names, and their translations; texts with the most
    fixed words come first. ``value`` is the expression of one value. Later tables replace texts of earlier ones.
    """
    texts = {text: translation for table in tables for text, translation in catalogue(language, table).items()}
    unnamed = {text: translation for text, translation in texts.items() if not re.search(r"{\w+}", text)}
    by_words = sorted(unnamed.items(), key=lambda pair: len(pair[0].replace("{}", "")), reverse=True)
    return tuple((re.compile(value.join(map(re.escape, text.split("{}")))), to) for text, to in by_words)


def translation_of(
    text: str, language: Language, tables: tuple[Table, ...], value: str
) -> tuple[str, tuple[str, ...]] | None:
    """Find the translation of a whole text, which may have values.

    Parameters
    ----------
    text : str
        English text.
    language : Language
        Language of the translation.
    tables : tuple of tables
        Tables of the catalogue in which the text may be.
    value : str
        Regular expression of one value, with one group.

    Returns
    -------
    The translation with numbers in braces, and the values that replace them; None without a translation.
    """
    for pattern, translation in _patterns(language, tables, value):
        match = pattern.fullmatch(text)
        if match is not None:
            return translation, match.groups()
    return None
