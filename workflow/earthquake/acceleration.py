"""Accelerations as people write them: "250 gal", "0.25 g", "2.5 m/s^2"."""

from typing import Annotated, Any

from pydantic import PlainSerializer, PlainValidator

from meshes.section.quantity import GRAVITY, Kind, Quantity

GAL = 0.01  # m/s²
# pint reads g as grams and gal as gallons.
WRITTEN = {"g": GRAVITY, "gal": GAL, "cm/s^2": GAL, "m/s^2": 1.0}
ACCELERATION = Kind(
    "an acceleration", "m/s^2", '"250 gal", "0.25 g" or "2.5 m/s^2"', minimum=0.0, maximum=50.0, minimum_allowed=False,
    limits=" above 0 and below 50 m/s^2",
)  # fmt: skip


def read(value: Any) -> Quantity:
    """The acceleration in m/s²; raises ValueError that says what was expected."""
    if isinstance(value, str):
        number, _, unit = value.strip().partition(" ")
        factor = WRITTEN.get(unit.strip().lower())
        try:
            if factor is not None:
                return Quantity(ACCELERATION.read(float(number) * factor), value)
        except OverflowError:
            pass
        except ValueError as error:
            raise ValueError(str(error) if ACCELERATION.name in str(error) else ACCELERATION.expected) from None
        raise ValueError(f"not understood as a number with a unit; {ACCELERATION.expected}")
    return ACCELERATION.read(value)


Acceleration = Annotated[
    float, PlainValidator(read), PlainSerializer(lambda number: getattr(number, "written", number))
]
