"""Reads the text of a file from another program, in UTF-8, UTF-16, or an older encoding of Windows."""

import codecs
import re
from functools import cache
from pathlib import Path
from typing import NamedTuple

from meshes.errors import InputError

MARKS = ((codecs.BOM_UTF8, "utf-8-sig"), (codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16"))


class Text(NamedTuple):
    """Holds the text of a file, and a sentence if its encoding is a guess; else empty."""

    text: str
    notice: str


def read_text(path: Path) -> Text:
    """Read the text of a file.

    Without a byte order mark the encoding is UTF-8, or UTF-16 if every other byte is zero, or cp932 if the bytes beyond
    ASCII form Japanese pairs, else cp1252.

    Parameters
    ----------
    path : path of the file

    Returns
    -------
    The text, and a notice if the encoding is a guess.

    Raises
    ------
    InputError
        If the file cannot be read.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(str(path), [f"cannot be read: {error.strerror}"]) from None
    for mark, encoding in MARKS:
        if data.startswith(mark):
            return Text(_decoded(path, data, encoding), "")
    for first, encoding in ((1, "utf-16-le"), (0, "utf-16-be")):
        if data[first:200:2].count(0) > len(data[first:200:2]) // 2:
            return Text(_decoded(path, data, encoding), "")
    try:
        return Text(data.decode("utf-8"), "")
    except UnicodeDecodeError:
        encoding = "cp932" if _is_japanese(data) else "cp1252"
        message = f"{path.name} is not UTF-8 text and is read as {encoding}: check names with letters other than a to z"
        return Text(data.decode(encoding, errors="replace"), message)


def _decoded(path: Path, data: bytes, encoding: str) -> str:
    try:
        return data.decode(encoding)
    except UnicodeDecodeError:
        raise InputError(str(path), [f"cannot be read: it is not {encoding.upper()} text"]) from None


def _is_japanese(data: bytes) -> bool:
    """Return whether ``data`` is likely Japanese text in cp932, which decodes to mostly Japanese letters beyond ASCII.

    Western text decodes differently: a Western letter and the character after it decode as a rare kanji, as a sign of
    no script, or as a single kana of half width; Western quotation marks and dashes decode as a kanji in the middle of
    a word.
    """
    try:
        text = data.decode("cp932")
    except UnicodeDecodeError:
        return False
    japanese = sum(len(run) for run in _japanese().findall(text))
    return japanese > 0.5 * sum(ord(letter) > 127 for letter in text)


@cache
def _japanese() -> re.Pattern[str]:
    """Return a run of Japanese characters that is not within a Western word: kana, kanji of JIS level 1 and the kanji
    for gravel, and signs of full width; of kana of half width at least two.
    """
    common = "礫" + "".join(
        char for lead in (*range(0x81, 0x84), *range(0x88, 0x98)) for trail in range(0x40, 0xFD)
        if len(char := bytes((lead, trail)).decode("cp932", "ignore")) == 1 and not "\0" <= char < "\x80"
        and not "\uff61" <= char <= "\uff9f"
    )  # fmt: skip
    return re.compile(rf"(?<![A-Za-z])[{re.escape(common)}]+(?![a-z])|(?<![A-Za-z])[\uff66-\uff9f]{{2,}}(?![a-z])")
