"""The text of a file that others wrote: in UTF-8, UTF-16, or in what Windows wrote before."""

import codecs
from pathlib import Path
from typing import NamedTuple

from meshes.errors import InputError

MARKS = ((codecs.BOM_UTF8, "utf-8-sig"), (codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16"))


class Text(NamedTuple):
    """The text of a file, and a sentence where its encoding is a guess; else empty."""

    text: str
    notice: str


def read_text(path: Path) -> Text:
    """The text of a file.

    Without a mark it is UTF-8, UTF-16 where every other byte is zero, cp932 where the bytes beyond ASCII come in pairs
    that are Japanese, else cp1252. Raises InputError where the file cannot be read.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(str(path), [f"cannot be read: {error.strerror}"]) from None
    for mark, encoding in MARKS:
        if data.startswith(mark):
            return Text(_decoded(path, data, encoding), "")
    if data[1:200:2].count(0) > len(data[1:200:2]) // 2:
        return Text(_decoded(path, data, "utf-16-le"), "")
    try:
        return Text(data.decode("utf-8"), "")
    except UnicodeDecodeError:
        encoding = "cp932" if _is_japanese(data) else "cp1252"
        told = (
            f"{path.name} is no UTF-8 text and is read as {encoding}: look at the names with other letters than a to z"
        )
        return Text(data.decode(encoding, errors="replace"), told)


def _decoded(path: Path, data: bytes, encoding: str) -> str:
    try:
        return data.decode(encoding)
    except UnicodeDecodeError:
        raise InputError(str(path), [f"cannot be read: it is not {encoding.upper()} text"]) from None


def _is_japanese(data: bytes) -> bool:
    """Whether text in cp932 is likely: it decodes, and most of what is beyond ASCII is kana and kanji."""
    try:
        letters = [letter for letter in data.decode("cp932") if ord(letter) > 127]
    except UnicodeDecodeError:
        return False
    bytes_beyond = sum(byte > 127 for byte in data)
    # Where a Western letter and the next one are taken for a kanji, there is one byte beyond ASCII for each.
    return bool(letters) and bytes_beyond > 1.4 * len(letters)
