"""Loads on the ground: a table [[surcharges]] for each, vertical and per metre of horizontal distance."""

from typing import Annotated, Any, Self

import numpy as np
from pydantic import ConfigDict, Field, PlainSerializer, PlainValidator, model_validator

from meshes.section.model import Model
from meshes.section.quantity import STRENGTH, Coordinate, Quantity


def _read_pressure(value: Any) -> tuple[Quantity, Quantity]:
    ends = value if isinstance(value, list | tuple) else (value, value)
    if len(ends) != 2:
        raise ValueError("expected one pressure, or one at either end")
    first, last = (STRENGTH.read(end) for end in ends)
    return first, last


def _write_pressure(ends: tuple[Quantity, Quantity]) -> Any:
    first, last = (getattr(end, "written", end) for end in ends)
    return first if first == last else [first, last]


Pressures = Annotated[tuple[float, float], PlainValidator(_read_pressure), PlainSerializer(_write_pressure)]


class Surcharge(Model):
    """A vertical load (Pa of horizontal area) on the ground, linear between its ends."""

    model_config = ConfigDict(populate_by_name=True)

    start: Coordinate = Field(alias="from", description="x of its left end, such as 20.0")
    end: Coordinate = Field(alias="to", description="x of its right end, such as 28.0")
    pressure: Pressures = Field(description='a pressure such as "20 kPa", or one at either end')
    seismic_share: float = Field(
        default=1.0,
        ge=0.0,
        le=1.0,
        description="the share of its mass that shakes with the ground, from 0 to 1",
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if not self.end > self.start:
            raise ValueError(f"from = {self.start:g} m, to = {self.end:g} m: expected the left end, then the right one")
        return self

    def at(self, x: np.ndarray, near: np.ndarray) -> np.ndarray:
        """The load (Pa) at x (n,), which are ends or inner points of a stretch whose middle is at ``near`` (n,)."""
        share = (x - self.start) / (self.end - self.start)
        first, last = self.pressure
        return np.where((near > self.start) & (near < self.end), first + share * (last - first), 0.0)
