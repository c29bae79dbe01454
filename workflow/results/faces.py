"""Stores critical Kh and factor of safety of every face of the structures, by finite elements and bounds, in
fem/faces.json."""

from typing import ClassVar, Literal

from pydantic import Field

from workflow.results.answer import Answer, Known, Line, Part, SectionLabel


class StrongZonePart(Part):
    """Holds a zone along the ground in which nothing fails, so that an earlier failure elsewhere is excluded."""

    start: float = Field(description="x of the left end of the zone (m)")
    end: float = Field(description="x of the right end of the zone (m)")
    depth: float = Field(description="depth of the zone below the ground (m); 1e6 if it reaches down to the base")


class FaceValue(Part):
    """Holds a critical Kh or factor of safety of one face."""

    value: float = Field(description="value by finite elements with ψ = φ")
    davis: float | None = Field(default=None, description="Davis's estimate (low, no bound); null if there is none")
    lower: Known = Field(default=None, description="strict lower bound with ψ = φ, if it was computed for the face")
    upper: Known = Field(default=None, description="strict upper bound with ψ = φ, if it was computed for the face")
    slip_surface: Line = Field(default=(), description="points [x, elevation] of the slip surface (m)")
    strong_zones: tuple[StrongZonePart, ...] = Field(
        default=(), description="strong zones in which nothing fails; empty if the face fails first without them"
    )
    reaches_crest: bool = Field(default=True, description="whether a part of the crest slides")


class FaceStrength(Part):
    """Holds one face of a structure by finite elements."""

    structure: str = Field(description="name of the structure")
    towards: Literal["left", "right"] = Field(description="side to which the face slides")
    critical: FaceValue | None = Field(description="critical Kh of the face; null without an answer")
    safety: FaceValue | None = Field(description="factor of safety of the face without shaking; null without an answer")
    reasons: tuple[str, ...] = Field(default=(), description="reasons why an answer is missing, one sentence each")


class FaceAtRest(Part):
    """Holds the factor of safety of one face in ground after shaking or liquefaction, by finite elements."""

    structure: str = Field(description="name of the structure")
    towards: Literal["left", "right"] = Field(description="side to which the face slides")
    safety: FaceValue | None = Field(description="factor of safety without shaking; null without an answer")
    reason: str = Field(default="", description="reason why there is no factor of safety")


class FacesAnswer(Answer):
    """Holds the faces of all structures."""

    FILE: ClassVar[str] = "fem/faces.json"

    section: SectionLabel = Field(description="section of the structures")
    faces: tuple[FaceStrength, ...] = Field(description="faces of all structures, towards the left and the right")
    after_shaking: tuple[FaceAtRest, ...] = Field(
        default=(), description="factors of safety with the excess pore pressure of shaking; empty without any"
    )

    def of(self, structure: str, towards: str) -> FaceStrength | None:
        """Return the strength of the face of a structure towards one side; None if it was not computed."""
        return next((face for face in self.faces if (face.structure, face.towards) == (structure, towards)), None)
