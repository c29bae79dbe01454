"""Reads units of ground motion as people and networks write them: "gal", "cm/sec/sec", "0.01 g", "%g", "kine", "ms"."""

import re
from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from meshes.section.quantity import GRAVITY

Motion = Literal["acceleration", "velocity", "displacement"]

LENGTHS = {"um": 1e-6, "mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254, "inch": 0.0254, "ft": 0.3048}  # m
SECOND = r"(?:s|secs?|seconds?)"
# What stands behind a length: per second, or per second squared, with a slash or a negative power.
PER = {
    "acceleration": re.compile(rf"/\(?{SECOND}\^?2\)?|/{SECOND}/{SECOND}|{SECOND}\^?-2"),
    "velocity": re.compile(rf"/{SECOND}|{SECOND}\^?-1"),
}
NAMED: dict[str, tuple[Motion, float]] = {
    **dict.fromkeys(("g", "gs", "g's", "gn"), ("acceleration", GRAVITY)),
    **dict.fromkeys(("%g", "pctg", "percentg"), ("acceleration", 0.01 * GRAVITY)),
    **dict.fromkeys(("mg", "milli-g", "millig"), ("acceleration", 0.001 * GRAVITY)),
    **dict.fromkeys(("gal", "gals"), ("acceleration", 0.01)),
    "mgal": ("acceleration", 1e-5),
    **dict.fromkeys(("kine", "kines"), ("velocity", 0.01)),
}
TIMES = {
    **dict.fromkeys(("s", "sec", "secs", "second", "seconds"), 1.0),
    **dict.fromkeys(("ms", "msec", "msecs", "millisecond", "milliseconds"), 1e-3),
    **dict.fromkeys(("us", "usec", "microseconds"), 1e-6),
    **dict.fromkeys(("min", "minutes"), 60.0),
}
EXPECTED = 'expected one such as "g", "%g", "m/s^2", "gal" or "cm/sec^2"'


@dataclass(frozen=True)
class MotionUnit:
    """Describes a unit of ground motion.

    Attributes
    ----------
    motion : quantity that the unit measures: "acceleration", "velocity" or "displacement"
    factor : size of the unit in m/s², m/s or m
    """

    motion: Motion
    factor: float


def motion_unit(written: str) -> MotionUnit | None:
    """Return the unit of an acceleration, a velocity or a displacement.

    Parameters
    ----------
    written : unit as written in a heading or a setting, in any case: "CM/SEC/SEC", "cm/s²", "gal(cm/s/s)", "m s-2", "%
        g"

    Returns
    -------
    The unit; None if the word is no such unit.
    """
    word = "".join(written.lower().split()).replace("²", "2").replace("**", "^").replace("⁻", "-").replace("µ", "u")
    word = word.replace("·", "").replace("*", "").strip(".,;:")
    if unit := NAMED.get(word):
        return MotionUnit(*unit)
    if parts := re.fullmatch(r"(gals?)\((.+)\)", word):  # both say the same, or it is none
        in_brackets = motion_unit(parts[2])
        return in_brackets if in_brackets == motion_unit(parts[1]) else None
    parts = re.fullmatch(r"(um|mm|cm|ft|inch|in|m)(.*)", word)
    if parts is None:
        return None
    if not parts[2]:
        return MotionUnit("displacement", LENGTHS[parts[1]])
    for motion, per in PER.items():
        if per.fullmatch(parts[2]):
            return MotionUnit("acceleration" if motion == "acceleration" else "velocity", LENGTHS[parts[1]])
    return None


def time_unit(written: str) -> float | None:
    """Return the seconds in a unit of time.

    Parameters
    ----------
    written : unit as written in a heading, in any case, such as "sec", "ms" or "minutes"

    Returns
    -------
    Size of the unit (s); None if the word is no such unit.
    """
    return TIMES.get(written.strip().strip(".,;:").lower().replace("µ", "u"))


def checked(written: str) -> str:
    """Return a unit of a record from a setting, or nothing. Raises ValueError if it is no unit of ground motion."""
    if written and motion_unit(written) is None:
        raise ValueError(f"not a unit of ground motion; {EXPECTED}")
    return written


RecordUnit = Annotated[
    str,
    AfterValidator(checked),
    Field(description='the unit of the record where its heading names none: "g", "m/s^2", "gal", "cm/sec^2", "%g"'),
]
RecordComponent = Annotated[
    str,
    Field(description='which component of a file with several, as its heading names it, such as "EW", or its number'),
]
RecordScale = Annotated[float, Field(gt=0.0, le=100.0, description="a number that multiplies the record, above 0")]
