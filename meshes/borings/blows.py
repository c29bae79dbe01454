"""Reads blow counts as logs write them: numbers, and refusals, which are drives that ended before the full
penetration."""

import math
import re
from typing import Annotated, Any

from pydantic import PlainSerializer, PlainValidator

from meshes.section.quantity import Quantity

# What counts as a refusal (ASTM D1586: 50 blows for less than 15 cm), and how far a counted drive goes (mm).
REFUSAL, DRIVE, QUARTER, SEATED = 50.0, 300.0, 75.0, 25.0
HIGHEST = 500.0
EXPECTED = (
    f"expected the blow count for 30 cm as measured, from 0 to {HIGHEST:g}, or a refusal such as "
    '">50", "50/75 mm" or "R"'
)
MILLIMETRES = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4, "inch": 25.4, "inches": 25.4, '"': 25.4, "ft": 304.8,
               "foot": 304.8, "feet": 304.8, "'": 304.8, "": 1.0}  # fmt: skip
NUMBER = r"(\d+(?:\.\d+)?)"
AT_LEAST = re.compile(rf"(?:N\s*)?(?:>=?|≥|=>)\s*{NUMBER}|{NUMBER}\s*(?:\+|以上)", re.IGNORECASE)
# Which tool was driven, "S" the split spoon and "C" a solid cone, that it was stopped, and a mark of a footnote say
# nothing of the count.
MARKS = re.compile(r"^\(?[SC]\)?(?=[\s\d(N])\s*|\s*\(?\b[SC]\)?$|\*+|\s*-\s*abandoned$", re.IGNORECASE)
# Blows of seating and of four quarters before the count, as AGS has them: "1,2/3,4,5,6 N=18", "9,16/50 SPT =50/75".
INCREMENTS = re.compile(r"^[\d\s,/]+(?:[SC]PT\s*(?:N\s*)?=(?:\d+/\d+=)?|(?=N\s*[=:]))", re.IGNORECASE)
# A count followed by its drives in brackets, as in "N=50 (25 for 5mm/50 for 15mm)".
WITH_COUNT = re.compile(rf"N\s*[=:>]+\s*{NUMBER}(.*)|{NUMBER}\s*(\(.*\)?)", re.IGNORECASE)
# The quarters of a drive, the last one with what it went in, where that is less than 75 mm: "10,15,20,5 for 30mm".
QUARTERS = re.compile(
    rf"(?:^|[/(\s])(?P<whole>[\d\s,-]*,)?\s*{NUMBER}\s*(?:for|in)\s*{NUMBER}\s*mm\s*\)?$", re.IGNORECASE
)
# Blows for a depth with its unit, "50/75mm" or "12 blows/ft"; without one only where nothing else is written.
LENGTH = "mm|cm|m|inches|inch|in|feet|foot|ft|\"|'"
DRIVEN = re.compile(
    rf"{NUMBER}\s*(?:blows?)?\s*(?:/|-|\(\s*(?:for|pour)?|for|per|in|pour|sur|por|para|für|auf)\s*{NUMBER}?\s*({LENGTH})\.?",
    re.IGNORECASE,
)
BARE = re.compile(rf"(?<![/\d.]){NUMBER}\s*/\s*{NUMBER}")
WORDS = {"r", "ref", "ref.", "refusal", "refused", "refus", "rechazo", "rifiuto", "rebote", "abbruch", "貫入不能"}
UNDER_ITS_WEIGHT = re.compile(r"(woh|wor|wr|wh|hw|rw|sw|(モンケン|ハンマー|ロッド)?自沈)(\s*/.*)?", re.IGNORECASE)
WORD = "|".join(map(re.escape, sorted(WORDS, key=len, reverse=True)))
REFUSED = re.compile(
    rf"(?:N\s*[=:]\s*)?(?:{NUMBER}[\s(/-]*)?(?:{WORD})\)?|(?:{WORD})[\s(/-]*{NUMBER}\)?"
    rf"|(?:{WORD})\s*(?:/|for)\s*[\d.]+\s*(?:{LENGTH})",
    re.IGNORECASE,
)


def read_blows(value: Any) -> Quantity:
    """Read the blow count of a test; for a refusal return the least possible count.

    A drive that ended after ``b`` blows and ``p`` mm has a count of at least ``b``, and of 300 b / p in proportion. The
    count of such a refusal is ``b`` if ``b`` is at least 50, else the smaller of 300 b / p and 50. A sampler that sinks
    under the weight of rods or hammer ("WOH") has a count of 0.

    Raises
    ------
    ValueError : if the text is no blow count; the message states the expected form
    """
    if isinstance(value, Quantity):
        number, written = float(value), value.written
    elif isinstance(value, int | float) and not isinstance(value, bool):
        number, written = float(value), value
    elif isinstance(value, str):
        number, written = _counted(value.strip())[0], value.strip()
    else:
        raise ValueError(EXPECTED)
    if not 0.0 <= number <= HIGHEST:  # nan is not, either
        raise ValueError(EXPECTED)
    return Quantity(number, _plain(written))


def is_refusal(blows: float) -> bool:
    """Return whether a count is the least possible count of a refusal."""
    written = getattr(blows, "written", blows)
    return isinstance(written, str) and _counted(written)[1]


def _plain(written: str | float) -> str | float:
    try:
        return float(written)
    except ValueError:
        return written


def _counted(text: str) -> tuple[float, bool]:
    """Return the count in a text (NaN if there is none), and whether the sampler was refused."""
    try:
        return float(text), False
    except ValueError:
        pass
    if refused := REFUSED.fullmatch(text):
        return float(refused[1] or refused[2] or REFUSAL), True
    if UNDER_ITS_WEIGHT.fullmatch(text):
        return 0.0, False
    text = INCREMENTS.sub("", MARKS.sub("", text)).strip()
    if text.replace(".", "", 1).isdecimal():
        return float(text), False
    if least := AT_LEAST.fullmatch(text):
        return float(least[1] or least[2]), True
    return _of_drives(text)


def _of_drives(text: str) -> tuple[float, bool]:
    """Return the count of a text that states how far the sampler was driven, and whether the sampler was refused; see
    `_counted`."""
    recorded, driven = WITH_COUNT.fullmatch(text), list(DRIVEN.finditer(text))
    count = float(recorded[1] or recorded[3]) if recorded else math.nan
    if driven and driven[0].start() == 0 and text[driven[0].end() :].lstrip().startswith("("):  # "50/75mm (20,5,50)"
        return _driven(float(driven[0][1]), _depth(driven[0]))
    if quarters := QUARTERS.search(text):
        # Without a slash, what comes before the last drive may be its seating.
        whole = [float(blows) for blows in re.findall(r"\d+", quarters["whole"] or "") if recorded or "/" in text]
        count = count if recorded else sum(whole) + float(quarters[2])
        return _driven(count, QUARTER * len(whole) + float(quarters[3]))
    bare = next((match for match in BARE.finditer(text) if match.end() == len(text)), None)
    if bare and not driven:
        counted = _without_unit(count if recorded else float(bare[1]), float(bare[2]))
        return counted if counted[1] or not recorded else (count, False)
    if driven and driven[-1].end() == len(text.rstrip(") ")):
        return _driven(count if recorded else float(driven[-1][1]), _depth(driven[-1]))
    if count == 0.0 and any(float(drive[1]) >= SEATED for drive in driven):  # it was stopped while it was seated
        return REFUSAL, True
    return count, bool(recorded) and ">" in text


def _depth(drive: re.Match[str]) -> float:
    """Return the penetration (mm) of a drive."""
    return float(drive[2] or 1.0) * MILLIMETRES[drive[3].lower()]


def _without_unit(blows: float, depth: float) -> tuple[float, bool]:
    """Return the count of a text such as "12/30", "50/75" or "47/0.29", and whether the sampler was refused. The
    penetration is in cm, as in Japanese logs, in mm or in m.

    The count is NaN if cm and mm would give different counts.
    """
    if depth in (30.0, DRIVE):
        return blows, False
    if 0.0 < depth < 1.0:
        return _driven(blows, 1000.0 * depth)
    return _driven(blows, depth) if blows >= REFUSAL or depth == 0.0 or depth > 45.0 else (math.nan, False)


def _driven(blows: float, depth: float) -> tuple[float, bool]:
    """Return the count of ``blows`` for a ``depth`` (mm) of the drive, and whether the drive ended early."""
    if depth >= 0.98 * DRIVE:  # 30 cm or a foot: it went in
        return blows, False
    if blows >= REFUSAL:
        return blows, True
    return REFUSAL if depth == 0.0 else min(REFUSAL, blows * DRIVE / depth), True


Blows = Annotated[float, PlainValidator(read_blows), PlainSerializer(lambda number: getattr(number, "written", number))]
