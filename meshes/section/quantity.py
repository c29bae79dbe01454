"""Reads quantities as written in a file ("1560 tf/m^2", "35 deg", or a plain SI number), which are SI numbers inside
the program."""

import math
import re
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import PlainSerializer, PlainValidator

if TYPE_CHECKING:
    import pint

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


def spelling_of(unit: str) -> str:
    """Return a unit in the spelling of pint.

    "ton" and "tonf" are metric, as in Japanese reports, but together with feet and inches they are short tons of 2,000
    pounds.

    Parameters
    ----------
    unit : unit as written, such as "tonf/m2"
    """
    for power, digit in (("²", "2"), ("³", "3")):
        unit = unit.replace(power, digit)
    unit = BARE_POWER.sub(r"^\1", unit)
    for wrong, right in SPELLINGS:
        unit = wrong.sub(right, unit)
    if FOOT_OR_INCH.search(unit):
        return TON.sub(lambda ton: "force_ton" if ton[1] else "short_ton", unit)
    return TON.sub(lambda ton: "tf" if ton[1] else "t", unit)


# Standard gravity (m/s²), which also turns tonnes-force into newtons.
GRAVITY = 9.80665

# A number, then a unit. Not a sum, a product or a power of numbers; and no comma, which is a decimal point to some
# and nothing to others.
NUMBER_AND_UNIT = re.compile(
    r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[-+]?(?:nan|inf)\b)\s*([^\d,]?[^,]{0,40}?)\s*"
)
# Three digits behind a comma are thousands to some.
DECIMAL_COMMA = re.compile(r"\s*([-+]?\d*),(\d{1,2}|\d{4,})(?![\d,.])(.*)", re.DOTALL)


# What most files are written in: SI unit and factor. pint knows these, too, and all others, but takes 0.3 s to load.
COMMON_UNITS = {
    "m": ("m", 1.0),
    "km": ("m", 1e3),
    "cm": ("m", 1e-2),
    "mm": ("m", 1e-3),
    "m/s": ("m/s", 1.0),
    "Pa": ("Pa", 1.0),
    "kPa": ("Pa", 1e3),
    "MPa": ("Pa", 1e6),
    "GPa": ("Pa", 1e9),
    "kN/m^2": ("Pa", 1e3),
    "tf/m^2": ("Pa", 1e3 * GRAVITY),
    "kg/m^3": ("kg/m^3", 1.0),
    "t/m^3": ("kg/m^3", 1e3),
    "kN/m^3": ("N/m^3", 1e3),
    "kN/m^3/g_0": ("kg/m^3", 1e3 / GRAVITY),
    "kPa/m": ("Pa/m", 1e3),
    "rad": ("rad", 1.0),
    "deg": ("rad", math.pi / 180.0),
    "°": ("rad", math.pi / 180.0),
}


class Quantity(float):
    """Holds a number in SI units, and the text in which it was written.

    A file can therefore be written back unchanged.

    Parameters
    ----------
    value : the number in SI units
    written : text or number in the file; ``value`` if left out
    """

    written: str | float

    def __new__(cls, value: float, written: str | float | None = None) -> "Quantity":
        number = super().__new__(cls, value)
        number.written = value if written is None else written
        return number

    def __reduce__(self) -> tuple[type, tuple[float, str | float]]:
        return Quantity, (float(self), self.written)


@dataclass(frozen=True)
class Kind:
    """Describes a physical quantity: its name, its unit and its limits.

    Attributes
    ----------
    name : name with the article
    unit : SI unit; empty for a ratio
    example : an example for messages
    minimum, maximum : limits in SI units; the maximum itself is not allowed
    minimum_allowed : whether the minimum itself is allowed
    limits : the limits in words, for messages
    times_gravity : whether a density may be given as a unit weight, and the reverse
    """

    name: str
    unit: str
    example: str
    minimum: float = -math.inf
    maximum: float = math.inf
    minimum_allowed: bool = True
    limits: str = ""
    times_gravity: bool = False

    @property
    def expected(self) -> str:
        return f"expected {self.name}{self.limits}, such as {self.example}"

    def read(self, value: Any) -> Quantity:
        """Return the SI number of a written quantity. Raises ValueError with the expected form."""
        if isinstance(value, Quantity):
            number, written = float(value), value.written
        elif isinstance(value, str):
            number, written = self._convert(value), value
        elif isinstance(value, int | float) and not isinstance(value, bool):
            try:
                number, written = float(value), value
            except OverflowError:  # a whole number of more than 308 digits
                number, written = math.inf, math.inf
        else:
            raise ValueError(self.expected)
        if not math.isfinite(number):
            raise ValueError(f"not a finite number; {self.expected}")
        too_low = number < self.minimum or (number == self.minimum and not self.minimum_allowed)
        if too_low or number >= self.maximum:
            hint = ""
            if self.unit == "rad" and not isinstance(written, str):
                hint = f' (a plain number is in radians; did you mean "{written} deg"?)'
            raise ValueError(f"out of range{hint}; {self.expected}")
        return Quantity(number, written)

    def _convert(self, text: str) -> float:
        if comma := with_a_point(text):
            raise ValueError(f'has a decimal comma; write "{comma}"; {self.expected}')
        parts = NUMBER_AND_UNIT.fullmatch(text)
        wanted = spelling_of(parts[2]) if parts else ""
        unit, factor = COMMON_UNITS.get(wanted, ("", 0.0))
        if parts and unit and unit == self.unit:
            return float(parts[1]) * factor
        if parts and self.times_gravity and (unit, self.unit) == ("N/m^3", "kg/m^3"):
            return float(parts[1]) * factor * (1.0 / GRAVITY)
        registry = unit_registry()
        if not parts or re.search(r"\d{3}|(\^|\*\*)[^/*]*(\^|\*\*)", wanted):
            raise ValueError(f"not understood as a number with a unit; {self.expected}")
        try:
            quantity: Any = registry.Quantity(float(parts[1]), registry.parse_units(wanted))
        except Exception as error:  # pint raises what its tokenizer raises
            raise ValueError(f"not understood as a number with a unit; {self.expected}") from error
        if quantity.unitless and self.unit:
            raise ValueError(f"has no unit; {self.expected}, or a plain number in {self.unit}")
        for factor, unit in ((GRAVITY, f"{self.unit} / (m / s^2)"), (1.0 / GRAVITY, f"{self.unit} * m / s^2")):
            if self.times_gravity and quantity.is_compatible_with(registry.Unit(unit)):
                return float(quantity.to(unit).magnitude) * factor
        same_dimension = quantity.is_compatible_with(registry.Unit(self.unit))
        angle_for_ratio = not self.unit and not quantity.unitless
        if not same_dimension or angle_for_ratio:
            mass = self.unit == "Pa" and quantity.is_compatible_with(registry.Unit("kg / m^2"))
            hint = ", a mass per area: write tf, kgf or lbf for a force" if mass else ""
            raise ValueError(f"has the wrong dimension ({quantity.units}){hint}; {self.expected}")
        return float(quantity.to(self.unit).magnitude)


def with_a_point(text: str) -> str:
    """Return a number that was written with a decimal comma, with a decimal point.

    Parameters
    ----------
    text : a number, with or without a unit, or another text

    Returns
    -------
    The number with its unit; empty for a text without a decimal comma.
    """
    parts = DECIMAL_COMMA.fullmatch(text)
    return f"{parts[1] or 0}.{parts[2]}{parts[3]}".strip() if parts else ""


@cache
def unit_registry() -> "pint.UnitRegistry":
    """Return the units of pint, with those of American and Japanese soil reports (`DEFINITIONS`).

    Returns
    -------
    The registry, which is made once in a process.
    """
    import pint

    registry: pint.UnitRegistry = pint.UnitRegistry()
    for definition in DEFINITIONS:
        registry.define(definition)
    return registry


def _field(kind: Kind) -> Any:
    # Not BeforeValidator: pydantic's own reading of a float would forget how it was written.
    return Annotated[
        float, PlainValidator(kind.read), PlainSerializer(lambda number: getattr(number, "written", number))
    ]


LENGTH = Kind("a length", "m", '"1.5 m"', minimum=0.0, minimum_allowed=False, limits=" above 0")
# Beyond 10,000 km nothing is a section on the Earth, and the last digit of a number is coarser than a layer's contact.
COORDINATE = Kind(
    "a coordinate or depth", "m", '12.5 or "41 ft"', minimum=-1e7, maximum=1e7, limits=" within 10,000 km of zero"
)
HEIGHT = Kind("a height", "m", '"0.5 m"', minimum=0.0, limits=" of 0 or more")
STIFFNESS = Kind("a stiffness", "Pa", '"15.3 MPa"', minimum=0.0, minimum_allowed=False, limits=" above 0")
STRENGTH = Kind("a stress", "Pa", '"10 tf/m^2"', minimum=0.0, limits=" of 0 or more")
DENSITY = Kind(
    "a density or unit weight",
    "kg/m^3",
    '"1.8 t/m^3" or "18 kN/m^3"',
    minimum=0.0,
    limits=" of 0 or more",
    times_gravity=True,
)
GRADIENT = Kind("a stress per length", "Pa/m", '"2 kPa/m"', minimum=0.0, limits=" of 0 or more")
UNIT_WEIGHT = Kind(
    "a unit weight",
    "N/m^3",
    '"9.81 kN/m^3"',
    minimum=0.0,
    minimum_allowed=False,
    limits=" above 0",
    times_gravity=True,
)
PERMEABILITY = Kind("a permeability", "m/s", '"1e-5 m/s"', minimum=0.0, minimum_allowed=False, limits=" above 0")
RATIO = Kind("a ratio", "", "0.3", minimum=0.0, limits=" of 0 or more")
ANGLE = Kind("an angle", "rad", '"35 deg"', minimum=0.0, maximum=math.pi / 2, limits=" from 0 to below 90 deg")
POISSON = Kind("a Poisson's ratio", "", "0.33", minimum=0.0, maximum=0.5, limits=" from 0 to below 0.5")

Length = _field(LENGTH)
Height = _field(HEIGHT)
Coordinate = _field(COORDINATE)
Stiffness = _field(STIFFNESS)
Strength = _field(STRENGTH)
Density = _field(DENSITY)
Gradient = _field(GRADIENT)
UnitWeight = _field(UNIT_WEIGHT)
Permeability = _field(PERMEABILITY)
Ratio = _field(RATIO)
Angle = _field(ANGLE)
PoissonsRatio = _field(POISSON)
