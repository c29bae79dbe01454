"""Units as reports spell them ("KPa", "ton/m3", "psf"), in the spelling and with the meaning that pint knows."""

import re

# What American and Japanese reports have and pint has not; 1 short ton (US) is 2,000 pounds.
DEFINITIONS = (
    "psf = pound_force / foot ** 2",
    "ksf = 1000 * pound_force / foot ** 2",
    "tsf = 2000 * pound_force / foot ** 2",
    "pcf = pound_force / foot ** 3",
    "kcf = 1000 * pound_force / foot ** 3",
    "pci = pound_force / inch ** 3",
    "ksc = kilogram_force / centimeter ** 2",
)

# A power written as "m3" is, "m³", and no square of a cube.
BARE_POWER = re.compile(r"(?<=[A-Za-z])([23])(?![A-Za-z\d.])")

# Prefixes and units with the wrong capitals, none of which is another unit: not "mPa", a thousandth of a pascal.
SPELLINGS = (
    (re.compile(r"\b[kK][pP][aA]\b"), "kPa"),
    (re.compile(r"\bM[pP][aA]\b"), "MPa"),
    (re.compile(r"\bG[pP][aA]\b"), "GPa"),
    (re.compile(r"\b[kK][nN]\b"), "kN"),
    (re.compile(r"\b(?:FT|Ft|feet|Feet|FEET|foot|Foot)\b"), "ft"),
    (re.compile(r"\b(?:PSF|Psf)\b"), "psf"),
    (re.compile(r"\b(?:KSF|Ksf)\b"), "ksf"),
    (re.compile(r"\b(?:TSF|Tsf)\b"), "tsf"),
    (re.compile(r"\b(?:PCF|Pcf)\b"), "pcf"),
    (re.compile(r"\b(?:KCF|Kcf)\b"), "kcf"),
    (re.compile(r"\b(?:PSI|Psi)\b"), "psi"),
    (re.compile(r"\blbs\b"), "lb"),
    (re.compile(r"\bgr\b"), "g"),  # no soil is weighed in grains
)
FOOT_OR_INCH = re.compile(r"\b(?:ft|in|inch|yd)\b")
TON = re.compile(r"\b[tT]ons?(f?)\b")


def spelled(unit: str) -> str:
    """A unit as pint reads it.

    "ton" and "tonf" are metric, as in Japanese reports, but beside feet and inches the short ones of 2,000 pounds.

    Parameters
    ----------
    unit : as it was written, such as "tonf/m2"
    """
    for power, digit in (("²", "2"), ("³", "3")):
        unit = unit.replace(power, digit)
    unit = BARE_POWER.sub(r"^\1", unit)
    for wrong, right in SPELLINGS:
        unit = wrong.sub(right, unit)
    if FOOT_OR_INCH.search(unit):
        return TON.sub(lambda ton: "force_ton" if ton[1] else "short_ton", unit)
    return TON.sub(lambda ton: "tf" if ton[1] else "t", unit)
