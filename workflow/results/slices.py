"""Stores slip circles of limit equilibrium, for comparison with elements and bounds, in fem/slices.json."""

from typing import ClassVar, Literal

from pydantic import Field

from meshes.section.structure import Kind
from workflow.results.answer import Answer, Line, Part, Point, SectionLabel


class LongerCircle(Part):
    """Holds the critical slip circle of a section whose ground continues level past both sides."""

    side: Literal["left", "right"] = Field(
        description="side of the section at which the circle of the given section ends"
    )
    past_m: float = Field(description="distance by which the longer circle reaches past this side")
    beyond_m: float = Field(description="length over which the ground was continued beyond the section")
    bishop: float = Field(description="critical Kh by Bishop's simplified method")


class CirclePart(Part):
    """Holds a critical slip circle."""

    towards: Literal["left", "right"] = Field(description="side of the section to which the circle slides")
    centre_m: Point = Field(description="centre [x, elevation] of the circle")
    radius_m: float = Field(description="radius of the circle")
    surface_m: Line = Field(description="points of the slip surface, from left to right")
    bishop: float = Field(description="factor of safety or critical Kh by Bishop's simplified method")
    spencer: float | None = Field(
        description=(
            "factor of safety or critical Kh by Spencer's method on the same circle; null if forces and "
            "moments do not balance"
        )
    )
    frictionless: bool = Field(
        default=False, description="whether no friction acts on the circle, so that moments alone give its value"
    )
    strengthened: bool = Field(
        default=False, description="whether cohesionless faces, which fail first, were given a cohesion"
    )
    longer: LongerCircle | None = Field(
        default=None, description="critical circle of a longer section; None unless this circle ends at a side"
    )


class FactorCircles(Part):
    """Holds the circles with the least factors of safety at one Kh, towards either side, the least first."""

    kh: float = Field(description="seismic coefficient")
    circles: tuple[CirclePart, ...] = Field(description="circles, the one with the least factor of safety first")


class FaceCircle(Part):
    """Holds the critical slip circle of one face of a structure, with which a part of the crest slides."""

    start_m: float = Field(description="x of the left foot of the structure")
    end_m: float = Field(description="x of the right foot of the structure")
    towards: Literal["left", "right"] = Field(description="side to which the face slides")
    circle: CirclePart = Field(description="the circle")


class CirclesAtRest(Part):
    """Holds the slip circles with the least factors of safety without a seismic force.

    The ground has the excess pore pressure of shaking, or its strength after liquefaction.
    """

    cases: tuple[int, ...] = Field(
        default=(), description="cases of liquefaction with this strength; empty without any"
    )
    circles: tuple[CirclePart, ...] = Field(description="circles of the section towards either side, the least first")
    faces: tuple[FaceCircle, ...] = Field(default=(), description="circles of the faces of structures")


class FacePart(Part):
    """Holds one face of a structure, and the slip circles with which a part of its crest slides."""

    structure: str = Field(description="name of the structure")
    kind: Kind = Field(description='kind of the structure, such as "levee"')
    start_m: float = Field(description="x of the left foot of the structure")
    end_m: float = Field(description="x of the right foot of the structure")
    crest_m: tuple[float, float] = Field(description="x of both ends of the crest")
    towards: Literal["left", "right"] = Field(description="side to which the face slides")
    factors: tuple[FactorCircles, ...] = Field(description="factors of safety, at most one circle for each Kh")
    critical: CirclePart | None = Field(description="circle with the least critical Kh")
    davis_factor: CirclePart | None = Field(
        default=None, description="least factor of safety without shaking with Davis's reduced strength, if ψ < φ"
    )
    davis_critical: CirclePart | None = Field(
        default=None, description="least critical Kh with Davis's reduced strength, if ψ < φ"
    )
    reason: str = Field(default="", description="reason why no circle slides with the crest; empty if one does")

    def factor(self, kh: float) -> float | None:
        """Return the least factor of safety at one Kh; None if no circle slides or it was not computed."""
        factors = [circle.bishop for group in self.factors if group.kh == kh for circle in group.circles]
        return factors[0] if factors else None


class SlicesAnswer(Answer):
    """Holds the results of limit equilibrium of slices on slip circles."""

    FILE: ClassVar[str] = "fem/slices.json"

    section: SectionLabel = Field(description="section of the circles")
    factors: tuple[FactorCircles, ...] = Field(description="factors of safety, one entry for each Kh")
    critical: tuple[CirclePart, ...] = Field(description="circles with the least critical Kh, the least first")
    faces: tuple[FacePart, ...] = Field(description="the faces of structures, towards the left and the right")
    after_shaking: CirclesAtRest | None = Field(
        default=None,
        description="circles at Kh = 0 with the excess pore pressure that shaking leaves behind; null without any",
    )
    least_depth: float = Field(description="depth (m) below which circles count; shallower ones are left out")
    reason: str = Field(description="reason why there is no circle; empty if there is one")
    weak_layers: tuple[str, ...] = Field(default=(), description="thin, weak layers that circles cannot follow")
    strong_blocks: tuple[str, ...] = Field(
        default=(), description="soils of steep faces much stronger than the ground below, which may slide as a block"
    )
    endless: bool = Field(
        default=False,
        description="whether the sides are periodic and the slope is endless, which circles cannot follow",
    )
    source: str = Field(description="publications of the methods")

    @property
    def least_of_longer(self) -> float | None:
        """Return the least critical Kh of circles in a longer section; None if no circle ends at a side."""
        return min((circle.longer.bishop for circle in self.critical if circle.longer is not None), default=None)
