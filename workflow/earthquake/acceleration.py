"""Reads accelerations as people write them: "250 gal", "0.25 g", "2.5 m/s^2", "250 cm/s²", "25 %g"."""

from typing import Annotated

from pydantic import PlainSerializer, PlainValidator

from meshes.section.motion_units import motion_unit
from meshes.section.quantity import NUMBER_AND_UNIT, Kind, with_a_point


class AccelerationKind(Kind):
    """Describes an acceleration in the units of ground motion, such as g and gal, which the library pint would read as
    grams and gallons."""

    def _convert(self, text: str) -> float:
        if comma := with_a_point(text):
            raise ValueError(f'has a decimal comma; write "{comma}"; {self.expected}')
        parts = NUMBER_AND_UNIT.fullmatch(text)
        if parts is None:
            raise ValueError(f"not understood as a number with a unit; {self.expected}")
        if not parts[2]:
            raise ValueError(f"has no unit; {self.expected}, or a plain number in {self.unit}")
        unit = motion_unit(parts[2])
        if unit is None:
            raise ValueError(f'"{parts[2]}" is not understood as a unit of acceleration; {self.expected}')
        if unit.motion != "acceleration":
            raise ValueError(f'"{parts[2]}" is a unit of {unit.motion}; {self.expected}')
        return float(parts[1]) * unit.factor


ACCELERATION = AccelerationKind(
    "an acceleration", "m/s^2", '"250 gal", "0.25 g", "2.5 m/s^2" or "25 %g"', minimum=0.0, maximum=50.0,
    minimum_allowed=False, limits=" above 0 and below 50 m/s^2",
)  # fmt: skip

Acceleration = Annotated[
    float, PlainValidator(ACCELERATION.read), PlainSerializer(lambda number: getattr(number, "written", number))
]
