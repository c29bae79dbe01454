"""Translates the texts of pictures into the language of the report of their run, from the catalogue of the report."""

import re
import textwrap
import tomllib
from functools import cache
from pathlib import Path

from workflow.config.tables import Language
from workflow.texts.catalogue import Table, translation_of

TABLES: tuple[Table, ...] = ("report", "sentences", "pictures")  # in which texts of pictures may be
MATH = re.compile(r"\$k_\{\\mathrm\{h\}\}\$")  # mathtext has the characters of one font
CUTS = ((". ", "。"), ("; ", "。"), (": ", ":"))  # between parts of a text, and between their translations
CHARACTERS = 44  # of a line of a text that is several lines in English
VALUE = r"((?:(?!; |: |\. ).)+?)"  # within one part


def language_of(picture: Path) -> Language:
    """Return the language of the run in whose folder a picture lies.

    Parameters
    ----------
    picture : file in figures/ of the folder of a run

    Returns
    -------
    The language of [report] in section.toml of the folder; English without a run.
    """
    section = picture.resolve().parent.parent / "section.toml"
    try:
        return "ja" if _report(section, section.stat().st_mtime_ns).get("language") == "ja" else "en"
    except OSError:
        return "en"


@cache
def _report(section: Path, changed: int) -> dict[str, object]:
    """Return the table [report] of a section file, last changed at ``changed`` (ns)."""
    table: dict[str, object] = tomllib.loads(section.read_text(encoding="utf-8")).get("report", {})
    return table


def translated(text: str, language: Language) -> str:
    """Return the text of a picture in a language, in about as many lines.

    Parameters
    ----------
    text : English text, which may have mathtext
    language : language of the report

    Returns
    -------
    The translation; parts without a translation, such as names, are unchanged.
    """
    if language == "en" or not re.search("[A-Za-z]{2}", text):
        return text
    part = _part(" ".join(MATH.sub("Kh", text).split()), language)
    part = re.sub(r"(?<=\d) to (?=\d)", "~", part)
    return "\n".join(textwrap.wrap(part, CHARACTERS)) if "\n" in text else part


def _part(text: str, language: Language) -> str:
    """Return the translation of a whole text, or of its parts; the text itself if none of them has one."""
    if text.endswith("."):
        part = _part(text.removesuffix("."), language)
        return text if part == text.removesuffix(".") else f"{part}。"
    whole = translation_of(text, language, TABLES, VALUE)
    if whole is not None:
        translation, values = whole
        return translation.format(*(_part(value, language) for value in values))
    for cut, joint in CUTS:
        if cut in text:
            parts = text.split(cut)
            translations = [_part(part, language).removesuffix("。") for part in parts]
            return text if translations == parts else joint.join(translations)
    return text
