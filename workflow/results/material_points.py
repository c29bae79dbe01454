"""Stores the slide of each case of liquefaction by the material point method in mpm/slides.json."""

from typing import ClassVar

from pydantic import Field

from fem.settings import Sides
from workflow.results.answer import Answer, SectionLabel
from workflow.results.cases import MovedSurface, SurfaceMovement
from workflow.results.lengths import metres

WARNING = "Warning: "  # how a note begins that warns


class PointCase(SurfaceMovement, MovedSurface):
    """Holds one case by material points."""

    slide_max_m: float = Field(
        description=(
            "largest slide of the surface, to either side, with a damping rate of 10 1/s of velocities that the grid "
            "cannot resolve"
        )
    )
    slide_max_low_m: float = Field(
        description=(
            "lower end of the numerical interval: the smallest of this slide, the slide extrapolated to fine "
            "cells, and the slide changed as in coarse cells by a damping rate of 1 1/s, all at the same place"
        )
    )
    slide_max_high_m: float = Field(
        description="upper end of the numerical interval: the largest of the same three slides"
    )
    settlement_crest_m: float = Field(description="highest level of the ground before the slide less that after it")
    settled: bool = Field(description="whether the surface came to rest")
    reason: str = Field(description="reason why the computation of the slide ended")
    seconds_simulated: float = Field(description="model time since the beginning of the slide (s)")
    transfer_loss_share: float = Field(
        description="energy lost between points and grid, over the total energy exchanged"
    )
    energy_lost_share: float = Field(
        description="energy that is unaccounted for, over the total energy exchanged; negative if energy was created"
    )
    stopped_by: str | None = Field(
        default=None, description="side at which the slide was stopped, or through which it left the section"
    )

    @property
    def highest(self) -> str:
        """Return by how much the highest level of the ground is lower or higher after the slide, in words."""
        settles, change_words = self.settlement_crest_m, metres(abs(self.settlement_crest_m))
        if change_words == metres(0.0):
            return "as high as before"
        return f"{change_words} {'higher' if settles < 0.0 else 'lower'}"


class PointSlidesAnswer(Answer):
    """Holds all cases by number, and the discretisation of the ground by points."""

    FILE: ClassVar[str] = "mpm/slides.json"

    section: SectionLabel = Field(description="section of the points")
    points: int = Field(default=0, description="number of material points of the ground")
    cell_m: float = Field(default=0.0, description="side of a cell of the background grid")
    settled_by_m: float = Field(
        default=0.0, description="displacement of the ground until it was in equilibrium under its weight"
    )
    softened: tuple[str, ...] = Field(
        default=(), description="strata whose stiffness was reduced, so that longer time steps are stable"
    )
    sides: Sides = Field(default="fixed", description="boundary condition of the sides")
    cases: dict[int, PointCase] = Field(default={}, description="cases by number")
    not_possible: str = Field(default="", description="reason why there are no slides by material points")
