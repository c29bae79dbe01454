"""Finds fonts for names in any script: a font on this machine that has their characters, or the name of a font to
install."""

from collections.abc import Iterable
from functools import cache
from pathlib import Path

from matplotlib import font_manager
from matplotlib.ft2font import FT2Font

PLAIN = "DejaVu Sans"  # comes with matplotlib: Latin, Greek, Cyrillic, Arabic
# Looked at first, so that a text is set in the same font on every machine that has it.
PREFERRED = ("NotoSansCJK", "ipaexg", "ipag", "TakaoPGothic", "NotoSans")
UNKNOWN = "?"  # replaces characters that no font of this machine has
ASKED_FOR = "Noto's fonts have them: on Debian and Ubuntu apt install fonts-noto-cjk, or fonts-noto"


def files_for(text: str) -> tuple[str, ...]:
    """Return the font files that together have the characters of a text, the default font first, as far as they are
    installed.
    """
    files = [font_manager.findfont(PLAIN)]
    left = _lacking(files, frozenset(text))
    for file in _others() if left else ():
        if left and (more := left - _lacking([file], left)):
            files.append(file)
            left -= more
    return tuple(files)


def file_for(text: str) -> str:
    """Return the file of the font with most characters of a text, for programs that use only one font at a time."""
    return min(files_for(text), key=lambda file: len(_lacking([file], frozenset(text))))


def families_for(text: str) -> list[str]:
    """Return the names by which matplotlib knows these fonts."""
    names = []
    for file in files_for(text):
        if file not in {entry.fname for entry in font_manager.fontManager.ttflist}:
            font_manager.fontManager.addfont(file)  # installed after matplotlib had listed the fonts
        names.append(next(entry.name for entry in font_manager.fontManager.ttflist if entry.fname == file))
    return names


def missing(text: str) -> str:
    """Return the characters of a text that no font of this machine has."""
    left = _lacking(files_for(text), frozenset(text))
    return "".join(sorted(left, key=text.index))


def notice(texts: Iterable[str]) -> str:
    """Return a sentence on the characters that no font can show, and on the font that could.

    Parameters
    ----------
    texts : texts of a picture

    Returns
    -------
    The sentence; empty if all characters can be shown.
    """
    missing_characters = missing("".join(texts))
    if not missing_characters:
        return ""
    return f"no font on this machine has {missing_characters}, so pictures show {UNKNOWN} in their place; {ASKED_FOR}"


def _lacking(files: Iterable[str], characters: frozenset[str]) -> frozenset[str]:
    printed = {character for character in characters if not character.isspace()}
    return frozenset(character for character in printed if not any(ord(character) in _characters(f) for f in files))


@cache
def _characters(file: str) -> frozenset[int]:
    try:
        return frozenset(FT2Font(file).get_charmap())
    except (OSError, RuntimeError):  # a file that is no font, or of a kind that FreeType does not read
        return frozenset()


@cache
def _others() -> tuple[str, ...]:
    """Return all fonts of this machine, those preferred first and bold ones last."""
    files = set(font_manager.findSystemFonts())

    def order(file: str) -> tuple[int, bool, str]:
        name = Path(file).stem
        rank = next((place for place, begin in enumerate(PREFERRED) if name.startswith(begin)), 99)
        return rank, "Regular" not in name, file

    return tuple(sorted(files, key=order))
