"""Stores the answer of the FEM model that soil discs are calibrated to in dem/continuum.json."""

from collections.abc import Mapping
from typing import ClassVar, Self

from pydantic import Field

from fem.continuum.strength import Flow
from fem.path.path_step import PathStep
from fem.settings import YIELDED, PathVerdict, Sides
from workflow.results.answer import Answer, Line
from workflow.results.continuum import FemAnswer, displacement_at

FLOWS: Mapping[Flow, str] = {
    "davis": "Davis's estimate",
    "associated": "ψ = φ",
    "non-associated": "non-associated flow with the given ψ",
}


class DemCounterpart(Answer):
    """Holds the critical Kh with the sides of the DEM box and the dilation of the soil.

    Only failures count that are deep enough for the discs to resolve.
    """

    FILE: ClassVar[str] = "dem/continuum.json"

    kc: float = Field(description="critical Kh: the largest Kh at which an equilibrium was found")
    kc_upper: float = Field(description="upper end of the bracket on this mesh, not above the critical Kh with ψ = φ")
    verdict: PathVerdict = Field(description='how the path ended: "plateau", "peak", "no failure", or "undecided"')
    reason: str = Field(description="reason of the verdict, in words")
    sides: Sides = Field(description="boundary condition of the sides")
    flow: Flow = Field(description='flow rule; "non-associated" is a non-associated path with the given ψ')
    deeper_than_m: float | None = Field(
        default=None,
        description=(
            "depth below which failures count, if cohesionless faces fail before; discs cannot resolve "
            "shallower failures"
        ),
    )
    instead: str = Field(description="reason why ψ is not the given one; empty if it is")
    yielding_m: float = Field(description="mean displacement at which the path reaches 0.99 of its critical Kh")
    curve: tuple[PathStep, ...] = Field(description="steps of the path: Kh over the mean horizontal displacement")
    slip_surface: Line = Field(description="points [x, elevation] of the slip surface (m)")

    @classmethod
    def of(cls, fem: FemAnswer) -> Self:
        """Return the result of the stage `fem`, which has the sides set in [fem], in the form of this answer."""
        end = fem.last_in_equilibrium()
        return cls.taken(
            fem,
            sides=fem.settings.sides,
            instead="",
            yielding_m=displacement_at(fem.curve, fem.kc, YIELDED),
            slip_surface=end.slip_surface if end else (),
        )

    @property
    def terms(self) -> str:
        """Return the conditions of this critical Kh in words: sides, flow rule, and depth of failures."""
        deep = f", failures deeper than {self.deeper_than_m:.2g} m" if self.deeper_than_m else ""
        return f"{self.sides} sides, {FLOWS[self.flow]}{deep}"
