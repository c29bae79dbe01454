"""mpm/slides.json: the slide of each case of liquefaction by the material point method."""

from typing import ClassVar

from pydantic import Field

from fem.settings import Sides
from workflow.results.answer import Answer, SectionLabel
from workflow.results.cases import MovedSurface

WARNING = "Warning: "  # how a note begins that warns


class PointCase(MovedSurface):
    """Holds one case by material points. Lengths are in m, positive downslope and down."""

    slide_max_m: float = Field(description="largest slide of the surface, with velocities given up at 10 1/s")
    slide_max_low_m: float = Field(description="smallest of it, and of what finer cells and a decay of 1 1/s come to")
    slide_max_high_m: float = Field(description="largest of the three; that is the method's interval")
    slide_max_at_x_m: float = Field(description="where the surface slides furthest")
    slide_uphill_m: float = Field(description="median over the uphill third of the surface")
    slide_middle_m: float
    slide_downhill_m: float
    settlement_uphill_m: float = Field(description="median over the uphill third of the surface")
    settlement_middle_m: float
    settlement_downhill_m: float
    settlement_crest_m: float = Field(description="how much lower the highest point of the ground is")
    settled: bool = Field(description="whether the surface came to rest")
    reason: str
    seconds_simulated: float
    transfer_loss_share: float = Field(
        description="energy lost between points and grid, over the total energy exchanged"
    )
    energy_lost_share: float = Field(
        description="energy out of balance over the total energy exchanged; negative: created"
    )
    stopped_by: str | None = Field(default=None, description="the side that the slide ran up against, or out of")
    notes: tuple[str, ...] = Field(description="what a reader must know to believe these numbers")


class PointSlidesAnswer(Answer):
    """Holds all cases by number, and the discretisation of the ground by points."""

    FILE: ClassVar[str] = "mpm/slides.json"

    section: SectionLabel
    points: int = Field(default=0, description="material points of the ground")
    cell_m: float = Field(default=0.0, description="side of a cell of the background grid")
    settled_by_m: float = Field(default=0.0, description="how far the ground moved to equilibrium under its weight")
    softened: tuple[str, ...] = Field(
        default=(), description="strata that were made less stiff, so that longer time steps are stable"
    )
    sides: Sides = Field(default="fixed", description="what the sides did")
    cases: dict[int, PointCase] = Field(default={})
    not_possible: str = Field(default="", description="why there are no slides by material points, if there are none")
