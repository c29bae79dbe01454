"""Spells out characters for terminals and pipes that are not UTF-8: characters missing in their encoding are spelled
out, ψ as psi."""

import codecs
import sys
import unicodedata
from typing import TextIO

SPELLED_OUT = "spelled out"  # the name of the handler of errors
SIGNS = {
    "²": "^2", "³": "^3", "⁴": "^4", "¹": "^1", "⁻": "^-", "ᵀ": "^T", "°": " deg", "·": " ", "×": "x", "±": "+/-",
    "√": "sqrt", "∛": "cbrt", "≤": "<=", "≥": ">=", "≈": "~", "→": "->", "∞": "inf", "–": "-", "—": "-", "−": "-",
    "ß": "ss", "æ": "ae", "Æ": "AE", "œ": "oe", "ø": "o", "Ø": "O", "ł": "l", "Ł": "L", "đ": "d", "ı": "i",
    "…": "...", "‘": "'", "’": "'", "“": '"', "”": '"', "µ": "u", "▸": ">", "✓": "+", "✗": "x", "█": "#", "░": ".",
}  # fmt: skip


def spelled(character: str) -> str:
    """Return a character in ASCII: a sign, the name of a Greek letter, the letter without its accent, or its code."""
    if character in SIGNS:
        return SIGNS[character]
    kind, _, name = unicodedata.name(character, "").partition(" LETTER ")
    if kind in ("GREEK SMALL", "GREEK CAPITAL"):
        name = name.partition(" WITH ")[0].removeprefix("FINAL ").lower()
        return name.capitalize() if kind.endswith("CAPITAL") else name
    plain = unicodedata.normalize("NFKD", character).encode("ascii", "ignore").decode()
    return plain or character.encode("ascii", "backslashreplace").decode()


def _handler(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(map(spelled, error.object[error.start : error.end])), error.end


codecs.register_error(SPELLED_OUT, _handler)


def spell_out() -> None:
    """Make the streams of this process spell out characters that their encoding does not have."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors=SPELLED_OUT)


def legible(text: str, stream: TextIO | None = None) -> str:
    """Return a text as a stream will show it; tables need its width.

    Parameters
    ----------
    text : the text
    stream : where the text is written; None for standard output

    Returns
    -------
    The text with the characters that the encoding of the stream lacks spelled out, such as psi for ψ.
    """
    encoding = getattr(stream or sys.stdout, "encoding", None) or "utf-8"
    return text.encode(encoding, SPELLED_OUT).decode(encoding)


def is_legible(text: str) -> bool:
    """Return whether standard output has every character of a text.

    Parameters
    ----------
    text : the text

    Returns
    -------
    False if the encoding of standard output lacks a character, which is then spelled out.
    """
    return legible(text) == text
