"""Reads accelerations as people write them: "250 gal", "0.25 g", "2.5 m/s^2", "250 cm/s²", "25 %g"."""

from typing import Annotated, Any

from pydantic import PlainSerializer, PlainValidator

from meshes.section.motion_units import motion_unit
from meshes.section.quantity import NUMBER_AND_UNIT, Kind, Quantity, with_a_point

ACCELERATION = Kind(
    "an acceleration", "m/s^2", '"250 gal", "0.25 g", "2.5 m/s^2" or "25 %g"', minimum=0.0, maximum=50.0,
    minimum_allowed=False, limits=" above 0 and below 50 m/s^2",
)  # fmt: skip


def read(value: Any) -> Quantity:
    """Read an acceleration in m/s²; raise ValueError with the expected form."""
    if not isinstance(value, str):
        return ACCELERATION.read(value)
    if comma := with_a_point(value):
        raise ValueError(f'has a decimal comma; write "{comma}"; {ACCELERATION.expected}')
    parts = NUMBER_AND_UNIT.fullmatch(value)
    if parts is None:
        raise ValueError(f"not understood as a number with a unit; {ACCELERATION.expected}")
    if not parts[2]:
        raise ValueError(f"has no unit; {ACCELERATION.expected}, or a plain number in m/s^2")
    # pint reads g as grams and gal as gallons.
    unit = motion_unit(parts[2])
    if unit is None:
        raise ValueError(f'"{parts[2]}" is not understood as a unit of acceleration; {ACCELERATION.expected}')
    if unit.motion != "acceleration":
        raise ValueError(f'"{parts[2]}" is a unit of {unit.motion}; {ACCELERATION.expected}')
    return Quantity(ACCELERATION.read(float(parts[1]) * unit.factor), value)


Acceleration = Annotated[
    float, PlainValidator(read), PlainSerializer(lambda number: getattr(number, "written", number))
]
