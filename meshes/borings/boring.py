"""A boring on the line of a section, with the blow counts that were measured in it."""

from itertools import pairwise
from typing import Self

from pydantic import Field, model_validator

from meshes.section.quantity import Coordinate, Length
from meshes.section.section import Model


class Sample(Model):
    """One standard penetration test, and what the sampler brought up."""

    depth: Length = Field(description='the depth below the ground in the middle of the test, such as "3.3 m"')
    N: float = Field(ge=0.0, le=500.0, description="the blow count for 30 cm, as measured, from 0 to 500")
    fines: float | None = Field(
        default=None, ge=0.0, le=100.0, description="the fines content in percent, from 0 to 100"
    )
    d50: Length | None = Field(default=None, description='the mean grain size, such as "0.25 mm"')
    plasticity: float | None = Field(default=None, ge=0.0, le=500.0, description="the plasticity index in percent")


class Boring(Model):
    """A boring: its name, where it stands along the section, and its tests from the top down."""

    name: str = Field(min_length=1, description="the name of the boring, such as B-1")
    x: Coordinate = Field(description="where it stands along the section, a coordinate in m")
    spt: tuple[Sample, ...] = Field(
        min_length=1, description="its tests, such as [{ depth = 1.3, N = 4, fines = 10 }, ...]"
    )

    @model_validator(mode="after")
    def _from_the_top_down(self) -> Self:
        depths = [float(sample.depth) for sample in self.spt]
        falls = [f"{a:g} m, then {b:g} m" for a, b in pairwise(depths) if b <= a]
        if falls:
            raise ValueError(f"spt: the depths are {'; '.join(falls)}; expected every test below the one before")
        return self
