"""Writes symbols of the field with their subscripts in pictures, captions and heads of tables: Kh is written k_h
there."""

import re

# Symbols as text, with their letter and their subscript.
SYMBOLS = {
    "Kh": ("k", "h"), "Kv": ("k", "v"), "kc": ("k", "c"), "k_max": ("k", "max"), "F_s": ("F", "s"),
    "F_L": ("F", "L"), "P_L": ("P", "L"), "s_u": ("s", "u"),
}  # fmt: skip
SYMBOL = re.compile(r"(?<![A-Za-z0-9_.])(?:" + "|".join(SYMBOLS) + r")(?![A-Za-z0-9_])")
CAPTIONS = re.compile(r"<(figcaption|caption|th)\b([^>]*)>(.*?)</\1>", re.DOTALL)
TAG = re.compile(r"(<[^>]*>)")


def in_mathtext(text: str) -> str:
    """Return a text for Matplotlib with its symbols as mathtext; other dollar signs are escaped."""
    return SYMBOL.sub(_mathtext, text.replace("$", r"\$"))


def in_captions(html: str) -> str:
    """Return a page whose captions and heads of tables have symbols with subscripts.

    Parameters
    ----------
    html : the page

    Returns
    -------
    The page with Kh, kc, F_s and so on typeset in figcaption, caption and th elements; its other text is unchanged.
    """

    def typeset(match: re.Match[str]) -> str:
        parts = TAG.split(match[3])
        words = [part if part.startswith("<") else SYMBOL.sub(_subscript, part) for part in parts]
        return f"<{match[1]}{match[2]}>{''.join(words)}</{match[1]}>"

    return CAPTIONS.sub(typeset, html)


def _mathtext(match: re.Match[str]) -> str:
    letter, index = SYMBOLS[match[0]]
    return rf"${letter}_{{\mathrm{{{index}}}}}$"


def _subscript(match: re.Match[str]) -> str:
    letter, index = SYMBOLS[match[0]]
    return f"<i>{letter}</i><sub>{index}</sub>"
