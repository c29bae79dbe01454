"""Describes a boring or sounding on the line of a section, with the blow counts or cone resistances measured in it."""

from itertools import pairwise
from typing import Self

from pydantic import Field, model_validator

from meshes.borings.blows import Blows
from meshes.section.quantity import Coordinate, Length, Strength
from meshes.section.section import Model


class Sample(Model):
    """Holds one standard penetration test, and the properties of its sample."""

    depth: Length = Field(description='the depth below the ground in the middle of the test, such as "3.3 m"')
    N: Blows = Field(
        description='the blow count for 30 cm as measured, from 0 to 500, or a refusal such as ">50" or "50/75 mm"'
    )
    fines: float | None = Field(
        default=None, ge=0.0, le=100.0, description="the fines content in percent, from 0 to 100"
    )
    d50: Length | None = Field(default=None, description='the mean grain size, such as "0.25 mm"')
    plasticity: float | None = Field(default=None, ge=0.0, le=500.0, description="the plasticity index in percent")
    energy_ratio: float | None = Field(
        default=None,
        ge=20.0,
        le=120.0,
        description="energy of its hammer in percent of its free fall, from 20 to 120; by default that of [triggering]",
    )


class Cone(Model):
    """Holds the readings of a cone penetration test at one depth."""

    depth: Length = Field(description='the depth below the ground, such as "3.3 m"')
    qc: Strength = Field(description='the cone resistance, corrected for pore pressure (qt), such as "4.2 MPa"')
    fs: Strength = Field(description='the sleeve friction, such as "25 kPa"')
    fines: float | None = Field(
        default=None, ge=0.0, le=100.0, description="the fines content in percent, from 0 to 100; by default from Ic"
    )


class Boring(Model):
    """Holds a boring with its name, its place along the section, and its tests from the top down."""

    name: str = Field(min_length=1, description="the name of the boring, such as B-1")
    x: Coordinate = Field(description="the position along the section, a coordinate in m")
    spt: tuple[Sample, ...] = Field(
        default=(), description="its blow counts, such as [{ depth = 1.3, N = 4, fines = 10 }, ...]"
    )
    cpt: tuple[Cone, ...] = Field(
        default=(), description='its cone resistances, such as [{ depth = 1.3, qc = "4 MPa", fs = "25 kPa" }, ...]'
    )

    @property
    def depths(self) -> list[float]:
        """Return the depths of all tests (m)."""
        return [*(test.depth for test in self.spt), *(test.depth for test in self.cpt)]

    @model_validator(mode="after")
    def _from_the_top_down(self) -> Self:
        if not self.spt and not self.cpt:
            raise ValueError("spt, cpt: missing; expected tests of one kind at least")
        for kind, tests in (("spt", self.spt), ("cpt", self.cpt)):
            falls = [f"{a:g} m, then {b:g} m" for a, b in pairwise(float(test.depth) for test in tests) if b <= a]
            if falls:
                raise ValueError(f"{kind}: the depths are {'; '.join(falls)}; expected every test below the one before")
        return self
