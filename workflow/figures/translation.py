"""Translates the texts of pictures into the language of the report of their run, from the catalogue of the report."""

import re
import textwrap
import tomllib
from functools import cache
from importlib.resources import files
from pathlib import Path

from workflow.config.tables import Language

PICTURES, SENTENCES = "pictures", "sentences"  # tables of the catalogue; values in their texts are written {}
MATH = re.compile(r"\$k_\{\\mathrm\{h\}\}\$")  # mathtext has the characters of one font
CUTS = ((". ", "。"), ("; ", "。"), (": ", ":"))  # between parts of a text, and between their translations
CHARACTERS = 44  # of a line of a text that is several lines in English
VALUE = r"((?:(?!; |: |\. ).)+?)"  # within one part


def language_of(picture: Path) -> Language:
    """Return the language of the run in whose folder a picture lies; English without a run."""
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


@cache
def _patterns(language: Language) -> tuple[tuple[re.Pattern[str], str], ...]:
    """Return the regular expressions of all texts, those with the most fixed words first, and their translations."""
    data = tomllib.loads(files("workflow.report").joinpath(f"{language}.toml").read_text(encoding="utf-8"))
    texts = {text: to for text, to in data.items() if isinstance(to, str)} | data[SENTENCES] | data[PICTURES]
    plain = {text: to for text, to in texts.items() if not re.search(r"{\w+}", text)}
    by_words = sorted(plain.items(), key=lambda pair: len(pair[0].replace("{}", "")), reverse=True)
    return tuple((re.compile(VALUE.join(map(re.escape, text.split("{}")))), to) for text, to in by_words)


def translated(text: str, language: Language) -> str:
    """Return the text of a picture in a language, in about as many lines; parts without a translation, such as names,
    are unchanged."""
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
    for pattern, to in _patterns(language):
        match = pattern.fullmatch(text)
        if match is not None:
            return to.format(*(_part(group, language) for group in match.groups()))
    for cut, joint in CUTS:
        if cut in text:
            parts = text.split(cut)
            translations = [_part(part, language).removesuffix("。") for part in parts]
            return text if translations == parts else joint.join(translations)
    return text
