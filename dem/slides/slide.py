"""Stores the record of a slide of discs."""

from dataclasses import asdict, dataclass, field, fields
from typing import Any

import numpy as np

from dem.slides.rest import moved_lately

WEIGHT_ALONE_TIME = 20.0  # s of a slide without shaking that shows whether the ground flows by its weight alone
LEAST_UPHILL = 0.05  # of the largest slide: smaller movements uphill are no slide
SLIDING_RATIO = 2.0  # displacement over that under Kh alone from which a disc of the surface slides


def stopped_at(side: str) -> str:
    """Return the reason of a slide that a side of the box brought to rest.

    Parameters
    ----------
    side : "left" or "right"

    Returns
    -------
    Sentence for the report.
    """
    return f"the {side} side of the box stopped the slide: in a longer section it would continue"


@dataclass(frozen=True)
class Row:
    """Holds the state of a slide at one time, a line of history.csv.

    Attributes
    ----------
    time_s : time since Kh began to rise (s)
    settlement_uphill_m, settlement_middle_m, settlement_downhill_m : median settlement of each third of the surface (m)
    slide_uphill_m, slide_middle_m, slide_downhill_m : median slide of each third, horizontally downhill (m)
    slide_max_m : largest slide of the surface to either side, smoothed (m)
    kinetic_J, stored_J, dissipated_J : kinetic energy, energy stored in springs and bonds, and energy dissipated by
        friction, dashpots and cracks (J per metre)
    work_J, shaking_J : work of weight, Kh and boundaries together; work of Kh alone (J per metre)
    cracked : number of cracked pore springs
    crack_opening_m : widest gap between discs of the surface (m)
    surface_speed_m_s : largest speed of the surface, smoothed (m/s)
    """

    time_s: float
    settlement_uphill_m: float
    settlement_middle_m: float
    settlement_downhill_m: float
    slide_uphill_m: float
    slide_middle_m: float
    slide_downhill_m: float
    slide_max_m: float
    kinetic_J: float  # noqa: N815
    stored_J: float  # noqa: N815
    dissipated_J: float  # noqa: N815
    work_J: float  # noqa: N815
    shaking_J: float  # noqa: N815
    cracked: int
    crack_opening_m: float
    surface_speed_m_s: float


@dataclass
class Slide:
    """Holds the result of a slide: its history, and the reason why it ended.

    Attributes
    ----------
    rows : rows of the history, one for every record
    settled : whether the surface has come to rest
    reason : reason why the computation of the slide ended
    escaped : number of discs outside the rigid lines
    loose_share : share of the mass that has left the connected ground: flown, or rolled away
    slide_max_at_x_m : place of the largest slide of the surface (m)
    slide : smoothed slide of each disc of the surface, from uphill to downhill (m)
    slide_along : smoothed slide of each surface disc from left to right, over the position of the disc before the slide
        (m)
    surface_before, surface_after : tops of the discs at the surface before and after the slide (m)
    seconds_simulated : simulated time since the onset (s)
    step_share : time step over the stable time step
    overlap : largest overlap of two discs at any record, over their mean radius (-)
    area_lost_share : share of the area of the ground that is lost, beyond drainage and compression of springs
    slide_by_weight_m : largest slide of the same case without shaking (m); None if it was not computed
    flows : whether the slide without shaking is a flow failure
    stopped_by : "left" or "right": the side of the box that stopped the slide
    notes : warnings on the numbers, the most important first: flow failure without shaking, influence of the sides,
        discs in the walls, lost ground, discs that are too strong, layers that are too thin
    """

    rows: list[Row] = field(default_factory=list)
    settled: bool = False
    reason: str = ""
    escaped: int = 0
    loose_share: float = 0.0
    slide_max_at_x_m: float = 0.0
    slide: list[float] = field(default_factory=list)
    slide_along: list[list[float]] = field(default_factory=list)
    surface_before: list[list[float]] = field(default_factory=list)
    surface_after: list[list[float]] = field(default_factory=list)
    seconds_simulated: float = 0.0
    step_share: float = 0.3
    overlap: float = 0.0
    area_lost_share: float = 0.0
    slide_by_weight_m: float | None = None
    flows: bool | None = None
    stopped_by: str | None = None
    notes: list[str] = field(default_factory=list)

    def as_json(self, alone: "Slide | None" = None) -> dict[str, Any]:
        """Return the numbers of a case. alone: the slide of the same ground under Kh without liquefaction; a disc
        counts as sliding if it moves more than twice as far as in ``alone``.
        """
        last = asdict(self.rows[-1])
        answers = {key: last[key] for key in last if key.startswith(("settlement", "slide", "crack_"))}
        out = {
            **answers,
            **{item.name: getattr(self, item.name) for item in fields(self) if item.name not in ("rows", "slide")},
            "cracked_pore_springs": self.rows[-1].cracked,
            "moved_lately_m": moved_lately([row.time_s for row in self.rows], [row.slide_max_m for row in self.rows]),
        }
        if alone is not None:
            slide, without = np.array(self.slide), SLIDING_RATIO * np.array(alone.slide)
            least = LEAST_UPHILL * np.abs(slide).max()
            moving = (slide > np.maximum(without, 0.0)) | (-slide > np.maximum(np.abs(without), least))
            half = len(moving) // 2
            out["slides_over_share"] = float(moving.mean())
            out["slides_over_share_uphill"] = float(moving[:half].mean())
            out["slides_over_share_downhill"] = float(moving[half:].mean())
        return out
